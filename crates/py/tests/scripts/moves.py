"""Moves of single particles, accepted or rejected by the energy after `run 1 pre no post no`: written for LAMMPS' module, which `sys.argv[1]` may name."""

import importlib
import math
import random
import sys

module = importlib.import_module(sys.argv[1])
lammps, LAMMPS_INT, LMP_STYLE_GLOBAL, LMP_VAR_EQUAL = (
    module.lammps,
    module.LAMMPS_INT,
    module.LMP_STYLE_GLOBAL,
    module.LMP_VAR_EQUAL,
)

MOVES, SCATTER, STRIDE, HEAT = 300, 0.05, 0.05, 0.02
random.seed(27848)
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", *sys.argv[2:]])
for line in """
units lj
atom_style bond
atom_modify map array sort 0 0.0
dimension 2
boundary p p p
lattice sq 1.0
region box block 0 8 0 8 -0.5 0.5
create_box 1 box bond/types 1 extra/bond/per/atom 6 extra/special/per/atom 30
create_atoms 1 box
mass 1 1.0
pair_style zero 1.3
pair_coeff * *
special_bonds lj/coul 0 1 1
bond_style harmonic
bond_coeff 1 2.0 1.0
create_bonds many all all 1 0.9 1.1
neighbor 0.5 bin
neigh_modify delay 0 every 1 check yes
variable e equal pe
""".splitlines():
    lmp.command(line)
lmp.command("run 0")
natoms = lmp.extract_global("natoms")
emin = lmp.extract_compute("thermo_pe", LMP_STYLE_GLOBAL, LAMMPS_INT) / natoms
lmp.command("variable emin equal $e")
x = lmp.extract_atom("x")
for i in range(natoms):
    x[i][0] += SCATTER * (2 * random.random() - 1)
    x[i][1] += SCATTER * (2 * random.random() - 1)
lmp.command("variable elast equal $e")
lmp.command("thermo_style custom step v_emin v_elast pe")
lmp.command("run 0")
x = lmp.extract_atom("x")
lmp.command("variable elast equal $e")
estart = elast = lmp.extract_compute("thermo_pe", LMP_STYLE_GLOBAL, LAMMPS_INT) / natoms
taken = 0
for turn in range(MOVES):
    i = random.randrange(0, natoms)
    x0, y0 = x[i][0], x[i][1]
    x[i][0] += STRIDE * (2 * random.random() - 1)
    x[i][1] += STRIDE * (2 * random.random() - 1)
    lmp.command("run 1 pre no post no")
    x = lmp.extract_atom("x")
    e = lmp.extract_compute("thermo_pe", LMP_STYLE_GLOBAL, LAMMPS_INT) / natoms
    if e <= elast or random.random() <= math.exp(natoms * (elast - e) / HEAT):
        elast = e
        lmp.command("variable elast equal $e")
        taken += 1
    else:
        x[i][0], x[i][1] = x0, y0
lmp.command("variable nbuild equal nbuild")
nbuild = lmp.extract_variable("nbuild", None, LMP_VAR_EQUAL)
lmp.command("run 0")
estop = lmp.extract_compute("thermo_pe", LMP_STYLE_GLOBAL, LAMMPS_INT) / natoms
print("energies", "%.10g %.10g %.10g" % (emin, estart, estop))
print("taken", taken, "lists", nbuild >= 0)
lmp.close()

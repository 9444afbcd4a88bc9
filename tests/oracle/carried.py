"""Random decks of other kinds that end in a data file, which both programs read from both and continue with."""
from beside import Read
from bonds import bonds
from grains import grains
from hybrid import hybrid
from mixed import mixed
from motion import motion

# What stands before the file, and what is said again behind it.
BEFORE = {"units", "dimension", "atom_style", "atom_modify", "boundary", "newton", "comm_modify"}
AFTER = {"lattice", "region", "group", "variable", "pair_style", "pair_coeff", "bond_style", "bond_coeff", "special_bonds", "neighbor", "neigh_modify", "timestep", "fix", "fix_modify",
         "compute", "thermo_style", "thermo_modify", "run_style"}


def carried(r):
    """A deck, a data file behind its first run, and a deck that continues from it."""
    deck = r.choice([bonds, bonds, grains, hybrid, hybrid, mixed, motion])(r)
    at = next(k for k, line in enumerate(deck) if line.startswith("run ") and int(line.split()[1]) > 0)
    head = deck[:at] + [f"run {r.choice([1, 10, 20])}"]
    bonded = any(line.startswith("bond_style") for line in deck)
    room = " extra/bond/per/atom 30 extra/special/per/atom 200" if bonded else ""
    rest = [line for line in deck[:at] if line.split()[0] in AFTER and "world" not in line]
    # LAMMPS' state-based bodies break in the first step of all.
    rest += ["run 0"] if any(f"peri/{law} " in line for line in rest for law in ("lps", "ves", "eps")) else []
    # Without masses of types LAMMPS writes zeros, and does not read them.
    head = [line if not line.startswith("set group all diameter") or not bonded else "mass * 1\n" + line for line in head]
    read = [line for line in deck[:at] if line.split()[0] in BEFORE] + [f"read_data ../{{of}}/kept.data{room}"] + rest + ["thermo 5", "run 20", "write_dump all custom read.dump id type x y z vx vy vz radius mass modify sort id format float %.11g"]
    # LAMMPS puts what fix property/atom keeps into a section of its own.
    words = " nofix" + (" nocoeff" if bonded else r.choice(["", " nocoeff"]))
    return Read([part for line in head for part in line.split("\n")] + [f"write_data kept.data{words}"], read)

"""Random decks of one block of peridynamic particles: styles, cuts, indenters."""
from levels import levels

# With neighbours 0.001 apart, upright, turned by whole directions and by odd angles.
LATTICES = ["fcc 0.0014142135623731 origin 0.1 0.2 0", "bcc 0.0011547005383793 origin 0.3 0 0.1", "hcp 0.001", "diamond 0.0023094010767585",
            "fcc 0.0014142135623731 orient x 1 1 0 orient y -1 1 0", "fcc 0.0014142135623731 orient x 1 1 1 orient y 1 -1 0 orient z 1 1 -2",
            "bcc 0.0011547005383793 orient x 1 1 0 orient y -1 1 0", "sc 0.001 orient x 3 4 0 orient y -4 3 0",
            "custom 0.001 a1 1 0 0 a2 0.3 1.1 0 a3 0.2 -0.1 1.2 basis 0 0 0"]


def bodies(r):
    """A deck of one block of peridynamic particles."""
    style = r.choice(["pmb", "pmb", "lps", "ves", "eps"])
    size, horizon = [r.randint(4, 9), r.randint(4, 8), r.randint(3, 6)], r.choice([2.001, 2.5, 3.0001, 3.2])
    # State-based bonds through a periodic face are wrong in LAMMPS; a box must hold two horizons.
    repeats = [style == "pmb" and n >= 2 * horizon + 2 and r.random() < 0.4 for n in size]
    sides = " ".join("p" if p else r.choice("sf") for p in repeats)
    world = " ".join(f"0 {n}" if p else f"-3 {n + 3}" for n, p in zip(size, repeats))
    block = " ".join(f"0 {n - 0.5 if p else n}" for n, p in zip(size, repeats))
    deck = ["units si", "atom_style peri", "atom_modify map array", f"boundary {sides}", "lattice sc 0.001",
            f"region w block {world}", "create_box 1 w", f"region body block {block}", "create_atoms 1 region body"]
    if r.random() < 0.4:
        middle = size[0] // 2
        deck += [f"region cut block {middle - 0.2} {middle + 0.2} INF {size[1] // 2} INF INF", "delete_atoms region cut compress yes"]
    if r.random() < 0.2:
        deck.append(f"delete_atoms random fraction 0.1 yes all NULL {r.randint(1, 9999)}")
    breaking = f"{horizon * 0.001:.7f} {r.choice([0.0008, 0.005, 0.1])} {r.choice([0, 0.25])}"
    moduli = f"{6e10 * r.choice([1, 0.5]):g} {2.4e10 * r.choice([1, 0.7]):g}"
    # Nothing flows in eps: from the onset on LAMMPS' energies grow without end.
    coefficients = {"pmb": f"1.69e22 {breaking}", "lps": f"{moduli} {breaking}",
                    "ves": f"{moduli} {breaking} {r.choice([0.3, 0.7])} {r.choice([1e-6, 1e-5])}", "eps": f"{moduli} {breaking} 1e30"}
    deck += ["set group all density 2700", "set group all volume 1.0e-9", f"pair_style peri/{style}", f"pair_coeff * * {coefficients[style]}",
             f"neighbor {r.choice([0.0003, 0.0007])} bin", f"neigh_modify every {r.choice([1, 5])} delay 0 check yes",
             "region l block INF 1.2 INF INF INF INF", "group left region l"]
    deck.append(r.choice([f"velocity all ramp vx -{r.choice([1, 10])} {r.choice([1, 10])} x 0 {size[0] * 0.001} units box",
                          f"velocity left set {r.choice([2, 20, 50])} {r.choice([0, 3])} 0 units box", "velocity all set 0 0 0"]))
    deck.append("fix 1 all nve")
    if r.random() < 0.4:
        x, y, z = size[0] * 0.0005, size[1] * 0.0005, size[2] * 0.001 + 0.0008
        deck.append(f"fix ind all indent {r.choice(['1e17', '1e19'])} sphere {x:.6g} {y:.6g} {z:.6g} 0.001 units box")
    deck += [line for line in ["fix sf left setforce 0 NULL 0", "fix af left aveforce 0 0 NULL"] if r.random() < 0.25]
    deck += ["compute dmg all damage/atom", "compute ds all reduce sum c_dmg", "compute mx all reduce max vx vy vz",
             "thermo_style custom step atoms pe ke c_ds c_mx[*]", "thermo_modify norm no lost ignore format float %20.13g",
             "timestep 5.0e-8", "thermo 25", "run 0", "run 75"]
    deck = levels(r, deck + r.choice([[], ["run 25"]]), 0.2)
    if not any(repeats) and r.random() < 0.6:
        at = deck.index("create_atoms 1 region body")
        deck[at:at + 1] = [f"lattice {r.choice(LATTICES)}", deck[at], "lattice sc 0.001"]
    return deck

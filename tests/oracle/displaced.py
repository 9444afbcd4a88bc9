"""Random decks of solids whose scene is changed by hand before and between runs."""


def displaced(r):
    """One or two blocks that are moved, pressed, cut and set to other values; then runs with more of that between them."""
    size = [r.randint(4, 8), r.randint(4, 7), r.randint(3, 5)]
    types, apart = r.choice([1, 1, 2, 3]), r.choice([0, 0, 1.6, 4])
    deck = ["units si", "atom_style peri", "atom_modify map array", "boundary f f f", "lattice sc 0.001",
            "region w block -9 30 -9 30 -9 30", f"create_box {types} w",
            *body(r, size), "create_atoms 1 region body"]
    if apart:
        # Above whatever shape the first has: particles at one place end as numbers that are none in LAMMPS.
        at = size[2] + 3.5 + apart
        deck += [f"region second block 1 {size[0] - 1} 1 {size[1] - 1} {at} {at + 2}",
                 f"create_atoms {types} region second"]
    deck += ["region low block INF INF INF INF INF 1.2", "region left block INF 1.7 INF INF INF INF",
             "region middle sphere 2 2 2 1.6", "group low region low", "group left region left", "group middle region middle"]
    if types > 1:
        deck.append(f"set group {r.choice(['low', 'left', 'middle'])} type {types}")
    # One volume: of two particles that repel each other LAMMPS takes that of whichever its list has second.
    deck += ["set group all density 2700", "set group all volume 1.0e-9"]
    style = r.choice(["pmb", "pmb", "lps", "ves", "eps"])
    # LAMMPS weighs bonds of the others by places of creation; their critical stretches are unknown until the second run begins.
    states = style != "pmb"
    deck += [change(r, states) for _ in range(r.randint(0, 3))]
    if states:
        deck = [line for line in deck if not line.startswith("displace_atoms")]
    deck.append(f"pair_style peri/{style}")
    horizon = r.choice([2.001, 2.5, 3.0001, 3.2])
    # One law for all types: of two ends LAMMPS takes the dilatation and moduli of one for both.
    moduli, relaxing = "6e10 2.4e10", f"{r.choice([0.3, 0.7])} {r.choice([1e-6, 1e-5])}"
    ends = {"pmb": "", "lps": "", "ves": relaxing, "eps": "1e30"}
    for i in range(1, types + 1):
        for j in range(i, types + 1):
            first = moduli if states else f"{1.69e22 * r.choice([1, 1, 0.6]):g}"
            deck.append(f"pair_coeff {i} {j} {first} {horizon * 0.001:.7f} "
                        f"{r.choice([0.002, 0.01, 0.1])} {r.choice([0, 0, 0.25])} {ends[style]}".rstrip())
    if not states and r.random() < 0.2:
        deck.append(f"neigh_modify exclude group {r.choice(['low left', 'middle left', 'low low'])}")
    deck += [f"neighbor {r.choice([0.0003, 0.0007])} bin", "neigh_modify every 1 delay 0 check no",
             "fix 1 all nve", "compute dmg all damage/atom", "compute ds all reduce sum c_dmg",
             "compute mx all reduce max vx vy vz x y z",
             "thermo_style custom step atoms pe ke c_ds c_mx[*]", "thermo_modify norm no lost ignore format float %20.13g",
             "timestep 5.0e-8", "thermo 10", *(["run 0", "run 1"] if states else [f"run {r.choice([0, 1, 20])}"])]
    for _ in range(r.randint(0, 3)):
        deck += [change(r, True) for _ in range(r.randint(0, 2))] + [f"run {r.choice([1, 10, 20])}"]
    return deck


def body(r, size):
    """The region of the first block, which may have a bar or a step beside it, or be round."""
    x, y, z = size
    block = f"block 0 {x} 0 {y} 0 {z}"
    if r.random() < 0.5:
        return [f"region body {block}"]
    return r.choice([[f"region one {block}", f"region bar block 0 {r.choice([20, 29])} 0 {r.choice([0.5, 1.5])} {r.choice([0, z])} {z + 0.5}", "region body union 2 one bar"],
                     [f"region one {block}", f"region step block 0 1.5 0 1.5 0 {z + 2}", "region body union 2 one step"],
                     [f"region body sphere {x / 2} {y / 2} {z / 2} {r.choice([2.3, 3.1])}"], [f"region body cylinder x {y / 2} {z / 2} 2.2 0 {x + 9}"],
                     [f"region body cone z {x / 2} {y / 2} 3.2 0.4 0 {z + 3}"]])


def change(r, later=False):
    """A line that changes the scene; some only make sense before families are found."""
    group = r.choice(["all", "low", "left", "middle"])
    small = lambda: f"{r.choice([0, 0, 1, -1]) * r.choice([1e-7, 2e-6, 1e-4]):g}"
    lines = [f"displace_atoms {group} move {small()} {small()} {small()} units box",
             f"displace_atoms {group} ramp {r.choice('xyz')} 0 {small()} {r.choice('xyz')} 0 0.004 units box",
             f"velocity {group} set {r.choice([0, 5, -20])} {r.choice([0, 3])} {r.choice([0, 0, 30, -40])} units box",
             f"velocity {group} ramp vx -5 5 x 0 0.005 units box",
             f"set group {group} density {r.choice([2000, 3000])}"]
    rotate = f"displace_atoms {group} rotate 0.002 0.002 0 0 0 1 {r.choice([2, 30])} units box"
    # What is drawn depends on the last digits of places, which a run leaves other than LAMMPS does.
    scatter = f"displace_atoms {group} random {r.choice(['1e-7', '2e-5'])} 0 1e-6 {r.randint(1, 999)} units box"
    press = [scatter, f"change_box all {r.choice('xyz')} scale {r.choice([0.85, 0.97, 1.03])} remap", rotate,
             f"delete_atoms region middle compress {r.choice(['yes', 'no'])}",
             f"delete_atoms random fraction 0.1 yes all NULL {r.randint(1, 9999)}"]
    return r.choice(lines if later else lines + press)

"""Random decks of what comes and goes: pour, deposit, create_atoms, molecules, evaporate, delete_atoms."""
from levels import levels


def u(r, low, high, digits=3):
    return round(r.uniform(low, high), digits)


def block(r, low, high):
    """Six bounds inside low…high, at least a quarter of it wide."""
    words, width = [], high - low
    for _ in range(3):
        a = u(r, low, low + width * 0.5)
        words += [a, u(r, a + width * 0.25, high)]
    return " ".join(f"{w:g}" for w in words)


def region(r, name):
    shape = r.choice([f"block {block(r, 1, 9)}", f"sphere {u(r, 3, 6)} {u(r, 3, 6)} {u(r, 3, 6)} {u(r, 2, 4)}",
                      f"cylinder z {u(r, 4, 6)} {u(r, 4, 6)} {u(r, 2, 4)} 1 8", f"cone z 5 5 {u(r, 1, 4)} {u(r, 1, 4)} 2 8",
                      f"prism 2 7 2 7 2 7 {u(r, 0, 1)} {u(r, 0, 1)} {u(r, 0, 1)}", f"ellipsoid 5 5 5 {u(r, 1, 4)} {u(r, 1, 4)} {u(r, 1, 4)}"])
    return f"region {name} {shape} units box"


def create(r, flat):
    """Lines that make the first particles."""
    kind = r.choice(["random", "random", "overlap", "lattice", "subset", "ratio", "var", "single"])
    seed = r.randint(1, 99999)
    if kind == "single":
        z = 0 if flat else 5
        return [f"create_atoms {r.choice([1, 2])} single 5 5 {z} units box", f"create_atoms 1 single 2.0 3 {z} units box"]
    where = r.choice(["a", "NULL"])
    if kind == "random":
        return [f"create_atoms {r.choice([1, 2])} random {r.randint(3, 60)} {seed} {where}"]
    if kind == "overlap":
        return [f"create_atoms 1 random {r.randint(3, 60)} {seed} {where} overlap {u(r, 0.3, 1.2)} maxtry {r.choice([5, 50])} units box"]
    lattice = f"lattice {'sq2' if flat and r.random() < 0.5 else 'sq' if flat else r.choice(['sc', 'bcc', 'fcc', 'diamond'])} {u(r, 0.1, 0.6)}"
    place = r.choice(["box", "region a"])
    if kind == "lattice":
        return [lattice, f"create_atoms 1 {place}"]
    if kind == "subset":
        return [lattice, f"create_atoms 2 {place} subset {r.randint(1, 12)} {seed}"]
    if kind == "ratio":
        return [lattice, f"create_atoms 2 {place} ratio {u(r, 0.05, 0.8)} {seed}"]
    return [lattice, "variable xx internal 0.0", "variable yy internal 0.0", "variable keep equal (v_xx*2+v_yy)<12",
            f"create_atoms 1 {place} var keep set x xx set y yy"]


def pour(r, flat):
    words = f"fix ins all pour {r.randint(5, 80)} {r.choice([1, 2])} {r.randint(1, 99999)} region slot"
    one = f"one {u(r, 0.4, 0.9)}"
    words += r.choice(["", f" diam {one}", f" diam range 0.4 {u(r, 0.5, 0.9)}", " diam poly 2 0.5 0.3 0.8 0.7", " diam poly 3 0.5 0.3 0.8 0.5 0.7 0.2"])
    words += r.choice(["", f" vol {u(r, 0.05, 0.4)} {r.choice([5, 50])}"]) + r.choice(["", f" dens 0.5 {u(r, 0.6, 2)}"])
    if r.random() < 0.5:
        words += f" vel -0.2 {u(r, -0.1, 0.3)} " + ("-1.5" if flat else "0 0.2 -1.5")
    return words + r.choice(["", "", " id max", " id next"]) + r.choice(["", "", f" rate {u(r, 0.1, 1)}"])


def deposit(r, flat):
    words = f"fix dep {r.choice(['all', 'some'])} deposit {r.randint(2, 30)} {r.choice([1, 2])} {r.choice([1, 5, 10])} {r.randint(1, 99999)} region slot"
    words += r.choice(["", f" near {u(r, 0.2, 1.2)}"]) + r.choice(["", f" attempt {r.randint(1, 20)}"])
    words += r.choice(["", "", f" global {u(r, 0.5, 1)} {u(r, 1, 2)}", f" local {u(r, 0.5, 1)} {u(r, 1, 2)} {u(r, 0.3, 2)}", f" gaussian 5 5 {0 if flat else 6} {u(r, 0.2, 1)}"])
    for axis in "xyz"[: 2 if flat else 3]:
        words += r.choice(["", f" v{axis} {u(r, -1, 0)} {u(r, 0, 1)}"])
    words += r.choice(["", "", f" target 5 5 {0 if flat else 5}"])
    return words + r.choice(["", "", f" rate {u(r, 0.1, 1)}"]) + r.choice(["", " id max", " id next"]) + " units box"


def more_later(r, deck):
    """Particles made between two runs; after them LAMMPS' `id next` gives ids twice."""
    seed = r.randint(1, 9999)
    return [] if any(" id next" in line for line in deck) else [f"create_atoms 2 random 5 {seed} NULL", "run 10"]


def sources(r):
    """A deck of sources and sinks."""
    flat = r.random() < 0.25
    across = r.choice("ppf")
    sides = f"{across} {r.choice('pf')} " + ("p" if flat else r.choice("ffp"))
    deck = ["units lj", f"dimension {2 if flat else 3}", f"atom_style sphere{r.choice(['', ' 1'])}", "atom_modify map array sort 0 0", f"boundary {sides}",
            "newton off", "comm_modify vel yes", f"region world block 0 10 0 10 {'-0.5 0.5' if flat else '0 10'} units box", "create_box 2 world"]
    deck.append(f"region a block {' '.join(block(r, 1, 9).split()[:4])} -0.5 0.5 units box" if flat else region(r, "a"))
    start = create(r, flat) if r.random() < 0.7 else []
    more = create(r, flat) if r.random() < 0.3 else []
    deck += ["pair_style gran/hooke/history 200 NULL 5 NULL 0.5 1", "pair_coeff * *", "neighbor 3.0 nsq", "neigh_modify every 1 delay 0 check yes"]
    deck += start + (more if not any(line.startswith("variable") for line in start) else [])
    if start and r.random() < 0.5:
        deck.append(f"set type 1 diameter {u(r, 0.3, 0.9)}")
    if start and r.random() < 0.3:
        deck.append(f"set group all type/fraction 2 {u(r, 0.1, 0.9)} {r.randint(1, 9999)}")
    if start and r.random() < 0.3:
        deck.append(f"set group all type/ratio 1 {u(r, 0.1, 0.9)} {r.randint(1, 9999)}")
    deck += ["region slab block INF INF INF 5 INF INF units box", "group some type 1", "group slab region slab"]
    if r.random() < 0.5:
        deck.append(f"velocity {r.choice(['all', 'some', 'slab'])} create {u(r, 0.1, 1)} {r.randint(1, 99999)}"
                    + r.choice(["", " dist gaussian", " dist uniform", " loop geom", " loop local", " mom no", " rot yes", " sum yes"]))
    if r.random() < 0.4:
        deck.append(r.choice(["delete_atoms group slab", "delete_atoms region a", "delete_atoms region a compress no",
                              "delete_atoms overlap 0.5 some all", "delete_atoms group slab compress yes",
                              f"delete_atoms random fraction {u(r, 0.1, 0.9)} yes all NULL {r.randint(1, 9999)}",
                              f"delete_atoms random fraction {u(r, 0.1, 0.9)} no some a {r.randint(1, 9999)}",
                              f"delete_atoms random count {r.randint(1, 6)} no all NULL {r.randint(1, 9999)}"]))
    if r.random() < 0.2:
        deck.append(f"displace_atoms all random {u(r, 0, 0.1)} {u(r, 0, 0.1)} {0 if flat else 0.1} {r.randint(1, 9999)} units box")
    deck += ["timestep 0.005", "fix 1 all nve/sphere" + (" disc" if flat and r.random() < 0.5 else "")]
    down = "vector 0 -1 0" if flat else "vector 0 0 -1"
    deck.append(f"fix g all gravity {u(r, 0.5, 2)} {down}")
    if flat:
        deck += ["fix e all enforce2d", f"region slot block 1 {u(r, 4, 9)} {u(r, 5, 6)} {u(r, 7, 9)} -0.5 0.5 units box"]
    else:
        deck.append(r.choice([f"region slot block 1 {u(r, 4, 9)} 2 {u(r, 5, 9)} {u(r, 4, 6)} {u(r, 7, 9)} units box",
                              f"region slot cylinder z 5 5 {u(r, 2, 4.5)} {u(r, 4, 6)} {u(r, 7, 9)} units box"]))
    what = r.random()
    if what < 0.45:
        deck.append(pour(r, flat))
    elif what < 0.9:
        deck.append(deposit(r, flat))
    if r.random() < 0.3:
        deck.append(f"fix ev {r.choice(['all', 'some', 'slab'])} evaporate {r.choice([5, 10, 13])} {r.randint(1, 3)} a {r.randint(1, 99999)}")
    deck += ["compute er all erotate/sphere", "compute sx all reduce sum x y z vx vy vz", "compute p all property/atom id type mass radius",
             "compute sp all reduce sum c_p[*]", "compute mp all reduce max c_p[1] x y z", "variable gs equal count(some)", "variable gl equal count(slab)",
             "variable ga equal count(all,a)", "variable m equal mass(all)",
             "thermo_style custom step atoms ke c_er v_gs v_gl v_ga v_m c_sx[*] c_sp[*] c_mp[*] temp press",
             "thermo_modify norm no lost ignore format float %20.13g", f"thermo {r.choice([5, 10])}", f"run {r.choice([30, 60])}"]
    # With new ids LAMMPS loses some contacts' springs.
    deck += r.choice([[], ["run 20"], ["delete_atoms group slab compress no", "run 20"], ["unfix g", "run 0"] if what > 0.45 else [],
                      more_later(r, deck), ["set type 2 diameter 0.7", "run 10"]])
    deck.append("write_dump all custom end.dump id type x y z vx vy vz radius mass modify sort id format float %.12g")
    # Across periodic faces LAMMPS' contacts of outer levels see old velocities.
    deck = levels(r, deck, 0 if "p" in sides.split()[: 2 if flat else 3] else 0.4)
    # Newcomers take the first kick of an inner level from whoever stood in their place in LAMMPS' memory.
    new = any(line.split()[:2] in (["fix", "ins"], ["fix", "dep"]) for line in deck)
    return [line for line in deck if not (new and line.startswith("fix_modify"))]

"""Random decks of some dozen grains in boxes that lean, at rest or sheared."""
from grains import EDGE, contact_law, placed


def box(r):
    """Edges and tilts of a box, none leaning by more than 0.45 of another."""
    lengths = [round(r.uniform(4.5, EDGE), 3) for _ in range(3)]
    lean = lambda along: round(r.choice([0, 1, 1]) * r.uniform(-0.45, 0.45) * lengths[along], 3)
    return lengths, [lean(0), lean(0), lean(1)]


def packing(r, lengths, tilt):
    """Spheres that overlap by 3 % at most, images included: place, diameter, type."""
    (lx, ly, lz), (xy, xz, yz) = lengths, tilt
    at = lambda f: [f[0] * lx + f[1] * xy + f[2] * xz, f[1] * ly + f[2] * yz, f[2] * lz]
    images = [at([a, b, c]) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1)]
    spheres = []
    for _ in range(1500):
        d, p = round(r.uniform(0.6, 1.1), 3), [round(a, 4) for a in at([r.uniform(0.02, 0.98) for _ in range(3)])]
        apart = all(sum((a - b + s) ** 2 for a, b, s in zip(p, q, image)) > ((d + e) / 2 * 0.97) ** 2
                    for q, e, _ in spheres for image in images)
        if apart and len(spheres) < 45:
            spheres.append((p, d, r.choice([1, 2])))
    return spheres[: r.randint(10, 45)]


def motion(r, name):
    """What a tilt or length does under fix deform."""
    ways = {
        "x": ["erate 0.05", "trate -0.05", "scale 1.05", "vel 0.2"], "z": ["erate -0.05", "delta -0.1 0.1", "wiggle 0.2 0.3"],
        "xy": ["erate 1.5", "final 1.0", "delta -2.5", "vel 4", "trate 0.5", "wiggle 1.5 0.3"],
        "xz": ["erate -1.2", "delta 0.8", "vel -3", "wiggle 0.7 0.2"], "yz": ["delta 0.1", "erate 0.1", "wiggle 0.1 0.2"],
    }
    return f"{name} {r.choice(ways[name])}"


def tilted(r):
    """A deck of grains in a triclinic box."""
    lengths, tilt = box(r)
    spheres = packing(r, lengths, tilt)
    sides = r.choice(["p p p", "p p p", "p p f", "p p s"])
    corners = " ".join(f"0 {l}" for l in lengths)
    deck = placed(r, sides, f"prism {corners} {' '.join(map(str, tilt))}", spheres)
    if r.random() < 0.4:
        numbers = f"2000 {r.choice(['NULL', '700'])} 5 NULL 0.4 {r.choice([0, 1])}"
        deck += [f"pair_style gran/{r.choice(['hooke', 'hooke/history', 'hertz/history'])} {numbers}", "pair_coeff * *"]
    else:
        deck += ["pair_style granular", f"pair_coeff * * {contact_law(r)}"]
    # What rolls or twists is not to cross faces: LAMMPS turns the sign of what one side of the pair remembers.
    stays = any(word in deck[-1] for word in (" rolling ", " twisting "))
    skin = r.choice([0.2, 0.4, 1.0])
    deck += ["neighbor 3.0 nsq" if stays else f"neighbor {skin} bin", "neigh_modify every 1 delay 0 check yes",
             f"timestep {r.choice([0.0005, 0.001])}", "group odd id 1:60:2", "fix 1 all nve/sphere"]
    maybe = ["fix g all gravity 9.81 vector 1 0 -1", "fix v odd viscous 0.3", "fix a odd addforce 0.1 -0.2 0.05", "fix s odd spring/self 0.5",
             "fix m all momentum 20 linear 1 1 1", "neigh_modify exclude type 1 2", "fix l odd move linear 0.2 NULL -0.1"]
    deck += [line for line in maybe if r.random() < 0.2]
    names = ["x", "xy", "xz", "yz"] + (["z"] if sides == "p p p" else [])
    moved = [n for n in names if r.random() < 0.4]
    # It refuses tilts of an edge that follows the particles, and time steps that change beside fix move.
    if sides == "p p s":
        moved = [n for n in moved if n not in ("xz", "yz")]
    # LAMMPS refuses a yz that may flip while xy changes.
    moved = [n for n in moved if n != "yz" or abs(tilt[2]) < 0.3 * lengths[1]]
    ramps = [motion(r, n) for n in moved]
    # Nor a trate of nothing.
    ramps = [ramp for ramp in ramps if "trate" not in ramp or tilt[0] != 0]
    if ramps and r.random() < 0.7:
        deck.append(f"fix d all deform {r.choice([1, 1, 3])} {' '.join(ramps)} remap {r.choice(['x', 'v', 'v', 'none'])} units box{' flip no' if stays else ''}")
    sums = ["er all erotate/sphere", "cn all contact/atom", "cs all reduce sum c_cn", "sx all reduce sum x y z vx vy vz",
            "om all property/atom omegax omegay omegaz", "so all reduce sum c_om[*]", "ms all msd", "gy all gyration",
            "pa all property/atom xs ys zs xu yu zu", "sp all reduce sum c_pa[*]", "st all stress/atom NULL", "ss all reduce sum c_st[*]"]
    deck += [f"compute {line}" for line in sums]
    deck += [f"dump d all custom 100 tilted.dump id x y z xsu ysu zsu ix iy iz fx", "dump_modify d sort id format float %.12g",
             "thermo_style custom step atoms ke c_er c_cs press pxx pxy pxz pyz c_sx[*] c_so[*] c_ms[4] c_gy c_sp[*] c_ss[*] lx ly lz xy xz yz vol cellgamma",
             "thermo_modify norm no lost ignore format float %20.13g", "thermo 50", "run 150"]
    later = r.choice([[], ["run 100"], [] if any("move" in line for line in deck) else ["timestep 0.0004", "run 100"], ["set group odd vx 0.1", "run 100"],
                      [f"change_box all {r.choice(['xy delta 0.3', 'xz delta -0.2', 'x scale 1.02'])} {r.choice(['', 'remap '])}units box", "run 60"]])
    deck += [] if stays else later
    # LAMMPS' gyration continues with the mass of lost particles.
    return deck if "f" not in sides else [line.replace(" c_ms[4] c_gy", "") for line in deck]

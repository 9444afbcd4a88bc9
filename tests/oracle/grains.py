"""Random decks of some dozen grains: contact laws, walls, fixes."""
from levels import levels

EDGE = 6.0


def packing(r):
    """Spheres in a box that overlap by 3 % at most: place, diameter, type."""
    spheres = []
    for _ in range(4000):
        d, p = round(r.uniform(0.6, 1.1), 3), [round(r.uniform(0.6, EDGE - 0.6), 4) for _ in range(3)]
        apart = all(sum((a - b) ** 2 for a, b in zip(p, q)) > ((d + e) / 2 * 0.97) ** 2 for q, e, _ in spheres)
        if apart and len(spheres) < 60:
            spheres.append((p, d, r.choice([1, 2])))
    return spheres[: r.randint(10, 60)]


def contact_law(r):
    """The words of one granular model."""
    normal = r.choice(["hooke 2000", "hertz 2000", "hertz/material 2000", "dmt 2000", "jkr 2000"])
    sticky, material = normal[:3] in ("dmt", "jkr"), normal[:3] in ("dmt", "jkr") or "material" in normal
    damping = r.choice(["velocity", "mass_velocity", "viscoelastic"] + ([] if sticky else ["tsuji", "coeff_restitution"]))
    eta = 0.6 if damping in ("tsuji", "coeff_restitution") else 5
    rest = {"jkr": " 0.3 0.5", "dmt": " 0.3 0.2"}.get(normal[:3], " 0.3" if material else "")
    stiffness = "NULL" if material and r.random() < 0.6 else "800"
    friction = r.choice(
        ["linear_nohistory 0.5 0.4", "linear_history 500 0.5 0.4", "linear_history_classic 500 0.5 0.4"]
        + [f"mindlin{kind} {stiffness} 0.5 0.4" for kind in ("", "/force", "_rescale", "_rescale/force")]
        + ["mindlin_classic 800 0.5 0.4"]
    )
    words = f"{normal} {eta}{rest} damping {damping} tangential {friction}"
    if r.random() < 0.4:
        words += " rolling sds 200 2 0.2"
    if r.random() < 0.4:
        # Without a tangential spring LAMMPS' marshall is 0/0.
        words += " twisting marshall" if "nohistory" not in friction and r.random() < 0.5 else " twisting sds 50 1 0.3"
    return words + (" limit_damping" if not sticky and r.random() < 0.3 else "")


def walls(r, sides, law):
    """Some walls, of the pair style's law or one of the same family."""
    lines = []
    if sides[2] == "f" and r.random() < 0.8:
        motion = r.choice(["", " wiggle z 0.05 2.0", " shear x 0.5"])
        lines.append(f"fix wz all wall/gran {law()} zplane 0.0 {r.choice(['NULL', EDGE])}{motion}")
    if sides[:2] == "ff" and r.random() < 0.6:
        region = r.choice(
            ["block 0.1 5.9 0.1 5.9 0.05 5.9", "sphere 3 3 3 3.6", "cylinder z 3 3 3.4 0 6", "cone z 3 3 2.0 4.0 -0.2 6.5",
             "sphere 3 3 0.2 0.9 side out", "plane 3 3 0.3 0.1 0.2 1"]
        )
        lines += [f"region w {region} units box", f"fix wr all wall/gran/region {law()} region w"]
    return lines


def placed(r, sides, region, spheres):
    """The lines that make a box of two types with spheres that move and spin."""
    deck = ["units lj", "atom_style sphere 1", "atom_modify map array sort 0 0", f"boundary {sides}",
            "newton off", "comm_modify vel yes", f"region b {region} units box", "create_box 2 b"]
    deck += [f"create_atoms {t} single {p[0]} {p[1]} {p[2]} units box" for p, _, t in spheres]
    for k, (_, d, _) in enumerate(spheres, 1):
        v, w = ([round(r.uniform(-s, s), 4) for _ in range(3)] for s in (1, 2))
        deck.append(f"set atom {k} diameter {d} density {round(r.uniform(0.5, 2), 3)} vx {v[0]} vy {v[1]} vz {v[2]}"
                    f" omega {w[0]} {w[1]} {w[2]}")
    return deck


def grains(r):
    """A deck of grains."""
    sides = "".join(r.choice(side) for side in ("pf", "pf", "fp"))
    spheres = packing(r)
    deck = placed(r, " ".join(sides), f"block 0 {EDGE} 0 {EDGE} 0 {EDGE}", spheres)
    if r.random() < 0.35:
        style = r.choice(["hooke", "hooke/history", "hertz/history"])
        numbers = f"2000 {r.choice(['NULL', '700'])} 5 {r.choice(['NULL', '2.0'])} 0.4 {r.choice([0, 1])}"
        numbers += " limit_damping" if r.random() < 0.3 else ""
        deck += [f"pair_style gran/{style} {numbers}", "pair_coeff * *"]
        law = lambda: f"{style} {numbers}"
    else:
        own = contact_law(r)
        mixed = own.replace("2000", r.choice(["1000", "3000"]), 1)
        deck += ["pair_style granular"] + r.choice(
            [[f"pair_coeff * * {own}"], [f"pair_coeff 1 1 {own}", f"pair_coeff 2 2 {mixed}"]])
        law = lambda: "granular " + (own if r.random() < 0.5 else contact_law(r))
    # One order of the grains of a pair in all of LAMMPS' lists.
    deck += ["neighbor 5.0 nsq", "neigh_modify every 1 delay 0 check yes", f"timestep {r.choice([0.0005, 0.001])}",
             "group odd id 1:60:2", "group few id 3 5 8", "group mob subtract all few"]
    kind = r.choice(["single", "single force 1 on off on torque 1 off off on", "single reinit no"])
    deck += r.choice([
        ["fix 1 all nve/sphere"],
        ["fix fz few freeze", "fix 1 mob nve/sphere"],
        [f"fix r few rigid {kind}", "fix 1 mob nve/sphere", "neigh_modify exclude group few few"],
    ])
    maybe = ["fix g all gravity 9.81 vector 0 0 -1", "fix c all gravity 1 chute 25", "fix v odd viscous 0.3", "fix vs all viscous/sphere 0.1",
             "fix a odd addforce 0.1 -0.2 0.05", "fix sf mob setforce 0 NULL 0.1", "fix at odd addtorque 0.01 0.02 -0.01",
             "fix m all momentum 20 linear 1 1 0", "fix d odd drag 3 3 3 0.05 0.2", "fix s odd spring/self 0.5", "neigh_modify exclude type 1 2"]
    deck += [line for line in maybe if r.random() < 0.25]
    deck += walls(r, sides, law)
    sums = ["er all erotate/sphere", "cn all contact/atom", "cs all reduce sum c_cn", "sx all reduce sum x y z vx vy vz",
            "om all property/atom omegax omegay omegaz", "so all reduce sum c_om[*]"]
    deck += [f"compute {line}" for line in sums]
    deck += ["thermo_style custom step atoms ke c_er c_cs press c_sx[*] c_so[*]",
             "thermo_modify norm no lost ignore format float %20.13g", "thermo 50", "run 100"]
    deck += r.choice([[], ["run 100"], ["timestep 0.0008", "run 100"], ["set group odd vx 0.1", "run 100"]])
    # Not what LAMMPS gets wrong (docs/coming-from-lammps.md).
    return levels(r, deck, 0 if "p" in sides or any("rigid" in line for line in deck) else 0.3)

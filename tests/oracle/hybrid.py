"""Random decks of one or two peridynamic bodies among grains: pair_style hybrid, contacts between both kinds, walls."""
from levels import levels

DX = 0.001
VOLUME = 1e-9


def law(r):
    """A pair style of grains and its coefficients, of SI size."""
    if r.random() < 0.4:
        style = r.choice(["gran/hooke", "gran/hooke/history", "gran/hertz/history"])
        stiffness = "2e10" if "hertz" in style else "2e6"
        damping = {"gran/hertz/history": "1e10"}.get(style, "2e5")
        numbers = f"{stiffness} {r.choice(['NULL', stiffness])} {damping} NULL {r.choice([0, 0.3])} {r.choice([0, 1])}"
        return f"{style} {numbers}{r.choice(['', ' limit_damping'])}", [""]
    words = []
    for size in (1, r.choice([1, 0.5])):
        words.append(granular(r, size))
    return "granular", words


def granular(r, size):
    """The words of one granular model."""
    normal = r.choice(["hooke 2e6", "hertz 2e10", "hertz/material 2e10", "dmt 2e10", "jkr 2e10"])
    sticky, material = normal[:3] in ("dmt", "jkr"), normal[:3] in ("dmt", "jkr") or "material" in normal
    damping = r.choice(["velocity", "mass_velocity", "viscoelastic"] + ([] if sticky else ["tsuji", "coeff_restitution"]))
    eta = {"velocity": 0.3, "mass_velocity": 2e5, "viscoelastic": 1e10 if "hooke" not in normal else 1e9}.get(damping, 0.7)
    if "hooke" in normal and damping == "viscoelastic":
        eta = 1e3
    rest = {"jkr": " 0.25 20", "dmt": " 0.25 20"}.get(normal[:3], " 0.25" if material else "")
    stiffness = "NULL" if material and r.random() < 0.7 else ("1e6" if "hooke" in normal else "1e10")
    mindlin = [f"mindlin{kind} {stiffness} 0.8 0.3" for kind in ("", "/force", "_rescale", "_rescale/force")] if "hooke" not in normal else []
    friction = r.choice(["linear_nohistory 0.5 0.4", "linear_history 1e6 0.5 0.4"] + mindlin)
    words = f"{normal.replace('2e', f'{2 * size:g}e')} {eta}{rest} damping {damping} tangential {friction}"
    if r.random() < 0.3:
        words += " rolling sds 1e5 0.1 0.2"
    if r.random() < 0.3 and "nohistory" not in friction:
        words += " twisting marshall"
    return words


def material(r, style, horizon):
    """Coefficients of one body, times the volume of a particle: true forces on true masses."""
    breaking = f"{horizon * DX:.7f} {r.choice([0.0008, 0.004, 0.1])} {r.choice([0, 0.25])}"
    bulk, shear = 4e10 * r.choice([1, 0.5]) * VOLUME, 2.4e10 * r.choice([1, 0.7]) * VOLUME
    if style == "pmb":
        return f"{18 * bulk / (3.14159 * (horizon * DX) ** 4):.6g} {breaking}"
    rest = {"lps": "", "ves": f" {r.choice([0.3, 0.7])} {r.choice([1e-6, 1e-5])}", "eps": " 1e30"}[style]
    return f"{bulk:.6g} {shear:.6g} {breaking}{rest}"


def lattice_points(size, offset):
    return [tuple((n + o) * DX for n, o in zip((i, j, k), offset))
            for i in range(size[0]) for j in range(size[1]) for k in range(size[2])]


def impactors(r, points):
    """Grains that nearly touch the bodies or each other: place, diameter, type."""
    found, low, high = [], [min(p[k] for p in points) for k in range(3)], [max(p[k] for p in points) for k in range(3)]
    wanted = r.randint(1, 12)
    for _ in range(30000):
        d = round(r.uniform(0.0008, 0.002), 5)
        p = [round(r.uniform(a - 0.002, b + 0.002), 6) for a, b in zip(low, high)]
        gap = min(sum((a - b) ** 2 for a, b in zip(p, q)) ** 0.5 - (d + DX) / 2 for q in points)
        among = min([sum((a - b) ** 2 for a, b in zip(p, q)) ** 0.5 - (d + e) / 2 for q, e, _ in found], default=1)
        if -1e-5 < gap < 1e-4 and among > -1e-5 or (-1e-5 < among < 5e-5 and gap > 0):
            found.append((p, d, r.choice([3, 4])))
        if len(found) == wanted:
            break
    return found


def hybrid(r):
    """A deck of bodies and grains."""
    style, horizon = r.choice(["pmb", "pmb", "lps", "ves", "eps"]), r.choice([2.001, 2.5, 3.0001])
    size = [r.randint(4, 6), r.randint(4, 6), r.randint(3, 4)]
    two = r.random() < 0.5
    second = [r.randint(3, 4), r.randint(3, 5), r.randint(3, 4)]
    gap = [size[0] + r.choice([0, 0.02, -0.02, 0.3]), r.choice([0, 0.3]), r.choice([0, 1])]
    points = lattice_points(size, (0, 0, 0)) + (lattice_points(second, gap) if two else [])
    grains = impactors(r, points)
    newton = r.choice(["off", "off", "off", "on"])
    deck = ["units si", f"atom_style hybrid {r.choice(['sphere peri', 'peri sphere'])}", "atom_modify map array sort 0 0",
            f"newton {newton}", "comm_modify vel yes", f"boundary {' '.join(r.choice('ffs') for _ in range(3))}", f"lattice sc {DX}",
            "region w block -5 16 -5 12 -5 10", "create_box 4 w"]
    deck += [f"region one block -0.1 {size[0] - 0.9:g} -0.1 {size[1] - 0.9:g} -0.1 {size[2] - 0.9:g}", "create_atoms 1 region one"]
    if two:
        low, high = [g - 0.1 for g in gap], [g + n - 0.9 for g, n in zip(gap, second)]
        deck += [f"lattice sc {DX} origin {gap[0] % 1:g} {gap[1] % 1:g} {gap[2] % 1:g}",
                 "region two block " + " ".join(f"{a:g} {b:g}" for a, b in zip(low, high)), "create_atoms 2 region two"]
    deck += [f"create_atoms {t} single {p[0]} {p[1]} {p[2]} units box" for p, _, t in grains]
    deck += [f"set type 1*2 diameter {0.98 * DX:g}", "set type 1 mass 2.5e-6", f"set type 2 mass {r.choice([2.5, 5])}e-6",
             f"set group all volume {VOLUME:g}"]
    for k, (_, d, _) in enumerate(grains, len(points) + 1):
        v, w = ([round(r.uniform(-s, s), 3) for _ in range(3)] for s in (r.choice([1, 20]), 3000))
        deck.append(f"set atom {k} diameter {d} density {r.choice([2500, 7800])} vx {v[0]} vy {v[1]} vz {v[2]} omega {w[0]} {w[1]} {w[2]}")
    deck += ["group body type 1 2", "group grain type 3 4", "region half block INF 2.1 INF INF INF INF units lattice",
             "group half region half", "group halfbody intersect half body",
             "region low block INF INF INF INF INF 0.5", "group foot region low", "group foot2 intersect foot body"]
    pair, laws = law(r)
    overlay = r.random() < 0.3
    peri = f"peri/{style}"
    order = [peri, pair] if r.random() < 0.5 else [pair, peri]
    deck.append(f"pair_style hybrid{'/overlay' if overlay else ''} {' '.join(order)}")
    gran = pair.split()[0]
    own = other = material(r, style, horizon)
    joined = r.random() < 0.4
    # State-based bonds between types of different moduli are wrong in LAMMPS; perigrain's ves has one lambda and one tau.
    if style == "pmb" or (not joined and style != "ves"):
        other = material(r, style, horizon)
    deck += [f"pair_coeff 1 1 {peri} {own}", f"pair_coeff 2 2 {peri} {other}"]
    deck.append(f"pair_coeff 1 2 {peri} {own}" if joined else f"pair_coeff 1 2 {gran} {laws[0]}")
    deck += [f"pair_coeff 1*2 3*4 {gran} {laws[0]}", f"pair_coeff 3*4 3*4 {gran} {laws[-1]}"]
    # Walls of style history without damping are 0/0 in LAMMPS: laws here are damped.
    deck += ["neighbor 0.005 nsq", "neigh_modify every 1 delay 0 check yes", f"timestep {r.choice(['2e-8', '5e-8'])}"]
    if r.random() < 0.2:
        deck.append("neigh_modify exclude type 3 3")
    deck += ["fix 1 body nve", r.choice(["fix 2 grain nve/sphere", "fix 2 grain nve/sphere", "fix 2 grain freeze"])]
    wall = f"{gran} {laws[0]}".strip() if gran == "granular" else " ".join([gran.removeprefix("gran/")] + pair.split()[1:])
    who = lambda: r.choice(["all", "grain", "body", "half"])
    maybe = ["fix g all gravity 9.81 vector 0 0 -1", "fix g2 grain gravity 1e6 vector 1 0 -1", "fix v body viscous 0.1",
             "fix sf foot setforce 0 NULL 0", "fix sf2 foot2 setforce 0 0 0", "fix af body aveforce NULL NULL 0",
             "fix ad grain addforce 0 0 -1", "fix vs grain viscous/sphere 1e-9", "fix m all momentum 20 linear 1 1 1",
             f"fix wz {who()} wall/gran {wall} zplane -0.0005 NULL", f"fix wx {who()} wall/gran {wall} xplane -0.00051 {r.choice(['NULL', '0.02'])}",
             f"fix wg {who()} wall/gran/region {wall} region cup",
             f"fix ind {who()} indent {r.choice(['1e9', '1e10'])} sphere 0.002 0.002 {(size[2] - 1) * DX + 0.0009:.6g} 0.001 units box",
             "velocity body ramp vx -2.03 2.11 x 0 0.005 units box", "velocity halfbody set 5 0 -1 units box", "velocity body set 0 0 -10 units box"]
    deck.append("region cup " + r.choice(["block -0.0012 0.02 -0.0012 0.02 -0.0005 0.02", "cylinder z 0.0025 0.0025 0.0052 -0.002 0.02",
                                          "sphere 0.0025 0.0025 0.001 0.006", "plane 0 0 -0.0005 0 0 1"]) + " units box")
    if style != "pmb":
        deck.append("run 0")
    deck += [line for line in maybe if r.random() < 0.22]
    deck += ["compute dmg all damage/atom", "compute ds all reduce sum c_dmg", "compute cn all contact/atom", "compute cs all reduce sum c_cn",
             "compute er grain erotate/sphere", "compute mo all momentum", "compute kb body ke", "compute kg grain ke",
             "compute mx all reduce max vx vy vz", "compute pa all pe/atom", "compute ps body reduce sum c_pa",
             "variable fz equal fcm(grain,z)", "variable vx equal vcm(body,x)", "variable xg equal xcm(grain,y)",
             "compute st all stress/atom NULL virial", "compute ss all reduce sum c_st[*]",
             "compute di all displace/atom", "compute dm body reduce max c_di[4]",
             "thermo_style custom step atoms pe ke c_ds c_cs c_er c_mo[*] c_kb c_kg c_mx[*] c_ps v_fz v_vx v_xg c_dm c_ss[*]",
             "thermo_modify norm no lost ignore format float %20.13g", "thermo 25", "run 75"]
    deck += r.choice([[], ["run 25"], ["velocity grain set 0 0 -20 units box", "run 25"]])
    deck = levels(r, deck, 0.3, parts=2)
    return deck + ["write_dump all custom end.dump id type x y z vx vy vz fx fy fz omegax omegay omegaz c_dmg modify sort id format float %.12g"]

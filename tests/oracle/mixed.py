"""Random decks of three types of grains of very different sizes: laws by pair of types, several pair styles, moving walls."""
from grains import contact_law

EDGE = 6.0


def packing(r, flat):
    """Spheres of three types that hardly overlap, the larger ones first: place, diameter, type."""
    spheres = []
    for kind, low, high, most in ((3, 1.6, 2.2, 4), (2, 0.8, 1.2, 12), (1, 0.25, 0.5, 40)):
        many = 0
        for _ in range(600):
            d = round(r.uniform(low, high), 3)
            p = [round(r.uniform(d / 2, EDGE - d / 2), 4) for _ in range(3)]
            if flat:
                p[2] = 0
            if many < most and all(sum((a - b) ** 2 for a, b in zip(p, q)) > ((d + e) / 2 * 0.98) ** 2 for q, e, _ in spheres):
                spheres.append((p, d, kind))
                many += 1
    return spheres


def classic(r):
    """A pair style of the older kind, with its words."""
    style = r.choice(["gran/hooke", "gran/hooke/history", "gran/hertz/history"])
    return f"{style} {r.choice([1000, 2000])} {r.choice(['NULL', 700])} {r.choice([3, 5])} {r.choice(['NULL', 2.0])} {r.choice([0, 0.4])} {r.choice([0, 1])}{r.choice(['', ' limit_damping'])}"


def laws(r):
    """Pair style and coefficients; the law of walls."""
    pairs = ["1 1", "2 2", "3 3", "1 2", "1 3", "2 3"]
    if r.random() < 0.5:
        lines = ["pair_style granular"]
        if r.random() < 0.5:
            own = contact_law(r)
            # LAMMPS mixes laws of one shape; the rest is said.
            lines += [f"pair_coeff {k} {k} {own.replace('2000', str(1000 * k), 1)}" for k in (1, 2, 3)]
        else:
            lines += [f"pair_coeff {pair} {contact_law(r)}" for pair in pairs]
        return lines, "granular " + contact_law(r)
    older = classic(r)
    name = older.split()[0]
    parts = [older, "granular"] if r.random() < 0.5 else ["granular", older]
    lines = [f"pair_style hybrid{r.choice(['', '/overlay'])} {' '.join(parts)}"]
    for pair in pairs:
        what = r.random()
        if what < 0.4 or pair == "1 1":
            lines.append(f"pair_coeff {pair} {name}")
        else:
            lines.append(f"pair_coeff {pair} granular {contact_law(r)}")
            if "overlay" in lines[0] and what > 0.9:
                lines.append(f"pair_coeff {pair} {name}")
    if not any(" granular " in line for line in lines[1:]):
        lines[-1] = f"pair_coeff 2 3 granular {contact_law(r)}"
    return lines, f"{older[5:]}"


def kept(deck):
    """Whether no grain may be deleted: fixes hold them, or the last grains, which take their places in LAMMPS' lists, would
    stand first in pairs that remember rolling and twisting."""
    return any("few" in line for line in deck if line.startswith("fix")) or any(" rolling " in line or " twisting " in line for line in deck)


def mixed(r):
    """A deck of grains of three types."""
    flat = r.random() < 0.3
    sides = [r.choice("pfsm") for _ in range(2)] + ["p" if flat else r.choice("pfsm")]
    deck = ["units lj", f"dimension {2 if flat else 3}", "atom_style sphere 1", "atom_modify map array sort 0 0", f"boundary {' '.join(sides)}", "newton off", "comm_modify vel yes",
            f"region b block 0 {EDGE} 0 {EDGE} {'-0.5 0.5' if flat else f'0 {EDGE}'} units box", "create_box 3 b"]
    spheres = packing(r, flat)
    deck += [f"create_atoms {t} single {p[0]} {p[1]} {p[2]} units box" for p, _, t in spheres]
    for k, (_, d, _) in enumerate(spheres, 1):
        v, w = ([round(r.uniform(-s, s), 3) for _ in range(3)] for s in (1, 2))
        if flat:
            v[2] = w[0] = w[1] = 0
        deck.append(f"set atom {k} diameter {d} density {r.choice([0.6, 1, 2])} vx {v[0]} vy {v[1]} vz {v[2]} omega {w[0]} {w[1]} {w[2]}")
    pair, wall = laws(r)
    deck += pair + ["neighbor 7.0 nsq", "neigh_modify every 1 delay 0 check yes", f"timestep {r.choice([0.0005, 0.001])}", "group small type 1", "group large type 2 3", "group few id 2 5 8", "group mob subtract all few",
                    "variable t equal step*dt", "variable lift equal 0.2*sin(6*v_t)", "variable turn equal 0.8*v_t", "variable grow equal 3.2-0.4*v_t", "variable push equal 3*cos(9*v_t)", "variable each atom 0.3*x-vy"]
    if r.random() < 0.3:
        deck.append(f"neigh_modify exclude {r.choice(['type 1 1', 'group few few', 'type 1 3', 'group small large'])}")
    deck += [r.choice(["fix 1 all nve/sphere", "fix 1 all nve/sphere", "fix 1 mob nve/sphere\nfix fz few freeze", "fix 1 mob nve/sphere\nfix mv few move wiggle 0.1 0.05 NULL 0.4",
                       f"fix 1 mob nve/sphere\nfix rb few rigid{r.choice(['', '/nve'])} {r.choice(['single', 'group 1 few'])}{' force 1 on on off torque 1 off off on' if flat else ''}\nneigh_modify exclude group few few"])]
    if flat:
        deck.append("fix e2 all enforce2d")
    z = "0" if flat else "-1"
    forces = [f"fix g all gravity v_grow vector {'1 -1 0' if flat else '0.2 0 -1'}", "fix v small viscous 0.4", f"fix af large addforce v_push v_each {0 if flat else 'v_push'}", "fix vs all viscous/sphere 0.0005 scale 3 2", f"fix sf few setforce NULL v_push {'NULL' if flat else 'v_each'}",
              f"fix dr all drag 3 3 {0 if flat else 'NULL'} 0.2 0.5", "fix m all momentum 25 linear 1 1 0 angular", f"fix at large addtorque 0 0 v_push"]
    deck += [line for line in forces if r.random() < 0.25]
    box = lambda axes: not any(sides["xyz".index(a)] == "p" for a in axes)
    if box("x") and r.random() < 0.5:
        deck.append(f"fix wx all wall/gran {wall} xplane {r.choice(['0.0', 'NULL'])} {EDGE} {r.choice(['', 'wiggle x 0.05 1.0', 'shear y 0.7'])}")
    if box("y") and r.random() < 0.5:
        deck.append(f"fix wy large wall/gran {wall} yplane 0.0 {r.choice(['NULL', EDGE])} {r.choice(['', 'wiggle y 0.05 1.0', 'shear x 0.7'])}")
    if not flat and box("z") and r.random() < 0.5:
        deck.append(f"fix wz small wall/gran {wall} zplane 0.0 NULL {r.choice(['', 'wiggle z 0.05 1.0', 'shear y 0.7'])}")
    if not flat and box("xy") and r.random() < 0.6:
        shape = r.choice(["cylinder z 3 3 3.1 INF INF move v_lift NULL NULL", "block 0.05 5.95 0.1 5.9 INF INF rotate v_turn 3 3 3 0 0 1", "sphere 3 3 3 3.5 move v_lift NULL NULL", "plane 3 3 0.4 0 0.1 1 move NULL NULL v_lift", "sphere 3 3 3 3.4 rotate v_turn 3 3 2 0 1 0",
                          "cylinder z 3 3 0.6 INF INF side out rotate v_turn 3 3 0 0 0 1", "cone z 3 3 3.6 2.5 -1 7", "block 0.1 5.9 0.1 5.9 0.1 5.9 move v_lift NULL NULL rotate v_turn 3 3 3 0 0 1", "block 1 5 1 5 -1 0.3 side out"])
        deck += [f"region wr {shape} units box", f"fix wr {r.choice(['all', 'large'])} wall/gran/region {wall} region wr"]
    deck += ["compute er all erotate/sphere", "compute cn all contact/atom", "compute cs all reduce sum c_cn", "compute sx all reduce sum x y z vx vy vz", "compute om all property/atom omegax omegay omegaz", "compute so all reduce sum c_om[*]", "compute st small stress/atom NULL",
             "compute ss all reduce sum c_st[*]", "compute kl large ke", f"thermo_style custom step atoms ke c_er c_cs pe press vol c_sx[*] c_so[*] c_ss[*] c_kl", "thermo_modify norm no lost ignore format float %20.13g", "thermo 20", "run 80"]
    deck += r.choice([[], ["run 40"], ["run 20 every 10 \"velocity few set 0 0 0\"", "run 140 upto"], ["run 40 every 20 NULL"], ["set type 1 vx 0.1", "run 20"], ["delete_atoms group few", "run 20"] if not kept(deck) else []])
    return [part for line in deck for part in line.split("\n")] + ["write_dump all custom end.dump id type x y z vx vy vz fx fy fz omegax omegay omegaz modify sort id format float %.11g"]

"""Random decks of rigid bodies among grains: bodies of two to five spheres, under all rigid fixes, in boxes of all kinds."""
from grains import contact_law
from motion import some

EDGE = 7.0


def bodies(r, flat):
    """Bodies that do not touch each other: lists of places and diameters."""
    found, middles = [], []
    for _ in range(2000):
        many = r.choice([1, 2, 2, 3, 4, 5])
        reach = 0.5 if many == 1 else 0.9
        middle = [r.uniform(reach, EDGE - reach) for _ in range(3)]
        if flat:
            middle[2] = 0.0
        if any(sum((a - b) ** 2 for a, b in zip(middle, m)) < (reach + far) ** 2 for m, far in middles):
            continue
        parts = []
        for _ in range(many):
            p = [round(m + (r.uniform(-0.3, 0.3) if many > 1 else 0), 4) for m in middle]
            if flat:
                p[2] = 0
            parts.append((p, round(r.uniform(0.4, 0.75), 3)))
        found.append(parts)
        middles.append((middle, reach))
        if len(found) == 14:
            break
    return found[: r.randint(3, 14)]


def rigid(r):
    """A deck of rigid bodies."""
    flat = r.random() < 0.25
    sides = [r.choice("ppfsm") for _ in range(2)] + ["p" if flat else r.choice("ppfsm")]
    found = bodies(r, flat)
    deck = ["units lj", f"dimension {2 if flat else 3}", "atom_style sphere", "atom_modify map array sort 0 0", f"boundary {' '.join(sides)}", "newton off", "comm_modify vel yes cutoff 4.0",
            "fix mol all property/atom mol i_kind ghost yes", f"region b block 0 {EDGE} 0 {EDGE} {'-0.5 0.5' if flat else f'0 {EDGE}'} units box", "create_box 2 b"]
    tag, free, clumps = 0, [], []
    for k, parts in enumerate(found, 1):
        ids = []
        density, v = round(r.uniform(0.5, 2), 3), [round(r.uniform(-1, 1), 3) for _ in range(3)]
        for p, d in parts:
            tag += 1
            ids.append(tag)
            deck += [f"create_atoms {r.choice([1, 2])} single {p[0]} {p[1]} {p[2]} units box"]
            spin = [round(r.uniform(-2, 2), 3) for _ in range(3)]
            # Parts of a body need not agree on how it moves.
            u = [x + (r.choice([0, 0, 0.2]) if len(parts) > 1 else 0) for x in v]
            if flat:
                u[2] = spin[0] = spin[1] = 0
            free_spin = f" omega {spin[0]} {spin[1]} {spin[2]}" if r.random() < 0.5 else ""
            deck.append(f"set atom {tag} diameter {d} density {density} vx {u[0]:.3f} vy {u[1]:.3f} vz {u[2]:.3f}{free_spin}")
            deck.append(f"set atom {tag} mol {k if len(parts) > 1 else 0} i_kind {k if len(parts) > 1 else 0}")
        (clumps if len(parts) > 1 else free).append(ids)
    if not clumps:
        return rigid(r)
    deck += [f"group clumps id {' '.join(str(i) for ids in clumps for i in ids)}"]
    deck += [f"group free id {' '.join(str(i) for ids in free for i in ids)}"] if free else []
    if r.random() < 0.4:
        law = f"{r.choice(['hooke', 'hooke/history', 'hertz/history'])} 2000 {r.choice(['NULL', '700'])} 5 {r.choice(['NULL', '2.0'])} 0.4 {r.choice([0, 1])}"
        deck += [f"pair_style gran/{law}", "pair_coeff * *"]
    else:
        law = "granular " + contact_law(r)
        deck += ["pair_style granular", f"pair_coeff * * {law[9:]}"]
    deck += ["neighbor 3.0 nsq", "neigh_modify every 1 delay 0 check yes", f"timestep {r.choice([0.0005, 0.001])}"]
    # Some bodies press themselves, which moves nothing.
    inside = r.random() < 0.15
    deck += [] if inside else [f"neigh_modify exclude {r.choice(['molecule/intra', 'molecule/intra'])} clumps"]
    deck += ["variable grow equal 0.5+step*dt", "variable each atom 0.1*id", "group odd id 1:80:2", "region half block INF 3.5 INF INF INF INF units box"]
    zero, null = ("0", "NULL") if flat else ("0.1", "0")
    gravity = "fix g all gravity 3 vector 0 -1 0" if flat else "fix g all gravity 3 vector 0.2 0.1 -1"
    deck += some(r, [gravity, "fix v all viscous 0.3", f"fix a odd addforce 0.2 {r.choice(['v_grow', 'v_each'])} {zero}", f"fix s {r.choice(['odd', 'clumps'])} setforce NULL {r.choice(['0', '0.3'])} {null}",
                     f"fix d all drag 3 3 {0 if flat else 'NULL'} 0.1 0.5", "fix vs all viscous/sphere 0.05", "fix af clumps aveforce 0.1 NULL NULL"], 0.25)
    if sides[0] != "p" and r.random() < 0.5:
        deck.append(f"fix wx all wall/gran {law} xplane 0.0 {EDGE}")
    if not flat and sides[2] != "p" and r.random() < 0.5:
        deck.append(f"fix wz all wall/gran {law} zplane 0.0 {r.choice(['NULL', EDGE])}{r.choice(['', ' shear x 0.3'])}")
    if flat:
        deck.append("fix e2 all enforce2d")
    deck += ["fix 1 free nve/sphere" + (" disc" if flat and r.random() < 0.3 else "")] if free else []
    # LAMMPS overlooks the forces of fixes that stand below in the first half kick, so this one is last.
    many = len(clumps)
    style = r.choice(["rigid/small molecule", "rigid/small molecule", "rigid/nve/small molecule", "rigid molecule", "rigid/nve molecule", "rigid custom i_kind", "rigid/small custom i_kind", "group", "single"])
    first, which = "clumps", style
    if style == "group" or (style == "single" and many > 1):
        names = []
        for k, ids in enumerate(clumps, 1):
            names.append(f"c{k}")
            deck.append(f"group c{k} id {' '.join(map(str, ids))}")
        which = f"{r.choice(['rigid', 'rigid/nve'])} group {many} {' '.join(names)}"
    elif style == "single":
        which = f"{r.choice(['rigid', 'rigid/nve'])} single"
    # Steps of NO_SQUISH hang on the axes, which of bodies with two equal moments are anybody's choice.
    if any(len(ids) == 2 for ids in clumps):
        which = which.replace("rigid/nve", "rigid")
    small = "small" in which
    extra = ""
    if not small and r.random() < 0.4 and "nve" not in which:
        extra += f" force {r.choice(['*', '1'])} {r.choice(['on', 'off'])} on {'off' if flat else r.choice(['on', 'off'])}"
        extra += f" torque {r.choice(['*', '1'])} {'off off on' if flat else r.choice(['off off on', 'on on off', 'off off off'])}"
    if r.random() < 0.2:
        extra += " reinit no"
    deck.append(f"fix r {first} {which}{extra}")
    # Which of two equal moments' axes comes first is anybody's choice.
    columns = [] if "torque" in extra and "off off off" not in extra and not flat else ["f_r"]
    # LAMMPS takes six degrees of freedom from each sphere in a body, of three that it counts, and ends below zero.
    deck += ["compute_modify thermo_temp extra/dof -1000"]
    deck += ["compute sx all reduce sum x y z vx vy vz", "compute om all property/atom omegax omegay omegaz tqx tqy tqz", "compute so all reduce sum c_om[*]", "compute er all erotate/sphere", "compute un all property/atom xu yu zu",
             "compute su all reduce sumsq c_un[*]", "compute kl clumps ke", "compute st all stress/atom NULL", "compute ss all reduce sum c_st[*]", "compute ms all msd com yes", "compute pr all pressure NULL virial"]
    columns += ["c_er", "c_su[*]", "c_kl", "c_ms[4]"]
    if not small:
        last = 1 if "single" in which else many
        columns += [f"f_r[{r.randint(1, last)}][{k}]" for k in r.sample(range(1, 16), 5)]
    elif "nve" not in which:
        names = ["mass", "x", "y", "z", "vx", "vy", "vz", "fx", "fy", "fz", "omegax", "omegay", "omegaz", "angmomx", "angmomz", "tqx", "tqz", "inertiax", "inertiay", "inertiaz", "xu", "yu", "zu", "ix", "iy", "id", "mol"]
        chosen = r.sample(names, 6)
        deck += [f"compute rl clumps rigid/local r {' '.join(chosen)}", "compute rs all reduce sum c_rl[*] inputs local", "compute rx all reduce max c_rl[*] inputs local"]
        columns += ["c_rs[*]", "c_rx[*]"]
    if "group" not in which and "single" not in which:
        deck += ["compute ke2 clumps ke/rigid r", "compute er2 clumps erotate/rigid r"]
        columns += ["c_ke2", "c_er2"]
    if r.random() < 0.5:
        deck += ["compute cc clumps chunk/atom molecule nchunk once limit 0 ids once compress yes", "compute cm all com/chunk cc", "compute cv all vcm/chunk cc", "compute cl all angmom/chunk cc", "compute co all omega/chunk cc", "compute ci all inertia/chunk cc"]
        columns += ["c_cm[1][1]", "c_cv[1][2]", "c_cl[1][3]", "c_cl[1][1]", "c_co[1][3]", "c_ci[1][1]", "c_ci[1][4]"]
    deck += [f"thermo_style custom step atoms ke pe c_pr c_pr[1] c_pr[4] c_sx[*] c_so[*] c_ss[*] {' '.join(columns)} {r.choice(['', 'vol lx xlo'])}",
             "thermo_modify norm no lost ignore format float %20.13g", "thermo 20", f"run {r.choice([60, 100])}"]
    deck += r.choice([[], [], ["run 40"], ["velocity clumps set 0.3 NULL NULL", "run 20"], ["displace_atoms clumps move 0.05 0 0 units box", "run 20"], *([["unfix r", "fix r2 clumps nve/sphere", "thermo_style custom step ke c_pr", "run 20"]] if "group" in which or "single" in which else []), ["reset_timestep 1000", "run 20"]])
    return deck + ["write_dump all custom end.dump id type x y z vx vy vz fx fy fz omegax omegay omegaz tqx tqy tqz radius mass ix iy iz modify sort id format float %.11g"]

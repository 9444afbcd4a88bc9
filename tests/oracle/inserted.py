"""Random decks of molecules that come: poured, deposited and created, as rigid bodies or of free spheres, onto walls and each other."""

from sources import u


def template(r, name, flat):
    """Lines that write a molecule's file: two to five spheres that overlap."""
    n = r.randint(2, 5)
    places = [[0.0, 0.0, 0.0]]
    while len(places) < n:
        before = r.choice(places)
        step = [u(r, -0.4, 0.4) for _ in range(3)]
        place = [round(a + b, 3) for a, b in zip(before, step)]
        if flat:
            place[2] = 0.0
        if all(sum((a - b) ** 2 for a, b in zip(place, q)) > 0.04 for q in places):
            places.append(place)
    kinds = [r.choice([1, 1, 2]) for _ in places]
    wide = [u(r, 0.35, 0.6) for _ in places]
    sections = ["Coords", "", *(f"{k} {p[0]} {p[1]} {p[2]}" for k, p in enumerate(places, 1)), "", "Types", "", *(f"{k} {t}" for k, t in enumerate(kinds, 1)), "",
                "Diameters", "", *(f"{k} {d}" for k, d in enumerate(wide, 1))]
    if r.random() < 0.6:
        sections += ["", "Masses", "", *(f"{k} {u(r, 0.05, 0.2)}" for k in range(1, n + 1))]
    lines = ["# made at random", "", f"{n} atoms", ""] + sections
    return [f'print "{lines[0]}" file {name}.mol screen no'] + [f'print "{line}" append {name}.mol screen no' for line in lines[1:]]


def inserted(r):
    """A deck of molecules that come."""
    flat = r.random() < 0.3
    sides = f"{r.choice('pf')} {r.choice('f') if flat else r.choice('pf')} {'p' if flat else 'f'}"
    names = ["one"] if r.random() < 0.6 else ["one", "two"]
    deck = [line for name in names for line in template(r, name, flat)]
    deck += ["units lj", f"dimension {2 if flat else 3}", "atom_style sphere", "atom_modify map array sort 0 0", f"boundary {sides}", "newton off", "comm_modify vel yes cutoff 3.0",
             "fix prop all property/atom mol ghost yes", f"region world block 0 12 0 12 {'-0.5 0.5' if flat else '0 12'} units box", "create_box 3 world"]
    law = r.choice(["hooke 2000 NULL 20 NULL 0.5 0", "hooke/history 2000 NULL 20 NULL 0.5 1", "hertz/history 3000 NULL 30 NULL 0.4 1"])
    deck += [f"pair_style gran/{law}", "pair_coeff * *", "neighbor 1.5 nsq", "neigh_modify every 1 delay 0 check yes exclude molecule/intra all", "timestep 0.002",
             f"molecule obj {' '.join(f'{n}.mol' for n in names)}" + r.choice(["", f" offset {r.choice([0, 1])} 0 0 0 0" if len(names) == 1 else ""])]
    stiff = r.random() < 0.75
    # Of molecules of several kinds LAMMPS' pour counts too few.
    what = r.choice(["pour", "deposit", "deposit", "create"] if len(names) == 1 else ["deposit", "create"])
    where = "block 2 10 6 11 -1e-12 1e-12" if flat else r.choice(["block 2 10 2 10 6 11", "cylinder z 6 6 4 6 11"])
    deck += [f"region slot {where} units box", "group nobody empty"]
    if r.random() < 0.5 or what == "create":
        middle = "0" if flat else "4"
        deck += [f"create_atoms 0 single 5 3 {middle} mol obj {r.randint(1, 9999)}" + r.choice(["", f" rotate {u(r, 10, 300, 1)} 0 0 1"]) + " units box"] if len(names) == 1 else []
        if what == "create":
            deck += [f"create_atoms 0 random {r.randint(2, 8)} {r.randint(1, 9999)} slot mol obj {r.randint(1, 9999)} overlap 1.0 maxtry 20 units box"]
    deck += ["fix g all gravity 1 vector 0 -1 0" if flat else "fix g all gravity 1 vector 0 0 -1"]
    share = f" molfrac {r.choice(['0.3 0.7', '0.5 0.5'])}" if len(names) == 2 and r.random() < 0.6 else ""
    bodies = " rigid rb" if stiff else ""
    if stiff:
        deck.append(f"fix rb all rigid/small molecule mol obj")
    else:
        deck.append("fix nv all nve/sphere")
    if what == "pour":
        deck.append(f"fix ins all pour {r.randint(3, 25)} 0 {r.randint(1, 99999)} region slot vol {u(r, 0.05, 0.3)} {r.choice([5, 30])} mol obj{share}{bodies}" + r.choice(["", f" vel -0.2 0.2 {'-1' if flat else '-0.1 0.1 -1'}"]) + r.choice(["", " id max", " id next"]))
    elif what == "deposit":
        words = f"fix ins all deposit {r.randint(2, 12)} 0 {r.choice([5, 10, 20])} {r.randint(1, 99999)} region slot near {u(r, 0.3, 1.0)} attempt {r.choice([5, 20])} mol obj{share}{bodies}"
        words += r.choice(["", f" vx -0.5 0.5", f" v{'y' if flat else 'z'} -2 -1"]) + r.choice(["", f" orient 0 0 1" if flat else f" orient {r.choice(['1 0 0', '0 0 1', '1 1 0'])}"]) + r.choice(["", " id max", " id next"])
        deck.append(words + " units box")
    wall = "yplane" if flat else "zplane"
    deck += [f"fix w all wall/gran {law} {wall} 0 NULL"] + (["fix e2 all enforce2d"] if flat else [])
    deck += ["compute_modify thermo_temp extra/dof -10000 dynamic/dof yes", "compute er all erotate/sphere", "compute sx all reduce sum x y z vx vy vz", "compute p all property/atom id type mass radius mol",
             "compute sp all reduce sum c_p[*]", "compute mp all reduce max c_p[1] c_p[5] x y z", "compute om all property/atom omegax omegay omegaz", "compute so all reduce sumsq c_om[*]"]
    # Without bodies LAMMPS' temperature is 0/0.
    columns = ["f_rb"] if stiff and what == "create" else []
    if what == "create" or r.random() < 0.3:
        # Their numbers are not known before all have come.
        deck += ["compute cc all chunk/atom molecule nchunk every ids every", "compute vc all vcm/chunk cc"]
        columns += ["c_vc[1][1]"] if what == "create" else []
    deck += [f"thermo_style custom step atoms ke pe c_er c_sx[*] c_sp[*] c_mp[*] c_so[*] {' '.join(columns)}", "thermo_modify norm no lost ignore format float %20.13g", "thermo 20",
             f"run {r.choice([100, 300])}"]
    deck += r.choice([[], ["run 40"], ["unfix ins", "run 40"] if what != "create" else []])
    return deck + ["write_dump all custom end.dump id type mol x y z vx vy vz omegax omegay omegaz radius mass ix iy iz modify sort id format float %.10g"]

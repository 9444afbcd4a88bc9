"""Random decks of what the other kinds leave out: baths, walls without contacts, bonds that are taken away, controllers, pressures that move faces, fragments."""
from bonds import clumps
from motion import some

EDGE = 9.0


def gas(r, sides):
    """Spheres that fly in a box, as lines."""
    lines = []
    for k in range(r.randint(5, 30)):
        x = [r.uniform(0.5, EDGE - 0.5) for _ in range(3)]
        lines.append(f"create_atoms {r.choice([1, 2])} single {x[0]:.3f} {x[1]:.3f} {x[2]:.3f} units box")
    return ["units lj", "atom_style sphere", "atom_modify map array sort 0 0", f"boundary {sides}", "newton off", "comm_modify vel yes",
            f"region world block 0 {EDGE} 0 {EDGE} 0 {EDGE} units box", "create_box 2 world"] + lines + [
            "pair_style zero 1.0", "pair_coeff * *", "delete_atoms overlap 0.7 all all", "set group all diameter 0.8 density 1.2", "set type 2 diameter 0.6"]


def solid(r, sides):
    """Two clumps of harmonic bonds, as lines."""
    points, near = clumps(r)
    return ["units lj", "atom_style hybrid sphere bond", "atom_modify map array sort 0 0", "boundary f f f", "newton off", "comm_modify vel yes",
            "region world block -2 11 -2 11 -2 15 units box", "create_box 3 world bond/types 2 extra/bond/per/atom 30 extra/special/per/atom 200"] + points + [
            "set group all diameter 0.9 density 1", "group one type 1", "group two type 2", "bond_style zero", "bond_coeff *", "special_bonds lj/coul 0 1 1",
            "pair_style zero 3.0", "pair_coeff * *", f"create_bonds many one one 1 0.3 {near * 1.05:.3f}", f"create_bonds many two two 2 0.3 {near * 1.05:.3f}",
            "bond_style harmonic", f"bond_coeff 1 {r.choice([50, 300])} {near:g}", f"bond_coeff 2 {r.choice([50, 300])} {near * 0.98:.3f}"]


def odds(r):
    """A deck of odds and ends."""
    bonded = r.random() < 0.4
    sides = [r.choice("ppfsm") for _ in range(3)]
    deck = solid(r, sides) if bonded else gas(r, " ".join(sides))
    sides = "fff" if bonded else sides
    law = r.choice(["hooke 300 NULL 2 NULL 0.3 0", "hooke/history 300 NULL 2 NULL 0.3 1", "hertz/history 500 NULL 2 NULL 0.3 1"])
    deck += [f"pair_style gran/{law}", "pair_coeff * *", "neighbor 1.5 nsq", "neigh_modify every 1 delay 0 check yes", f"timestep {r.choice([0.002, 0.004])}",
             f"velocity all create {r.choice([0.3, 2.0])} {r.randint(1, 99999)} loop geom", "group odd id 1:200:2", "region half block INF 4 INF INF INF INF units box",
             "variable place equal 0.4+0.1*sin(step*0.05)", "variable hot equal 0.5+0.01*step", "variable each atom 0.2+0.1*(id%3)", "variable stiff equal 20+step*0.1", "variable level internal 1.0",
             "variable weight atom mass*vx^2", "variable now equal c_k+0.001*step", "compute k all ke", "fix 1 all nve/sphere"]
    deck += some(r, [
        f"fix la {r.choice(['all', 'odd'])} langevin {r.choice(['1.0 1.0', '0.5 2.0', 'v_hot 1.0', 'v_each 1.0'])} {r.choice([0.5, 5.0])} {r.randint(1, 99999)}"
        + r.choice(["", " omega yes", " tally yes", " zero yes", " scale 2 2.5", " tally yes omega yes"]),
        "fix g all gravity 1 vector 0 0 -1", "fix v odd viscous 0.2",
        f"fix co all controller {r.choice([5, 10])} {r.choice([0.5, 2.0])} {r.choice([0, 0.1])} {r.choice([0, 0.2])} {r.choice(['-0.5', '0.3'])} c_k {r.choice([0, 5.0])} level\nvariable push equal v_level\nfix pu odd addforce v_push 0 0",
        f"fix hw all ave/histo/weight {r.choice(['1 1 5', '5 2 20', '2 5 10'])} -1 1 6 vx v_weight mode vector file hw.out" + r.choice(["", " beyond extra", " ave running", " beyond end"]),
    ], 0.4)
    free = [d for d in range(3) if sides[d] != "p"]
    if free and r.random() < 0.6:
        d = r.choice(free)
        axis = "xyz"[d]
        if r.random() < 0.5:
            ends = r.choice([f"{axis}lo EDGE {axis}hi EDGE", f"{axis}lo v_place", f"{axis}lo EDGE", f"{axis}hi 8.0"]) if not bonded else f"{axis}lo EDGE {axis}hi EDGE"
            if sides[d] == "f" or "EDGE" not in ends:
                deck.append(f"fix wr {r.choice(['all', 'odd'])} wall/reflect {ends} units box")
        elif bonded:
            deck.append(f"fix wh all wall/harmonic {axis}lo {r.choice(['-1.9', 'v_low'])} {r.choice(['30', 'v_stiff'])} 1.0 1.5 units box" + r.choice(["\nfix_modify wh energy yes", "\nfix_modify wh virial yes", ""]))
            deck.insert(0, "variable low equal -2.0+0.05*sin(step*0.1)")
    if bonded and r.random() < 0.6:
        deck.append(f"fix bb {r.choice(['all', 'one'])} bond/break {r.choice([1, 5])} {r.choice([1, 2])} {r.choice([1.02, 1.1, 1.3])}" + r.choice(["", f" prob 0.5 {r.randint(1, 9999)}"]))
    if not bonded and "".join(sides) == "ppp" and r.random() < 0.7:
        deck.append(f"fix dp all deform/pressure {r.choice([1, 3])} " + " ".join(r.sample([f"x pressure {r.choice([0, 0.05])} {r.choice([0.1, 1.0])}", f"y {r.choice(['vel -0.2', 'pressure 0.02 0.5'])}", "z erate 0.02", "z volume"], 2)) + r.choice([" remap x", " remap v", ""]) + " units box")
    columns = []
    extra = {
        "ag": ("compute ag all aggregate/atom 0.9\ncompute am all reduce max c_ag\ncompute an all reduce sum c_ag" if bonded else "compute ag all cluster/atom 0.9\ncompute am all reduce max c_ag\ncompute an all reduce sum c_ag", ["c_am", "c_an"]),
        "gl": ("compute vt vector none", []),
        "ch": ("compute ct all chunk/atom type\ncompute cv all vcm/chunk ct\ncompute ca all angmom/chunk ct\ncompute gg all global/atom c_ct c_cv[1] c_ca[3]\ncompute gs all reduce sum c_gg[*]", ["c_gs[*]", "c_ca[1][2]"]),
        "fr": (f"compute fg all fragment/atom{r.choice(['', ' single yes'])}\ncompute fm all reduce max c_fg\ncompute fs all reduce sum c_fg\ncompute fc all chunk/atom c_fg nchunk every compress yes\ncompute fp all property/chunk fc count id\ncompute fq all com/chunk fc", ["c_fm", "c_fs", "c_fp[1][1]", "c_fq[1][2]"]),
        "pe": ("compute pa all pe/atom\ncompute ps all reduce sum c_pa", ["c_ps"]),
        "st": ("compute st all stress/atom NULL\ncompute ss all reduce sum c_st[*]", ["c_ss[*]"]),
        "tm": ("compute ts all temp/sphere\ncompute tr odd temp/region half", ["c_ts", "c_tr"]),
    }
    extra.pop("gl")
    if not bonded:
        extra.pop("fr")
    for key in r.sample(sorted(extra), r.randint(1, 4)):
        lines, shown = extra[key]
        deck += lines.split("\n")
        columns += shown
    deck = [part for line in deck for part in line.split("\n")]
    ids = {line.split()[1] for line in deck if line.startswith("fix ")}
    columns += ["f_la"] if "la" in ids else []
    # LAMMPS' values of a controller before it acts are whatever was in memory.
    columns += ["v_level"] if "co" in ids else []
    columns += ["f_hw[1]", "f_hw[4]"] if "hw" in ids else []
    columns += ["f_bb[1]", "f_bb[2]", "bonds"] if "bb" in ids else []
    columns += ["f_wh", "f_wh[1]"] if "wh" in ids else []
    columns += ["lx", "ly", "lz"] if "dp" in ids else []
    deck += ["compute sx all reduce sum x y z vx vy vz", f"thermo_style custom step atoms ke pe press c_sx[*] {' '.join(columns)} {r.choice(['', 'ecouple econserve', 'etotal'])}",
             "thermo_modify norm no lost ignore format float %20.13g", "thermo 20", f"run {r.choice([40, 100])}"]
    deck += r.choice([[], [], ["run 20"], ["velocity odd set 0.1 NULL NULL", "run 20"]])
    return deck + ["write_dump all custom end.dump id type x y z vx vy vz omegax omegay omegaz ix iy iz modify sort id format float %.10g"]

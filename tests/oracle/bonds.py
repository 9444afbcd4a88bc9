"""Random decks of bonded grains: clumps of springs or of springs that break, contacts among them, walls."""
from grains import contact_law
from levels import levels


def clumps(r):
    """Lines that make two clumps and some grains, and the largest distance of neighbours in a clump."""
    shape, near = r.choice([("sc 1.0", 1.0), ("bcc 1.4", 0.99), ("fcc 1.6", 0.97)])
    lines = [f"lattice {shape}"]
    for kind, (x, y, z) in enumerate([(2, 2, 2), (2.2, 2.4, 6.2)], 1):
        size = [r.choice([1.2, 2.2, 3.2]) for _ in range(3)]
        if kind == 2:
            size[2] = 1.2
        low = [a - 0.1 for a in (x, y, z)]
        bounds = " ".join(f"{a:g} {a + b:g}" for a, b in zip(low, size))
        lines += [f"region c{kind} block {bounds} units box", f"create_atoms {kind} region c{kind}"]
    for k in range(r.randint(0, 4)):
        lines.append(f"create_atoms 3 single {r.uniform(1, 6):.3f} {r.uniform(1, 6):.3f} {9.0 + 1.1 * k:g} units box")
    return lines, near


def pairs(r):
    """A pair style with its coefficients."""
    what = r.random()
    hooke = f"gran/hooke {r.choice([400, 1000])} NULL {r.choice([3, 10])} NULL {r.choice([0, 0.4])} {r.choice([0, 1])}"
    if what < 0.3:
        return [f"pair_style {r.choice([hooke, hooke.replace('hooke', 'hooke/history'), hooke.replace('hooke', 'hertz/history')])}", "pair_coeff * *"]
    if what < 0.5:
        return ["pair_style granular", f"pair_coeff * * {contact_law(r)}"]
    own = f"{r.choice([20, 100])} {r.choice([0.9, 1.1, 1.3])} {r.choice([0, 0.5])}"
    if what < 0.75:
        return ["pair_style bpm/spring", f"pair_coeff * * {own}"]
    # Beside a granular style that remembers LAMMPS ends without a word.
    return [f"pair_style hybrid {hooke} bpm/spring", f"pair_coeff 1*2 1*2 bpm/spring {own}", "pair_coeff * 3 gran/hooke"]


def bonds(r):
    """A deck of bonded grains."""
    points, near = clumps(r)
    breaks = r.random() < 0.6
    deck = ["units lj", "atom_style hybrid sphere bond", "atom_modify map array sort 0 0", "boundary f f f", "newton off", "comm_modify vel yes",
            "region world block -2 11 -2 11 -2 15 units box", "create_box 3 world bond/types 2 extra/bond/per/atom 30 extra/special/per/atom 200"]
    deck += points + [f"set group all diameter {r.choice([0.9, 1.0])}", "set type 1 density 1", f"set type 2*3 density {r.choice([0.7, 1.5])}",
                      "group one type 1", "group two type 2", "group loose type 3", "group odd id 1:200:2"]
    pair = pairs(r)
    deck += pair + ["neighbor 2.0 nsq", "neigh_modify every 1 delay 0 check yes", "bond_style zero", "bond_coeff *", "special_bonds lj/coul 0 1 1",
                    f"create_bonds many one one 1 0.3 {near * r.choice([1.05, 1.45]):.3f}", f"create_bonds many two two 2 0.3 {near * 1.05:.3f}"]
    leveled = r.random() < 0.5
    overlay = r.random() < 0.3
    if breaks:
        # Under steps of several lengths LAMMPS' ends of broken bonds push each other late.
        rest = " smooth no break no" if leveled else r.choice(["", " smooth no", " smooth no break no"])
        rest += r.choice(["", " normalize yes"]) + (" overlay/pair yes" if overlay else "")
        strain = r.choice([0.05, 0.2, 0.5])
        style = r.choice(["bpm/spring", "bpm/spring", "bpm/spring/plastic"])
        # Where a bond yields.
        flow = f" {strain * r.choice([0.1, 0.4, 0.9]):g}" if "plastic" in style else ""
        deck += ["special_bonds lj/coul 1 1 1" if overlay else "special_bonds lj 0 1 1 coul 1 1 1", f"bond_style {style}{rest}",
                 f"bond_coeff 1 {r.choice([50, 300])} {strain} {r.choice([0, 0.5, 2])}{flow}", f"bond_coeff 2 {r.choice([50, 300])} {strain} 0.3{flow}"]
    else:
        deck += ["special_bonds lj/coul 1 1 1" if overlay else f"special_bonds lj/coul 0 {r.choice(['1 1', '0 1', '0 0'])}", "bond_style harmonic",
                 f"bond_coeff 1 {r.choice([50, 300])} {near:g}", f"bond_coeff 2 {r.choice([50, 300])} {near * 0.98:.3f}"]
    deck += [f"timestep {r.choice([0.002, 0.004])}",
             f"velocity all create {r.choice([0.01, 0.3])} {r.randint(1, 99999)} loop geom", f"velocity two set 0.1 0 -{r.choice([0.5, 2])} sum yes units box"]
    fixes = ["fix g all gravity 1 vector 0 0.1 -1", "fix w all wall/gran hooke 500 NULL 5 NULL 0.4 1 zplane 1.4 NULL", "fix v odd viscous 0.2",
             "fix a two addforce 0.1 0 -0.2", "fix sp one spring tether 2.0 3 3 3 0.5", "fix s odd spring/self 0.3", "fix sf loose setforce NULL 0 NULL",
             "fix at odd addtorque 0.01 0 0.02", "fix m all momentum 20 linear 1 1 0"]
    if not breaks:
        fixes.append("fix ad all adapt 5 bond harmonic k 1 v_stiff bond harmonic r0 2 v_long")
    deck += ["variable stiff equal 100+step", f"variable long equal {near:g}-0.001*step", "fix 1 all nve/sphere"]
    deck += [line for line in fixes if r.random() < 0.35]
    deck += ["compute e all erotate/sphere", "compute sx all reduce sum x y z vx vy vz", "compute om all property/atom omegax omegay omegaz",
             "compute so all reduce sum c_om[*]", f"compute bl all bond/local {'dist dist dist' if breaks else 'dist engpot force'}", "compute bs all reduce sum c_bl[*] inputs local",
             "compute bm all reduce max c_bl[1] c_bl[3] inputs local", f"compute st all stress/atom NULL {r.choice(['', 'bond', 'pair', 'bond pair', 'fix'])}",
             "compute ss all reduce sum c_st[*]", "compute pb all pressure NULL bond", "compute pa all pe/atom", "compute ps two reduce sum c_pa",
             "thermo_style custom step atoms ke pe ebond c_e press bonds c_sx[*] c_so[*] c_bs[*] c_bm[*] c_ss[*] c_pb c_ps",
             "thermo_modify norm no lost ignore format float %20.13g", "thermo 20", "run 60"]
    deck += r.choice([[], ["run 40"], ["velocity one set 0 0.2 0 units box", "run 40"],
                      [] if breaks else ["delete_bonds two bond 2 remove special", "run 20"]])
    deck = levels(r, deck, 1 if leveled else 0, parts=2 if "hybrid" in pair[0] else 0, bonded=True)
    return deck + ["write_dump all custom end.dump id type x y z vx vy vz omegax omegay omegaz modify sort id format float %.11g"]

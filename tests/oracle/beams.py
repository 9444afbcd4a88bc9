"""Random decks of bonds that twist and bend (bond_style bpm/rotational), broken and whole, with the outputs about them. LAMMPS takes
small angles by arc cosines, which leaves 1e-6 in some columns of one deck in ten."""
from bonds import clumps


def coeff(r, kind):
    """Stiffnesses, strengths and damping of a bond type."""
    stiff = r.choice([30, 200])
    limit = r.choice([0.3, 2, 30])
    k = [stiff, stiff * r.choice([0.1, 0.4, 0]), stiff * r.choice([0.02, 0.05, 0]), stiff * r.choice([0.02, 0.07])]
    # The manual lists limits of twist and bending in another order than the program: they differ here.
    b = [limit, limit * 0.7, limit * 0.2, limit * 0.3]
    g = [r.choice([0, 0.5]), r.choice([0, 0.1]), r.choice([0, 0.02]), r.choice([0, 0.03])]
    return f"bond_coeff {kind} " + " ".join(f"{a:g}" for a in k + b + g)


def beams(r):
    """A deck of grains with such bonds."""
    points, near = clumps(r)
    flat = r.random() < 0.2
    deck = ["units lj", f"dimension {2 if flat else 3}", f"atom_style {r.choice(['bpm/sphere', 'bpm/sphere', 'hybrid bpm/sphere bond'])}",
            "atom_modify map array sort 0 0", "boundary f f p" if flat else f"boundary {r.choice(['f f f', 'f f f', 'p p f'])}", "newton on off",
            "comm_modify vel yes cutoff 3.5"]
    deck[2] = "atom_style bpm/sphere" if flat else deck[2]
    if flat:
        points = ["lattice hex 1.15", "region c1 block 0.9 4.1 0.9 4.1 -0.1 0.1 units box", "create_atoms 1 region c1",
                  "region c2 block 1.4 4.6 5.2 7.1 -0.1 0.1 units box", "create_atoms 2 region c2"]
        near = 1.01
    deck += [f"region world block -2 11 -2 11 {'-0.5 0.5' if flat else '-2 15'} units box",
             "create_box 3 world bond/types 2 extra/bond/per/atom 30 extra/special/per/atom 200"] + points
    deck += [f"set group all diameter {r.choice([0.9, 1.0])}", "set type 1 density 1", f"set type 2*3 density {r.choice([0.7, 1.5])}",
             "group one type 1", "group two type 2", "group loose type 3", "group odd id 1:200:2"]
    if r.random() < 0.7:
        # Bonds exactly along −z are distinguished by rounding.
        deck.append(f"displace_atoms all random 0.03 0.03 {0 if flat else 0.03} {r.randint(1, 9999)} units box")
    deck += [f"pair_style gran/{r.choice(['hooke', 'hooke/history', 'hertz/history'])} {r.choice([400, 1000])} NULL {r.choice([3, 10])} NULL {r.choice([0, 0.4])} 1",
             "pair_coeff * *", "neighbor 2.0 nsq", "neigh_modify every 1 delay 0 check yes", "bond_style zero", "bond_coeff *", "special_bonds lj 0 1 1 coul 0 1 1",
             f"create_bonds many one one 1 0.3 {near * r.choice([1.1, 1.45]):.3f}", f"create_bonds many two two 2 0.3 {near * 1.1:.3f}"]
    overlay = r.random() < 0.3
    rest = r.choice(["", " smooth no", " smooth no break no"]) + r.choice(["", " normalize yes"]) + (" overlay/pair yes" if overlay else "")
    store = r.random() < 0.6
    rest += f" store/local gone {r.choice([5, 20])} time id1 id2 x y z" if store else ""
    deck += ["special_bonds lj/coul 1 1 1" if overlay else "special_bonds lj 0 1 1 coul 1 1 1", f"bond_style bpm/rotational{rest}", coeff(r, 1), coeff(r, 2)]
    deck += [f"timestep {r.choice([0.002, 0.004])}",
             f"velocity all create {r.choice([0.01, 0.3])} {r.randint(1, 99999)} loop geom", f"velocity two set 0.1 -{r.choice([0.5, 2])} 0 sum yes units box"]
    deck += [f"set group odd omega {r.choice([0, 0.5])} 0 {r.choice([0.3, -2])}"] if not flat else ["set group odd omega 0 0 0.7", "fix flat all enforce2d"]
    if r.random() < 0.3:
        deck.append(f"set group two quat {'0 0 1' if flat else '0.6 0 0.8'} {r.choice([2, 8])}")
    fixes = ["fix g all gravity 1 vector 0 0.1 -1", "fix w all wall/gran hooke 500 NULL 5 NULL 0.4 1 zplane 1.4 NULL", "fix at odd addtorque 0.01 0 0.02",
             "fix sp one spring tether 2.0 3 3 3 0.5"]
    fixes = ["fix v odd viscous 0.2", "fix a two addforce 0.1 0 0"] + ([] if flat else fixes)
    deck += [f"fix 1 all nve/bpm/sphere{' disc' if flat else ''}"] + [line for line in fixes if r.random() < 0.35]
    deck += ["compute e all erotate/sphere", "compute sx all reduce sum x y z vx vy vz", "compute om all property/atom omegax omegay omegaz quatw quati quatj quatk",
             "compute so all reduce sum c_om[*]", "compute bl all bond/local dist force fx engpot b1 b2 b3 b4 b5 b6 b7", "compute bs all reduce sum c_bl[*] inputs local",
             "compute nb all nbond/atom", "compute sn all reduce sum c_nb", "compute st all stress/atom NULL bond", "compute ss all reduce sum c_st[*]",
             "thermo_style custom step atoms ke pe ebond c_e press bonds c_sx[*] c_so[*] c_bs[*] c_sn c_ss[*]",
             "thermo_modify norm no lost ignore format float %20.13g", "thermo 20"]
    if store:
        deck += ["dump gone all local 20 gone.dump f_gone[1] f_gone[2] f_gone[3] f_gone[4] f_gone[5] f_gone[6]", "dump_modify gone format float %.9g"]
    deck += ["run 60"] + r.choice([[], ["run 40"], ["velocity one set 0 0.2 0 units box", "run 40"]])
    return deck + ["write_dump all custom end.dump id type x y z vx vy vz omegax omegay omegaz c_om[4] c_om[5] c_om[6] c_om[7] modify sort id format float %.11g"]

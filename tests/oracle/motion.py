"""Random decks of moving grains: fixes, walls, computes and averages in combination, in space and in the plane."""
from grains import contact_law
from levels import levels

EDGE = 6.0

# What LAMMPS gets wrong in steps of several lengths, and what has no part in them (docs/coming-from-lammps.md).
WHOLE = ["fix mv few move", "nve/noforce", "store/force"]


def packing(r, flat):
    """Spheres that hardly overlap: place, diameter."""
    spheres = []
    for _ in range(4000):
        d, p = round(r.uniform(0.6, 1.1), 3), [round(r.uniform(0.6, EDGE - 0.6), 4) for _ in range(3)]
        if flat:
            p[2] = 0
        if all(sum((a - b) ** 2 for a, b in zip(p, q)) > ((d + e) / 2 * 0.97) ** 2 for q, e in spheres):
            spheres.append((p, d))
        if len(spheres) == 45:
            break
    return spheres[: r.randint(8, 45)]


def some(r, lines, share):
    return [line for line in lines if r.random() < share]


def movers(r, flat):
    """Fixes that move the group `few`."""
    z = "NULL" if flat else r.choice(["NULL", "0.1"])
    axis = "0 0 1" if flat else r.choice(["0 0 1", "1 1 0", "0 1 0"])
    return r.choice([
        f"fix mv few move linear 0.5 {r.choice(['NULL', '-0.2'])} {z}", f"fix mv few move wiggle 0.1 {r.choice(['NULL', '0'])} {z} {r.choice([0.2, 1.5])}",
        f"fix mv few move rotate 3 3 {0 if flat else 3} {axis} {r.choice([1, 10])}",
        f"fix mv few move transrot 0.1 0.2 0 3 3 0 {axis} 5", "fix mv few move variable v_px NULL NULL v_pv NULL NULL",
        "fix mv few move variable NULL NULL NULL v_pv v_pa NULL", "fix mv few freeze", "fix mv few nve/noforce", "fix mv few nve",
        "fix mv few nve/limit 0.001"])


def forces(r, flat):
    zero, null = ("0", "NULL") if flat else ("0.1", "0")
    return some(r, [
        f"fix g all gravity {r.choice(['9.81', 'v_grow'])} " + ("vector 0 -1 0" if flat else r.choice(["vector 0 0 -1", "spherical 20 150", "chute 25", "vector 1 v_tilt -1"])),
        f"fix v odd viscous {r.choice(['0.3', '0.2 scale 2 0.5'])}", f"fix vs all viscous/sphere {r.choice(['0.1', '0.1 scale 2 0.5'])}",
        f"fix a odd addforce {r.choice(['0.1', 'v_grow', 'v_each'])} -0.2 {zero}" + r.choice(["", " every 3", " region half"]),
        f"fix sf {r.choice(['odd', 'few'])} setforce {r.choice(['0', 'v_grow', 'NULL'])} NULL {null}" + r.choice(["", " region half"]),
        f"fix af odd aveforce {r.choice(['NULL', '0.1'])} NULL {null}", f"fix to odd addtorque {'0 0' if flat else '0.01 0.02'} {r.choice(['-0.1', 'v_grow'])}",
        f"fix m all momentum {r.choice([7, 20])} " + r.choice(["linear 1 1 0", "angular", "linear 1 0 0 angular", "linear 1 1 0 rescale"]),
        f"fix d odd drag 3 {r.choice(['3', 'NULL'])} {0 if flat else 3} 0.05 0.2", "fix s odd spring/self 0.5 xy",
        f"fix sp odd spring tether 5.0 3 3 {0 if flat else 'NULL'} 0.5", "fix sc odd spring couple few 3.0 NULL 1 NULL 0.1",
        "fix lf few lineforce 1 1 0", f"fix pf few planeforce {'0 1 0' if flat else '0 1 1'}", "fix ind all indent 300 cylinder z 3 v_grow 1.2 units box",
        "fix ip all indent 300 plane x 0.7 lo units box", f"fix is odd indent 300 sphere 3 3 {0 if flat else 3} v_grow units box" if not flat else "fix is odd indent 300 cylinder z v_px 3 1.0 units box",
        "fix ad odd adapt 5 atom diameter v_swell mass no", "fix ha all halt 20 v_ken > 1e5 error continue",
    ], 0.2)


def walls(r, flat, sides, law):
    lines = []
    move = lambda across: r.choice(["", "", " wiggle x 0.05 2.0", " wiggle y 0.04 1.0"] + [f" shear {a} 0.4" for a in "xy" if a != across]) + r.choice(["", "", " contacts"])
    if sides[0] != "p" and r.random() < 0.6:
        lines.append(f"fix wx all wall/gran {law} xplane {r.choice(['0.0', 'NULL'])} {EDGE}{move('x')}")
    if sides[1] != "p" and r.random() < 0.6:
        lines.append(f"fix wy {r.choice(['all', 'odd'])} wall/gran {law} yplane 0.0 NULL{move('y')}")
    if not flat and sides[2] != "p" and r.random() < 0.6:
        lines.append(f"fix wz all wall/gran {law} zplane 0.0 {r.choice(['NULL', EDGE])}{move('z')}")
    if r.random() < 0.3 and "p" not in sides[:2]:
        lines.append(f"fix wc all wall/gran {law} zcylinder 8.0{r.choice(['', ' shear z 0.4' if not flat else ''])}")
    if r.random() < 0.5 and not flat and "p" not in sides[:2]:
        kind = r.choice(["block 0.1 5.9 0.1 5.9 0.05 5.9", "sphere 3 3 3 3.6", "cylinder z 3 3 3.4 0 6", "plane 3 3 0.3 0.1 0.2 1", "cylinder z 3 3 0.5 0 6 side out"])
        motion = r.choice(["", " move v_px NULL NULL", " rotate v_turn 3 3 3 0 0 1"])
        lines += [f"region wr {kind}{motion} units box", f"fix wr all wall/gran/region {law} region wr{r.choice(['', ' contacts'])}"]
    return lines


def computes(r, flat, plain, classic, fixed):
    """Computes, averages and the columns they give."""
    # Where a box shrinks, LAMMPS' densities are those of bins of before.
    binned = ["density/number", "density/mass vx"] if fixed else []
    kinds = {
        "er": ("compute er all erotate/sphere", ["c_er"]), "ea": ("compute ea all erotate/sphere/atom\ncompute eas odd reduce sum c_ea", ["c_eas"]),
        "cn": ("compute cn all contact/atom\ncompute cs all reduce sum c_cn", ["c_cs"]),
        "cg": ("compute cg all contact/atom few\ncompute cgs all reduce max c_cg", ["c_cgs"]),
        "co": ("compute co all coord/atom cutoff 1.0 1 2\ncompute cos all reduce ave c_co[1] c_co[2]", ["c_cos[*]"]),
        "st": ("compute st all stress/atom NULL\ncompute ss all reduce sum c_st[*]", ["c_ss[*]"]),
        "sv": (f"compute sv all stress/atom NULL {r.choice(['pair', 'virial', 'ke', 'ke pair', 'fix'])}\ncompute svs odd reduce sum c_sv[*]", ["c_svs[*]"]),
        "pr": (f"compute pr all pressure NULL {r.choice(['virial', 'pair', 'pair fix'])}", ["c_pr", "c_pr[*]"]),
        "ts": ("compute ts odd temp/sphere" + r.choice(["", " dof all", " dof rotate"]), ["c_ts", "c_ts[*]"]),
        "tc": ("compute tc all temp/com", ["c_tc"]), "tp": ("compute tp odd temp/partial 1 1 0", ["c_tp"]),
        "tr": ("compute tr all temp/ramp vx 0 1 y 0 6 units box", ["c_tr"]),
        "km": ("compute km odd ke\ncompute mo few momentum\ncompute cm odd com\ncompute gy odd gyration\ncompute ms odd msd com yes", ["c_km", "c_mo[*]", "c_cm[*]", "c_gy", "c_gy[*]", "c_ms[*]"]),
        "pl": ("compute pl all pair/local dist force cutoff radius\ncompute ps all reduce sum c_pl[1] c_pl[2] inputs local", ["c_ps[*]"]),
        "di": ("compute di all displace/atom\ncompute dm all reduce maxabs c_di[1] c_di[4]", ["c_dm[*]"]),
        "cl": ("compute cl all cluster/atom 0.9\ncompute clm all reduce max c_cl", ["c_clm"]),
        "rr": ("compute rr odd reduce/region half avesq vx vy", ["c_rr[*]"]),
        "nb": ("compute nb all reduce minabs vx\ncompute nc all reduce sumabs vx", ["c_nb", "c_nc"]),
        "cb": (f"compute cb all chunk/atom bin/1d {r.choice('xy')} lower {r.choice([0.7, 1.5])} units box\nfix cb all ave/chunk 2 5 20 cb {r.choice(binned + ['vx vy v_each', 'temp'])}"
               f"{r.choice(['', ' norm sample', ' norm none', ' norm all'])}{r.choice(['', ' ave running', ' ave window 2'])} file cb.out\ncompute kea all ke/atom", []),
        "cv": ("compute kc all ke/atom\ncompute ch odd chunk/atom type\ncompute vc odd vcm/chunk ch\ncompute rc odd reduce/chunk ch sum v_each c_kc\ncompute cc odd com/chunk ch\ncompute pc odd property/chunk ch count",
               ["c_vc[1][1]", "c_vc[2][3]", "c_rc[1][2]", "c_cc[2][1]", "c_pc[2]"]),
        "b2": (f"compute b2 all chunk/atom bin/2d x lower 1.5 y lower 2 units box {r.choice(['', 'discard yes', 'bound x 1 5', 'ids every'])}\nfix b2 all ave/chunk 5 4 20 b2 vx {' '.join(binned[:1])} file b2.out", []),
        "bc": ("compute bc all chunk/atom bin/cylinder z lower 3 3 3 0.2 2.8 3 units box\nfix bc all ave/chunk 10 1 10 bc vx file bc.out" if not flat else "compute bc all chunk/atom type", []),
        "at": (f"compute ak all ke\nfix at all ave/time 2 5 {r.choice([10, 20])} c_ak v_grow {r.choice(['', 'ave running', 'ave window 3'])} file at.out", ["f_at[1]", "f_at[2]"]),
        "av": ("compute am all momentum\nfix av all ave/time 5 2 10 c_am mode vector file av.out", []),
        "aa": ("compute kf all ke/atom\nfix aa all ave/atom 2 5 10 vx c_kf\ncompute as all reduce sum f_aa[1] f_aa[2]", ["c_as[*]"]),
        "ah": (f"fix ah all ave/histo 5 2 10 -1 1 {r.choice([5, 8])} vx vy mode vector beyond {r.choice(['ignore', 'end', 'extra'])} file ah.out", ["f_ah[1]", "f_ah[2]"]),
        "fv": ("fix fv all vector 10 c_thermo_temp\nvariable fvs equal max(f_fv)", ["v_fvs"]),
        "sst": ("fix sst all store/state 0 x vx\ncompute sss all reduce sum f_sst[1] f_sst[2]", ["c_sss[*]"]),
        "ssf": ("fix ssf all store/force\ncompute ssg all reduce sum f_ssf[1] f_ssf[2]", ["c_ssg[*]"]),
        "fa": ("compute fa all fabric radius contact branch" if plain else "compute fa all com", ["c_fa[*]"]),
        "sl": ("variable vv vector [1,2,3]\ncompute sl all slice 1 3 2 v_vv", ["c_sl[1]"]),
        "tn": (f"compute tn odd temp/region half\ncompute tm all temp/profile 1 1 {0 if flat else 1} xy {r.choice(['2 3', '1 2'])}\n"
               "compute td all temp/deform\ncompute tz odd temp/sphere bias tn\ncompute tb all temp/sphere bias tm", ["c_tn", "c_tn[*]", "c_tm", "c_td[*]", "c_tz", "c_tb[*]"]),
        "cq": ("compute ct all chunk/atom type nchunk once\ncompute ci odd inertia/chunk ct\ncompute cj all gyration/chunk ct\ncompute ck odd gyration/chunk ct tensor\n"
               f"compute co all omega/chunk ct\ncompute cu odd torque/chunk ct\ncompute cx all temp/chunk ct temp {r.choice(['', 'adof 2 cdof 1'])}\n"
               "compute cy all msd/chunk ct\ncompute cz odd vacf/chunk ct\ncompute cs odd chunk/spread/atom ct c_cj c_ci[*]\ncompute csr all reduce sum c_cs[*]",
               ["c_ci[1][4]", "c_ci[2][3]", "c_cj[2]", "c_ck[1][2]", "c_co[2][3]", "c_cu[1][3]", "c_cx", "c_cx[2]", "c_cx[1][1]", "c_cy[1][4]", "c_cz[2][4]", "c_csr[*]"]),
        "rd": (f"compute rd all rdf {r.choice([6, 11])} {r.choice(['', '1 2', '* 1 2 *'])} cutoff {r.choice([0.7, 1.0])}\ncompute re odd rdf 5\ncompute va odd vacf\ncompute ca odd centro/atom 4\ncompute cb2 all reduce sum c_ca",
               ["c_rd[4][2]", "c_rd[6][3]", "c_re[5][1]", "c_re[5][3]", "c_va[*]", "c_cb2"]),
        "gg": ("compute gg odd group/group few\ncompute gh few group/group all", ["c_gg[*]", "c_gh[*]"]),
        "vf": ("variable vf equal bound(all,xmax)+gyration(odd)+ke(few)+inertia(all,xy)+angmom(all,z)+omega(all,y)+torque(odd,x)", ["v_vf"]),
    }
    # LAMMPS' pair/local shortens the springs of style granular that slide.
    if not classic:
        kinds.pop("pl")
        kinds.pop("gg")
    lines, columns = [], []
    for key in r.sample(sorted(kinds), r.randint(3, 9)):
        own, shown = kinds[key]
        lines += own.split("\n")
        columns += shown
    return lines, columns


def motion(r):
    """A deck of grains on the move."""
    flat = r.random() < 0.3
    sides = [r.choice("pfsm") for _ in range(2)] + ["p" if flat else r.choice("pfsm")]
    spheres = packing(r, flat)
    deck = ["units lj", f"dimension {2 if flat else 3}", "atom_style sphere 1", "atom_modify map array sort 0 0", f"boundary {' '.join(sides)}",
            "newton off", "comm_modify vel yes", f"region b block 0 {EDGE} 0 {EDGE} {'-0.5 0.5' if flat else f'0 {EDGE}'} units box", "create_box 2 b"]
    deck += [f"create_atoms {r.choice([1, 2])} single {p[0]} {p[1]} {p[2]} units box" for p, _ in spheres]
    for k, (_, d) in enumerate(spheres, 1):
        v, w = ([round(r.uniform(-s, s), 4) for _ in range(3)] for s in (1, 2))
        if flat:
            v[2] = w[0] = w[1] = 0
        deck.append(f"set atom {k} diameter {d} density {round(r.uniform(0.5, 2), 3)} vx {v[0]} vy {v[1]} vz {v[2]} omega {w[0]} {w[1]} {w[2]}")
    heat = False
    if r.random() < 0.35:
        style = r.choice(["hooke", "hooke/history", "hertz/history"])
        law = f"{style} 2000 {r.choice(['NULL', '700'])} 5 {r.choice(['NULL', '2.0'])} 0.4 {r.choice([0, 1])}"
        deck += [f"pair_style gran/{law}", "pair_coeff * *"]
    else:
        law = "granular " + contact_law(r)
        heat = r.random() < 0.4
        if heat:
            law += r.choice([" heat area 30", " heat radius 10"])
        deck += ["pair_style granular", f"pair_coeff * * {law[9:]}"]
    deck += ["neighbor 5.0 nsq", "neigh_modify every 1 delay 0 check yes", f"timestep {r.choice([0.0005, 0.001])}", "group odd id 1:60:2", "group few id 2 4 8",
             "group mob subtract all few", "region half block INF 3 INF INF INF INF units box", "variable grow equal 0.5+step*dt", "variable tilt equal 0.1*step/100",
             "variable each atom vx*0.1+id*0.01", "variable px equal 0.05*sin(10*step*0.001)", "variable pv equal 0.5*cos(10*step*0.001)", "variable pa atom 0.01*id",
             "variable turn equal 0.5*step*0.001", "variable swell equal 0.8+0.002*step*dt", "variable ken equal ke"]
    motor = movers(r, flat)
    deck += [motor, r.choice(["fix 1 mob nve/sphere", "fix 1 mob nve/sphere" + (" disc" if flat else "")])]
    deck += forces(r, flat)
    if flat:
        deck.append("fix e2 all enforce2d")
    # An id once.
    kept = {}
    for line in deck:
        kept[" ".join(line.split()[:2]) if line.startswith("fix ") else line + str(len(kept))] = line
    deck = list(kept.values())
    if heat:
        deck += ["fix pt all property/atom temperature heatflow ghost yes", "set group all temperature 1", "set group odd temperature 3",
                 f"fix hf all heat/flow {r.choice(['constant 2', 'type 1 3'])}", "compute tt all property/atom temperature heatflow", "compute ttx all reduce sumsq c_tt[*]"]
    deck += walls(r, flat, sides, law)
    if heat:
        deck = [line + " temperature 2.5" if line.startswith("fix w") else line for line in deck]
    # LAMMPS refuses another step beside fix move; in the setup it overlooks the forces of fixes below.
    if " move " not in motor:
        deck += some(r, [r.choice(["fix dt all dt/reset 5 1e-5 2e-3 0.002 units box", "fix dt all dt/reset 10 NULL 1e-3 0.01 emax 0.05 units box"])], 0.2)
    lines, columns = computes(r, flat, "jkr" not in law and "dmt" not in law, not law.startswith("granular"), not set(sides) & set("sm"))
    deck += lines + ["compute sx all reduce sum x y z vx vy vz", "compute om all property/atom omegax omegay omegaz", "compute so all reduce sum c_om[*]",
                     f"thermo_style custom step atoms ke pe press c_sx[*] c_so[*] {' '.join(columns)} {'c_ttx[*]' if heat else ''} " + r.choice(["", "dt time", "vol lx xlo zhi", "pxx pxy pyy", "etotal enthalpy"]),
                     "thermo_modify norm no lost ignore format float %20.13g", "thermo 20", "run 100"]
    deck += r.choice([[], ["run 40"], ["unfix mv", "fix mv few nve", "run 20"], ["velocity odd set 0 0.1 0", "run 20"], ["reset_timestep 1000", "run 20"] if " move " not in motor and not any(word in " ".join(deck) for word in ("/time", " vector ", "dt/reset", "/chunk", "/histo", "ave/atom")) else []])
    if not heat and "p" not in sides[: 2 if flat else 3] and not any(word in line for line in deck for word in WHOLE):
        deck = levels(r, deck, 0.4)
    return deck + ["write_dump all custom end.dump id type x y z vx vy vz fx fy fz omegax omegay omegaz tqx tqy tqz radius mass ix iy iz modify sort id format float %.11g"]

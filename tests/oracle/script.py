"""Random decks of the language: variables, loops, groups, regions, formats, chunks, dumps, data and restart files."""

FUNCTIONS = ["sqrt(abs({}))", "exp(({})/100)", "ln(abs({})+1)", "log(abs({})+1)", "abs({})", "sin({})", "cos({})", "tan({})", "asin(({})/1000)",
             "acos(({})/1000)", "atan({})", "ceil({})", "floor({})", "round({})", "sign({})", "-({})", "!({})", "(({})^2)", "ternary({0}>1,2,{0})",
             "atan2({0},3)", "ramp({0},5)", "stagger(100,30)", "logfreq(10,3,10)", "logfreq2(10,3,10)", "logfreq3(10,25,1000)", "stride(0,100,10)",
             "stride2(0,100,10,20,50,5)", "vdisplace({0},2)", "swiggle({0},2,1)", "cwiggle({0},2,1)"]
OPERATORS = ["+", "-", "*", "<", "<=", ">", ">=", "==", "!=", "&&", "||", "|^"]
GROUPED = ["count({})", "mass({})", "xcm({},x)", "vcm({},y)", "fcm({},z)", "bound({},xmin)", "bound({},zmax)", "ke({})", "gyration({})",
           "angmom({},x)", "inertia({},xy)", "omega({},z)", "torque({},y)"]


def formula(r, depth=0, atom=False):
    """A formula, of particles with `atom`."""
    leaf = r.random() < 0.3 or depth > 3
    if leaf:
        names = [f"{round(r.uniform(-9, 9), 2):g}", f"{r.randint(0, 20)}", "1.5e-1", "PI", "step", "dt", "atoms", "v_a", "v_b", "c_ke1", "vol", "lx", "xlo", "yhi",
                 "c_com1[1]", "c_com1[2]", "x[3]", "vy[5]", "lz", "C_kea[4]", "mass[2]", "type[1]"]
        if r.random() < 0.25:
            word = r.choice(GROUPED).format(r.choice(["all", "g1", "g2"]))
            names = [word if r.random() < 0.7 or "omega" in word else word[:-1] + ",ra)"]
        if atom:
            # LAMMPS has no single elements in formulas of particles.
            names = [name for name in names if "c_" not in name.lower()]
        if atom and r.random() < 0.6:
            names = ["x", "y", "z", "vx", "vy", "vz", "id", "type", "mass", "fx", "v_at", "c_kea", "gmask(g1)", "rmask(ra)", "grmask(g2,ra)", "radius"]
        return r.choice(names)
    if r.random() < 0.3:
        return r.choice(FUNCTIONS[:-12] if atom and r.random() < 0.5 else FUNCTIONS).format(formula(r, depth + 1, atom))
    if r.random() < 0.1:
        return f"({formula(r, depth + 1, atom)})%{r.choice([3, 2.5, 7])}"
    if r.random() < 0.1:
        return f"({formula(r, depth + 1, atom)})/{r.choice([3, -2.5, 7])}"
    return f"({formula(r, depth + 1, atom)}{r.choice(OPERATORS)}{formula(r, depth + 1, atom)})"


def shape(r, name, flat):
    c = lambda: round(r.uniform(2, 6), 2)
    # LAMMPS' ellipsoids of flat scenes know no z.
    egg = f"sphere {c()} {c()} 0 2" if flat else f"ellipsoid {c()} {c()} {c()} {c()} {c()} 2"
    kind = r.choice([f"block {c()-2:g} {c()+1:g} INF {c():g} EDGE {c():g}", f"sphere {c()} {c()} {c()} {c() - 1:g}", f"cylinder {r.choice('xyz')} {c()} {c()} {c() - 1:g} 1 6",
                     f"cone {r.choice('xyz')} {c()} {c()} 1 {c()} 0.5 7", f"plane {c()} {c()} {c()} 1 {r.choice([0, 1])} -0.5", "prism 1 5 1 5 1 5 1 0 0",
                     egg])
    words = f"region {name} {kind} side {r.choice(['in', 'in', 'out'])} units {r.choice(['box', 'box', 'lattice'])}"
    return words + r.choice(["", "", " move v_mv NULL NULL", " rotate v_ro 4 4 4 0 0 1", " move NULL v_mv v_ro rotate v_ro 4 4 4 1 1 0"])


def regions(r, flat):
    lines = ["variable mv equal 0.1+0.02*step", "variable ro equal 0.3+0.03*step"] + [shape(r, f"r{k}", flat) for k in range(4)]
    lines.append(f"region ra {r.choice(['union', 'intersect'])} {r.choice([2, 3])} r0 r1" + " r2")
    if " 2 r0" in lines[-1]:
        lines[-1] = lines[-1].replace(" r2", "")
    lines[-1] += r.choice(["", " side out"])
    return lines


def groups(r):
    lines = [f"group g1 {r.choice(['type 1', 'id 1:20:3 25', 'type < 2', 'id <> 5 30', 'id >= 12', 'region r3', 'type != 1', 'type <= 1'])}",
             f"group g2 {r.choice(['type 2', 'id 2:40:2', 'region ra', 'variable va', 'id < 17', 'type == 2'])}", "group g3 union g1 g2", "group g4 intersect g1 g2",
             "group g5 subtract all g1", "group g5 id 1 2 3", "group g6 empty", "group g6 type 1", "group g7 region r1",
             f"group dy dynamic {r.choice(['all', 'g1'])} {r.choice(['region ra', 'var va', 'region r2 var va'])} every {r.choice([1, 5])}"]
    if r.random() < 0.5:
        lines += ["group g6 clear", "group g6 id 7"]
    return lines


def text(r):
    """Printed words: formats, loops, jumps."""
    form = lambda: r.choice(["%.3f", "%12.5e", "%08.3f", "%.15g"])
    lines = ["variable a equal 3.25", f"variable b equal {r.randint(-5, 9)}", "variable s string 'two words'", f"variable i index {' '.join(str(r.randint(1, 99)) for _ in range(3))}",
             f"variable l loop {r.randint(2, 5)}", f"variable p loop {r.randint(1, 4)} {r.randint(5, 12)} pad", f"variable fm format a {form()}", "variable in internal 2.5",
             "variable ge getenv HOME_OF_NOBODY", f"variable vec vector [1,2,{r.randint(3, 9)}]", "variable vs equal sum(v_vec)+max(v_vec)*min(v_vec)+ave(v_vec)+trap(v_vec)+slope(v_vec)",
             'print "= ${a} $b ${s} ${i} ${p} ${fm} $(v_a/3) $(v_b*2:%.3f) ${vs}"']
    lines += ["label again", 'print "= $i $l ${p}"', 'if "$l > 2" then "variable a equal $(v_a*2)" elif "$i == 3" "print \'= three\'" else "print \'= less $i\'"',
              f"if \"{r.choice(['$l > 1', '$l==2 && $i<50', '!($l == 1)', '$i >= 40 || $l == 2', '$(v_l>1)', 'abc == abc', 'x${l} != x2', '$l |^ 0', '${a} <= 7'])}\" then 'print \"= yes\"' else 'print \"= no\"'", "next l", f"jump SELF {'again'}", 'print "= ${a}"', "next i", "next p", 'print "= $i ${p}"']
    lines += ['variable str string "a b"', 'print """= ${str}: "quoted" \'x\' """', "print '= tab $(v_a)' append told.txt screen yes", 'print "= second" append told.txt',
              f'variable big equal 1e{r.choice([5, 6, 7, 15, 16])}', 'print "= ${big} $(v_big+1) $(1/3) $(2^0.5:%20.15f) $(10/4) $(-3^2) $(2^3^2) $(7%4) $(-7%4)"',
              f'if "{r.choice(["1 == 1.0", "3 < 4", "2e3 == 2000", "-1 < 0", "a == b", "a != b"])}" then "print \'= t\'" else "print \'= f\'"']
    return lines


def script(r):
    """A deck of the language."""
    flat = r.random() < 0.2
    sides = f"boundary {r.choice('pfsm')} {r.choice('pfsm')} {'p' if flat else r.choice('pfsm')}"
    deck = ["units lj", f"dimension {2 if flat else 3}", "atom_style sphere", "atom_modify map array sort 0 0", sides,
            "newton off", "comm_modify vel yes", f"lattice {'sq' if flat else 'sc'} {round(r.uniform(0.4, 1), 2)}", f"region b block 0 8 0 8 {'-0.5 0.5' if flat else '0 8'} units box", "create_box 2 b"]
    deck += [f"create_atoms {1 + k % 2} single {round(r.uniform(0.5, 7.5), 3)} {round(r.uniform(0.5, 7.5), 3)} {0 if flat else round(r.uniform(0.5, 7.5), 3)} units box" for k in range(40)]
    deck += ["set group all diameter 0.4 density 1.5", "velocity all create 0.5 4711 loop geom", "pair_style gran/hooke/history 500 NULL 5 NULL 0.5 1", "pair_coeff * *", "neighbor 2.0 nsq",
             "neigh_modify every 1 delay 0 check yes", "timestep 0.002", "fix 1 all nve/sphere", "compute ke1 all ke", "compute com1 all com", "compute kea all ke/atom", "run 0"]
    if flat:
        deck.append("fix e2 all enforce2d")
    deck += text(r) + regions(r, flat) + ["variable at atom x*0.5+id", "variable va atom " + r.choice(["x>3", "vx*vx<0.2", "id<22", "(x<4)&&(y>2)", "rmask(r1)"])] + groups(r)
    reduced = [f"compute f{k} all reduce {r.choice(['sum', 'min', 'max', 'ave', 'sumsq'])} v_f{k}" for k in range(3)]
    deck += [f"variable e{k} equal {formula(r)}" for k in range(8)] + [f"variable f{k} atom {formula(r, 0, True)}" for k in range(3)]
    told = [f'print "= $(count(g{k})) $(count(g{k},ra))"' for k in range(1, 8)] + files(r, sides, flat)
    deck += reduced + ["run 0"] + [f'print "= ${{e{k}}}"' for k in range(8)] + [f'print "= $(c_f{k})"' for k in range(3)] + told
    style = r.choice(["one", "multi", "yaml", "custom step atoms ke pe etotal press lx vol", "custom step time dt temp c_com1[*] v_a v_b", "custom step elapsed elaplong atoms v_e0 v_e1 xlo yhi zhi density"])
    deck += [f"thermo_style {style}", "thermo_modify " + r.choice(["norm yes", "norm no", "line yaml", "line multi", "line one", "norm yes", "format float %14.6f", "format int %6d", "flush yes", "norm no"]) + " lost ignore",
             f"thermo {r.choice([5, 7, 10])}", f"run {r.choice([20, 33])}", 'print "= $(count(dy)) $(step) $(c_ke1)"', f"run {r.choice([5, 10])} {r.choice(['', 'pre no', 'post no'])}",
             'print "= $(step) $(xcm(all,x)) ${e2}"']
    return deck


def files(r, sides, flat):
    """Dumps, tables and files that are read again."""
    lines = []
    custom = "id type x y z vx xs ys zs xu yu zu ix radius mass c_kea v_at"
    modify = r.choice(["", " format float %.8g", " format line \"%d %d %g %g %g %g %g %g %g %g %g %g %d %g %g %g %g\"", " thresh x > 3", " thresh v_at < 12.5", " region ra", " first yes",
                       " header no", " units yes", " time yes", " append no", " format 3 %.3f", " format int %04d", " every 7", " delay 5", " pbc yes"])
    lines += [f"dump d1 {r.choice(['all', 'g1', 'dy'])} custom {r.choice([5, 10])} d1.dump {custom}", f"dump_modify d1 sort {r.choice(['id', '3', '-4'])}{modify}"]
    lines += some_of(r, ["dump d2 all atom 10 d2.dump\ndump_modify d2 sort id scale " + r.choice(["yes", "no"]) + r.choice(["", " image yes"]), "dump d3 g1 xyz 10 d3.xyz\ndump_modify d3 sort id" + r.choice(["", " element Si O"]),
                         "dump d4 all cfg 10 d4.*.cfg mass type xs ys zs vx id\ndump_modify d4 sort id element A B", "dump d5 all yaml 10 d5.yaml id x vx\ndump_modify d5 sort id",
                         "dump d6 all custom 10 d6.*.dump id x\ndump_modify d6 sort id pad 4", f"fix pr all print 5 \"step $(step) $(c_ke1) ${{a}}\" file pr.txt screen no{r.choice(['', ' title hello'])}"])
    again = r.choice(["", "data", "restart", "data types", "data offset", "dump"])
    if again.startswith("data"):
        lines += [f"print '{sides}' file kept.sides screen no", *(["print 'dimension 2' append kept.sides screen no"] if flat else []), f"write_data kept.data{r.choice(['', ' nocoeff', ' nofix'])}"]
    if again == "restart":
        lines += ["write_restart kept.restart"]
    if again == "dump":
        lines += ["write_dump all custom kept.dump id type x y z vx vy vz ix iy iz modify sort id format float %.15g", "displace_atoms all move 0.1 0 0 units box",
                  "read_dump kept.dump 0 x y z vx" + r.choice(["", " replace yes", " trim yes replace yes", " box no"]), "run 0", 'print "= $(xcm(all,x)) $(atoms)"']
    return [line for line in lines if line]


def some_of(r, lines):
    return [part for line in lines if line and r.random() < 0.35 for part in line.split("\n")]

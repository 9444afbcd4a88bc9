"""Random decks of what is written: thermo styles, dumps, averages, chunks, reductions, printed text."""
from sources import u


def chunks(r, name, flat):
    """A compute that makes chunks."""
    step = lambda: f"{r.choice(['lower', 'center', 'upper', '1.0'])} {r.choice([0.7, 1.5, 2])}"
    axes = r.sample("xy" if flat else "xyz", 2)
    middle = f"3 3 {0 if flat else 3}"
    style = r.choice(["type", f"bin/1d {axes[0]} {step()}", f"bin/2d {axes[0]} {step()} {axes[1]} {step()}", f"bin/sphere {middle} 0.3 3 4",
                      "c_near", "v_bin", "c_pid[1]"] + ([] if flat else [f"bin/cylinder z {step()} 3 3 0.2 2.8 3", f"bin/3d x {step()} y {step()} z {step()}"]))
    words = f"compute {name} {r.choice(['all', 'odd'])} chunk/atom {style}"
    if "bin/" in style:
        words += r.choice(["", "", f" bound x {r.choice(['lower', '1'])} {r.choice(['upper', '5'])}"]) + " units box"
        words += r.choice(["", "", " discard yes", " discard no", " discard mixed"])
    # LAMMPS' compressed shells take in those beyond them; limit beside compress it ignores.
    fewer = ["", "", " limit 3 max", " limit 2 exact", " limit 4 max"] + ([] if "sphere" in style else [" compress yes"] * 2)
    return words + r.choice(["", "", " region half"]) + r.choice(fewer) + r.choice(["", "", " ids every", " ids nfreq nchunk every", " ids once nchunk once"])


def averages(r, name):
    """How something is averaged and where it goes."""
    every = r.choice(["2 5 10", "5 2 20", "1 1 10", "10 1 10", "3 3 12"])
    words = r.choice(["", "", " ave one", " ave running", " ave running overwrite", " ave window 2"]) + r.choice(["", "", " start 10", " start 7"])
    return every, words + f" file {name}.out" + r.choice(["", "", " format \" %.8g\"", " title1 \"# one\"", " title2 '# two'", " title3 \"\""])


def outputs(r, flat):
    lines = []
    for k in range(r.randint(1, 3)):
        lines.append(chunks(r, f"ch{k}", flat))
        every, rest = averages(r, f"chunk{k}")
        rest = rest.replace(" start 10", "").replace(" start 7", "")
        # Volumes and coordinates of compressed bins are those of other bins in LAMMPS.
        dense = [] if "compress" in lines[-1] else ["density/number", "density/mass vx"]
        what = r.choice(dense + ["vx vy", "temp", "c_ea fx", "v_each v_bin", "radius"]).replace("radius", "v_wide")
        lines += [f"fix chunk{k} {r.choice(['all', 'odd'])} ave/chunk {every} ch{k} {what}{r.choice(['', ' norm all', ' norm sample', ' norm none'])}{r.choice(['', '', ' adof 2', ' cdof 1'])}{rest}"]
        if r.random() < 0.5:
            # LAMMPS locks the chunks of one fix against those of another.
            lines.append(chunks(r, f"cw{k}", flat).split(" limit")[0])
            own = r.choice([f"reduce/chunk cw{k} {r.choice(['sum', 'min', 'max'])} v_each c_ea", f"com/chunk cw{k}", f"vcm/chunk cw{k}", f"property/chunk cw{k} count{' id' if 'compress' in lines[-1] else ' coord1' if 'bin/' in lines[-1] else ''}"])
            lines.append(f"compute of{k} odd {own}")
            every, rest = averages(r, f"vec{k}")
            single = "property" in own and own.endswith("count")
            value = f"c_of{k}" if single else f"c_of{k}[{r.choice(['1', '*'])}]"
            lines.append(f"fix vec{k} all ave/time {every} {value} mode vector{rest}")
    for k in range(r.randint(0, 2)):
        every, rest = averages(r, f"time{k}")
        lines.append(f"fix time{k} all ave/time {every} {' '.join(r.sample(['c_ke', 'v_ken', 'c_com[2]', 'c_com[*]', 'c_thermo_temp', 'c_red[1]', 'c_red[*]', 'v_vec[2]', 'v_ken'], r.randint(1, 3)))}{rest}{r.choice(['', '', ' off 1'])}")
    for k in range(r.randint(0, 2)):
        every, rest = averages(r, f"histo{k}")
        mode, what = r.choice([("vector", "vx vy"), ("vector", "c_ea"), ("vector", "v_each x"), ("scalar", "c_ke v_ken"), ("vector", "c_com"), ("vector", "c_pl")])
        rest = rest.replace(' format " %.8g"', "")
        lines.append(f"fix histo{k} {r.choice(['all', 'odd'])} ave/histo {every} {u(r, -3, 0)} {u(r, 1, 5)} {r.randint(2, 9)} {what} mode {mode}{r.choice(['', ' beyond end', ' beyond extra', ' beyond ignore'])}{' kind local' if 'pl' in what else ''}{rest}")
    modify = lambda n: "".join(r.sample([" format float %.9g", " format int %5d", f" thresh x > {u(r, 0, 4)}", " thresh type == 1", " thresh v_each < 2", " region half", " first yes", " units yes", " time yes", " every 7", " delay 12", " every v_when", " flush no", " header no",
                                        f" thresh vx |^ 0 " if r.random() < 0.1 else " thresh z != 9"], n))
    custom = r.sample(["type", "mass", "x", "y", "z", "xs", "ys", "xu", "yu", "xsu", "ix", "iy", "vx", "vy", "fx", "fy", "radius", "diameter", "omegaz", "tqz", "c_ea", "v_each", "c_pid[1]", "c_pa[*]", "zu"], r.randint(3, 9))
    if r.random() < 0.8:
        lines += [f"dump a {r.choice(['all', 'odd', 'late'])} custom 5 a.dump id {' '.join(custom)}", f"dump_modify a sort {r.choice(['id', 'id', '-1'])}{modify(r.randint(0, 3))}"]
    if r.random() < 0.4:
        lines += [f"dump b odd {r.choice(['atom', 'xyz'])} 7 b.*.txt", f"dump_modify b sort id{r.choice([' pad 5', ' maxfiles 2', ' every 3', ''])}"]
    if r.random() < 0.4:
        lines += [f"dump d all yaml 10 d.yaml id {' '.join(w for w in custom if '*' not in w)}", f"dump_modify d sort id{r.choice(['', ' time yes', ' units yes', ' thermo yes', ' region half'])}"]
    if r.random() < 0.5:
        title = r.choice(["", " title none", ' title "# a b"'])
        lines.append(f"fix tell all print {r.choice(['5', '7', 'v_when'])} '$(step) $(c_ke:%.8g) ${{ken}} $(v_vec[1]) $(count(late))' file told.txt screen no{title}".replace("'", '"'))
    if r.random() < 0.4:
        lines.append(f"fix keep all vector {r.choice([5, 10])} {r.choice(['c_com[1] c_com[2]', 'v_ken v_push'])}\nvariable kept equal {r.choice(['max', 'min', 'sum', 'ave', 'trap', 'slope'])}(f_keep[1])")
    return [part for line in lines for part in line.split("\n")]


# Columns of whole numbers.
WHOLE = ("elapsed", "elaplong", "nbuild", "ndanger")


def thermo(r, lines):
    known = ["elapsed", "elaplong", "dt", "time", "temp", "press", "pe", "ke", "etotal", "evdwl", "ecoul", "epair", "ebond", "emol", "elong", "enthalpy", "vol", "density", "lx", "ly", "lz", "xlo", "xhi", "yhi", "zlo", "xy", "pxx", "pyy", "pzz", "pxy", "pxz", "pyz",
             "c_ke", "v_ken", "c_com[*]", "c_com[1]", "c_red[*]", "c_red[2]", "v_vec[3]", "nbuild", "ndanger", "imp", "cella", "cellgamma", "fmax", "fnorm", "bonds", "part", "timeout"]
    known = [w for w in known if w not in ("imp", "part", "timeout", "bonds")]
    known += [f"f_{line.split()[1]}[1]" for line in lines if line.startswith("fix time") and "[*]" in line]
    style = r.choice(["one", "multi", "yaml"] + ["custom step " + " ".join(r.sample(known, r.randint(2, 14)))] * 6)
    modify = r.choice(["", " line multi", " line yaml", " line one", " norm yes", " format float %16.9f", " format int %9d", " format float %20.13g", " format 1 %012d" if style != "multi" else "", " format -1 %.4f" if "custom" in style and style.split()[-1] not in WHOLE else "", " colname -1 Last", " colname 1 Schritt"])
    return [f"thermo_style {style}", f"thermo_modify lost ignore{modify}", f"thermo {r.choice(['5', '7', '10', 'v_when', '100'])}"]


def output(r):
    """A deck that writes all sorts of things."""
    flat = r.random() < 0.25
    sides = f"{r.choice('pm')} {r.choice('pm')} {'p' if flat else r.choice('pm')}"
    units = r.choice(['lj', 'lj', 'si', 'cgs', 'micro', 'nano', 'real', 'metal', 'electron'])
    # Electron volts are much beside grams per mole: grains would fly across the box within a step.
    k = 0.005 if units == "metal" else 50
    deck = [f"units {units}", f"dimension {2 if flat else 3}", "atom_style sphere", "atom_modify map array sort 0 0", f"boundary {sides}", "newton off", "comm_modify vel yes",
            f"region b block 0 6 0 6 {'-0.5 0.5' if flat else '0 6'} units box", "create_box 3 b"]
    deck += [f"create_atoms {r.choice([1, 2, 2, 3])} single {u(r, 0.5, 5.5)} {u(r, 0.5, 5.5)} {0 if flat else u(r, 0.5, 5.5)} units box" for _ in range(r.randint(3, 25))]
    deck += ["set group all diameter 0.8 density 1.3", "set type 2 diameter 0.5", f"velocity all set 1 {u(r, -1, 1)} {0 if flat else 0.3} units box", "velocity all ramp vx -1 1 y 0 6 sum yes units box", f"pair_style gran/hooke {k} NULL {k / 50} NULL 0 0", "pair_coeff * *", "neighbor 2.0 nsq",
             "timestep 0.004", "fix 1 all nve/sphere", "fix ad all addforce 0.2 v_push 0", *(["fix e2 all enforce2d"] if flat else []), "group odd id 1:30:2", "region half block INF 3 INF INF INF INF units box", "group late dynamic all region half every 5",
             "variable push equal 0.3*sin(step*0.05)", "variable each atom x*0.3-vy+0.1*id", "variable bin atom floor(x)+1", "variable wide atom radius*2", "variable ken equal c_ke+step*0.01", "variable when equal stride(0,100,3)+2*(step>100)", f"variable vec vector [1.5,{u(r, 0, 9)},-2]",
             "compute ke all ke", "compute com odd com", "compute ea all ke/atom", "compute near all coord/atom cutoff 0.5", "compute pid all property/atom id type", "compute pa all property/atom x vx", "compute pl all pair/local dist", "compute pr all property/local natom1 natom2",
             f"compute red {r.choice(['all', 'odd', 'late'])} reduce {r.choice(['sum', 'min', 'max', 'ave', 'sumsq', 'avesq', 'maxabs'])} x vy c_ea v_each"]
    lines = outputs(r, flat)
    if "m" in sides:
        # LAMMPS' densities are those of bins of before, where a box grows.
        lines = [line.replace("density/mass", "vx").replace("density/number", "vx") for line in lines]
    deck += lines + thermo(r, lines)
    for steps in r.choice([[40], [20, 20], [33], [10, 25]]):
        deck += [f"run {steps}{r.choice(['', '', ' post no', ' start 0 stop 100'])}", 'print "= $(step) $(c_ke) ${ken} $(c_red[1])"']
        if r.random() < 0.3:
            deck.append(r.choice(["thermo_style one", "undump a" if any(line.startswith("dump a ") for line in lines) else "thermo 5", "unfix ad", "variable ken equal c_ke-1"]))
    return deck

"""Random decks that make scenes and change them between short runs: all that edits particles, groups and boxes."""
from script import shape
from sources import u

KEPT = "id type x y z vx vy vz omegax omegay omegaz radius mass ix iy iz xu yu zu"


def custom(r, flat):
    """The words of a lattice of the deck's own: edges, tilted or not, and points in the cell."""
    tilt = lambda: r.choice([0, 0, 0, u(r, -0.4, 0.4)])
    edges = [[u(r, 0.7, 1.4) if d == k else tilt() for d in range(3)] for k in range(3)]
    if flat:
        edges = [edges[0][:2] + [0], edges[1][:2] + [0], [0, 0, 1]]
    words = "".join(f" a{k + 1} {' '.join(f'{x:g}' for x in edge)}" for k, edge in enumerate(edges))
    points = [[0, 0, 0]] + [[u(r, 0, 0.99) for _ in range(3)] for _ in range(r.randint(0, 2))]
    return words + "".join(f" basis {p[0]} {p[1]} {0 if flat else p[2]}" for p in points)


def created(r, flat):
    """A line that makes particles, with what it needs."""
    z = 0 if flat else u(r, 0.5, 7.5)
    lattice = f"lattice {r.choice(['sq', 'sq2', 'hex'] if flat else ['sc', 'bcc', 'fcc', 'hcp', 'diamond'])} {u(r, 0.1, 0.4)}"
    if r.random() < 0.2:
        lattice = f"lattice custom {u(r, 0.1, 0.4)}{custom(r, flat)}"
    if r.random() < 0.4:
        lattice += f" origin {u(r, 0, 0.9)} {u(r, 0, 0.9)} 0"
    if r.random() < 0.2:
        lattice += " orient x 0 1 0 orient y -1 0 0 orient z 0 0 1" if flat else r.choice([" orient x 1 1 0 orient y -1 1 0 orient z 0 0 1", " orient x 0 1 0 orient y 0 0 1 orient z 1 0 0"])
    if r.random() < 0.2:
        lattice += f" spacing 1.2 1.5 {r.choice([1, 0.8])}"
    rest = r.choice(["", "", f" subset {r.randint(1, 9)} {r.randint(1, 999)}", f" ratio {u(r, 0.1, 0.9)} {r.randint(1, 999)}", " var keep set x xx set y yy", f" var keep set x xx set y yy subset 3 {r.randint(1, 99)}", " basis 1 2", " group made"])
    kind, seed = r.choice([1, 2]), r.randint(1, 9999)
    return r.choice([[lattice, f"create_atoms {kind} {r.choice(['box', 'region ra', 'region r2'])}{rest}"], [f"create_atoms {kind} single {u(r, 0.5, 7)} {u(r, -2, 9)} {z} units box{r.choice(['', ' remap yes'])}"],
                     [f"create_atoms {kind} random {r.randint(1, 20)} {seed} {r.choice(['NULL', 'ra', 'r1'])}{r.choice(['', ' overlap 0.8 maxtry 20 units box', ' var keep set x xx set y yy', ' group made'])}"]])


def edits(r, flat):
    """One change of the scene."""
    who, seed, z = r.choice(["all", "g1", "g2", "dy", "made"]), r.randint(1, 9999), "0" if flat else str(u(r, -0.4, 0.4))
    chosen = r.choice([f"group {who}", f"group {who}", "type 1", "type 1*2", "type 2*", "atom 3*12", "atom 5", "region ra", "region r2"])
    units = r.choice([" units box", " units box", " units lattice", ""])
    value = lambda: r.choice([str(u(r, -2, 2)), "v_at"])
    box = [f"{d} {r.choice([f'scale {u(r, 1, 1.3)}', f'final {u(r, -1, -0.1)} {u(r, 8.1, 10)}', f'delta {u(r, -0.8, 0)} {u(r, 0, 0.8)}'])}" for d in ("xy" if flat else "xyz")]
    box = r.choice([box, box, [f"x scale {u(r, 0.8, 1.2)} y volume", "y scale 1.1 x volume"]])
    named = r.choice(["all", "g1"])
    return r.choice([
        [f"set {chosen} type {r.choice(['1', '2', 'v_kind'])}"], [f"set {chosen} type/ratio 1 {u(r, 0.1, 0.9)} {seed}"],
        [f"set {chosen} type/subset 2 {r.randint(0, 3)} {seed}"], [f"set {chosen} diameter {r.choice(['0.5', 'v_wide'])} density {r.choice(['1.2', 'v_wide'])}"], [f"set {chosen} mass {r.choice(['0.7', 'v_wide'])}"],
        [f"set {chosen} vx {value()} vy {value()}{'' if flat else ' vz 0.5'}"], [f"set {chosen} omega {'0 0' if flat else '0.1 v_at'} {value()}"], [f"set {chosen} x {u(r, 1, 7)}"], [f"set {chosen} image {r.choice(['0', 'NULL', 'NULL', '-2'])} {r.choice(['NULL', '1', 'NULL'])} NULL"],
        [f"set {chosen} density/disc 1.3" if flat else f"set {chosen} density 0.8"],
        [f"displace_atoms {who} move {u(r, -2, 2)} {r.choice(['v_push', '0.3'])} {z}{units}"], [f"displace_atoms {who} move v_at 0 0 units box"], [f"displace_atoms {who} ramp x -0.5 {u(r, 0, 1)} y 1 7{units}"],
        [f"displace_atoms {who} random 0.2 0.1 {0 if flat else 0.1} {seed}{units}"], [f"displace_atoms {who} rotate 4 4 {0 if flat else 4} 0 {0 if flat else 1} 1 {u(r, -90, 90)}{units}"],
        [f"delete_atoms {r.choice(['region ra', 'group g1', 'region r2', 'variable va', f'overlap {u(r, 0.3, 1.2)} g1 g2', f'overlap 0.9 all all', f'random fraction 0.3 yes {who} NULL {seed}', f'random count 2 no all ra {seed}', f'random fraction 0.2 no all r1 {seed}'])}{r.choice(['', '', ' compress no'])}"],
        [f"group {named if named != 'all' else 'g1'} {r.choice(['type 1', 'region r1', 'id 3:9:2', 'include molecule', 'clear', 'variable va', 'union g2', 'id > 20'])}"], ["group made clear", f"group made {r.choice(['intersect g1 all', 'subtract all g1 g2', 'union g1 g2', 'type == 2', 'id <= 9', 'id <> 4 14', 'region ra'])}"],
        [f"velocity {who} create {u(r, 0.1, 2)} {seed}{r.choice(['', ' dist gaussian', ' rot yes', ' mom no', ' loop geom', ' loop local', ' sum yes'])}"],
        [f"velocity {who} set {value()} NULL {0 if flat else 'v_push'}{units}"], [f"velocity {who} ramp vx 0 {u(r, 0, 2)} y 1 7{units}"], [f"velocity all zero {r.choice(['linear', 'angular'])}"], [f"velocity all scale {u(r, 0.1, 2)}"],
        [f"change_box {who} {' '.join(r.sample(box, r.randint(1, len(box))))}{r.choice(['', ' remap'])}{units}"], [f"change_box all boundary {r.choice('pfsm')} {r.choice('pfsm')} {'p' if flat else r.choice('pfsm')}"],
        [f"change_box all set x scale 1.1 remap y final 0 9 remap{units}"], ["run 0", f"replicate {r.choice([1, 2])} {r.choice([1, 2])} 1"], [f"reset_atoms id sort {r.choice(['yes', 'no'])}"],
        ["write_data scene.data nocoeff", "read_data scene.data " + r.choice(["add append shift 0.3 0.2 0", "add append offset 0 0 0 0 0 group made", "add 1000 shift 9 0 0", "add append group made nocoeff"])],
        ["write_data scene.data nocoeff", "clear"], created(r, flat), created(r, flat), ["run 0"], ["run 5"], ["run 4", "run 3 pre no"], [f"reset_timestep {r.choice([0, 100])}"],
        ["write_dump all custom back.dump id type x y z vx vy vz ix iy iz modify sort id format float %.16g", f"delete_atoms group {who} compress no", f"read_dump back.dump $(step:%.0f) x y {'' if flat else 'z'} vx {r.choice(['', 'ix', 'iy iz'])} {r.choice(['add keep', 'add yes', 'replace yes', 'trim yes', 'box no', 'purge yes replace no add keep'])}"],
        ["region r9 delete", f"region r9 union 2 ra r2{r.choice(['', ' side out'])}"],
    ])


def scenes(r):
    """A deck of changes; after each the scene is written."""
    flat = r.random() < 0.25
    sides = f"boundary {r.choice('ppfsm')} {r.choice('ppfsm')} {'p' if flat else r.choice('ppfsm')}"
    opening = ["units lj", f"dimension {2 if flat else 3}", f"atom_style sphere", "atom_modify map array sort 0 0", sides, "newton off", "comm_modify vel yes"]
    names = [shape(r, f"r{k}", flat) for k in range(3)] + [f"region ra {r.choice(['union', 'intersect'])} 2 r0 r1{r.choice(['', ' side out'])}", "region r9 union 2 r1 ra"]
    values = ["variable mv equal 0.1+0.02*step", "variable ro equal 0.3+0.03*step", "variable push equal 0.2+0.01*step", "variable xx internal 0", "variable yy internal 0", "variable keep equal (v_xx+v_yy)<9",
              "variable at atom x*0.1+0.01*id", "variable kind atom 1+(y>4)", "variable wide atom 0.4+0.02*x", "variable va atom (x>3)&&(vx<0.5)"]
    rest = ["pair_style zero 1.0", "pair_coeff * *", "neighbor 3.0 nsq", "neigh_modify every 1 delay 0 check yes", "timestep 0.002", "fix 1 all nve/sphere", *(["fix e2 all enforce2d"] if flat else []),
            "group dy dynamic all region r2 every 1", "compute sx all reduce sum x y z vx vy vz", "thermo_style custom step atoms ke vol lx ly lz c_sx[*]", "thermo_modify norm no lost ignore format float %20.13g"]
    # The scale and the box come before regions in lattice units.
    deck = opening + ["lattice " + ("sq 0.3" if flat else "sc 0.2"), f"region b block 0 8 0 8 {'-0.5 0.5' if flat else '0 8'} units box", "create_box 2 b"] + values + names
    deck += created(r, flat) + created(r, flat) + ["set group all diameter 0.6 density 1", "velocity all create 1 99 loop geom", "group g1 type 1", "group g2 id 1:30:3", "group made empty", "set type 2 diameter 0.5"] + rest + ["run 0"]
    for k in range(r.randint(4, 9)):
        lines = edits(r, flat)
        if lines[-1] == "clear":
            lines += opening + ["lattice " + ("sq 0.3" if flat else "sc 0.2"), f"read_data scene.data{r.choice(['', ' extra/atom/types 1', ' group made'])}"] + values + names + ["group g1 type 1", "group g2 id 1:30:3", "group made id 1"] + rest
        deck += lines + [f"write_dump all custom s{k}.dump {KEPT} modify sort id format float %.12g", "print \"= $(atoms) $(count(all)) $(count(g1)) $(count(g2)) $(count(made)) $(count(all,ra)) $(count(all,r9)) $(xlo) $(xhi) $(ylo) $(yhi) $(zlo) $(zhi) $(mass(all)) $(vol)\""]
    return deck + ["run 4", f"write_dump all custom end.dump {KEPT} modify sort id format float %.12g"]

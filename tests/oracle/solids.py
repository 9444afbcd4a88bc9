"""Random decks of bond-based solids under fixes, computes and averages in combination."""
from levels import levels
from motion import WHOLE, computes, forces, movers

# What needs spheres, or pairs that touch.
SPHERES = ("radius", "/sphere", "contact/atom", "fabric", "cutoff radius", "diameter", "omega")

# Of neighbours equally far on a lattice centro/atom takes any; distances stand on the edges of rdf's bins.
TIES = ("centro/atom", "rdf")


def solids(r):
    """A block of springs of unit size, with what acts on grains in `motion`."""
    size, horizon = [r.randint(3, 6), r.randint(3, 6), r.randint(3, 6)], r.choice([1.5001, 2.001, 2.5, 3.0001])
    sides = [r.choice("fsm") for _ in range(3)]
    deck = ["units lj", "atom_style peri", "atom_modify map array sort 0 0", f"boundary {' '.join(sides)}", "comm_modify vel yes", "lattice sc 1.0",
            "region b block -3 10 -3 10 -3 10 units box", "create_box 2 b",
            f"region body block 0 {size[0] - 0.5} 0 {size[1] - 0.5} 0 {size[2] - 0.5} units box", "create_atoms 1 region body"]
    if r.random() < 0.3:
        deck.append(f"delete_atoms random fraction 0.1 yes all NULL {r.randint(1, 9999)}")
    deck += ["set group all density 1.5", "set group all volume 1.0", "region up block INF INF 1.5 INF INF INF units box",
             "group odd id 1:200:2", "group few id 2 4 8", "group mob subtract all few", "region half block INF 3 INF INF INF INF units box"]
    deck += r.choice([[], ["set region up type 2"]])
    strength = f"{r.choice([0.002, 0.02, 0.5])} {r.choice([0, 0.25])}"
    deck += ["pair_style peri/pmb", f"pair_coeff * * {r.choice([4, 20])} {horizon} {strength}",
             "neighbor 2.0 bin", "neigh_modify every 1 delay 0 check no", f"timestep {r.choice([0.0005, 0.002])}",
             "variable grow equal 0.5+step*dt", "variable tilt equal 0.1*step/100",
             "variable each atom vx*0.1+id*0.01", "variable px equal 0.05*sin(10*step*0.001)", "variable pv equal 0.5*cos(10*step*0.001)", "variable pa atom 0.01*id",
             "variable turn equal 0.5*step*0.001", "variable swell equal 0.8+0.002*step*dt", "variable ken equal ke",
             r.choice([f"velocity all ramp vx -{r.choice([0.1, 1])} {r.choice([0.1, 1])} x 0 {size[0]} units box",
                       "velocity odd set 0.1 0 -0.2 units box", "velocity all create 0.5 4928 loop geom"])]
    motor = movers(r, False)
    plain = lambda lines: [line for line in lines if not any(word in line for word in SPHERES)]
    # LAMMPS' indenter has no direction for a particle in its very middle.
    deck += [motor, "fix 1 mob nve"] + [line.replace("sphere 3 3 3", "sphere 3.1 2.9 3.05") for line in plain(forces(r, False))]
    kept = {}
    for line in deck:
        kept[" ".join(line.split()[:2]) if line.startswith("fix ") else line + str(len(kept))] = line
    deck = list(kept.values())
    if " move " not in motor and r.random() < 0.2:
        deck.append("fix dt all dt/reset 5 1e-5 2e-3 0.002 units box")
    lines, columns = computes(r, False, False, False, not set(sides) & set("sm"))
    left = [line for line in lines if not any(word in line for word in SPHERES + ("pair/local", "group/group", "temp/sphere", "tz", "tb", "torque/chunk") + TIES)]
    known = {line.split()[1] for line in left if line.split()[0] in ("compute", "fix", "variable")}
    # What depends on something left out goes too.
    while True:
        uses = lambda line: {w.split("_", 1)[1].split("[")[0] for w in line.split() if w[:2] in ("c_", "f_")}
        fewer = [line for line in left if uses(line) <= known | {"thermo_temp"}]
        if fewer == left:
            break
        left, known = fewer, {line.split()[1] for line in fewer if line.split()[0] in ("compute", "fix", "variable")}
    # Two computes of `motion` are called cs, and two co; those of contacts are not here.
    columns = [c for c in columns if c.split("_", 1)[1].split("[")[0] in known and c.split("[")[0] not in ("c_cs", "c_co")]
    deck += left + ["compute sx all reduce sum x y z vx vy vz", "compute dmg all damage/atom", "compute ds all reduce sum c_dmg",
                    f"thermo_style custom step atoms ke pe press c_sx[*] c_ds {' '.join(columns)} " + r.choice(["", "dt time", "vol lx xlo zhi", "pxx pxy pyy", "etotal enthalpy"]),
                    "thermo_modify norm no lost ignore format float %20.13g", "thermo 20", "run 100"]
    deck += r.choice([[], ["run 40"], ["velocity odd set 0 0.1 0", "run 20"]])
    # In the setup of a run with levels fixes see forces of one level alone in LAMMPS: its first step would be another one.
    if not any(word in line for word in [*WHOLE, "dt/reset"] for line in deck):
        deck = levels(r, deck, 0.3)
    return deck + ["write_dump all custom end.dump id type x y z vx vy vz fx fy fz c_dmg mass ix iy iz modify sort id format float %.11g"]

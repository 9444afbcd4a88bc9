"""Random decks that run once more through what they have dumped: rerun of one dump or two, under the same forces or others."""
from bodies import bodies
from grains import grains
from mixed import mixed

# What LAMMPS lets no deck go back in time with.
TIMED = (" move ", " rigid", "wiggle", " shear ", " vector ", "dt/reset", " recenter")


def dumped(r, name):
    """A dump, and the words that read it: fields and keywords of read_dump."""
    every, what = r.choice([1, 2, 3, 5, 10]), r.random()
    if what < 0.15:
        return [f"dump {name} all atom {every} {name}.dump", f"dump_modify {name} sort id scale {r.choice(['yes', 'no'])} format line \"%d %d %.16g %.16g %.16g\""], "x y z"
    places, fields = r.choice([("x y z", "x y z"), ("x y z", "x y z"), ("xs ys zs", "x y z"), ("xu yu zu", "x y z wrapped no"), ("x y z ix iy iz", "x y z ix iy iz"), ("xu yu zu ix iy iz", "x y z")])
    speeds = r.choice(["", " vx vy vz", " vx vy vz", " vx"])
    extra = r.choice(["", " fx fy fz", " type mass", " radius"])
    order = r.choice(["sort id", "sort id", "sort -1"])
    words = fields.split(" wrapped", 1)
    rest = " wrapped" + words[1] if len(words) > 1 else ""
    forces = " fx fy fz" if "fx" in extra and r.random() < 0.3 else ""
    return ([f"dump {name} all custom {every} {name}.dump id {places}{speeds}{extra}", f"dump_modify {name} {order} format float %.16g{r.choice(['', '', ' every 4', ' delay 8', ' first yes'])}"],
            f"{words[0]}{speeds}{forces}{rest}")


def chosen(r, steps):
    """Which snapshots are taken."""
    words = r.choice(["", "", f" first {r.randint(0, steps // 2)}"]) + r.choice(["", "", f" last {r.randint(steps // 2, steps)}"]) + r.choice(["", "", f" every {r.choice([2, 3, 4, 6])}"]) + r.choice(["", "", f" skip {r.choice([2, 3])}"])
    return words + r.choice(["", "", " start 0 stop 1000", " stop 500"]) + r.choice(["", "", " post yes", " post no"])


def reread(r):
    """A deck, its run and what is computed from its dumps."""
    whole = r.choice([bodies, grains, grains, mixed])(r)
    at = next(k for k, line in enumerate(whole) if line.startswith("run ") and int(line.split()[1]) > 0)
    deck = [line for line in whole[:at] if not (line.startswith("fix ") and any(word in line for word in TIMED)) and not line.startswith("run_style")]
    # LAMMPS takes the way of a wall from one snapshot to the next for that of a step.
    if any(line.startswith("region ") and (" move " in line or " rotate " in line) for line in deck):
        deck = [line for line in deck if "wall/gran/region" not in line]
    kept = {line.split()[1] for line in deck if line.startswith("fix ")}
    deck = [line for line in deck if not (line.startswith("fix_modify") and line.split()[1] not in kept)]
    steps = r.choice([20, 40])
    first, fields = dumped(r, "a")
    deck += first
    if r.random() < 0.3:
        deck += [line.replace("dump a", "dump b").replace("dump_modify a", "dump_modify b").replace("a.dump", "b.dump") for line in first]
        deck += [f"run {steps // 2}", "undump a", f"run {steps - steps // 2}", "undump b"]
        names = r.choice(["a.dump b.dump", "b.dump", "b.dump a.dump"])
    else:
        deck += [f"run {steps}", "undump a"]
        names = "a.dump"
    if r.random() < 0.3:
        deck.append(r.choice(["velocity all set 0 0 0", "displace_atoms all move 0.01 0 0 units box", "reset_timestep 7", "group odd2 id 1:40:2\ndelete_atoms group odd2 compress no"]))
    # LAMMPS' particles with ids of old ones have the bonds of those.
    purge = "" if any("peri/" in line for line in deck) else " purge yes replace no add keep"
    deck += [r.choice(["", "unfix g"]) if any(line.startswith("fix g ") for line in deck) else "", f"thermo {r.choice([1, 1, 2, 5])}"]
    if r.random() < 0.6:
        deck.append("dump again all custom 1 again.dump id x y z vx vy vz fx fy fz ix iy iz\ndump_modify again sort id format float %.11g")
    # LAMMPS prints at its first snapshot before momentum is taken away.
    if r.random() < 0.3 and not any(" momentum " in line for line in deck):
        deck.append("compute kee all ke\nfix told all print 1 \"= $(step) $(c_kee:%.11g) $(elapsed) $(elaplong)\" screen yes")
    deck.append(f"rerun {names}{chosen(r, steps)} dump {fields}{r.choice(['', '', ' box no', ' box yes', ' replace yes', purge, ' trim yes'])}")
    deck += r.choice([["print \"= $(step) $(atoms) $(ke)\""], [], ["run 0"], [f"rerun {names} dump {fields}"]])
    return [part for line in deck for part in line.split("\n") if part] + ["write_dump all custom end.dump id type x y z vx vy vz fx fy fz modify sort id format float %.11g"]

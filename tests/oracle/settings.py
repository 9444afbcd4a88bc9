"""Random decks of other kinds with settings in them that are to change nothing, or only when lists are made: neigh_modify,
comm_modify, balance, run in stretches."""
from grains import grains
from mixed import mixed
from motion import motion
from sources import sources

LISTS = ["every 1 delay 0 check yes", "every 1 delay 0 check yes", "every 1 delay 0 check no", "every 2 delay 0 check yes", "every 1 delay 5 check yes", "every 5 delay 10 check yes",
         "every 5 delay 5 check no", "delay 7", "once yes", "every 3 delay 3"]
REST = ["", "", " page 200000 one 5000", " binsize 1.5", " binsize 0", " cluster yes", " exclude none"]
TALK = ["comm_modify mode single vel yes", "comm_modify cutoff 9 vel yes", "comm_modify vel yes group all", "comm_style brick", "processors * * *", "processors 1 1 1 map xyz",
        "processors 1 * 1 grid onelevel", "comm_modify vel yes cutoff 7"]
LATER = ["balance 1.1 shift yx 10 1.05", "balance 0.9 shift x 5 1.1", "balance 1.0 x uniform", "timer loop", "timer full", "timer normal sync", "timer off", "suffix off", "echo log",
         "fix bal all balance 1000 1.1 shift xy 10 1.05", "info system", "thermo_modify flush yes", "atom_modify sort 0 0", "partition yes 1 print hello"]


def stretched(r, line, leveled):
    """A run of at least ten steps in other words, with the same steps. LAMMPS knows no `pre no` in steps of several lengths."""
    steps = int(line.split()[1])
    said = r.choice(['"print \'= $(step) $(ke)\'"', "NULL", '"variable twice equal 2*step" "print \'= ${twice}\'"'])
    return r.choice([line, f"{line} post no", f"{line} start 0 stop 1000", line if leveled else f"run {steps // 2} pre yes post no\nrun {steps - steps // 2} pre no", f"{line} every {steps // r.choice([2, 3, 5])} {said}",
                     f"{line} post no every {steps // 2} {said}", f"{line} pre yes every 7 NULL", f"run $(step+{steps}:%.0f) upto", f"run $(step+{steps}:%.0f) upto every {r.choice([4, 10])} {said}"])


def settings(r):
    """A deck of another kind with more settings."""
    deck = [line for line in r.choice([grains, mixed, motion, sources])(r) if line not in ("comm_modify vel yes", "newton off")]
    # Which grain is first in a pair with rolling and twisting history depends on lists in LAMMPS.
    free = not any(" rolling " in line or " twisting " in line for line in deck)
    lines = []
    for line in deck:
        word = line.split()[0]
        if word == "create_box":
            lines += r.sample(TALK, r.randint(0, 1)) if free else []
            if not any(talk.endswith("vel yes") or " vel yes " in talk for talk in lines):
                lines.append("comm_modify vel yes")
            lines.append(f"newton {r.choice(['off', 'on'] if free and not any('boundary' in k and 'p' in k.split() for k in deck) else ['off'])}")
        if word == "neigh_modify" and " every " in line:
            line = f"neigh_modify {r.choice(LISTS)}{r.choice(REST)}"
        # What LAMMPS averages and keeps can be asked only where it has a value.
        if word == "run" and not any(k.startswith(("fix fv", "fix aa")) for k in deck) and int(line.split()[1]) >= 10 and len(line.split()) == 2:
            lines += r.sample(LATER, r.randint(0, 2))
            line = stretched(r, line, any("respa" in k for k in deck))
        lines.append(line)
    return [part for line in lines for part in line.split("\n")]

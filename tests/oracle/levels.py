"""Levels of steps for random decks: `run_style respa` and the levels of fixes."""

# Fixes whose level `fix_modify respa` chooses. Held components below the outermost level show other values in LAMMPS.
LEVELED = {"addforce", "addtorque", "drag", "gravity", "indent", "spring", "spring/self", "viscous", "viscous/sphere"}


def levels(r, deck, share, parts=0, bonded=False):
    """The deck with steps of several lengths before its first run, in that share of cases; `parts`: how many sub-styles
    its hybrid pair style has; `bonded`: it has bonds, whose level is not above those of pairs."""
    if r.random() >= share:
        return deck
    count = r.choice([1, 2, 2, 3, 3])
    loops = " ".join(str(r.choice([1, 2, 3, 4])) for _ in range(count - 1))
    bond = r.randint(1, count) if bonded else 1
    if parts:
        pair = "hybrid " + " ".join(str(r.randint(bond, count)) for _ in range(parts))
    else:
        pair = f"pair {r.randint(bond, count)}" if r.random() < 0.6 else ""
    if bonded:
        pair = f"bond {bond} {pair}"
    lines = []
    for line in deck:
        words = line.split()
        if words[0] == "fix" and words[3] in LEVELED and r.random() < 0.5:
            lines.append(f"fix_modify {words[1]} respa {r.randint(1, count)}")
    lines.append(f"run_style respa {count} {loops} {pair}".strip())
    # Forces in the first row of a run are one level's in LAMMPS.
    deck = [" ".join(w for w in line.split(" ") if w not in ("v_fz", "v_vf")) if line.startswith("thermo_style") else line for line in deck]
    at = next(k for k, line in enumerate(deck) if line.startswith("run "))
    return deck[:at] + lines + deck[at:]

"""Random decks that minimize: solids and harmonic bonds by any style, grains by those that need no energy, then a run from there."""
from bodies import bodies
from bonds import bonds
from grains import grains


def least(r):
    """A deck that minimizes in the place of its first run."""
    kind = r.choice([bodies, bonds, bonds, grains])
    deck = kind(r)
    while kind is bodies and not any("pair_style peri/pmb" in line for line in deck) or kind is bonds and not any("bond_style harmonic" in line for line in deck):
        deck = kind(r)
    at = next(k for k, line in enumerate(deck) if line.startswith("run ") and int(line.split()[1]) > 0)
    # Bodies stand still meanwhile, and LAMMPS has put them up before or not.
    head = [line for line in deck[:at] if not line.startswith("run_style") and " rigid " not in line]
    # The contact history of evaluations that a line search takes back depends on lists.
    forceful = kind is grains or any(word in line for line in head for word in ("mindlin", "_history", "/history", "sds", "marshall"))
    style = r.choice(["fire", "quickmin"] if forceful else ["cg", "sd", "fire", "quickmin"])
    # Wherever springs and indenters act, their energies count.
    head += [f"fix_modify {line.split()[1]} energy yes" for line in head if line.startswith("fix ") and line.split()[3] in ("indent", "spring", "spring/self") and not forceful]
    dmax = r.choice([0.01, 0.1]) if kind is not bodies else r.choice([1e-6, 1e-5])
    modify = f"dmax {dmax}"
    if style in ("cg", "sd"):
        modify += r.choice(["", " line quadratic", " line backtrack"])
    elif style == "fire":
        modify += r.choice(["", " integrator verlet", " delaystep 5", " alpha0 0.2 alphashrink 0.9", " halfstepback no", " tmax 4.0", " vdfmax 50"])
    norm = r.choice(["", "", " norm max", " norm inf"]) if style not in ("fire", "quickmin") else r.choice(["", " norm max"])
    head += [f"min_style {style}", f"min_modify {modify}{norm}", "thermo 5"]
    steps = r.choice([10, 25, 60])
    head.append(f"minimize {r.choice([0, 1e-6])} {r.choice([0, 1e-3])} {steps} {r.choice([steps, 400])}")
    head += r.choice([[], ["run 10"], ["minimize 0 0 10 100"], ["min_style " + ("fire" if forceful else "sd"), "minimize 0 0 5 50"]])
    return head + ["write_dump all custom end.dump id type x y z vx vy vz fx fy fz modify sort id format float %.10g"]

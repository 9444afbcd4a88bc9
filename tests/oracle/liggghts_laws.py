"""Materials and contact models of random decks of LIGGGHTS."""


def digits(r, low, high):
    """A number with three digits, with even chances for its logarithm."""
    return f"{low * (high / low) ** r.random():.3g}"


def matrix(r, types, low, high):
    """A symmetric matrix of a property."""
    values = [[digits(r, low, high) for _ in range(types)] for _ in range(types)]
    return f"{types} " + " ".join(values[max(i, j)][min(i, j)] for i in range(types) for j in range(types))


def law(r, types):
    """The properties of all models."""
    stiff = r.choice([1, 1, 10])
    each = {"youngsModulus": (5e6 * stiff, 2e7 * stiff), "poissonsRatio": (0.1, 0.45)}
    pairs = {"coefficientRestitution": (0.2, 0.98), "coefficientFriction": (0.02, 1.2), "coefficientRollingFriction": (0.01, 0.5),
             "coefficientRollingViscousDamping": (0.05, 0.9), "cohesionEnergyDensity": (1e4, 3e5), "coefficientMaxElasticStiffness": (1.2, 4),
             "coefficientAdhesionStiffness": (0.05, 0.9), "coefficientPlasticityDepth": (0.005, 0.1)}
    wide = r.random() < 0.5
    pairs |= {"k_finnie": (0.5, 2)}
    pairs |= {"kn": (1e6, 1e7), "kt": (5e5, 5e6), "gamman": (1e4, 3e5), "gammat": (5e3, 2e5)} if wide else {
        "kn": (1e3, 2e4), "kt": (5e2, 1e4), "gamman": (30, 1000), "gammat": (10, 500)}
    pairs |= {"gamman_abs": (0.01, 1), "gammat_abs": (0.01, 0.5)}
    alone = {"characteristicVelocity": (0.1, 3), "rollingStiffness": (1, 3), "coeffRollingStiffness": (1, 3)}
    lines = [f"{name} peratomtype {' '.join(digits(r, *span) for _ in range(types))}" for name, span in each.items()]
    lines += [f"{name} peratomtypepair {matrix(r, types, *span)}" for name, span in pairs.items()]
    lines += [f"{name} scalar {digits(r, *span)}" for name, span in alone.items()]
    return [f"fix m{k} all property/global {line}" for k, line in enumerate(lines, 1)]


def parts(r):
    """The parts of a contact model."""
    normal = r.choice(["hertz", "hertz", "hooke", "hooke", "hertz/stiffness", "hooke/stiffness", "hooke/hysteresis"])
    tangential = r.choice(["history", "history", "history", "no_history", "off", ""])
    cohesion = r.choice(["", "", "off", "sjkr", "sjkr2"])
    rolling = r.choice(["", "off", "cdt", "epsd", "epsd2", "epsd3"])
    # perigrain refuses the one that has no spring for its torque.
    if "stiffness" in normal and tangential == "no_history" and rolling == "epsd2":
        rolling = "epsd"
    return normal, tangential, cohesion, rolling


def words(normal, tangential, cohesion, rolling):
    """A contact model as it is written."""
    heads = (("model", normal), ("tangential", tangential), ("cohesion", cohesion), ("rolling_friction", rolling))
    return " ".join(f"{head} {word}" for head, word in heads if word)


def switches(r, normal, tangential, cohesion, rolling):
    """Some switches that such a model has."""
    all = (("limitForce", True), ("tangential_damping", tangential in ("history", "no_history")), ("ktToKnUser", normal == "hooke"),
           ("absolute_damping", normal == "hooke/stiffness"), ("tangential_reduce", "sjkr" in cohesion and tangential == "history"),
           ("torsionTorque", rolling not in ("", "off")))
    found = [f"{word} {r.choice(['on', 'off'])}" for word, fits in all if fits and r.random() < 0.3]
    r.shuffle(found)
    return found


def models(r, types):
    """The words of the contact model of pairs, and those of walls with their switches: walls may leave parts out, or have a model of their
    own."""
    of_pair = parts(r)
    given = switches(r, *of_pair)
    pair = f"{words(*of_pair)} {' '.join(given)}".strip()
    if types == 1 and r.random() < 0.2:
        own = parts(r)
        return pair, (words(*own), " ".join(switches(r, *own)))
    normal, tangential, cohesion, rolling = of_pair
    of_wall = (normal, r.choice([tangential, tangential, tangential, "off"]), r.choice([cohesion, cohesion, ""]), r.choice([rolling, rolling, ""]))
    lacks = {"tangential_damping": of_wall[1] in ("off", ""), "tangential_reduce": "sjkr" not in of_wall[2] or of_wall[1] != "history",
             "torsionTorque": of_wall[3] in ("", "off")}
    return pair, (words(*of_wall), " ".join(s for s in given if not lacks.get(s.split()[0])))

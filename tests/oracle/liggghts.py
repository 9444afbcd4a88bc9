"""Random decks in LIGGGHTS' words: contact models, walls, surfaces that move, servos, of two and of many grains. No insertion: its places come from
random numbers."""
import math

from liggghts_laws import law, models
from liggghts_walls import Room, surfaces, walls

EDGE = 0.03
DIGITS = "%.14g"


class Scene(list):
    """A deck with the files that it reads, and how much of the largest number of a kind may differ."""

    def __init__(self):
        super().__init__()
        self.files = {}
        self.limit = 5e-6
        self.only = None
        self.walls = []


    def inexact(self):
        """Surfaces of LIGGGHTS add up time step times speed: grains are about where they should be."""
        self.limit, self.only = 2e-2, {"x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz"}


def number(r, low, high):
    """A number with four digits."""
    return float(f"{r.uniform(low, high):.4g}")


def vector(r, size):
    """Three numbers."""
    return [number(r, -size, size) for _ in range(3)]


def away(r, length):
    """A vector of this length, along an axis or anywhere."""
    if r.random() < 0.3:
        axis = r.randrange(3)
        return [length if k == axis else 0.0 for k in range(3)]
    v = [r.gauss(0, 1) for _ in range(3)]
    size = math.sqrt(sum(x * x for x in v))
    return [x / size * length for x in v]


def pair(r, types, open):
    """Two or three grains that touch or nearly do: place, radius, density, type."""
    grains = [([0.0, 0.0, 0.0], number(r, 0.003, 0.006), number(r, 1500, 4000), r.randint(1, types))]
    for _ in range(r.choice([1, 1, 2])):
        radius = number(r, 0.003, 0.006)
        gap = r.choice([0.0005, 0.002] if open else [-0.02, -0.005, -0.001, 0.0005, 0.002]) * radius
        for _ in range(50):
            place = [round(x, 9) for x in away(r, grains[0][1] + radius + gap)]
            if all(math.dist(place, q) > (radius + s) * (1 if open else 0.99) for q, s, *_ in grains[1:]):
                grains.append((place, radius, number(r, 1500, 4000), r.randint(1, types)))
                break
    return grains


def packing(r, types, apart):
    """Many grains that overlap by 2 % at most."""
    grains, wanted = [], r.randint(10, 70)
    alike = number(r, 0.003, 0.005) if r.random() < 0.3 else None
    for _ in range(6000):
        radius = alike or number(r, 0.003, 0.006)
        place = [round(r.uniform(-EDGE + radius * 0.99, EDGE - radius * 0.99), 7) for _ in range(3)]
        if all(math.dist(place, q) > (radius + s) * apart for q, s, *_ in grains):
            grains.append((place, radius, number(r, 1500, 4000), r.randint(1, types)))
        if len(grains) == wanted:
            break
    return grains


def placed(r, deck, grains, types):
    """The lines that make the box and the grains, by single ones, a lattice or a data file."""
    # LIGGGHTS needs a grain of type 1.
    grains[0] = (*grains[0][:3], 1)
    speed, spin = r.choice([(0.02, 2), (0.3, 40), (1.0, 200)])
    motion = [(vector(r, speed), vector(r, spin)) for _ in grains]
    box = " ".join([f"{-EDGE * 2} {EDGE * 2}"] * 3)
    if r.random() < 0.25:
        rows = [f"{k} {t} {2 * s:.6g} {d} {p[0]} {p[1]} {p[2]}" for k, (p, s, d, t) in enumerate(grains, 1)]
        moves = [f"{k} " + " ".join(map(str, v + w)) for k, (v, w) in enumerate(motion, 1)]
        sides = [f"{-EDGE * 2} {EDGE * 2} {a}lo {a}hi" for a in "xyz"]
        deck.files["grains.data"] = "\n".join(["grains", "", f"{len(grains)} atoms", f"{types} atom types", *sides, "", "Atoms", "", *rows,
                                                "", "Velocities", "", *moves, ""])
        deck.append("read_data grains.data")
        return
    deck += [f"region reg block {box} units box", f"create_box {types} reg"]
    if len(grains) > 9 and not deck.walls and r.random() < 0.5:
        radius = number(r, 0.003, 0.005)
        gap = r.choice([0.99, 1.0, 1.01]) * 2 * radius
        top, far = EDGE - radius, r.choice([0.4, 0.8])
        deck += [f"lattice {r.choice(['sc', 'sc', 'fcc'])} {gap * r.choice([1, 1.5]):.6g}",
                 f"region fill block {-top} {top} {-top * far} {top * far} {-top} {top * far} units box", "create_atoms 1 region fill"]
        deck += [f"set group all density {number(r, 1500, 4000)} diameter {2 * radius:.6g}"]
        if types > 1:
            deck += ["region some block INF INF INF INF 0 INF units box", f"set region some type {types}"]
        deck += [f"velocity all set {' '.join(map(str, vector(r, speed)))}",
                 f"variable each atom {number(r, 0, speed)}*sin(300*x+200*y)", f"velocity all set v_each NULL v_each sum yes"]
        return
    for k, ((p, s, d, t), (v, w)) in enumerate(zip(grains, motion), 1):
        deck += [f"create_atoms {t} single {p[0]} {p[1]} {p[2]} units box",
                 f"set atom {k} diameter {2 * s:.6g} density {d} vx {v[0]} vy {v[1]} vz {v[2]} omegax {w[0]} omegay {w[1]} omegaz {w[2]}"]


def forces(r, deck, many):
    """Fixes of LAMMPS that act on grains, and the integration."""
    deck += ["group few id 2 5 8", "group rest subtract all few"]
    kind = r.random()
    moving = "all"
    if many and kind < 0.25:
        moving = "rest"
        deck.append(r.choice(["fix fz few freeze", "fix fz few freeze", f"fix mv few move linear {number(r, -.2, .2)} 0 {number(r, -.2, .2)}",
                              "fix mv few move wiggle 0.0005 0 0.0003 0.01"]))
    deck.append(f"fix integ {moving} nve/sphere")
    if r.random() < 0.7:
        deck.append(f"fix grav all gravity 9.81 vector {r.choice(['0 0 -1', '0 0 -1', '1 -2 -1'])}")
    extras = ["fix v all viscous 0.002", "fix af rest addforce 0.003 0 -0.002", "fix sf few setforce NULL 0 NULL", "fix dr all drag 0 0 0 0.001 0.01",
              "fix lim all nve/limit 0.0001"]
    deck += [line for line in extras[:4] if r.random() < 0.07]


def output(r, deck, steps, watched):
    """Computes, the step table and the dump."""
    columns = ["step", "atoms", "ke"]
    deck.append("compute er all erotate/sphere")
    columns.append("c_er")
    if r.random() < 0.3:
        deck += ["compute st all stress/atom pair", "compute ss all reduce sum c_st[1] c_st[2] c_st[3] c_st[4] c_st[5] c_st[6]"]
        columns += [f"c_ss[{k}]" for k in range(1, 7)]
    if r.random() < 0.3:
        deck += ["compute pl all pair/gran/local contactArea delta", "compute ps all reduce sum c_pl[1] c_pl[2]", "compute pm all reduce max c_pl[1] c_pl[2]"]
        columns += ["c_ps[1]", "c_ps[2]", "c_pm[1]", "c_pm[2]"]
    if r.random() < 0.3:
        deck += ["compute cn all contact/atom", "compute cc all reduce sum c_cn"]
        columns.append("c_cc")
    if r.random() < 0.15:
        deck.append("fix ts all check/timestep/gran 1 0.5 0.5")
        columns += ["f_ts[1]", "f_ts[2]"]
    columns += watched
    every = max(1, steps // 10)
    deck += [f"thermo_style custom {' '.join(columns)}", "thermo_modify lost ignore norm no", f"thermo_modify format float {DIGITS}", f"thermo {every}"]
    fields = "id type x y z vx vy vz omegax omegay omegaz fx fy fz tqx tqy tqz"
    deck += [f"dump d all custom {every} moved.dump {fields}", f'dump_modify d sort id format "%d %d {" ".join([DIGITS] * 15)}"']


def changes(r, deck, grains, steps, yields, types):
    """Runs with changes between them."""
    deck.append(f"run {steps}")
    for _ in range(r.choice([0, 0, 1, 2]) if not yields else 0):
        k = r.randint(1, grains)
        v, w = vector(r, 0.2), vector(r, 30)
        both = [line.split()[1] for line in deck if line.startswith(("fix w0 ", "fix mv0 ", "fix wm "))]
        # Where nothing has changed, perigrain continues with the forces of the last step, and LIGGGHTS evaluates dashpots anew.
        deck += r.choice([[f"unfix {name}"] for name in both] + [
            [f"displace_atoms few move {v[0] / 1000:.6g} 0 {v[2] / 1000:.6g} units box"],
            [f"set atom {k} vx {v[0]} vy {v[1]}"],
            [f"set atom {k} omegax {w[0]} omegaz {w[2]}"],
            [f"velocity all set {v[0]} NULL {v[2]} sum yes"],
            [f"velocity rest set 0 0 {v[2]}"],
            ["fix grav all gravity 9.81 vector 0 1 -1"],
            [f"set type 1 density {number(r, 1500, 4000)}"],
            [f"set group all diameter {number(r, 0.006, 0.008)} density {number(r, 1500, 4000)}"],
            [f"fix m4 all property/global coefficientFriction peratomtypepair {types} {' '.join(['0.3'] * types ** 2)}"],
        ])
        deck.append(f"run {max(1, steps // 2)}")


def liggghts(r):
    """A deck."""
    deck = Scene()
    many, types, sides = r.random() < 0.6, r.choice([1, 1, 2, 3]), r.choice(["f f f", "f f f", "m m m", "p f f", "f p f"])
    of_pair, of_wall = models(r, types)
    # In setups LIGGGHTS adds the step's share to the torque of a rolling spring, and does not keep what a contact has yielded: these begin apart.
    yields = any(word in of_pair + of_wall[0] for word in ("hysteresis", "epsd"))
    grains = packing(r, types, 1.0 if yields else 0.98) if many else pair(r, types, yields)
    room = Room(grains, many, EDGE, sides, 0.0 if yields else 1.0)
    deck.walls += walls(r, types, of_wall, room)
    watched = surfaces(r, deck, types, of_wall, room)
    deck += ["atom_style granular", "atom_modify map array sort 0 0", f"boundary {sides}", "newton off", "communicate single vel yes", "units si"]
    placed(r, deck, room.grains, types)
    # LIGGGHTS keeps the spring of a contact that has opened until lists are made anew.
    deck += ["neighbor 0.002 bin", "neigh_modify delay 0 every 1 check no"]
    deck += law(r, types)
    deck += [f"pair_style gran {of_pair}", "pair_coeff * *", f"timestep {r.choice(['1e-5', '5e-6', '2e-5'])}", *deck.walls]
    steps = r.choice([1, 3, 20, 60]) if not many else r.choice([20, 60, 150, 300])
    forces(r, deck, many)
    output(r, deck, steps, watched)
    changes(r, deck, len(room.grains), steps, yields, types)
    return deck

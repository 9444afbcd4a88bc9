"""Walls and surfaces of random decks of LIGGGHTS."""
import math


def number(r, low, high):
    """A number with four digits."""
    return f"{r.uniform(low, high):.4g}"


def to_triangle(p, face):
    """The distance of a point from a triangle."""
    sub = lambda a, b: [x - y for x, y in zip(a, b)]
    dot = lambda a, b: sum(x * y for x, y in zip(a, b))
    a, b, c = face
    u, v, w = sub(b, a), sub(c, a), sub(p, a)
    uu, uv, vv, wu, wv = dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)
    area = uu * vv - uv * uv
    s, t = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    if s >= 0 and t >= 0 and s + t <= 1:
        return math.dist(p, [o + s * x + t * y for o, x, y in zip(a, u, v)])
    nearest = []
    for e, f in ((a, b), (b, c), (c, a)):
        d = sub(f, e)
        k = min(1, max(0, dot(sub(p, e), d) / dot(d, d)))
        nearest.append(math.dist(p, [o + k * x for o, x in zip(e, d)]))
    return min(nearest)


def depth(grain, distance):
    """How deep a grain is in something at this distance of its centre, as a part of its radius."""
    return 1 - distance / grain[1]


class Room:
    """The grains of a deck, of which those that are too deep in a new wall go, or the wall does."""

    def __init__(self, grains, many, edge, sides, deepest):
        self.grains, self.many, self.edge, self.sides, self.deepest = grains, many, edge, sides, deepest

    def takes(self, distance, deepest=0.04):
        """Whether a wall may stand there."""
        deepest = min(deepest, self.deepest)
        good = [g for g in self.grains if depth(g, distance(g[0])) < deepest]
        if len(good) < len(self.grains) and not self.many or len(good) < 3 and self.many:
            return False
        self.grains[:] = good
        return True


def walls(r, types, of_wall, room):
    """Primitive walls."""
    words, switches = of_wall
    lines, edge = [], room.edge

    def wall(name, place, shears):
        shear = f" shear {r.choice(shears)} {number(r, -0.5, 0.5)}" if r.random() < 0.3 else ""
        lines.append(f"fix w{len(lines)} all wall/gran {words} primitive type {r.randint(1, types)} {name} {place}{shear} {switches}".rstrip())

    def plane(axis, place):
        k = "xyz".index(axis)
        # perigrain refuses walls across a periodic axis.
        if room.sides.split()[k] != "p" and room.takes(lambda p: abs(p[k] - float(place))):
            wall(f"{axis}plane", place, [a for a in "xyz" if a != axis])

    def cylinder(radius, centre):
        axis = r.choice("xyz")
        k = "xyz".index(axis)
        others = {0: (1, 2), 1: (2, 0), 2: (0, 1)}[k]
        if any(room.sides.split()[o] == "p" for o in others):
            return
        if room.takes(lambda p: abs(float(radius) - math.hypot(*(p[o] - float(c) for o, c in zip(others, centre))))):
            # The y cylinder of LIGGGHTS does not turn under a shear across it.
            wall(f"{axis}cylinder", f"{radius} {centre[0]} {centre[1]}", "y" if axis == "y" else "xyz")

    if room.many:
        for axis in "xyz":
            for side in (-edge, edge):
                if r.random() < 0.5:
                    plane(axis, side)
        if r.random() < 0.4:
            cylinder(number(r, 0.8 * edge, 1.1 * edge), [number(r, -0.002, 0.002) for _ in range(2)])
        return lines
    for _ in range(40):
        first = room.grains[0]
        if r.random() < 0.7:
            plane(r.choice("xyz"), f"{r.choice([-1, 1]) * first[1] * r.uniform(0.97, 1.001):.6g}")
        else:
            far = r.uniform(0.005, 0.02)
            angle = r.uniform(0, 2 * math.pi)
            cylinder(f"{far + first[1] * r.uniform(0.97, 1.001):.6g}", [f"{far * math.cos(angle):.6g}", f"{far * math.sin(angle):.6g}"])
        if lines:
            break
    return lines


def stl(faces):
    """A text STL of triangles."""
    out = ["solid made"]
    for face in faces:
        out += [" facet normal 0 0 0", "  outer loop", *(f"   vertex {p[0]:.12g} {p[1]:.12g} {p[2]:.12g}" for p in face), "  endloop", " endfacet"]
    return "\n".join(out + ["endsolid made", ""])


def quad(a, b, c, d, flip):
    """Two triangles."""
    return [(a, b, c), (a, c, d)] if not flip else [(a, b, d), (b, c, d)]


def floor(r, half, z, tilt):
    """A plate of some rectangles, that may lean."""
    n, faces = r.choice([1, 1, 2, 3, 7]), []
    at = [-half + 2 * half * k / n for k in range(n + 1)]
    height = lambda x: z + tilt * x
    for i in range(n):
        for j in range(n):
            corners = [(at[i], at[j]), (at[i + 1], at[j]), (at[i + 1], at[j + 1]), (at[i], at[j + 1])]
            faces += quad(*[(x, y, height(x)) for x, y in corners], r.random() < 0.5)
    return faces


def block(r, half, low, high):
    """The six sides of a box, from inside or outside the same."""
    p = lambda i, j, k: ((half if i else -half), (half if j else -half), (high if k else low))
    sides = [((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)), ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
             ((0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)), ((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))]
    return [face for side in sides for face in quad(*[p(*c) for c in side], r.random() < 0.5)]


def shape(r, room):
    """Triangles of a surface."""
    edge = room.edge
    size = 1.3 * edge
    if not room.many:
        return floor(r, size, -room.grains[0][1] * r.uniform(0.97, 1.002), 0)
    # No block from outside: on a face near its edge LIGGGHTS has two contacts.
    return r.choice([lambda: floor(r, size, -edge, 0), lambda: floor(r, size, -0.9 * edge, r.choice([0.2, -0.5])), lambda: block(r, edge, -edge, edge),
                     lambda: floor(r, size, 0, 0.2)])()


def placed(r, faces):
    """The triangles as a file has them, and the words that bring them to their places."""
    kind = r.random()
    if kind < 0.25:
        scale = r.choice([0.001, 0.5, 2.0])
        return [[[x / scale for x in p] for p in face] for face in faces], f"scale {scale}"
    if kind < 0.5:
        shift = [r.choice([0, 0.004, -0.01]) for _ in range(3)]
        return [[[x - s for x, s in zip(p, shift)] for p in face] for face in faces], f"move {shift[0]} {shift[1]} {shift[2]}"
    if kind < 0.65:
        # The file has it turned by a quarter about x.
        return [[[p[0], p[2], -p[1]] for p in face] for face in faces], "rotate axis 1. 0. 0. angle 90."
    return faces, ""


FIRST_ORDER = ("wiggle", "riggle", "viblin", "vibrot", "rotate")


def mover(r, mesh, edge):
    """The motion of a surface."""
    period = r.choice([0.002, 0.01, 0.05])
    origin = " ".join(number(r, -edge, edge) for _ in range(3))
    axis = r.choice(["1. 0. 0.", "0. 0. 1.", "0. 1. 1."])
    v = " ".join(number(r, -0.3, 0.3) for _ in range(3))
    words = r.choice([
        f"linear {v}", f"linear {v}", f"wiggle amplitude {number(r, 0, 1e-4)} 0. {number(r, 0, 1e-4)} period {period}",
        f"rotate origin {origin} axis {axis} period {r.choice([0.5, 2.0])}",
        f"riggle origin {origin} axis {axis} period {period} amplitude {number(r, 0.05, 0.2)}",
        f"viblin axis {axis} order 2 amplitude {number(r, 1e-5, 1e-4)} {number(r, 1e-5, 1e-4)} phase 0.3 1.0 period {period} {period * 2}",
    ])
    return words, f"move/mesh mesh {mesh} {words}"


def surfaces(r, deck, types, of_wall, room):
    """Lines of surfaces with a wall on them, and what moves them; the columns of the step table that show them."""
    if r.random() < 0.4:
        return flow(r, deck, room.edge)
    words, switches = of_wall
    edge = room.edge
    meshes, watched, lines, movers = [], [], [], []
    for k in range(r.choice([1, 1, 2])):
        name = f"cad{k}"
        stress = r.random() < 0.6
        servo = room.many and stress and r.random() < 0.3 and k == 0
        moved = not servo and r.random() < 0.4
        if servo:
            real = floor(r, 1.3 * edge, r.choice([edge, 0.8 * edge]), 0)
            faces, place = real, ""
        else:
            real = shape(r, room)
            faces, place = placed(r, real)
        # In a setup a surface that moves has no velocity in LIGGGHTS: nothing touches it then.
        if not room.takes(lambda p: min(to_triangle(p, face) for face in real), 0.0 if moved else 0.04):
            continue
        deck.files[f"{name}.stl"] = stl(faces)
        style = "mesh/surface" + ("/stress" if stress else "") + ("/servo" if servo else "")
        line = f"fix {name} all {style} file {name}.stl type {r.randint(1, types)} {place}".rstrip()
        if servo:
            line += (f" com 0. 0. {number(r, 0, edge)} ctrlPV force axis 0. 0. 1. target_val {number(r, -3, -0.5)} vel_max {number(r, 0.01, 0.5)}"
                     f" kp {number(r, 0.01, 2)} ki {r.choice(['0.', number(r, 0.1, 10)])} kd {r.choice(['0.', number(r, 1e-6, 1e-4)])}")
        elif not moved and r.random() < 0.3:
            line += r.choice([f" surface_vel {number(r, -1, 1)} {number(r, -1, 1)} 0.", f" surface_ang_vel origin 0. 0. 0. axis 0. 0. 1. omega {number(r, -30, 30)}"])
        if stress and not servo and r.random() < 0.3:
            line += f" reference_point {number(r, -edge, edge)} 0.01 {number(r, -edge, edge)}"
        lines.append(line)
        meshes.append(name)
        if stress:
            watched += [f"f_{name}[{c}]" for c in range(1, 10 if servo else 7)]
        if moved:
            words_of, text = mover(r, name, edge)
            movers.append(f"fix mv{k} all {text}")
            if words_of.startswith(FIRST_ORDER):
                deck.inexact()
    if meshes:
        lines.append(f"fix wm all wall/gran {words} mesh n_meshes {len(meshes)} meshes {' '.join(meshes)} {switches}".rstrip())
    deck.walls += lines + movers
    return watched


def flow(r, deck, edge):
    """A face that counts the grains which pass, in few decks."""
    if r.random() < 0.7:
        return []
    deck.files["flow.stl"] = stl(floor(r, edge, float(number(r, -0.01, 0.01)), 0))
    once = r.choice(["", " count once", " count multiple"])
    deck.walls += ["fix face all mesh/surface file flow.stl type 1", f"fix mf all massflow/mesh mesh face vec_side 0. 0. {r.choice([-1, 1])}.{once}"]
    return ["f_mf[1]", "f_mf[2]"]

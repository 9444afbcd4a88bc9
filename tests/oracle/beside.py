"""One deck in both programs, side by side: rows of thermo output, printed lines and files."""
import os
import re
import subprocess
import tempfile

# Relative to the largest magnitude of a column, positions and velocities to what is usual in the scene: round-off grows in contacts.
LIMIT = 1e-6
REFUSED = "LAMMPS refuses it, and so does perigrain or need not"
ROW = re.compile(r"^ +\d+ +\d+( +[-+0-9.enaif]+)+ *$")


def rows(text):
    """The rows of thermo output."""
    return [[float(x) for x in line.split()] for line in text.splitlines() if ROW.match(line)]


def number(word):
    """The word as a number, or None."""
    try:
        return float(word.removesuffix(","))
    except ValueError:
        return None


def tables(a, b, floor):
    """None, or the column of two tables of numbers that differs most."""
    for k in range(min(len(row) for row in a)):
        scale = max(floor, max(abs(row[k]) for row in a))
        worst = max(abs(p[k] - q[k]) / scale if p[k] != q[k] else 0 for p, q in zip(a, b))
        if not worst < LIMIT:
            return f"column {k + 1}: {worst:.1e} of {scale:.6g}"
    return None


def texts(a, b):
    """None, or the first line of two texts that differs. Numbers of lines with as many words are compared by column."""
    a, b = a.splitlines(), b.splitlines()
    if len(a) != len(b):
        return f"{len(a)} and {len(b)} lines"
    scales = {}
    for line in a:
        values = [abs(number(word) or 0) for word in line.split()]
        scales[len(values)] = [max(p, q) for p, q in zip(values, scales.get(len(values), values))]
    for p, q in zip(a, b):
        left, right = p.split(), q.split()
        if len(left) != len(right):
            return f"{p!r} and {q!r}"
        for x, y, scale in zip(left, right, scales[len(left)]):
            u, v = number(x), number(y)
            same = x == y or (u is not None and v is not None and (u == v or abs(u - v) <= LIMIT * max(scale, 1e-3)))
            if not same:
                return f"{p!r} and {q!r}"
    return None


def files(folder):
    """The files that a run left, by name."""
    found = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), errors="replace") as file:
            found[name] = file.read()
    return found


def run(folder, *words):
    """What a program prints in a folder of its own, and what it leaves there."""
    os.makedirs(folder, exist_ok=True)
    try:
        said = subprocess.run(words, capture_output=True, text=True, cwd=folder, timeout=120)
    except subprocess.TimeoutExpired:
        return "ERROR: takes too long", {}
    return said.stdout + said.stderr + (f"\nERROR: signal {said.returncode}" if said.returncode < 0 or said.returncode > 127 else ""), files(folder)


def compare(deck, name, lammps, perigrain, ours=None):
    """None, or what differs; then the deck stays. REFUSED where LAMMPS refuses the deck, and perigrain does too or has no need to. `ours`: what perigrain runs
    instead, of the same rows; files but dumps at the end are not compared then."""
    cut = ours or deck
    with open(name, "w") as file:
        file.write("\n".join(deck) + "\n")
    path = os.path.abspath(name)
    with tempfile.TemporaryDirectory() as top:
        theirs, their_files = run(f"{top}/lammps", lammps, "-in", path, "-log", "none")
        with open(f"{top}/ours.in", "w") as file:
            file.write("\n".join(cut) + "\n")
        ours, our_files = run(f"{top}/perigrain", perigrain, "-compat", "lammps/2025", "-threads", "1", "-log", "none", f"{top}/ours.in")
        if cut is not deck:
            their_files, our_files = ({k: v for k, v in found.items() if k == "end.dump"} for found in (their_files, our_files))
        if hasattr(deck, "read"):
            # LAMMPS writes masses of types where grains have their own; what matters is what is read.
            their_files, our_files = ({k: v for k, v in found.items() if k != "kept.data"} for found in (their_files, our_files))
        found = differences(theirs, ours) or file_differences(their_files, our_files) or crosswise(top, lammps, perigrain, getattr(deck, "read", None))
    if found in (None, REFUSED):
        os.remove(name)
    elif hasattr(deck, "read"):
        with open(f"read.{name}", "w") as file:
            file.write(deck.read.format(of="perigrain"))
    return found


class Read(list):
    """A deck that writes `kept.data`, and the lines of another that reads it as `../{of}/kept.data`."""

    def __init__(self, deck, read):
        super().__init__(deck)
        self.read = "\n".join(read) + "\n"


READ = """units lj
atom_style sphere
atom_modify map array sort 0 0
{sides}
newton off
comm_modify vel yes
read_data ../{of}/kept.data
pair_style gran/hooke/history 500 NULL 5 NULL 0.5 1
pair_coeff * *
neighbor 2.0 nsq
fix 1 all nve/sphere
compute p all property/atom id type radius mass x y z vx vy vz omegax omegay omegaz ix iy iz
compute s all reduce sum c_p[*]
compute q all reduce sumsq c_p[*]
thermo_style custom step atoms ke press c_s[*] c_q[*] xlo xhi ylo zhi
thermo_modify norm no lost ignore format float %20.13g
timestep 0.001
thermo 10
run 20
"""


def crosswise(top, lammps, perigrain, read=None):
    """What differs where each program reads the data files of both, by the deck `read` or one for spheres."""
    if not all(os.path.exists(f"{top}/{of}/kept.data") for of in ("lammps", "perigrain")):
        return None
    said = []
    for of in ("lammps", "perigrain"):
        if read:
            deck = read.replace("{of}", of)
        else:
            with open(f"{top}/lammps/kept.sides") as file:
                deck = READ.format(of=of, sides=file.read().strip())
        for program, words in (("lammps", [lammps, "-log", "none", "-in"]), ("perigrain", [perigrain, "-compat", "lammps/2025", "-threads", "1", "-log", "none"])):
            with open(f"{top}/read.in", "w") as file:
                file.write(deck)
            said.append(run(f"{top}/{program}", *words, f"{top}/read.in")[0])
    found = [differences(said[0], other) for other in said[1:]]
    return next((f if f == REFUSED else f"reading data: {f}" for f in found if f), None)


def differences(theirs, ours):
    """What differs in the printed output."""
    errors = [[line for line in text.splitlines() if re.match(r"ERROR|error|thread .* panicked", line)][:1] for text in (theirs, ours)]
    if errors[0] and errors[1] and "panicked" not in errors[1][0]:
        return REFUSED if "signal" not in theirs else errors
    if errors[0] and "signal" in errors[0][0] and not errors[1]:
        return REFUSED
    # LAMMPS needs longer lists, a wider rim of ghosts, averages of this very step or forces of zero, which perigrain does not need.
    if errors[0] and re.search("exceeds ghost atom range|longer than pairwise cutoff|cutoff > max neighbor cutoff|not computed at compatible time|non-zero forces in an energy minimization", errors[0][0]) and not errors[1]:
        return REFUSED
    if errors[0] or errors[1]:
        return errors
    a, b = rows(theirs), rows(ours)
    if len(a) != len(b) or any(len(p) != len(q) for p, q in zip(a, b)):
        return f"{len(a)} and {len(b)} rows"
    told = ["\n".join(line for line in text.splitlines() if line.startswith("= ")) for text in (theirs, ours)]
    return (a and tables(a, b, 1e-3)) or texts(*told)


def file_differences(theirs, ours):
    """What differs in the files left behind, restart files and the first line of data files aside."""
    theirs, ours = ({name: text.split("\n", 1)[-1] if name.endswith(".data") else text
                     for name, text in found.items() if not name.endswith(".restart")} for found in (theirs, ours))
    if sorted(theirs) != sorted(ours):
        return f"files {sorted(theirs)} and {sorted(ours)}"
    for name, text in theirs.items():
        found = texts(text, ours[name])
        if found:
            return f"{name}: {found}"
    return None

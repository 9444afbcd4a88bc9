"""One deck of LIGGGHTS in both programs, side by side: rows of thermo output, and the dump."""
import os
import re
import tempfile

from beside import REFUSED, ROW, run

# LIGGGHTS refuses what perigrain need not: moduli below its bound, walls outside of its box.
ERROR = re.compile(r"^(ERROR|error|thread .* panicked|\[?.*Signal: |with errorcode)")


def table(text):
    """The rows of the step table with their column names, without those of setups, where LIGGGHTS' surfaces feel nothing."""
    names, rows, step = [], [], None
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            names, step = words, None
        elif ROW.match(line + " ") and len(words) == len(names):
            if step is not None and words[0] != step:
                rows.append([float(w) for w in words])
            step = words[0]
    return names, rows


def snapshots(text):
    """Column names, and each step's rows."""
    names, found, lines = [], [], text.splitlines()
    k = 0
    while k < len(lines):
        if lines[k].startswith("ITEM: TIMESTEP"):
            step, count = int(lines[k + 1]), int(lines[k + 3])
            names = lines[k + 8].split()[2:]
            found.append((step, sorted([float(w) for w in line.split()] for line in lines[k + 9:k + 9 + count])))
            k += 9 + count
        else:
            k += 1
    return names, found


def kind(name):
    """What is measured alike: components of a vector, columns of a fix."""
    return re.sub(r"\[\d+\]$", "", name) if name[1:2] == "_" else name.rstrip("xyz") or "x"


def far(names, a, b, limit, only=None):
    """None, or the column that differs most, by more than this part of the largest number of its kind."""
    scales = {}
    for row in a:
        for name, value in zip(names, row):
            # Lengths count by a millimetre, forces on surfaces by a thousandth; a number below 1e-13 is what is left of sums.
            scales[kind(name)] = max(scales.get(kind(name), 1e-3 if name in "xyz" else 1e-3 if "[" in name else 1e-13), abs(value) if name not in "xyz" else 0)
    worst = (0, None)
    for row, other in zip(a, b):
        for name, value, ours in zip(names, row, other):
            part = abs(value - ours) / scales[kind(name)] if value != ours and (not only or name in only) else 0
            if not part <= worst[0]:
                worst = (part, f"{name}: {ours:.9g} instead of {value:.9g}, {part:.1e} of {scales[kind(name)]:.3g}")
    return worst[1] if not worst[0] <= limit else None


def compare(deck, name, liggghts, perigrain):
    """None, or what differs; then the deck stays, in a folder with its files."""
    with tempfile.TemporaryDirectory() as top:
        found = []
        for program, words in (("liggghts", [liggghts, "-in", "in.deck", "-log", "none"]),
                               ("perigrain", [perigrain, "-threads", "1", "-log", "none", "in.deck"])):
            folder = f"{top}/{program}"
            write(deck, folder, "in.deck")
            found.append(run(folder, *words))
        differs = differences(*found, deck)
    if differs not in (None, REFUSED):
        write(deck, name.removesuffix(".in"), name)
    return differs


def write(deck, folder, name):
    """The deck and its files."""
    os.makedirs(folder, exist_ok=True)
    for file, text in {**deck.files, name: "\n".join(deck) + "\n"}.items():
        with open(os.path.join(folder, file), "w") as out:
            out.write(text)


def differences(theirs, ours, deck):
    """What differs between what was printed and left by both."""
    errors = [[line for line in said.splitlines() if ERROR.match(line)][:1] for said, _ in (theirs, ours)]
    if errors[0] and "panicked" not in "".join(errors[1]):
        return REFUSED
    if errors[1]:
        return errors[1]
    names, a = table(theirs[0])
    b = table(ours[0])[1]
    columns, moved = snapshots(theirs[1].get("moved.dump", ""))
    others = snapshots(ours[1].get("moved.dump", ""))[1]
    if [(step, len(rows)) for step, rows in moved] != [(step, len(rows)) for step, rows in others]:
        return "other steps or numbers of grains in the dump"
    # The first step that differs is the one to look at.
    for k, (step, _) in list(enumerate(moved)):
        both = [[row for _, part in found[:k + 1] for row in part] for found in (moved, others)]
        differs = far(columns, *both, deck.limit, deck.only)
        if differs:
            return f"step {step}: {differs}"
    if len(a) != len(b):
        return f"{len(a)} and {len(b)} rows"
    return far(names, a, b, deck.limit) if not deck.only else None

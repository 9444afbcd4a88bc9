"""Reads every format we write with the programs that claim to know it, and compares with numbers the decks are made of.

Particles fly freely, so that all places are known: x + v t, exact in binary. For `read.py`.
"""

import gzip
import re
import subprocess
import sys

import lammps_logfile
import MDAnalysis
import numpy as np
import pandas as pd
import pyvista
import vtk
import yaml
from ovito.io import import_file
from ovito.modifiers import LoadTrajectoryModifier
from vtk.util.numpy_support import vtk_to_numpy

TYPES = np.array([1, 2, 1, 2])
X = np.array([[0.25, 0.5, 0.75], [1.5, 2.0, 3.0], [1.75, 0.5, 1.0], [1.0, 1.5, 2.0]])
V = np.array([[0.125, 0.0, 0.25], [0.0, -0.5, 0.0], [0.5, 0.25, 0.125], [-0.25, 0.0, 0.125]])
RADIUS = np.array([0.0625, 0.125, 0.0625, 0.125])
EDGES = np.array([2.0, 3.0, 4.0])
# Tilts xy, xz, yz of the two boxes.
BOXES = {"upright": (0.0, 0.0, 0.0), "leaning": (0.5, 0.25, -0.75)}
STEPS, DT = [0, 2], 0.5
ENERGY = float((0.5 * 1000.0 * 4.0 / 3.0 * np.pi * RADIUS**3 * (V**2).sum(axis=1)).sum())
STYLES = ["atomic", "sphere", "peri", "bond", "molecular", "bpm/sphere", "hybrid sphere peri", "hybrid peri sphere",
          "hybrid sphere bond", "hybrid bond peri", "hybrid peri bpm/sphere", "hybrid bond sphere peri"]
# Columns of data files for MDAnalysis, which knows no style by name.
COLUMNS = {"atomic": "id type x y z", "sphere": "id type diameter density x y z", "peri": "id type volume density x y z",
           "bond": "id resid type x y z", "molecular": "id resid type x y z", "bpm/sphere": "id resid type diameter density x y z",
           "hybrid sphere peri": "id type x y z diameter density volume", "hybrid peri sphere": "id type x y z volume density diameter",
           "hybrid sphere bond": "id type x y z diameter density resid", "hybrid bond peri": "id type x y z resid volume density",
           "hybrid peri bpm/sphere": "id type x y z volume density resid diameter",
           "hybrid bond sphere peri": "id type x y z resid diameter density volume"}
done = {}


def same(what, have, want, tolerance=0.0):
    have, want = np.asarray(have), np.asarray(want)
    if have.shape != want.shape or (np.abs(have - want) > tolerance).any():
        sys.exit(f"{what}: {have.tolist()}, expected {want.tolist()}")
    client = what.split(",")[0]
    done[client] = done.get(client, 0) + 1


def edges(tilt):
    """The box's edges as rows."""
    xy, xz, yz = tilt
    return np.array([[EDGES[0], 0.0, 0.0], [xy, EDGES[1], 0.0], [xz, yz, EDGES[2]]])


def places(tilt, step):
    """Places in the box and how often each face was crossed."""
    free = X + V * DT * step
    parts = free @ np.linalg.inv(edges(tilt))
    image = np.floor(parts).astype(int)
    return free - image @ edges(tilt), image


def deck(style, tilt, bonds=False):
    shape = "block 0 2 0 3 0 4" if tilt == BOXES["upright"] else "prism 0 2 0 3 0 4 " + " ".join(map(str, tilt))
    lines = ["units si", f"atom_style {style}", "boundary p p p", f"region b {shape} units box",
             "create_box 2 b" + (" bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 2" if bonds else "")]
    lines += [f"create_atoms {k} single {x} {y} {z} units box" for k, (x, y, z) in zip(TYPES, X)]
    lines += [f"set atom {i} vx {x} vy {y} vz {z}" for i, (x, y, z) in enumerate(V, 1)]
    if "sphere" in style:
        lines += [f"set type {k} diameter {2 * r} density 1000" for k, r in zip(TYPES[:2], RADIUS)]
    elif "peri" in style:
        lines += ["set group all density 1000"]
    if "peri" in style:
        lines += ["set group all volume 0.5"]
    if bonds:
        lines += ["bond_style zero nocoeff", "bond_coeff *", "create_bonds single/bond 1 1 2", "create_bonds single/bond 1 3 4"]
    if style == "atomic" or "bond" in style or style == "molecular":
        lines += ["mass 1 1.5", "mass 2 2.5"]
    return lines


def run(name, lines):
    (FOLDER / f"in.{name}").write_text("\n".join(lines) + "\n")
    subprocess.run([PROGRAM, "-in", f"in.{name}", "-log", f"log.{name}", "-screen", "none", "-threads", "1"], cwd=FOLDER, check=True)


def flights():
    """Dumps of all styles in both boxes, and logs of three kinds."""
    every = "id type x y z ix iy iz vx vy vz radius"
    for box, tilt in BOXES.items():
        dumps = [f"custom 2 {box}.dump {every}", f"custom 2 {box}.dump.gz {every}", f"custom 2 {box}.bin {every}", f"atom 2 {box}.atom",
                 f"xyz 2 {box}.xyz", f"cfg 2 {box}.*.cfg mass type xs ys zs vx vy vz", f"yaml 2 {box}.yaml {every}",
                 f"vtk 2 {box}_*.vtu id type vx vy vz radius", f"atom/gz 2 {box}.atom.gz"]
        run(box, deck("sphere", tilt) + [
            "comm_modify vel yes", "fix 1 all nve/sphere", f"timestep {DT}", "compute ke all ke", "variable t equal time",
            f"fix mean all ave/time 1 1 1 c_ke v_t file mean.{box}", *(f"dump {k} all {words}" for k, words in enumerate(dumps)),
            "dump_modify 4 element C Si", "dump_modify 5 element C Si",
            "thermo 1", "thermo_style custom step time c_ke atoms vol", "run 2"])
    # A log with rows of several lines, and one with rows in YAML: readers distinguish them by the whole file.
    for name, style in (("multi", "multi"), ("yaml", "yaml")):
        run(name, deck("sphere", BOXES["upright"]) + ["comm_modify vel yes", "fix 1 all nve/sphere", f"timestep {DT}", "thermo 1", f"thermo_style {style}", "run 2"])



def of_ovito(name, tilt, pipeline, columns, box=True):
    same(f"ovito, snapshots of {name}", pipeline.source.num_frames, len(STEPS))
    for frame, step in enumerate(STEPS):
        data = pipeline.compute(frame)
        where, image = places(tilt, step)
        p = data.particles
        order = np.argsort(p["Particle Identifier"][...]) if "Particle Identifier" in p else np.arange(len(X))
        # A CFG file says no corner: OVITO puts the middle of the box there.
        corner = data.cell[...][:, 3] if box else 0.0
        same(f"ovito, places of {name}", p.positions[...][order] - corner, where, 1e-5)
        if box:
            same(f"ovito, box of {name}", data.cell[...][:, :3].T, edges(tilt), 1e-5)
        known = {"Particle Type": TYPES, "Periodic Image": image, "Velocity": V, "Radius": RADIUS}
        for column in columns:
            same(f"ovito, {column} of {name}", p[column][...][order], known[column], 1e-6)


def dumps():
    for box, tilt in BOXES.items():
        everything = ["Particle Type", "Periodic Image", "Velocity", "Radius"]
        for end in ("dump", "dump.gz", "bin", "yaml"):
            of_ovito(f"{box}.{end}", tilt, import_file(FOLDER / f"{box}.{end}"), everything)
        for end in ("atom", "atom.gz"):
            of_ovito(f"{box}.{end}", tilt, import_file(FOLDER / f"{box}.{end}"), ["Particle Type"])
        of_ovito(f"{box}.cfg", tilt, import_file(FOLDER / f"{box}.*.cfg"), ["Particle Type", "Velocity"])
        of_ovito(f"{box}.xyz", tilt, import_file(FOLDER / f"{box}.xyz", columns=["Particle Type", "Position.X", "Position.Y", "Position.Z"]), ["Particle Type"], False)
        for end, form in (("dump", "LAMMPSDUMP"), ("dump.gz", "LAMMPSDUMP"), ("atom", "LAMMPSDUMP"), ("xyz", "XYZ")):
            told = {"dt": 1.0} if form == "LAMMPSDUMP" else {}
            universe = MDAnalysis.Universe(FOLDER / f"{box}.{end}", format=form, to_guess=(), **told)
            same(f"MDAnalysis, snapshots of {box}.{end}", universe.trajectory.n_frames, len(STEPS))
            for step, _ in zip(STEPS, universe.trajectory):
                same(f"MDAnalysis, places of {box}.{end}", universe.atoms.positions, places(tilt, step)[0], 1e-5)
                if form == "LAMMPSDUMP":
                    same(f"MDAnalysis, box of {box}.{end}", universe.trajectory.ts.triclinic_dimensions, edges(tilt), 1e-5)
        paraview(box, tilt)
        tables(box, tilt)


def paraview(box, tilt):
    series = pyvista.get_reader(FOLDER / f"{box}.pvd")
    same(f"pyvista, times of {box}.pvd", series.time_values, [DT * step for step in STEPS])
    for step in STEPS:
        name = f"{box}_{step}.vtu"
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(FOLDER / name))
        reader.Update()
        grid = reader.GetOutput()
        columns = {"id": np.arange(1, 5), "type": TYPES, "v": V, "radius": RADIUS}
        same(f"vtk, cells of {name}", [grid.GetNumberOfCells(), grid.GetCellType(0)], [len(X), vtk.VTK_VERTEX])
        same(f"vtk, places of {name}", vtk_to_numpy(grid.GetPoints().GetData()), places(tilt, step)[0])
        same(f"vtk, time of {name}", grid.GetFieldData().GetArray("TIME").GetValue(0), DT * step)
        mesh = pyvista.read(FOLDER / name)
        for column, wanted in columns.items():
            same(f"vtk, {column} of {name}", vtk_to_numpy(grid.GetPointData().GetArray(column)), wanted)
            same(f"pyvista, {column} of {name}", mesh.point_data[column], wanted)


def tables(box, tilt):
    """A dump as `docs/howto/results.md` reads it, averages, and logs."""
    path = FOLDER / f"{box}.dump"
    names = path.read_text().split("ITEM: ATOMS ")[1].split("\n")[0].split()
    last = pd.read_csv(path, sep=" ", skiprows=9 + len(X) + 9, names=names, index_col=False)
    same(f"pandas, places of {path.name}", last[["x", "y", "z"]], places(tilt, STEPS[-1])[0])
    with gzip.open(FOLDER / f"{box}.dump.gz", "rt") as packed:
        same(f"pandas, the same of {path.name}.gz", pd.read_csv(packed, sep=" ", skiprows=9, nrows=len(X), names=names, index_col=False)[["vx", "vy", "vz"]], V)
    mean = pd.read_csv(FOLDER / f"mean.{box}", sep=" ", comment="#", names=["step", "ke", "t"])
    same(f"pandas, averages over the time of mean.{box}", mean["t"][:3], [0.0, DT, 2 * DT])
    same(f"pandas, energy of mean.{box}", mean["ke"], np.full(len(mean), ENERGY), 1e-5 * ENERGY)
    log = lammps_logfile.File(str(FOLDER / f"log.{box}"))
    same(f"lammps-logfile, steps of log.{box}", log.get("Step", run_num=0), [0, 1, 2])
    same(f"lammps-logfile, energies of log.{box}", log.get("c_ke", run_num=0), np.full(3, ENERGY), 1e-6 * ENERGY)
    same(f"lammps-logfile, volumes of log.{box}", log.get("Volume", run_num=0), np.full(3, EDGES.prod()))


def data_files():
    """Data files of every atom style in both boxes; bonds, and bonds of `dump local` over a trajectory."""
    for box, tilt in BOXES.items():
        for style in STYLES:
            name = style.replace(" ", "_").replace("/", "_") + f".{box}.data"
            bonds = "bond" in style or "bpm" in style
            run(name, deck(style, tilt, bonds) + [f"write_data {name}"])
            data = import_file(FOLDER / name).compute()
            p = data.particles
            order = np.argsort(p["Particle Identifier"][...])
            same(f"ovito, box of {name}", data.cell[...][:, :3].T, edges(tilt))
            known = {"Position": X, "Particle Type": TYPES, "Velocity": V}
            known |= {"Radius": RADIUS} if "sphere" in style else {}
            known |= {"Volume": np.full(len(X), 0.5)} if "peri" in style else {}
            known |= {"Molecule Identifier": np.zeros(len(X))} if bonds or style == "molecular" else {}
            for column, wanted in known.items():
                same(f"ovito, {column} of {name}", p[column][...][order], wanted)
            if bonds:
                ends = p["Particle Identifier"][...][p.bonds.topology[...]]
                same(f"ovito, bonds of {name}", sorted(map(sorted, ends.tolist())), [[1, 2], [3, 4]])
            universe = MDAnalysis.Universe(FOLDER / name, format="DATA", atom_style=COLUMNS[style], to_guess=())
            same(f"MDAnalysis, places of {name}", universe.atoms.positions, X)
            # It takes them for lengths per femtosecond and gives them per picosecond.
            same(f"MDAnalysis, velocities of {name}", universe.atoms.velocities, 1000.0 * V)
            same(f"MDAnalysis, types of {name}", universe.atoms.types.astype(int), TYPES)
            same(f"MDAnalysis, box of {name}", universe.trajectory.ts.triclinic_dimensions, edges(tilt), 1e-5)
            if bonds:
                same(f"MDAnalysis, bonds of {name}", sorted(b.atoms.ids.tolist() for b in universe.bonds), [[1, 2], [3, 4]])


def moving_bonds():
    """Bonds over time: `dump local` beside `dump custom`, as OVITO joins them."""
    box = BOXES["upright"]
    run("bonds", deck("bond", box, True) + [
        "comm_modify cutoff 3.0", "fix 1 all nve", f"timestep {DT}", "compute b all property/local batom1 batom2 btype", "dump 1 all custom 2 bonds.dump id type x y z",
        "dump 2 all local 2 bonds.local index c_b[1] c_b[2] c_b[3]", "write_data bonds.data", "run 2"])
    pipeline = import_file(FOLDER / "bonds.dump")
    load = LoadTrajectoryModifier()
    columns = [None, "Particle Identifiers.1", "Particle Identifiers.2", "Bond Type"]
    load.source.load(str(FOLDER / "bonds.local"), columns=columns)
    pipeline.modifiers.append(load)
    for frame in range(len(STEPS)):
        p = pipeline.compute(frame).particles
        ends = p["Particle Identifier"][...][p.bonds.topology[...]]
        same(f"ovito, bonds of snapshot {frame} of bonds.local", sorted(map(sorted, ends.tolist())), [[1, 2], [3, 4]])


def logs():
    """Rows of several lines, and rows in YAML read as LAMMPS' manual does."""
    multi = lammps_logfile.read_log(str(FOLDER / "log.multi"))
    same("lammps-logfile, steps of log.multi", multi["Step"], [0, 1, 2])
    same("lammps-logfile, energies of log.multi", multi["KinEng"], np.full(3, ENERGY), 1e-3)
    lines = (FOLDER / "log.yaml").read_text().splitlines()
    text = "\n".join(line for line in lines if re.fullmatch(r"keywords:.*|data:\s*|---|\.\.\.|  - \[.*\]", line))
    for part in yaml.safe_load_all(text):
        table = pd.DataFrame(data=part["data"], columns=part["keywords"])
        same("pandas, steps of log.yaml", table["Step"], [0, 1, 2])
        same("pandas, energies of log.yaml", table["KinEng"], np.full(3, ENERGY), 1e-5 * ENERGY)


def swept():
    """The table of many runs."""
    lines = [*deck("sphere", BOXES["upright"]), "variable fast index 1 2", "velocity all set $(v_fast) 0 0", "compute ke all ke",
             "thermo_style custom step c_ke", "run 0"]
    (FOLDER / "in.swept").write_text("\n".join(lines) + "\n")
    words = ["sweep", "in.swept", "-each", "fast", "1", "2", "-out", "swept", "-report", "c_ke", "-screen", "none"]
    subprocess.run([PROGRAM, *words], cwd=FOLDER, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    table = pd.read_csv(FOLDER / "swept" / "table.csv")
    energy = 0.5 * (1000.0 * 4.0 / 3.0 * np.pi * RADIUS**3).sum()
    same("pandas, variables of a sweep", table["fast"], [1, 2])
    same("pandas, energies of a sweep", table["c_ke"], [energy, 4 * energy], 1e-9 * energy)


def main(program, folder):
    global PROGRAM, FOLDER
    PROGRAM, FOLDER = program, folder
    flights()
    dumps()
    data_files()
    moving_bonds()
    logs()
    swept()
    print("ok: " + ", ".join(f"{client} {count}" for client, count in sorted(done.items())) + " comparisons")


#!/usr/bin/env python3
"""Reads what a run left with the programs people use, then every format (`formats.py`); any warning is a failure.

Usage: tests/clients/read.py PERIGRAIN FOLDER
"""
import sys, warnings
from pathlib import Path

# Warnings that come from importing the packages themselves say nothing about our files.
import lammps_logfile
import MDAnalysis
import pyvista
from ovito.io import import_file

folder = Path(sys.argv[2])
warnings.simplefilter("error")
# Said of every file, good or bad: lammps-logfile never closes what it reads, MDAnalysis' dump reader
# knows no masses.
warnings.simplefilter("ignore", ResourceWarning)
warnings.filterwarnings("ignore", message="Guessed all Masses to 1.0")
SNAPSHOTS, ROWS = 6, [4, 3]  # steps 0, 20 … 100; thermo rows of the two runs


def check(what, have, want):
    if have != want:
        sys.exit(f"{what}: {have!r}, expected {want!r}")
    print(f"ok: {what}: {have}")


log = lammps_logfile.File(str(folder / "log.clients"))
check("lammps-logfile, number of runs", log.get_num_partial_logs(), 2)
for run, rows in enumerate(ROWS):
    check(f"lammps-logfile, rows of run {run}", len(log.get("Step", run_num=run)), rows)
check("lammps-logfile, last step", int(log.get("Step", run_num=1)[-1]), 100)
damage = float(log.get("c_dsum", run_num=1)[-1])

dump = import_file(str(folder / "clients.dump"))
check("ovito, snapshots of the dump", dump.source.num_frames, SNAPSHOTS)
data = dump.compute(SNAPSHOTS - 1)
particles = data.particles.count
check("ovito, step of the last snapshot", data.attributes["Timestep"], 100)
check("ovito, damage agrees with the log", abs(float(data.particles["c_dmg"][...].sum()) - damage) < 1e-3, True)

universe = MDAnalysis.Universe(str(folder / "clients.dump"), format="LAMMPSDUMP", dt=1.0)
check("MDAnalysis, particles", universe.atoms.n_atoms, particles)
check("MDAnalysis, snapshots", universe.trajectory.n_frames, SNAPSHOTS)

series = pyvista.get_reader(next(folder.glob("*.pvd")))
check("pyvista, steps of the .pvd", len(series.time_values), SNAPSHOTS)
series.set_active_time_value(series.time_values[-1])
for name, grid in [("the .pvd", series.read()[0]), ("one .vtu", pyvista.read(sorted(folder.glob("*.vtu"))[-1]))]:
    check(f"pyvista, particles in {name}", grid.n_points, particles)
    check(f"pyvista, arrays in {name}", {"id", "type", "c_dmg"} <= set(grid.point_data.keys()), True)

# In the same process: to import these packages takes longer than all that is asked of them.
import formats

formats.main(Path(sys.argv[1]).resolve(), folder.resolve())

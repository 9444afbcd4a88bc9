//! Pages of restart files, and of runs over what dumps hold.

use super::Entry;
use crate::graph::restarts::RestartLine;
use crate::session::lines::{ReadRestart, WriteRestart};
use perigrain_commands::read_dump;
use perigrain_styles::Doc;
use perigrain_styles::words::{Syntax, Words};

pub(super) const RESTART: Entry = (
    "restart",
    Doc {
        syntax: Syntax::Behind(RestartLine::GRAMMAR),
        summary: "Writes restart files during a run.",
        text: "Nothing is written where a run begins. With one name every step has a file of its own; with two names the files are \
            written in turn, and a restarted run continues with the one it did not come from. Both kinds may be in force. \
            What is in a file and how it is read is on the page of `read_restart`.\n\n\
            A run or minimization that is ended before its last step (Ctrl-C, a signal, `timer timeout`) makes one step \
            more as its last one, with a row of the step table, and then writes one more file: byte by byte the one that \
            `write_restart` writes behind a run of so many steps. A run that an error ends (particles lost, energy out of \
            control) leaves none besides those of its schedule.\n\n\
            A file is written beside its place, brought to the disk and then moved there: whenever the program or the \
            machine dies, a file of this name is whole. LAMMPS' `%`, `fileper` and `nfile` (one \
            file per processor) are refused.",
        example: "restart 2 plate.*.restart\nrestart 4 even.restart odd.restart\nrun 4",
    },
);

pub(super) const WRITE_RESTART: Entry = (
    "write_restart",
    Doc {
        syntax: Syntax::Behind(WriteRestart::GRAMMAR),
        summary: "Writes a restart file now.",
        text: "Writing changes nothing in the scene (LAMMPS wraps particles into the box and \
            rebuilds its lists). See `read_restart` and `restart`.",
        example: "write_restart plate.*.restart",
    },
);

pub(super) const READ_RESTART: Entry = (
    "read_restart",
    Doc {
        syntax: Syntax::Behind(ReadRestart::GRAMMAR),
        summary: "Continues from a restart file: box, particles, bonds, contacts, settings.",
        text: "It takes the place of `create_box` or `read_data`. The file holds \
            the whole scene: clock and time step, units, boundary, box, lattice, types, particles with their forces, groups, \
            regions, materials, peridynamic bonds whole and broken, what contacts remember, neighbour settings and the \
            moment of the last rebuild, the pair style with its coefficients, and the state that fixes keep.\n\n\
            As in LAMMPS, the deck says fixes, computes, variables, dumps and thermo output again. A fix of the same ID and \
            style continues with its stored state; unclaimed state is dropped at the first run, with a note. \
            Regions and materials may be defined again. The pair style may be said again or not.\n\n\
            Where the scene is still that of the file and the lines of the pair style, of fixes and of their variables are \
            the same, the stored forces stand: a run cut in two by a restart file has the same bits as one run. Otherwise \
            forces are computed anew and the log says why. `compat lammps` always computes them anew, as LAMMPS does. For \
            ramps across the cut, `run … start … stop …` says where they begin and end; `run N upto` makes the steps that \
            are left.\n\n\
            The format is perigrain's own: portable between machines, versioned, with a checksum. Files that are cut off, \
            damaged, LAMMPS' own, or of a version that stores scenes otherwise are refused, and so are those whose parts do not \
            fit together, whatever their checksum says. LAMMPS' switches \
            `-restart2data` and the like are not here: read the file and `write_data`.",
        example: "write_restart plate.restart\nclear\nread_restart plate.restart\nfix motion all nve",
    },
);

pub(super) const RERUN: Entry = (
    "rerun",
    Doc {
        syntax: Syntax::Behind(&read_dump::RERUN),
        summary: "Computes forces and output for the snapshots of dumps, without motion.",
        text: "Snapshots whose step is not above that of the one before are left out. It is an error if none is left (LAMMPS \
            takes the first one behind `first` even if it is behind `last`, and so does perigrain under `-compat lammps`).\n\n\
            For each, forces are computed as in the setup of a run, fixes that change forces act and integrators do not; \
            thermo output, dumps and averages appear for steps that are multiples of their intervals, rows of the step table for \
            the first and the last snapshot too.\n\n\
            Contacts remember at every snapshot, and afterwards, what they remembered before `rerun`; those with walls as long as no \
            snapshot opens them (under `-compat lammps` afterwards what the last snapshot has left, as in LAMMPS). \
            The clock shows step · dt of each snapshot (LAMMPS counts the time from its own first snapshot). Peridynamic \
            bonds are those of the scene before, or of the first snapshot if there was no run: bonds do not break, and \
            damage is not in a dump.",
        example: "dump 1 all custom 1 moves.txt id x y z vx vy vz\nrun 4\nundump 1\nrerun moves.txt first 2 every 2 dump x y z vx vy vz",
    },
);

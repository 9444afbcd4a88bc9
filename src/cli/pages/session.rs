//! Pages of the commands about the session: run, output, echo, modes.

use super::Entry;
use crate::styles::Doc;

pub(super) const RUN: Entry = (
    "run",
    Doc {
        syntax: "run N [upto] [start N1] [stop N2] [pre yes|no] [post yes|no] [every M \"command\" …]",
        summary: "Makes time steps.",
        text: "Checks all declarations together, seals them into a step plan (`perigrain plan` prints it), and makes `N` \
            steps. With `upto`, `N` is the step to arrive at. `run 0` computes forces, energies and output of the present \
            state.\n\n\
            - `start` and `stop` are the steps over which ramps go (`ramp()`, `fix setforce` with variables …) when \
            several runs share one; they must enclose the run's steps.\n\
            - `every M` stops every `M` steps and carries out the commands, each in quotes; `NULL` stands for none. \
            `quit` among them ends run and deck; `jump` is refused there.\n\
            - `post no` leaves out the tables of time and neighbours behind the run.\n\
            - `pre` is read for LAMMPS' decks. A second run of an unchanged scene reuses forces anyway and equals one \
            longer run bit by bit; a changed scene always computes forces anew. Under `compat lammps`, `pre yes` (the \
            default) computes them again, as LAMMPS does.\n\n\
            A run without box, with type pairs that have no coefficients, or types without mass is refused; a run that \
            looks wrong (nothing integrates, two integrators on one particle, volumes never set) draws a warning. A lost \
            particle or a force that is no number ends the run with step and particle named. Ctrl-C ends it after a whole \
            step.",
        example: "run 4 post no\n\
            run 8 upto\n\
            run 4 every 2 \"print 'speed of the ball: $(vcm(ball,z)) m/s'\"",
    },
);

pub(super) const PRINT: Entry = (
    "print",
    Doc {
        syntax: "print \"text\" [file NAME] [append NAME] [screen yes|no] [universe yes|no]",
        summary: "Writes a line to screen and log, or to a file too.",
        text: "Values are put into the text when it is printed: `$x`, `${name}`, `$(formula:%.3f)`. Text in `\"\"\"…\"\"\"` \
            may have several lines. `file` starts a file anew, `append` adds to it. `screen no` keeps the line off the \
            screen; it still goes into the log. `universe` is without effect: there is one.",
        example: "print \"step $(step): $(count(plate)) particles in the plate\"\n\
            print \"# v height\" file result.txt screen no\n\
            print \"$(vcm(ball,z):%.3f) $(xcm(ball,z):%.5f)\" append result.txt",
    },
);

pub(super) const LOG: Entry = (
    "log",
    Doc {
        syntax: "log FILE [append] | none",
        summary: "Changes the log file.",
        text: "The present log is finished and `FILE` goes on from here, written anew or, with `append`, behind what it \
            holds. `none` ends logging. The first log is `log.lammps`, or what `-log` says.",
        example: "log second.log\nlog none",
    },
);

pub(super) const ECHO: Entry = (
    "echo",
    Doc {
        syntax: "echo none|screen|log|both",
        summary: "Chooses where each line of the deck is repeated.",
        text: "Without it the log has them, the screen has not. A line with values put in is repeated as written and \
            after each value.",
        example: "echo both\necho log",
    },
);

pub(super) const CLEAR: Entry = (
    "clear",
    Doc {
        syntax: "clear",
        summary: "Forgets the scene: box, particles, all declarations and settings.",
        text: "Variables, the log and `compat` stay. What follows starts a new scene with `units` and so on. Dumps end \
            here; a file of the same name is written anew by the next scene.",
        example: "units si\natom_style sphere\nregion box block 0 1 0 1 0 1\ncreate_box 1 box\n\
            create_atoms 1 single 0.5 0.5 0.5\nclear\nunits lj\nregion box block 0 2 0 2 0 2\ncreate_box 1 box\n\
            mass 1 1.0\nprint \"a box of $(vol)\"",
    },
);

pub(super) const COMPAT: Entry = (
    "compat",
    Doc {
        syntax: "compat lammps|none",
        summary: "Gives LAMMPS' numbers also where LAMMPS is wrong.",
        text: "The same as `-compat lammps` on the command line. [Coming from LAMMPS](../coming-from-lammps.md) lists what \
            it changes and by how much; the log tells which of it a deck touches. `none` goes back. LAMMPS has no such \
            command.",
        example: "compat lammps",
    },
);

pub(super) const SUFFIX: Entry = (
    "suffix",
    Doc {
        syntax: "suffix word …",
        summary: "Taken for LAMMPS' decks, without effect.",
        text: "LAMMPS chooses variants of styles with it. Here kernels are chosen by what the scene and the processor \
            offer; a note in the log says that the line does nothing.",
        example: "suffix omp",
    },
);

pub(super) const PACKAGE: Entry = (
    "package",
    Doc {
        syntax: "package word …",
        summary: "Taken for LAMMPS' decks, without effect.",
        text: "A note in the log says so. Threads are set by `-threads N` (or `-pk omp N`) on the command line.",
        example: "package omp 4",
    },
);

pub(super) const WRITE_DUMP: Entry = (
    "write_dump",
    Doc {
        syntax: "write_dump group style FILE [attribute …] [modify keyword value …]",
        summary: "Writes one snapshot now.",
        text: "Style, attributes and the options after `modify` are those of `dump` and `dump_modify`; the file needs no \
            `*`. Values of computes and variables are computed for the present state; energies per particle need a `run 0` \
            before.",
        example: "write_dump all custom now.dump id type x y z c_dmg modify sort -1 format float %.6g\n\
            write_dump plate image now.png c_dmg auto modify range 0 1",
    },
);

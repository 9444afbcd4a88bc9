//! Pages of the commands about the session: run, output, echo, modes.

use super::Entry;
use crate::graph::heads;
use crate::session::lines::{
    CommStyle, Compatibility, Echoing, Info, Logging, Minimize, Package, Partition, Print, Run, Statics,
    Suffix, Sweep, TimerLine, Tiring,
};
use perigrain_styles::Doc;
use perigrain_styles::words::{Grammar, Syntax, Words};

pub(super) const RUN: Entry = (
    "run",
    Doc {
        syntax: Syntax::Behind(Run::GRAMMAR),
        summary: "Makes time steps.",
        text: "Checks all declarations together, seals them into a step plan (`perigrain plan` prints it), and makes the \
            steps. `start` and `stop` must enclose the run's steps.\n\n\
            With `every` the stretches between commands are runs of their own; with `pre no post no` only the first has a setup and \
            only the last tables. `quit` among the commands ends run and deck; `jump` is refused there.\n\n\
            A second run of an unchanged scene reuses forces anyway and equals one \
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

pub(super) const MINIMIZE: Entry = (
    "minimize",
    Doc {
        syntax: Syntax::Behind(Minimize::GRAMMAR),
        summary: "Moves particles until the energy is lowest.",
        text: "Stops at the first of these four limits. `min_style` chooses the \
            algorithm, `min_modify` its numbers. Where a line search of `cg` or `sd` only looks, no bond breaks or flows; it may where the search ends (LAMMPS: anywhere; so under `-compat lammps`).\n\n\
            Iterations are steps: thermo output, dumps and restart files come at their intervals, and once more where the \
            end is early. The time they show is of no meaning and is not counted by the next run. The log then gives the \
            criterion that ended it, energies and forces before and after.\n\n\
            Fixes that hold or push particles act at every evaluation: `addforce aveforce enforce2d indent lineforce \
            planeforce setforce spring spring/self store/force viscous`; `halt` ends it. The energy of `indent`, `spring` \
            and the like counts after `fix_modify ID energy yes`. `gravity` and `drag` do not act, as in LAMMPS, which a \
            warning says. Integrators, averages and `print` wait for runs. Particles do not rotate.\n\n\
            Peridynamic bonds break as in steps: each evaluation looks at them. Laws of contact count no energy, so for \
            grains `fire` or `quickmin` with a force tolerance is the way. Both set all velocities to zero first and leave those of \
            their last iteration. Springs of contacts grow by the steps `fire` takes; LAMMPS lets them grow by the deck's \
            `timestep`, and so does perigrain under `-compat lammps`.",
        example: "fix hold plate setforce 0.0 0.0 0.0\nmin_style fire\nmin_modify dmax 1.0e-6\nminimize 0.0 1.0e3 20 100",
    },
);

pub(super) const STATICS: Entry = (
    "statics",
    Doc {
        syntax: Syntax::Behind(Statics::GRAMMAR),
        summary: "Balances a solid under loads that grow with time: cracks without inertia.",
        text: "A load step moves the clock as a step of a run does, by `T`/`N`. What stands on a path moves there (`fix move`), \
            loads and walls that depend on time change (`gravity`, `addforce`, `indent`, `wall/region` with variables of \
            `time`), and the free particles follow to the place where no force is left on them. Free are the particles of \
            `fix nve`, but for the components that `fix move` leads and those that `setforce 0`, `freeze` or `enforce2d` \
            hold; particles that no fix moves are held. Nothing has a velocity: `viscous` and the like do nothing.\n\n\
            Newton's method finds that place, its linear systems are solved by conjugate gradients with clusters of particles \
            that move as rigid bodies; products with the tangent stiffness are differences of forces. Nothing breaks while places \
            are tried, and bonds that flow, soften or relax do so for the whole load step at each of them, and keep what the equilibrium \
            leaves (`peri/eps`, `peri/ves`, `plastic`, `softening`). A load step that is not balanced is cut in half, and so on \
            (`adapt`); where the body gives way at once, it is relaxed by damped motion, which `solver adr` does from the beginning.\n\n\
            Bonds break at equilibria alone. `break one` finds the load of each load step at which the first bond is at its limit (to \
            1e-3 of it), breaks that one with those that are stretched as much, balances the body again at the same load, and so on until \
            none is beyond its limit. `batch F` breaks the share `F` of the others too, `all` breaks all, at the end of load steps: \
            faster, and where a crack runs on under fixed loads its path depends on it. The load ratio of a bond is its stretch over its \
            critical stretch, or what `peri_modify break` compares; a formula is evaluated at the end of load steps alone.\n\n\
            Under `control damage` a load step is a break: time moves to where the bond with the largest load ratio is at its limit, \
            forwards or back, and that bond breaks. So the load falls where the body would otherwise fly apart at a fixed load \
            (snap-back), and no energy is given up but the little that one bond leaves. `N` is the most breaks, `T`/`N` the first guess \
            of a time; paths and loads should be linear in time. `until 0.2` ends where the load has fallen to 0.2 of its peak.\n\n\
            Under `control opening S` time and places are found together, so that the bond that opens fastest is longer by `S` of its length \
            (indirect displacement control). Bodies whose bonds soften are followed past the peak of their load and along a snap-back; a fifth of the \
            stretch at the peak is a good `S` there. `T`/`N` is the first guess of a time, and what the load moves by where nothing opens. Where a bond breaks \
            the load moves so that the next fastest keeps its length.\n\n\
            A table at the end has, for each load step, Newton's steps, products, the unbalanced force over reactions \
            and loads, bonds that broke, work and released energy; `compute statics` offers these numbers in rows and variables.\n\n\
            Then the log states the work of paths and loads, and where it is: in the energy of the body, released by \
            bonds where they broke, and relaxed: given up on the way from a break to the next equilibrium, which motion would have carried \
            away, and lost by bonds that soften and materials that flow or are damaged. The rest is the error of the load steps, in which forces \
            count with their mean; of bonds that flow or relax (peri/eps, peri/ves, peri/pmb/plastic) it counts as lost. Energies are true ones, also where `pe` sums densities.\n\n\
            Thermo output, dumps, averages and `print` come as in a run of `N` steps. A run behind it begins with velocities of 0. The force \
            on what `fix move` leads is the sum of `fx` over its group (`compute reduce`). Bonds of a \
            `bond_style`, contacts of grains, rigid bodies and fixes that insert or delete are refused by \
            name, and so are bodies of which nothing holds a piece along some axis, but for `solver adr`.",
        example: "fix motion plate nve\nfix base foot setforce 0.0 0.0 0.0\nregion far block INF INF 0.003 INF INF INF units box\n\
            group far region far\nfix pull far move linear 0.0 1.0e-3 0.0 units box\nstatics 2 time 1.0e-6",
    },
);

pub(super) const FATIGUE: Entry = (
    "fatigue",
    Doc {
        syntax: Syntax::Behind(Tiring::GRAMMAR),
        summary: "Lets peridynamic bonds tire under a load that repeats: cracks over millions of cycles.",
        text: "The present loads are the upper ones of each cycle; where `statics` has brought them up, this is the place to begin. \
            Each bond has a life λ, 1 at first, of which a cycle takes A ε^m, ε being (1 − R) times its stretch at the upper load, 0 in \
            compression (Silling & Askari 2014). `init` says how, away from cracks, and `grow` where an end of the bond or a partner of one has \
            lost the part `cracked` of its family; with A1 = 0 no crack begins.\n\n\
            The body is balanced as by `statics`; bonds beyond their limit break there one after another. Then as many cycles pass as the \
            bond that tires first bears. It breaks, with those of which `batch` or less is left, and the body is balanced again from \
            where it is, until `N` cycles have passed. `batch 0` breaks one bond at a time, with those that a symmetry maps to it. Each \
            equilibrium is a step of the clock, at which thermo output, dumps and `fix print` come, but takes no time, so that nothing moves; after `M` of them it ends in \
            equilibrium with fewer cycles. Lives are kept for a further `fatigue` and in restart files.\n\n\
            The log ends with a table: cycles, bonds that broke beyond their limit and by the end of their lives, the largest stretch; `file` has the \
            first five columns with all digits. What `statics` cannot balance is refused. Bonds of `peri_modify nofail` do not tire.",
        example: "fix motion plate nve\nfix base foot setforce 0.0 0.0 0.0\nregion far block INF INF 0.003 INF INF INF units box\n\
            group far region far\nfix pull far move linear 0.0 1.0e-3 0.0 units box\nstatics 2 time 1.0e-6\n\
            fatigue init 1.0e9 4 1.0e-5 grow 1.0e10 4 cycles 1.0e6",
    },
);

pub(super) const PRINT: Entry = (
    "print",
    Doc {
        syntax: Syntax::Behind(Print::GRAMMAR),
        summary: "Writes a line to screen and log, or to a file too.",
        text: "Values are put into the text when it is printed: `$x`, `${name}`, `$(formula:%.3f)`. Text in `\"\"\"…\"\"\"` \
            may have several lines. `file` and `append` exclude each other.",
        example: "print \"step $(step): $(count(plate)) particles in the plate\"\n\
            print \"# v height\" file result.txt screen no\n\
            print \"$(vcm(ball,z):%.3f) $(xcm(ball,z):%.5f)\" append result.txt",
    },
);

pub(super) const LOG: Entry = (
    "log",
    Doc {
        syntax: Syntax::Behind(Logging::GRAMMAR),
        summary: "Changes the log file.",
        text: "The present log is finished and `FILE` continues from here. The first log is `log.lammps`, or what `-log` says.",
        example: "log second.log\nlog none",
    },
);

pub(super) const ECHO: Entry = (
    "echo",
    Doc {
        syntax: Syntax::Behind(Echoing::GRAMMAR),
        summary: "Chooses where each line of the deck is repeated.",
        text: "Without it the log has them, the screen has not. A line with values put in is repeated as written and \
            after each value.",
        example: "echo both\necho log",
    },
);

pub(super) const CLEAR: Entry = (
    "clear",
    Doc {
        syntax: Syntax::Behind(Grammar::NONE),
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
        syntax: Syntax::Behind(Compatibility::GRAMMAR),
        summary: "Gives LAMMPS' numbers also where LAMMPS is wrong, or reads the words of LIGGGHTS.",
        text: "The same as `-compat lammps` on the command line. [Coming from LAMMPS](../coming-from-lammps.md) lists what \
            it changes and by how much; the log lists what concerns the deck. `none` goes back. LAMMPS has no such \
            command.\n\n\
            `lammps/2025` is LAMMPS 22Jul2025, whose numbers have been compared. `lammps/2026`, which `lammps` alone stands for, is the same but \
            for what LAMMPS has mended in 2026; that page lists it.\n\n\
            `liggghts` reads the lines that follow as [LIGGGHTS](liggghts.md) means them. A deck with a word that only LIGGGHTS \
            has is read so by itself; `none` above that word forbids it.",
        example: "compat lammps",
    },
);

pub(super) const SHELL: Entry = (
    "shell",
    Doc {
        syntax: Syntax::Written(
            "shell cd FOLDER\n\
            shell mkdir FOLDER …\n\
            shell rmdir FOLDER …\n\
            shell mv OLD NEW\n\
            shell rm [-f] FILE …\n\
            shell putenv NAME=VALUE …\n\
            shell COMMAND WORD …",
        ),
        summary: "Works with folders, files and the system's shell.",
        text: "`cd` changes the working folder, to which all further file names refer. `mkdir` and `rmdir` make and remove \
            folders (empty ones), `mv` and `rm` rename and remove files; `putenv` sets environment variables for `variable \
            … getenv` and for commands. Anything else is one line for `sh`, its words joined by single blanks as LAMMPS \
            does; its output goes to the screen.\n\n\
            A failure is a warning and the deck continues, as in LAMMPS; `rm -f` prints nothing. `perigrain check` and \
            `perigrain plan` carry out nothing but `putenv`; files that are missing later are then not complained about.",
        example: "shell mkdir results\nshell putenv RUN=seven\nvariable run getenv RUN\nprint \"run ${run}\"\nshell rmdir results",
    },
);

pub(super) const INFO: Entry = (
    "info",
    Doc {
        syntax: Syntax::Behind(Info::GRAMMAR),
        summary: "Shows what the session holds.",
        text: "The beginning of a category is enough, as in LAMMPS; an unknown one is refused.",
        example: "info system groups variables\ninfo styles pair out log",
    },
);

pub(super) const TIMER: Entry = (
    "timer",
    Doc {
        syntax: Syntax::Behind(TimerLine::GRAMMAR),
        summary: "Limits the time that runs may take; chooses how much is said about time.",
        text: "Once the limit has passed, further runs are passed over. A time is `SS`, `MM:SS` or `H:MM:SS`. `is_timeout()` and the \
            thermo keyword `timeremain` depend on it. Of words that exclude each other the last one counts; without the command it is \
            `normal nosync timeout off every 10`.",
        example: "timer timeout 1:00:00 every 5\nrun 4\nif \"$(is_timeout())\" then \"print 'out of time'\"\ntimer timeout off",
    },
);

pub(super) const PARTITION: Entry = (
    "partition",
    Doc {
        syntax: Syntax::Behind(Partition::GRAMMAR),
        summary: "Carries out a command on some of the partitions.",
        text: "Partitions are the processes that `-partition` on the command line makes; without it there is one, with the number 1. A partition that does not exist is refused.",
        example: "partition yes 1 print \"on the first partition\"",
    },
);

pub(super) const SWEEP: Entry = (
    "sweep",
    Doc {
        syntax: Syntax::Behind(Sweep::GRAMMAR),
        summary: "Many runs of the deck side by side, each with other values of variables, and one table of what they give.",
        text: SWEEP_TEXT,
        example: "sweep each v 10 20 30 each angle 0..90:30 report v_force pe\n\
            velocity ball set 0 0 -$v units box\n\
            print \"${angle} degrees\"",
    },
);

const SWEEP_TEXT: &str = "In a deck that is run by itself the line defines the variables that are not there yet with their first values, and says so. `perigrain sweep` makes \
    all runs; lists on its command line take the place of those in the deck, and `-report` adds to what the deck reports. `perigrain check` \
    checks all combinations, of more than 64 the first and the last.\n\n\
    ```text\n\
    perigrain sweep DECK [-each NAME VALUE …] [-zip NAME NAME …] [-table FILE] [-report WORD …]\n\
    \u{20}                    [-jobs N] [-threads N] [-out DIR] [-retry N] [-anew] [switch …]\n\
    perigrain sweep DIR -status\n\
    ```\n\n\
    - `-jobs N`: so many runs at once, on ranks on each of them (one per core); `-threads N`: threads of each (the cores shared out);\n\
    - `-out DIR`: the folder (`DECK.sweep`), with a folder for each run, `table.csv`, `times.csv` and the journal;\n\
    - `-retry N`: a run that fails is tried N times more;\n\
    - `-anew`: discards an earlier sweep there; without it the same command continues where the earlier one ended;\n\
    - `-status`: only shows where a sweep stands;\n\
    - `-var`, `-compat`, `-screen none` and others hold for all runs.\n\n\
    `mpirun -n N perigrain sweep …` and `-ranks N` share the runs out to ranks, on one machine or several; all else is the same. [Make many runs of one deck](../howto/sweep.md) shows it. Exit codes: 0 all runs are done and well, 1 a run failed or the sweep is refused, 2 the \
    command line is wrong, 130 interrupted: the same command continues.";

pub(super) const SUFFIX: Entry = (
    "suffix",
    Doc {
        syntax: Syntax::Behind(Suffix::GRAMMAR),
        summary: "Taken for LAMMPS' decks, without effect.",
        text: "LAMMPS chooses variants of styles with it. Here kernels are chosen by what the scene and the processor \
            offer; a note in the log says once that the line does nothing.",
        example: "suffix omp",
    },
);

pub(super) const PACKAGE: Entry = (
    "package",
    Doc {
        syntax: Syntax::Behind(Package::GRAMMAR),
        summary: "Taken for LAMMPS' decks, without effect.",
        text: "A note in the log says so once. Threads are set by `-threads N` (or `-pk omp N`) on the command line.",
        example: "package omp 4",
    },
);

pub(super) const COMM_STYLE: Entry = (
    "comm_style",
    Doc {
        syntax: Syntax::Behind(CommStyle::GRAMMAR),
        summary: "Taken for LAMMPS' decks, without effect.",
        text: "The box is not divided among processes; a note in the log says once that the line does nothing.",
        example: "comm_style tiled",
    },
);

pub(super) const BALANCE: Entry = (
    "balance",
    Doc {
        syntax: Syntax::Written(
            "balance thresh x|y|z uniform|cut … | shift dims N stop | rcb [weight style word …] [out FILE]",
        ),
        summary: "Taken for LAMMPS' decks, without effect.",
        text: "LAMMPS moves the borders between its processes; here threads share the work by themselves. The line is read \
            whole, and a note in the log says once that it does nothing.",
        example: "balance 1.1 shift xyz 10 1.05",
    },
);

pub(super) const WRITE_DUMP: Entry = (
    "write_dump",
    Doc {
        syntax: Syntax::Behind(&heads::WRITE_DUMP),
        summary: "Writes one snapshot now.",
        text: "Style, attributes and the options after `modify` are those of `dump` and `dump_modify`; the file needs no \
            `*`. Values of computes and variables are computed for the present state; energies per particle need a `run 0` \
            before.",
        example: "write_dump all custom now.dump id type x y z c_dmg modify sort -1 format float %.6g\n\
            write_dump plate image now.png c_dmg auto modify range 0 1",
    },
);

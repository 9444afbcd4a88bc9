//! The page about the program: its subcommands, switches and exit codes.

use super::Entry;
use perigrain_styles::Doc;
use perigrain_styles::words::Syntax;

pub(super) const PERIGRAIN: Entry = (
    "perigrain",
    Doc {
        syntax: Syntax::Written(
            "perigrain DECK [switch …]\n\
            perigrain [switch …] < DECK\n\
            perigrain plan|run DECK [switch …]\n\
            perigrain check DECK … [--json] [switch …]\n\
            perigrain fmt [--check|--diff] FILE|- …\n\
            perigrain translate IN [-o OUT] [-to perigrain|lammps]\n\
            perigrain lsp\n\
            perigrain sweep DECK -each NAME VALUE … [switch …]\n\
            perigrain bench DECK -each NAME VALUE … -measure WORD … [switch …]\n\
            perigrain repl [DECK] [switch …]\n\
            perigrain verify [-only PATTERN] [-html FILE] …\n\
            perigrain report LOG DUMP … -o FILE\n\
            perigrain new FILE [--kind crack|pour|bonded]\n\
            perigrain examples [list|show NAME|copy NAME [FOLDER]]\n\
            perigrain completions bash|zsh|fish|elvish|powershell\n\
            perigrain man [FOLDER]\n\
            perigrain doc [name]\n\
            perigrain explain CODE",
        ),
        summary: "The program: how it is called, its switches and exit codes.",
        text: TEXT,
        example: "perigrain in.plate -var v 70 -log plate.log\n\
            perigrain check in.plate\n\
            perigrain check --json in.plate\n\
            perigrain fmt --diff in.plate\n\
            perigrain translate in.grains -o in.native\n\
            perigrain plan in.plate --measure\n\
            perigrain plan --dot in.plate\n\
            perigrain -in in.plate -screen none -threads 2 -compat lammps\n\
            perigrain verify -only pull_off -html pull_off.html\n\
            perigrain report log.lammps dump.grains -o grains.html\n\
            perigrain new in.mine --kind pour\n\
            perigrain examples copy brittle_glass\n\
            perigrain doc fix nve\n\
            perigrain doc wall\n\
            perigrain explain PG0102",
    },
);

const TEXT: &str = "`perigrain DECK` (or `perigrain run DECK`) runs a deck. The other forms:\n\n\
    - `check` reads a deck, changes and writes nothing, and reports every problem of one or more decks at once, with \
    `--json` as JSON.\n\
    - `fmt` lays decks out anew: one blank between words, columns and comments below each other where they were, \
    continuations four blanks in, no blanks at the ends of lines and one empty line at most; words, quoted texts, `$(…)` and \
    line endings stay as they are, and a deck that cannot be read is refused. `--check` writes nothing and fails where a \
    deck would change, `--diff` shows the lines; `fmt -` reads standard input and writes to standard output.\n\
    - `translate` writes a deck of LIGGGHTS as a native one: see [liggghts](liggghts.md).\n\
    - `lsp` answers an editor while decks are written: see [In your editor](../editor/README.md).\n\
    - `plan` prints what each step of the deck's runs will do, in which order, and what was left out and why: each plan \
    once, with the lines whose runs have it and how often. It makes the particles that the first run begins with, so that \
    large scenes take their time, and no step; behind that run nothing is known of particles, and lines that depend on them \
    are listed at the end. Exit code 1 means that the deck is refused.\n\
    - `plan --measure` runs the deck and adds time and bytes of each part, with `-ranks N` also which rows of particles each \
    part needs in a quiet step and what ranks send for it; `plan --dot` prints the command graph for graphviz.\n\
    - `sweep` makes many runs of a deck side by side: see [sweep](sweep.md).\n\
    - `bench` weighs wall time against error over time steps, spacings and other knobs: see [bench](bench.md).\n\
    - `repl`, and `perigrain` alone on a terminal, execute lines as they are typed: see [the prompt](prompt.md).\n\
    - `verify` runs published cases that the program carries and says whether this build on this machine gives their \
    numbers: see [verify](verify.md).\n\
    - `report` writes a web page about a run that is over, from its log and dumps: see [Look at a run](../howto/report.md).\n\
    - `new` writes a small deck that runs as it stands and says in its lines what to change; `examples` lists the larger \
    ones that the program carries, shows what they are about, or copies one into a folder of its own. Neither overwrites a \
    file.\n\
    - `doc` (or `help`) prints a page of this manual, or a how-to (`perigrain help notch`); of a word that has no page it \
    lists pages and how-tos that speak of it; on a terminal pages are wrapped at words and go through `$PAGER` (`less`).\n\
    - `explain` prints the story behind the code of a message.\n\
    - `completions` prints what a shell needs to complete these lines (`source <(perigrain completions bash)`), `man` writes \
    pages for `man`.\n\n\
    Switches, before or behind the deck, with one dash or two:\n\n\
    - `-in FILE`, `-i`: the deck; without a deck or with `none` it is read from standard input;\n\
    - `-log FILE|none`, `-l`: the log file (`log.lammps`);\n\
    - `-screen FILE|none|full`, `-sc`: where the screen's text goes; `full` shows on a terminal all that the log has;\n\
    - `-echo none|screen|log|both`, `-e`: where each line of the deck is repeated (`log`);\n\
    - `-var NAME value …`, `-v`: defines an index variable; the deck's own `variable NAME index …` then does nothing. It \
    takes all words up to the next switch, so put the deck first or write `-in`;\n\
    - `-threads N`: uses at most N threads (without it as many as `OMP_NUM_THREADS` says, else one per core); runs find out by themselves whether one is faster; results are the same bits for any N;\n\
    - `-timeout TIME`: ends runs TIME (seconds, MM:SS or H:MM:SS) after the program began, at a whole step, with a last restart file, `DECK.STEP.restart` unless the deck has \
    `restart`; further runs are left out, the other lines are executed. What is still at work a tenth of TIME later (two seconds at least, a minute at most), and lines that follow then, \
    end with the error PG0209. A `timer timeout` in the deck has the last word, and ends runs alone;\n\
    - `-report FILE`: writes what the run was as one web page, see [Look at a run](../howto/report.md); the file is opened before the run begins;\n\
    - `-view [PORT]`: shows the run in a browser on this machine while it runs, at the address that it prints; with pause, step and stop;\n\
    - `-compat lammps[/2025|/2026]`: LAMMPS' numbers also where LAMMPS is wrong, see [Coming from LAMMPS](../coming-from-lammps.md), and of which version (without one the newest, 2026; `lammps/2025` is LAMMPS 22Jul2025);\n\
    - `-compat liggghts`: the deck has the words of [LIGGGHTS](liggghts.md), from its first line on;\n\
    - `-ranks N`: N processes of this machine run the deck together, as `mpirun -n N perigrain -in DECK` does with any MPI on one machine or several (`perigrain ranks` says which library \
    connects them, and how fast); results are the same bits for any N, files are written by the first rank. `sweep`, `bench` and `-partition` share their runs out to ranks instead;\n\
    - `-partition MxN …`, `-p`: runs the deck M times beside each other, each time with N threads, as LAMMPS' partitions (`4x1 2x8` are six); under `mpirun` or with `-ranks` each rank has some of them; `-plog FILE|none`, \
    `-pl`, and `-pscreen FILE|none`, `-ps`: their logs and screens (`log.lammps.0` …, `screen.0` …);\n\
    - `-safe`: keeps the deck in its own folder, without `shell` and environment and with limits to all it uses, for [decks of \
    others](../safe.md); `-limit memory|steps|lines|files|pixels N` is the same with another limit (memory in MB);\n\
    - `-suffix omp`, `-sf` and `-nocite`, `-nc`: taken for LAMMPS' command lines, without effect;\n\
    - `-package omp N`, `-pk`: the same as `-threads N`;\n\
    - `-help`, `-h`: prints switches and subcommands and ends; `-version`, `--version`, `-V`: prints version, commit (in release builds), target \
    and the vector instructions that kernels use here, and ends.\n\n\
    LAMMPS' other switches are refused by name.\n\n\
    Exit codes: 0 all well (or the status of `quit`), 1 the deck was refused or its run failed, 2 the command line is wrong, \
    130 ended by Ctrl-C or a signal.\n\n\
    The first Ctrl-C ends a run at a whole step with all files complete and a last file of `restart`, and any other line \
    that takes long within half a second, as not done. So do SIGTERM, as queues send it, SIGHUP of a closed terminal, unless \
    `nohup` has it ignored, and SIGXCPU behind `ulimit -t`. A second one (a second later, if it is no Ctrl-C) ends the \
    program at once. With `-partition` it reaches all of them. A file that outgrows `ulimit -f` is an error, as on a full \
    disk.\n\n\
    On a terminal the output is short: a line for each command that makes something, how much memory the particles are about \
    to take, the step table as far as whole columns fit, and behind a run three lines: time and speed; where results are; \
    what would make it faster. LAMMPS' blocks stand in the log, in pipes and with `-screen full`. Messages have colours \
    unless `NO_COLOR` is set.\n\n\
    A live line shows how many steps of all the deck's runs are made (of the present run where only a run determines it), \
    speed and time left as estimated from the runs so far, step, time and thermo columns; there is none where standard error \
    is no terminal, or `TERM` is `dumb`.";

#[cfg(test)]
mod tests {
    use super::TEXT;
    use crate::cli::args::SWITCHES;

    #[test]
    fn every_switch_is_on_the_page() {
        for switch in SWITCHES.iter().filter(|s| !s.about.is_empty()) {
            assert!(TEXT.contains(switch.names[0]), "{}", switch.names[0]);
        }
    }
}

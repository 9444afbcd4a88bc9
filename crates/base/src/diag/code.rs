//! The table of stable diagnostic codes, one per kind of mistake, each with an explanation and a wrong and a
//! corrected line.

/// A kind of mistake, such as `PG0101`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Code(pub u16);

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "PG{:04}", self.0)
    }
}

/// Documentation of a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// The code.
    pub code: Code,
    /// Short title.
    pub title: &'static str,
    /// Explanation and remedy.
    pub text: &'static str,
    /// Lines that trigger it, in the small scene of `tests/scripts/scene.in` unless they begin with `units`.
    pub wrong: &'static str,
    /// The corrected lines.
    pub right: &'static str,
}

impl Code {
    /// The code for an undefined name of some kind.
    pub fn unknown(kind: &str) -> Self {
        match kind {
            "group" => Self::UNKNOWN_GROUP,
            "region" => Self::UNKNOWN_REGION,
            "variable" => Self::UNKNOWN_VARIABLE,
            "compute" => Self::UNKNOWN_COMPUTE,
            "fix" => Self::UNKNOWN_FIX,
            _ => Self::UNKNOWN_NAME,
        }
    }

    /// Whether it is about an undefined name.
    pub fn is_unknown_name(self) -> bool {
        self == Self::UNKNOWN_NAME || (Self::UNKNOWN_GROUP..=Self::UNKNOWN_WORD).contains(&self)
    }
}

macro_rules! codes {
    ($($name:ident = $n:literal, $title:literal, $text:literal, $wrong:literal, $right:literal;)*) => {
        impl Code { $(#[doc = $title] pub const $name: Code = Code($n);)* }
        /// Every kind of mistake, by number.
        pub const CODES: &[Kind] =
            &[$(Kind { code: Code($n), title: $title, text: $text, wrong: $wrong, right: $right }),*];
    };
}

codes! {
    SYNTAX = 101, "the text cannot be read",
        "A brace or a parenthesis is not closed, a name is missing after `$`, or a closing quote is glued to the next word. The place that could not be read is underlined.",
        "print \"a\"b", "print \"a\" screen yes";
    UNKNOWN_COMMAND = 102, "unknown command",
        "The first word of the line is no command of perigrain. If it is a LAMMPS command that perigrain does not have yet, the message names it as one.",
        "pair_sytle none", "pair_style none";
    UNKNOWN_STYLE = 103, "unknown style",
        "The command exists, the style named in it does not. The message offers the nearest known style; `perigrain help` lists all.",
        "fix 2 all nve/spher", "fix 2 all nve";
    UNKNOWN_KEYWORD = 104, "unknown keyword",
        "The word is not an option of this command or style. Its page lists them.",
        "set group all diametre 1", "set group all volume 1e-9";
    MISSING_ARGUMENT = 105, "missing argument",
        "The line ends before everything the command needs. The message names what comes next; at the prompt it stands behind the cursor.",
        "velocity all set 1 0", "velocity all set 1 0 0";
    EXTRA_ARGUMENT = 106, "unexpected argument",
        "The line has more words than the command understands; nothing is silently ignored.",
        "timestep 1e-8 s", "timestep 1e-8";
    BAD_NUMBER = 107, "not a number",
        "A number was expected here. A letter O for a zero, a comma for a point and a unit behind the number are the usual reasons.",
        "timestep 1,0e-8", "timestep 1.0e-8";
    BAD_VALUE = 108, "value out of range",
        "The value can be read but makes no sense here: a negative radius, an empty range, a type that does not exist.",
        "run -100", "run 100";
    UNKNOWN_NAME = 109, "unknown name",
        "A dump, column, colour or other thing of this name has not been defined (yet).",
        "undump picture", "dump picture all atom 1 p.dump\nundump picture";
    DUPLICATE_NAME = 110, "name already taken",
        "IDs of the same kind must differ. The second label shows where the name was given first.",
        "compute d all damage/atom\ncompute d all ke", "compute d all damage/atom\ncompute e all ke";
    WRONG_ORDER = 111, "too early or too late",
        "The command needs something that comes first (a box, an atom style, a pair style), or must come before something that has already happened.",
        "units si\ncreate_atoms 1 single 0 0 0", "units si\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\ncreate_atoms 1 single 0 0 0";
    NOT_SUPPORTED = 112, "not in perigrain",
        "LAMMPS has this; perigrain does not (yet). It is refused rather than ignored.",
        "kspace_style pppm 1e-4", "pair_style none";
    WRONG_KIND = 113, "wrong kind of value",
        "A per-atom quantity where one number is needed, a scalar with an index, and the like. `compute reduce` makes one number of many.",
        "compute d all damage/atom\nthermo_style custom step c_d", "compute d all damage/atom\ncompute m all reduce max c_d\nthermo_style custom step c_m";
    INCOMPLETE = 114, "scene incomplete",
        "A run needs something that was never given: coefficients for all pairs of types, masses, volumes.",
        "pair_style peri/lps\nrun 1", "pair_style peri/pmb\npair_coeff * * 2e21 0.0030001 0.004 0\nrun 1";
    CONFLICT = 115, "declarations contradict each other",
        "Two statements of the deck cannot both hold. The second label shows the other one where there is one.",
        "fix_modify 1 energy yes", "fix 2 all indent 1e9 sphere 0 0 0.1 0.01\nfix_modify 2 energy yes";
    NO_EFFECT = 116, "without effect",
        "The line is accepted for the sake of LAMMPS decks but changes nothing here.",
        "processors 1 1 *", "";
    SUSPICIOUS = 117, "runs, but probably not as meant",
        "LAMMPS would run this too; a second look is worth it.",
        "pair_coeff * * 2e21 0.0005 0.004 0", "pair_coeff * * 2e21 0.0030001 0.004 0";
    NO_FILE = 118, "file cannot be opened",
        "The file does not exist or may not be read or written. Relative names refer to the folder the program was started in.",
        "include in.no_such_file", "";
    UNUSED = 119, "never used",
        "A variable or group is defined and no line of the deck names it again. Often the name was mistyped where it was meant.",
        "variable depth equal 1", "variable depth equal 1\nprint \"${depth}\"";
    UNREACHABLE = 120, "never reached",
        "A `quit` that is always carried out stands before this line.",
        "quit\nrun 100", "run 100\nquit";
    UNSTABLE = 121, "time step too long",
        "The step is longer than the stiffest bonds allow, √(ρ/(π c δ²)) for a peridynamic body of density ρ, micro-modulus c and horizon δ: the shortest waves would grow from step to step until numbers are out of control.",
        "timestep 1e-6\nrun 10", "timestep 1e-7\nrun 10";
    HORIZON = 122, "horizon on a shell of neighbours",
        "The horizon equals a distance between lattice sites to the last digits, so that rounding decides which neighbours at that distance have bonds. A horizon a little larger, 3.015 spacings instead of 3, is what the literature uses.",
        "pair_coeff * * 2e21 0.003 0.004 0", "pair_coeff * * 2e21 0.003015 0.004 0";
    UNKNOWN_GROUP = 123, "unknown group",
        "No `group` line before this one defines the name. Groups are `all` and what the deck has named.",
        "velocity iner set 1 0 0", "group inner id 1:10\nvelocity inner set 1 0 0";
    UNKNOWN_REGION = 124, "unknown region",
        "No `region` line before this one defines the name.",
        "group left region lefft", "region left block 0 1 INF INF INF INF\ngroup left region left\nvelocity left set 1 0 0";
    UNKNOWN_VARIABLE = 125, "unknown variable",
        "No `variable` line before this one, and no `-var` on the command line, defines the name. Names of more than one letter need braces: `${name}`.",
        "timestep ${step}", "variable step equal 1e-8\ntimestep ${step}";
    UNKNOWN_COMPUTE = 126, "unknown compute",
        "No `compute` line before this one defines the ID.",
        "thermo_style custom step c_dmg", "compute dmg all reduce max x\nthermo_style custom step c_dmg";
    UNKNOWN_FIX = 127, "unknown fix",
        "No `fix` line before this one defines the ID, or `unfix` has removed it.",
        "unfix 7", "unfix 1";
    UNKNOWN_MATERIAL = 128, "unknown material",
        "No `material` line before this one defines the ID.",
        "pair_style peri/pmb\npair_coeff * * material glas horizon 3.015", "material glass file soda-lime-glass.toml\npair_style peri/pmb\npair_coeff * * material glass horizon 3.015";
    UNKNOWN_LABEL = 129, "unknown label",
        "`jump` looks for a `label` of this name from the top of the file to its end, and there is none.",
        "jump SELF agian", "jump SELF again\nlabel again";
    UNKNOWN_WORD = 130, "unknown word in a formula",
        "A formula knows numbers, thermo keywords, attributes of particles, functions and constants; variables are written v_name, computes c_ID, fixes f_ID.",
        "print $(sqr(2))", "print $(sqrt(2))";
    NO_FORCES = 131, "particles do not feel each other",
        "There is a run but no pair_style. That is right for free flight only.",
        "pair_style none\nrun 1", "run 1";
    NO_MOTION = 132, "nothing moves",
        "There is a run of some steps and no fix that integrates the motion of any particle.",
        "unfix 1\nrun 1", "run 1";
    MOVED_TWICE = 133, "particles are moved twice",
        "Two fixes integrate the motion of the same particles, which then move twice as far in every step.",
        "fix 2 all nve\nrun 1", "run 1";
    NEVER_SET = 134, "a property was never set",
        "The pair style uses a property of particles that keeps the value it has by default, because no line has set it.",
        "units si\natom_style peri\nlattice sc 0.001\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 box\nset group all density 2500\npair_style peri/pmb\npair_coeff * * 2e21 0.0030001 0.004 0\nfix 1 all nve\nrun 1",
        "run 1";
    UNITS_OF_FORCE = 135, "forces and force densities meet",
        "Peridynamic coefficients given as numbers mean force densities, granular ones forces; in one scene momentum is then not conserved. `peri_modify force newton` makes all of them forces.",
        "", "";
    OPEN_QUOTE = 136, "a quote is not closed",
        "A quoted text ends with the line unless `&` stands at its end; only text in `\"\"\"` may continue over lines.",
        "print \"never closed", "print \"closed\"";
    FORMULA = 137, "the formula cannot be read",
        "Something is missing or too much in a formula or condition: an operand, a parenthesis, a comma. The place is underlined.",
        "print $(2*)", "print $(2*3)";
    FORMAT = 138, "no format for a number",
        "A C format for one number is wanted: `%g`, `%.3f`, `%12.5e` and the like.",
        "print $(1/3:%d%d)", "print $(1/3:%.3f)";
    BAD_FILE = 139, "file damaged or of another kind",
        "The file is not of the kind that its place in the deck requires: a restart file that is cut off, damaged, of another program or of a newer version.",
        "print \"no scene\" file old.restart\nclear\nread_restart old.restart", "write_restart old.restart\nclear\nread_restart old.restart";
    OTHER_SWEEP = 147, "the sweep in this folder is another",
        "The journal in the folder of a sweep is of another deck, other runs or another version of perigrain, a file that runs have read has changed since, or another sweep is at work there. Results of both in one table would be of no use. `-anew` discards the earlier runs, `-out DIR` puts the new ones elsewhere.",
        "", "";
    NO_COUNTERPART = 148, "a word of LIGGGHTS without counterpart",
        "The deck is one of LIGGGHTS, and perigrain has nothing that does what this word does. The help names what comes nearest. `Coming from LIGGGHTS` lists what is read.",
        "units si\natom_style granular\nfix cfd all couple/cfd couple_every 100 mpi", "units si\natom_style granular";
    LETTERS = 149, "a character that looks like another",
        "Web pages and word processors put in blanks that are none (U+00A0, U+200B and others), byte order marks, curly quotes and minus signs that are no ASCII. They are read as what they look like, as LAMMPS does, outside of comments; quotes and signs also outside of quoted texts. Type them anew where they are not meant.",
        "print\u{a0}\"x\"", "print \"x\"";
    LONG_LOOP = 150, "the end of a loop is not in sight",
        "Where a deck is only looked at (`check`, `plan`), a loop is followed for 10,000 turns, and none any further once 50,000 lines or ten seconds are spent. What variables have behind it counts as unknown. A run follows it to its end.",
        "", "";
    LOST = 201, "particles lost",
        "A particle left a box with fixed faces. Enlarge the box, use boundary s or m, or shorten the time step.",
        "units si\natom_style sphere\nboundary f f f\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\ncreate_atoms 1 single 0.5 0.5 0.5\nvelocity all set 1 0 0\nfix 1 all nve\ntimestep 0.01\nrun 100",
        "units si\natom_style sphere\nboundary s s s\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\ncreate_atoms 1 single 0.5 0.5 0.5\nvelocity all set 1 0 0\nfix 1 all nve\ntimestep 0.01\nrun 100";
    NOT_FINITE = 202, "numbers out of control",
        "A position, velocity or force is no longer finite: the time step is too long for the stiffness, or particles overlap heavily.",
"velocity all set 1e10 0 0\ntimestep 1e300\nrun 3", "velocity all set 1 0 0\ntimestep 1e-8\nrun 3";
    TOO_LARGE = 203, "memory does not suffice",
        "A count in a deck or a file, or the size of a packed file, needs more memory than is free: on the machine, under the limits of the process (`ulimit -v`) or of its container, or by `-limit memory`. It is forecast where a forecast can be made, and refused before it is allocated.",
        "units si\natom_style sphere\nlattice sc 1e-6\nregion b block 0 1 0 1 0 1 units box\ncreate_box 1 b\ncreate_atoms 1 box", "units si\natom_style sphere\nlattice sc 0.1\nregion b block 0 1 0 1 0 1 units box\ncreate_box 1 b\ncreate_atoms 1 box";
    RUNAWAY = 206, "energy out of control",
        "Particles move ten times as fast as waves with more than a million times the energy that the run began with, or no fix does work and there is a million times as much energy all the same: it was made from nothing, by a time step that is too long or by particles that overlap heavily. `thermo_modify energy ignore` lets such a run continue; under `compat lammps` it is a warning.",
        "", "";
    NOT_ALLOWED = 207, "not allowed by -safe",
        "The program was started with `-safe`, which keeps a deck in its own folder: no `shell`, no environment, no file outside, and so much memory, so many steps, lines, files and pixels. `Untrusted decks` in the manual lists the limits, and how to allow more.",
        "", "";
    OUTSIDE = 208, "the hosting program failed",
        "A `fix external pf/callback` calls the program that hosts the run for forces: that program has set no function, or the function ended in an exception. In a terminal no program hosts the run; in Python `lmp.set_fix_external_callback` sets the function.",
        "fix 2 all external pf/callback 1 1\nrun 1", "fix 2 all external pf/array 1\nrun 1";
    INTERRUPTED = 209, "ended before it was done",
        "A signal (Ctrl-C, SIGTERM) or the limit of `-timeout` came while a line was executed that takes long. The line is given up and no further one is executed; at the prompt the scene is as before the line. A run ends at a whole step instead, with a restart file where the deck has `restart`. `-timeout` gives lines behind its limit a tenth of it, two seconds at least and a minute at most.",
        "", "";
    HALTED = 205, "halted",
        "A `fix halt … error hard` found its condition met: the deck ends here, as the line requests. With `error soft` the run ends and the deck continues.",
        "variable late equal step\nfix 2 all halt 1 v_late > 5 error hard\nrun 10", "variable late equal step\nfix 2 all halt 1 v_late > 5 error soft\nrun 10";
    COMPAT = 301, "LAMMPS does otherwise",
        "A place where LAMMPS is wrong (22Jul2025, in part mended in 2026) and perigrain is not, unless `-compat lammps` is on. `Coming from LAMMPS` lists all of them.",
        "", "";
    DIALECT = 305, "read as LIGGGHTS means it",
        "The first word that only LIGGGHTS has makes the rest of the deck one of LIGGGHTS, as `-compat liggghts` does; `compat none` above it forbids that. Other notes with this code name words that have no effect here, and numbers that were made whole. `perigrain translate` writes the native lines.",
        "", "";
    MATERIAL = 302, "material questionable",
        "The material data contradict the model, as nu other than 1/4 with bond-based peridynamics. Where `form` selects the modulus that bonds keep, this is a note, else a warning.",
        "material m E 7e10 nu 0.3 rho 2500\npair_style peri/pmb\npair_coeff * * material m horizon 3.015", "material m E 7e10 nu 0.25 rho 2500\npair_style peri/pmb\npair_coeff * * material m horizon 3.015";
}

//! The table of stable diagnostic codes, one per kind of mistake, each with an explanation.

/// The kind of a mistake, as `PG0101`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Code(pub u16);

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "PG{:04}", self.0)
    }
}

macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $n:literal, $title:literal, $text:literal;)*) => {
        impl Code { $($(#[$doc])* #[doc = $title] pub const $name: Code = Code($n);)* }
        /// Code, short title and explanation of every kind of mistake.
        pub const CODES: &[(Code, &str, &str)] = &[$((Code($n), $title, $text)),*];
    };
}

codes! {
    SYNTAX = 101, "the text cannot be read", "A quote, brace or parenthesis is not closed, or a formula breaks off. The word that could not be read is underlined.";
    UNKNOWN_COMMAND = 102, "unknown command", "The first word of the line is no command of perigrain. If it is a LAMMPS command that perigrain does not have yet, the message says so by name.";
    UNKNOWN_STYLE = 103, "unknown style", "The command exists, the style named in it does not. The message lists the nearest known style.";
    UNKNOWN_KEYWORD = 104, "unknown keyword", "The word is not an option of this command or style.";
    MISSING_ARGUMENT = 105, "missing argument", "The line ends before everything the command needs was said.";
    EXTRA_ARGUMENT = 106, "unexpected argument", "The line says more than the command understands; nothing is silently ignored.";
    BAD_NUMBER = 107, "not a number", "A number was expected here.";
    BAD_VALUE = 108, "value out of range", "The value can be read but makes no sense here: a negative radius, an empty range, a NaN.";
    UNKNOWN_NAME = 109, "unknown name", "A group, region, variable, compute, fix, dump, material or file of this name has not been defined (yet).";
    DUPLICATE_NAME = 110, "name already taken", "IDs of the same kind must differ.";
    WRONG_ORDER = 111, "too early or too late", "The command needs something that comes first (a box, an atom style, coefficients), or must come before something that has already happened.";
    NOT_SUPPORTED = 112, "not in perigrain", "LAMMPS has this; perigrain does not (yet). It is refused rather than ignored.";
    WRONG_KIND = 113, "wrong kind of value", "A per-atom quantity where one number is needed, a scalar with an index, and the like.";
    INCOMPLETE = 114, "scene incomplete", "A run needs something that was never set: a pair style, all coefficients, masses, volumes.";
    CONFLICT = 115, "declarations contradict each other", "Two statements of the deck cannot both hold.";
    NO_EFFECT = 116, "without effect", "The line is accepted for the sake of LAMMPS decks but changes nothing here.";
    SUSPICIOUS = 117, "runs, but probably not as meant", "LAMMPS would run this too; a second look is worth it.";
    NO_FILE = 118, "file cannot be opened", "The file does not exist or may not be read or written.";
    UNUSED = 119, "never used", "A variable or group is defined and no line of the deck names it again. Often a name was mistyped where it was meant.";
    UNREACHABLE = 120, "never reached", "A `quit` that is always carried out stands before this line.";
    UNSTABLE = 121, "time step too long", "The step is longer than the stiffest bonds allow: the shortest waves would grow from step to step until numbers are out of control.";
    HORIZON = 122, "horizon on a shell of neighbours", "The horizon equals a distance between lattice sites to the last digits, so that rounding decides which neighbours at that distance have bonds. A horizon a little larger, 3.015 spacings instead of 3, is what the literature uses.";
    LOST = 201, "particles lost", "A particle left a box with fixed faces. Enlarge the box, use boundary s or m, or shorten the time step.";
    NOT_FINITE = 202, "numbers out of control", "A position, velocity or force is no longer finite: the time step is too long for the stiffness, or particles overlap heavily.";
    TOO_LARGE = 203, "scene does not fit", "The forecast says that memory will not suffice.";
    INTERRUPTED = 204, "interrupted", "The run was ended from outside at a whole step; files are complete.";
    HALTED = 205, "halted", "A `fix halt … error hard` found its condition met: the deck ends here, as it asked for.";
    COMPAT = 301, "LAMMPS does otherwise", "A place where LAMMPS 22Jul2025 is wrong and perigrain is not, unless `-compat lammps` is on.";
    MATERIAL = 302, "material questionable", "The material data contradict the model, as nu other than 1/4 with bond-based peridynamics.";
}

//! Manual pages of what no table of styles holds: the language, the session, the declarations, the program itself.

mod bench;
mod declarations;
mod formulas;
mod language;
mod liggghts;
mod program;
mod prompt;
mod restart;
mod session;
mod thermo;
mod verify;

use perigrain_styles::Doc;

/// A page's name and text.
pub type Entry = (&'static str, Doc);

/// What is no command: how decks are written, what formulas know, how the program is called.
pub const TOPICS: &[Entry] = &[
    program::PERIGRAIN,
    prompt::PROMPT,
    verify::VERIFY,
    bench::BENCH,
    liggghts::LIGGGHTS,
    language::DECKS,
    formulas::FORMULAS,
];

/// Commands that act by themselves, in the order of the manual.
pub const COMMANDS: &[Entry] = &[
    language::VARIABLE,
    language::IF,
    language::LABEL,
    language::JUMP,
    language::NEXT,
    language::INCLUDE,
    language::QUIT,
    declarations::PAIR_STYLE,
    declarations::PAIR_COEFF,
    declarations::PAIR_MODIFY,
    declarations::BOND_STYLE,
    declarations::BOND_COEFF,
    declarations::PERI_MODIFY,
    declarations::FIX,
    declarations::FIX_MODIFY,
    declarations::UNFIX,
    declarations::COMPUTE,
    declarations::COMPUTE_MODIFY,
    declarations::UNCOMPUTE,
    declarations::DUMP,
    declarations::DUMP_MODIFY,
    declarations::UNDUMP,
    session::WRITE_DUMP,
    restart::RESTART,
    restart::WRITE_RESTART,
    restart::READ_RESTART,
    restart::RERUN,
    thermo::THERMO,
    thermo::THERMO_STYLE,
    thermo::THERMO_MODIFY,
    session::RUN,
    session::MINIMIZE,
    session::STATICS,
    session::FATIGUE,
    session::PRINT,
    session::LOG,
    session::ECHO,
    session::CLEAR,
    session::COMPAT,
    session::SHELL,
    session::INFO,
    session::TIMER,
    session::PARTITION,
    session::SWEEP,
    session::SUFFIX,
    session::PACKAGE,
    session::COMM_STYLE,
    session::BALANCE,
];

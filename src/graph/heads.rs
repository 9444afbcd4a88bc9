//! The words of the lines that declare, up to those that belong to a style.

use super::declaration::id_of;
use perigrain_base::diag::Result;
use perigrain_fixes::Counted;
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::compute::TemperatureOption;
use perigrain_styles::words::{At, Each, Grammar, Keyword, Kind, Or, Part, Types, Words};
use perigrain_world::GroupId;

/// What a style reads itself.
const OF_STYLE: Part = Part::Many(&[Part::bare("word", Kind::Text)], 0);

/// The file of a dump, which its style reads.
const FILE: Part = Part::bare("FILE", Kind::File);

/// No style.
#[derive(Words)]
#[word(what = "style")]
pub enum NoStyle {
    /// There are no such forces.
    None,
}

/// The words of `pair_style` before those of the style.
#[derive(Words)]
pub struct PairStyle {
    #[word(name = "STYLE", what = "a pair style", kind = Kind::Or(&NoStyle::KIND, &Kind::Style("pair_style")))]
    pub(super) style: Or<NoStyle, Word>,
}

/// The words of `pair_coeff` before those of the style.
#[derive(Words)]
pub struct PairCoeff {
    /// Types or ranges of types: `2`, `*`, `2*`, `*4`, `2*4`; only pairs with I ≤ J count.
    #[word(name = "I")]
    pub(super) first: Types,
    /// Types or ranges of types: `2`, `*`, `2*`, `*4`, `2*4`; only pairs with I ≤ J count.
    #[word(name = "J")]
    pub(super) second: Types,
}

/// The words of `bond_style` before those of the style.
#[derive(Words)]
pub struct BondStyle {
    #[word(name = "STYLE", what = "a bond style", kind = Kind::Or(&NoStyle::KIND, &Kind::Style("bond_style")))]
    pub(super) style: Or<NoStyle, Word>,
}

/// The words of `bond_coeff` before those of the style.
#[derive(Words)]
pub struct BondCoeff {
    /// A bond type or a range: `2`, `*`, `2*`, `*4`, `2*4`.
    #[word(name = "T", with = bond_types, kind = Kind::Types)]
    pub(super) types: Types,
}

fn bond_types(args: &mut Args, cx: &BuildCx) -> Result<Types> {
    args.type_range(cx.world.bonds.types).map(|(first, last)| Types(first, last))
}

/// The words of `fix` before those of the style.
#[derive(Words)]
pub struct Fix {
    /// Its name: letters, digits and underscores.
    #[word(name = "ID", with = fix_id, kind = Kind::Text)]
    pub(super) id: Word,
    /// The particles that it concerns.
    #[word(name = "group", what = "the fix's group")]
    pub(super) group: At<GroupId>,
    #[word(name = "STYLE", what = "a fix style", kind = Kind::Style("fix"))]
    pub(super) style: Word,
}

/// The words of `compute` before those of the style.
#[derive(Words)]
pub struct Compute {
    /// Its name: letters, digits and underscores.
    #[word(name = "ID", with = compute_id, kind = Kind::Text)]
    pub(super) id: Word,
    /// The particles that it concerns.
    #[word(name = "group", what = "the compute's group")]
    pub(super) group: At<GroupId>,
    #[word(name = "STYLE", what = "a compute style", kind = Kind::Style("compute"))]
    pub(super) style: Word,
}

/// The words of `dump` before those of the style.
#[derive(Words)]
pub struct Dump {
    /// Its name.
    #[word(name = "ID", what = "the dump's ID")]
    pub(super) id: Word,
    /// The particles that it writes.
    #[word(name = "group", what = "the dump's group")]
    pub(super) group: At<GroupId>,
    #[word(name = "STYLE", what = "a dump style", kind = Kind::Style("dump"))]
    pub(super) style: Word,
    /// Snapshots are written at steps that are multiples of it, the first step of a run among them.
    #[word(name = "N", what = "the dump's interval", from = 1)]
    pub(super) every: i64,
}

/// The words of `write_dump` before those of the style.
#[derive(Words)]
pub struct WriteDump {
    /// The particles to write.
    #[word(name = "group", what = "the group to write")]
    pub(super) group: At<GroupId>,
    #[word(name = "STYLE", what = "a dump style", kind = Kind::Style("dump"))]
    pub(super) style: Word,
}

/// The ID of a fix that is there.
#[derive(Words)]
pub struct OfFix {
    #[word(name = "ID", with = fix_id, kind = Kind::Fix)]
    pub(super) id: Word,
}

/// The ID of a compute that is there.
#[derive(Words)]
pub struct OfCompute {
    #[word(name = "ID", with = compute_id, kind = Kind::Compute)]
    pub(super) id: Word,
}

/// The ID of a dump that is there.
#[derive(Words)]
pub struct OfDump {
    #[word(name = "ID", what = "the dump's ID", kind = Kind::Dump)]
    pub(super) id: Word,
}

fn fix_id(args: &mut Args, _: &BuildCx) -> Result<Word> {
    id_of(args, "fix").cloned()
}

fn compute_id(args: &mut Args, _: &BuildCx) -> Result<Word> {
    id_of(args, "compute").cloned()
}

/// The options of `fix_modify` that belong to no style.
#[derive(Words)]
pub struct FixOptions {
    /// Whether the energy of the fix counts in the potential energy `pe`; refused for a fix that has none.
    #[word(keyword, placed)]
    pub(super) energy: Option<At<bool>>,
    /// The level of steps in which the fix adds its force under `run_style respa`: from 1, the outermost if there are fewer, and 0 for
    /// the outermost; for addforce, addtorque, aveforce, drag, gravity, indent, setforce, spring, spring/self, viscous and
    /// viscous/sphere.
    #[word(keyword, name = "M", what = "the level, from 1, or 0 for the outermost", from = 0)]
    pub(super) respa: Option<i64>,
}

/// A whole line of a command, with the words of a style.
const fn whole(parts: &'static [Part]) -> Grammar {
    Grammar { parts, keywords: &[], refused: &[] }
}

/// A whole `pair_style` line.
pub const PAIR_STYLE: Grammar = whole(&[Part::All(PairStyle::GRAMMAR), OF_STYLE]);
/// A whole `pair_coeff` line.
pub const PAIR_COEFF: Grammar = whole(&[Part::All(PairCoeff::GRAMMAR), OF_STYLE]);
/// A whole `bond_style` line.
pub const BOND_STYLE: Grammar = whole(&[Part::All(BondStyle::GRAMMAR), OF_STYLE]);
/// A whole `bond_coeff` line.
pub const BOND_COEFF: Grammar = whole(&[Part::All(BondCoeff::GRAMMAR), OF_STYLE]);
/// A whole `fix` line.
pub const FIX: Grammar = whole(&[Part::All(Fix::GRAMMAR), OF_STYLE]);
/// A whole `compute` line.
pub const COMPUTE: Grammar = whole(&[Part::All(Compute::GRAMMAR), OF_STYLE]);
/// A whole `compute_modify` line.
pub const COMPUTE_MODIFY: Grammar =
    whole(&[Part::All(OfCompute::GRAMMAR), Part::All(<Each<TemperatureOption>>::GRAMMAR)]);
/// A whole `fix_modify` line but for the words of styles.
pub const FIX_MODIFY: Grammar =
    whole(&[Part::All(OfFix::GRAMMAR), Part::All(FixOptions::GRAMMAR), Part::All(Counted::GRAMMAR)]);
/// A whole `dump` line.
pub const DUMP: Grammar = whole(&[Part::All(Dump::GRAMMAR), FILE, OF_STYLE]);
/// A whole `write_dump` line.
pub const WRITE_DUMP: Grammar = Grammar {
    parts: &[Part::All(WriteDump::GRAMMAR), FILE, OF_STYLE],
    keywords: &[Keyword {
        word: "modify",
        values: &[Part::Many(&[Part::bare("word", Kind::Text)], 1)],
        about: "The options of `dump_modify` behind it.",
        default: "",
        repeats: false,
    }],
    refused: &[],
};

//! The words of rigid bodies.

use super::mold::Mold;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::common::range_from;
use perigrain_styles::molecules::named;
use perigrain_styles::words::{At, Grammar, Kind, Part, Value, Words};
use perigrain_world::{GroupId, Numbers, Template};

/// The words of fix rigid and fix rigid/nve.
#[derive(Words)]
pub struct Large {
    #[word(name = "bodies")]
    pub bodies: Any,
    /// Turns components of the sum of forces off for bodies M, a number or range such as `1*3`.
    #[word(keyword, name = "M x y z")]
    pub force: Vec<(At<Chosen>, bool, bool, bool)>,
    /// Turns components of the sum of torques off for bodies M.
    #[word(keyword, name = "M x y z")]
    pub torque: Vec<(At<Chosen>, bool, bool, bool)>,
    #[word(flatten)]
    pub common: Common,
}

/// The words of fix rigid/small and fix rigid/nve/small.
#[derive(Words)]
pub struct Small {
    #[word(name = "bodies")]
    pub bodies: Many,
    /// A template that bodies come from, several times for several ones. Where its file or a `mixture` gives `mass`, `com` or `inertia` of the whole, bodies that are copies of
    /// it have these instead of the sums over their particles, however they came: by `create_atoms`, `fix insert`,
    /// `fix pour` or `fix deposit`, and in later runs too. Particles whose molecule ID is 0 belong to no body then (under `compat lammps`
    /// they make one).
    #[word(keyword, name = "TEMPLATE", with = mold, kind = Kind::Molecule)]
    pub mol: Vec<Mold>,
    #[word(flatten)]
    pub common: Common,
}

/// Keywords of all rigid bodies.
#[derive(Words)]
pub struct Common {
    /// Whether bodies are set up anew when a run begins after something has changed; otherwise only once, so that what was done to
    /// the particles between runs is undone.
    #[word(keyword, default = true)]
    pub reinit: bool,
    /// A file name: mass, centre, inertia xx yy zz xy xz yz, velocity, angular momentum and image counts of some bodies, one line
    /// each behind the number of lines. It means `reinit no`.
    #[word(keyword, name = "FILE", kind = Kind::File)]
    pub infile: Option<Word>,
    /// The ID of a fix gravity, which pulls the bodies.
    #[word(keyword, name = "ID", kind = Kind::Fix)]
    pub gravity: Option<Word>,
}

/// The bodies of a group, of any kind.
#[derive(Words)]
#[word(what = "kind of bodies")]
pub enum Any {
    /// One body of the whole group.
    Single,
    /// One body for each molecule ID, in ascending order.
    Molecule,
    /// One body for each of N groups.
    Group(#[word(name = "groups")] Groups),
    /// One body for each value of a property of `fix property/atom`, in ascending order.
    Custom(#[word(name = "i_NAME")] Property),
}

/// The bodies of a group, of which there may be many.
#[derive(Words)]
#[word(what = "kind of bodies")]
pub enum Many {
    /// One body for each molecule ID.
    Molecule,
    /// One body for each value of a property of `fix property/atom`.
    Custom(#[word(name = "i_NAME")] Property),
}

/// The refusal of LAMMPS' thermostats and barostats.
pub fn baths(style: &str, word: &Word) -> Option<Diagnostics> {
    const BATHS: [&str; 11] =
        ["langevin", "temp", "iso", "aniso", "x", "y", "z", "couple", "tparam", "pchain", "dilate"];
    let refused = BATHS.contains(&word.text.as_str());
    let text = format!("fix {style}: `{}` is not in perigrain", word.text);
    refused.then(|| Diagnostic::error(Code::NOT_SUPPORTED, word.span, text).into())
}

/// A whole-number property.
pub struct Property(pub Numbers);

impl Value for Property {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("a property i_NAME")?;
        match cx.world.columns.custom(&word.text) {
            Some(column) if word.text.starts_with("i_") => Ok(Self(column)),
            _ => {
                let text = format!("`{}` is no whole-number property i_NAME", word.text);
                let d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, text);
                Err(d
                    .help("values of a variable become one by `fix p all property/atom i_body` and `set group all i_body v_NAME`")
                    .into())
            }
        }
    }
}

/// A number of groups.
pub struct Groups(pub Vec<GroupId>);

impl Value for Groups {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::bare("N", Kind::Whole), Part::Many(&[Part::bare("group", Kind::Group)], 1)],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let count = args.integer_from(1, "the number of groups")?;
        (0..count.min(32)).map(|_| cx.group(args.expect("a group")?)).collect::<Result<_>>().map(Self)
    }
}

/// A body or a range of bodies.
pub struct Chosen(pub i64, pub i64);

impl Value for Chosen {
    const KIND: Kind = Kind::Text;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let (first, last) = range_from(args.expect("a body or a range of bodies")?, 1, i64::MAX)?;
        Ok(Self(first, last))
    }
}

/// Parses the template of the bodies.
fn mold(args: &mut Args, cx: &BuildCx) -> Result<Mold> {
    let word = args.expect("a molecule template")?;
    let set = named(word, cx)?;
    let beside = |t: &Template| t.com.is_some_and(|x| x[2] != 0.0);
    if cx.world.settings.two_dimensional && set.iter().any(beside) {
        return fail(
            Code::BAD_VALUE,
            word.span,
            "in a flat scene the `com` of a molecule file has the z of 0",
        );
    }
    Ok(Mold { name: word.text.clone(), set })
}

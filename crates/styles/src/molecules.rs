//! Molecule templates as commands and fixes take them: by name, in given shares, turned at random.

use super::newcomers::settle;
use super::pair::ToCome;
use super::words::{At, Grammar, Keyword, Kind, Part, Value, Words};
use super::{BuildCx, SealCx};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_base::math::body::{Quat, turn};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::{Args, Word};
use perigrain_world::template::Numbering;
use perigrain_world::{GroupId, Template, World};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// The template of this name.
///
/// # Errors
/// When there is none.
pub fn named(word: &Word, cx: &BuildCx) -> Result<Arc<[Template]>> {
    if let Some(set) = cx.world.templates.get(&word.text) {
        return Ok(set.clone());
    }
    let text = format!("there is no molecule template `{}`", word.text);
    let d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, text);
    Err(match nearest(&word.text, cx.world.templates.keys().map(String::as_str)) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help("read one before this line with `molecule ID FILE`"),
    }
    .into())
}

/// Whether the particles of this scene can be what a template describes.
///
/// # Errors
/// What the file lacks, and what these particles do not have.
pub fn fits(t: &Template, cx: &BuildCx, span: Span) -> Result<()> {
    let style = cx.world.particles.style;
    if t.places.is_empty() || t.kinds.is_empty() {
        return fail(Code::INCOMPLETE, span, "the molecule file needs the sections Coords and Types");
    }
    let cases = [
        (!t.radii.is_empty() && !style.sphere, "diameters", "have none"),
        (!t.masses.is_empty() && !style.own_mass(), "masses", "have them by type"),
        (!t.bonds.is_empty() && !style.bonded, "bonds", "have none"),
        (!t.angles.is_empty() && !style.angled, "angles", "have none"),
    ];
    if let Some((_, what, but)) = cases.into_iter().find(|c| c.0) {
        let text = format!("the molecule has {what}, but particles of this atom_style {but}");
        return fail(Code::CONFLICT, span, text);
    }
    let most = t.bonds.iter().map(|b| usize::from(b.0)).max().unwrap_or(0);
    if most > cx.world.bonds.types {
        let types = cx.world.bonds.types;
        let text = format!("the molecule has bonds of type {most}, the scene has {types} bond types");
        return fail(Code::BAD_VALUE, span, text);
    }
    let (most, types) = (t.angles.iter().map(|a| usize::from(a.0)).max(), cx.world.bonds.angles.types);
    if let Some(most) = most.filter(|most| *most > types) {
        let text = format!("the molecule has angles of type {most}, the scene has {types} angle types");
        return fail(Code::BAD_VALUE, span, text);
    }
    Ok(())
}

/// Whether the types of a template exist when `kind` is added to them.
///
/// # Errors
/// When they do not.
pub fn check_types(t: &Template, kind: u16, types: usize, span: Span) -> Result<()> {
    let most = usize::from(kind) + t.kinds.iter().map(|k| usize::from(*k)).max().unwrap_or(0);
    if most <= types {
        return Ok(());
    }
    fail(Code::BAD_VALUE, span, format!("the molecule would have types up to {most}; there are {types}"))
}

/// A random turn, drawn as LAMMPS draws it: an axis inside a cube, then an angle; about z in the plane, or about a given
/// axis.
pub fn any_turn(mut draw: impl FnMut() -> f64, flat: bool, about: Option<Vec3>) -> Quat {
    let axis = match (flat, about) {
        (true, _) => [0.0, 0.0, 1.0],
        (false, Some(axis)) => axis,
        (false, None) => [draw() - 0.5, draw() - 0.5, draw() - 0.5],
    };
    let scale = 1.0 / (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]).sqrt();
    turn(axis.map(|x| x * scale), draw() * 2.0 * PI)
}

/// What a fix puts in in the place of single particles: `mol`, `molfrac`, `rigid` and `orient`.
#[derive(Clone, Debug)]
pub struct Molecules {
    /// The template's name.
    name: String,
    set: Arc<[Template]>,
    /// Sums of the shares up to each template.
    shares: Vec<f64>,
    /// Added to their types.
    kind: u16,
    /// A fix rigid/small that moves them.
    rigid: Option<Word>,
    /// The axis they are turned about.
    axis: Option<Vec3>,
}

/// The keywords of molecules that are put in.
#[derive(Default)]
pub struct Inserted {
    mol: Option<(Word, Arc<[Template]>)>,
    shares: Option<Vec<f64>>,
    rigid: Option<Word>,
}

const fn keyword(word: &'static str, values: &'static [Part], about: &'static str) -> Keyword {
    Keyword { word, values, about, default: "", repeats: false }
}

impl Words for Inserted {
    const GRAMMAR: &'static Grammar = &Grammar {
        parts: &[],
        keywords: &[
            keyword(
                "mol",
                &[Part::bare("TEMPLATE", Kind::Molecule)],
                "Copies of a molecule template with their bonds are put in, turned at random, in the place of single particles; `type` is \
                 added to their types (so 0 is one).",
            ),
            keyword(
                "molfrac",
                &[Part::Many(&[Part::bare("f", Kind::Number)], 1)],
                "The shares of the several molecules of a template, equal without it.",
            ),
            keyword(
                "rigid",
                &[Part::bare("fixID", Kind::Fix)],
                "The fix rigid/small with the same `mol` that moves the molecules as bodies.",
            ),
        ],
        refused: &[],
    };

    fn begin(_: &mut Args, _: &BuildCx) -> Result<Self> {
        Ok(Self::default())
    }

    fn keyword(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
        match word.text.as_str() {
            "mol" => {
                let name = args.expect("a molecule template")?;
                self.mol = Some((name.clone(), named(name, cx)?));
            }
            "molfrac" => self.shares = Some(self.fractions(word, args)?),
            "rigid" => self.rigid = Some(args.expect("the ID of a fix rigid/small")?.clone()),
            "shake" => {
                let text = "there is no fix shake in perigrain: it is for bond lengths of real molecules";
                let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text);
                return Err(d.help("`rigid ID` keeps whole molecules rigid").into());
            }
            _ => return Ok(false),
        }
        Ok(true)
    }
}

/// An axis about which molecules are turned.
#[derive(Clone, Copy, Debug)]
pub struct Orient(Vec3);

impl Value for Orient {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::bare("x", Kind::Number), Part::bare("y", Kind::Number), Part::bare("z", Kind::Number)],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let span = args.here();
        let axis = [args.number("x")?, args.number("y")?, args.number("z")?];
        if axis == [0.0; 3] {
            return fail(Code::BAD_VALUE, span, "the axis must not be zero");
        }
        if cx.world.settings.two_dimensional && (axis[0], axis[1]) != (0.0, 0.0) {
            return fail(Code::BAD_VALUE, span, "in a flat scene the axis is z: write `orient 0 0 1`");
        }
        Ok(Self(axis))
    }
}

/// A type, or 0 where molecules bring their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offset(pub u16);

impl Value for Offset {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let span = args.here();
        let kind = args.integer("the type")?;
        match u16::try_from(kind).ok().filter(|k| usize::from(*k) <= cx.world.types) {
            Some(kind) => Ok(Self(kind)),
            None => {
                fail(Code::BAD_VALUE, span, format!("there are types 1 to {}, not {kind}", cx.world.types))
            }
        }
    }
}

impl Inserted {
    fn fractions(&self, word: &Word, args: &mut Args) -> Result<Vec<f64>> {
        let Some((_, set)) = &self.mol else {
            let d = Diagnostic::error(Code::WRONG_ORDER, word.span, "`molfrac` comes before its template");
            return Err(d.help("write `mol TEMPLATE molfrac f1 f2 …`").into());
        };
        let start = args.here();
        let mut sums = vec![];
        for k in 1..=set.len() {
            let share = args.non_negative(&format!("the share of molecule {k}"))?;
            sums.push(sums.last().copied().unwrap_or(0.0) + share);
        }
        match sums.last_mut() {
            // LAMMPS' tolerance.
            Some(sum) if (*sum - 1.0).abs() > 1e-3 => {
                let text = format!("the shares of molecules must sum to 1, not {sum}");
                fail(Code::BAD_VALUE, start.to(args.here()), text)
            }
            Some(sum) => {
                *sum = 1.0;
                Ok(sums)
            }
            None => Ok(sums),
        }
    }

    /// What is inserted: nothing without `mol`, in which case `kind`, a type, must exist; turned about `orient`, if it is there.
    ///
    /// # Errors
    /// Templates that do not fit the scene, words that lack `mol`.
    pub fn finish(
        self,
        kind: At<Offset>,
        orient: Option<At<Orient>>,
        cx: &BuildCx,
    ) -> Result<Option<Molecules>> {
        let At { value: Offset(kind), span: at, .. } = kind;
        let Some((word, set)) = self.mol else {
            if let Some(At { span, .. }) = orient {
                let text = "without effect: `orient` is for molecules, and single particles are put in";
                cx.note(Diagnostic::note(Code::NO_EFFECT, span, text));
            }
            return match &self.rigid {
                Some(word) => {
                    let d = Diagnostic::error(Code::INCOMPLETE, word.span, "`rigid` is for molecules");
                    Err(d.help("choose one with `mol TEMPLATE`").into())
                }
                None if kind == 0 => {
                    let types = cx.world.types;
                    fail(Code::BAD_VALUE, at, format!("there are types 1 to {types}, not 0"))
                }
                None => Ok(None),
            };
        };
        for t in set.iter() {
            fits(t, cx, word.span)?;
            check_types(t, kind, cx.world.types, word.span)?;
        }
        let equal = (1..=set.len()).map(|k| k as f64 / set.len() as f64).collect();
        Ok(Some(Molecules {
            name: word.text.clone(),
            shares: self.shares.unwrap_or(equal),
            set,
            kind,
            rigid: self.rigid,
            axis: orient.map(|axis| axis.value.0),
        }))
    }
}

/// A new particle of a type as LAMMPS makes it where its size is not set, a sphere of diameter and density 1; nothing where
/// particles have no size.
pub fn default_sphere(w: &World, kind: u16, mask: u32) -> Option<ToCome> {
    let sphere = ToCome { kind, mask, mass: PI / 6.0, radius: 0.5 };
    w.particles.style.sphere.then_some(sphere)
}

/// A molecule where it is to appear.
pub struct Copy {
    /// Which of the templates.
    pub which: usize,
    /// Its particles.
    pub places: Vec<Vec3>,
    /// How it is turned.
    pub turn: Quat,
    /// The velocity of all of them.
    pub v: Vec3,
}

impl Molecules {
    /// The next kind and orientation, with its geometric centre at `x`; at rest.
    pub fn draw(&self, x: Vec3, flat: bool, stream: &mut ParkMiller) -> Copy {
        let one = stream.uniform();
        let which = self.shares.iter().position(|sum| one <= *sum).unwrap_or(self.set.len() - 1);
        let q = any_turn(|| stream.uniform(), flat, self.axis);
        Copy { which, places: self.set[which].turned(x, q), turn: q, v: [0.0; 3] }
    }

    /// The radii of a copy's particles.
    pub fn radii(&self, copy: &Copy) -> impl Iterator<Item = f64> {
        let t = &self.set[copy.which];
        // LAMMPS' default sphere.
        (0..t.count).map(|k| t.radii.get(k).copied().unwrap_or(0.5))
    }

    /// The lightest and smallest grains of each type.
    pub fn to_come(&self, w: &World, mask: u32) -> Vec<ToCome> {
        let mut least: BTreeMap<u16, ToCome> = BTreeMap::new();
        for t in self.set.iter() {
            for k in 0..t.count {
                let kind = t.kinds.get(k).map_or(self.kind, |kind| kind + self.kind);
                let Some(usual) = default_sphere(w, kind, mask) else { continue };
                let radius = t.radii.get(k).copied().unwrap_or(usual.radius);
                let sphere = usual.mass * (radius / usual.radius).powi(3);
                let mass = t.masses.get(k).copied().unwrap_or(sphere);
                let grain = least.entry(kind).or_insert(ToCome { kind, mask, mass, radius });
                (grain.mass, grain.radius) = (grain.mass.min(mass), grain.radius.min(radius));
            }
        }
        least.into_values().collect()
    }

    /// The largest radius of their particles.
    pub fn widest(&self) -> f64 {
        let one =
            |t: &Template| if t.radii.is_empty() { 0.5 } else { t.radii.iter().copied().fold(0.0, f64::max) };
        self.set.iter().map(one).fold(0.0, f64::max)
    }

    /// The radius of the smallest sphere about its centre that holds any of them.
    pub fn extent(&self) -> f64 {
        self.set.iter().map(Template::extent).fold(0.0, f64::max)
    }

    /// Puts copies behind the present particles, in `all` and a group, with the particle and molecule IDs behind `from`; the
    /// last ones given. Lists are rebuilt.
    ///
    /// # Errors
    /// More particles than there are ids.
    pub fn admit(&self, w: &mut World, group: GroupId, from: [u32; 2], list: &[Copy]) -> Result<[u32; 2]> {
        let mut numbers = Numbering { tag: from[0], molecule: from[1], kind: self.kind };
        if !list.is_empty() {
            w.fall_back();
        }
        for copy in list {
            let (t, start) = (&self.set[copy.which], w.n());
            if u32::try_from(t.count).ok().and_then(|n| numbers.tag.checked_add(n)).is_none() {
                return fail(Code::TOO_LARGE, None, "more particles than there are ids");
            }
            w.insert_molecule(t, &copy.places, copy.turn, &mut numbers);
            let p = &mut w.particles;
            p.v[start..].fill(copy.v);
            p.mask[start..].iter_mut().for_each(|m| *m |= group.bit());
            if !t.bonds.is_empty() {
                w.bonds.find_special();
            }
        }
        if !list.is_empty() {
            settle(w);
        }
        Ok([numbers.tag, numbers.molecule])
    }

    /// Whether the fix that moves them as rigid bodies is there and knows them.
    ///
    /// # Errors
    /// When it is not or does not.
    pub fn check_rigid(&self, cx: &dyn SealCx) -> Result<()> {
        let Some(word) = &self.rigid else { return Ok(()) };
        let id = &word.text;
        let (text, help) = match cx.adopts(id) {
            None => (
                format!("there is no fix `{id}`"),
                format!("fix {id} GROUP rigid/small molecule mol {}", self.name),
            ),
            Some(names) if names.contains(&self.name) => return Ok(()),
            Some(_) => (
                format!("fix {id} does not take molecules of template `{}`", self.name),
                format!("fix {id} GROUP rigid/small molecule mol {}", self.name),
            ),
        };
        let d = Diagnostic::error(Code::CONFLICT, word.span, text);
        Err(d.help(format!("write `{help}` before this run")).into())
    }
}

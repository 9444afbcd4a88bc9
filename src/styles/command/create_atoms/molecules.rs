//! `create_atoms … mol`: copies of a molecule template in place of single particles.

use super::places::New;
use crate::diag::{Code, Diagnostic, Result, Span, fail};
use crate::lang::Args;
use crate::math::body::{Quat, turn};
use crate::math::rng::Marsaglia;
use crate::styles::BuildCx;
use crate::styles::command::common;
use crate::world::template::Numbering;
use crate::world::{Template, World};
use std::f64::consts::PI;
use std::sync::Arc;

/// What `mol` and `rotate` ask for.
pub struct Copies {
    set: Arc<[Template]>,
    seed: u32,
    /// The turn of all copies; random where none is said.
    pub turned: Option<Quat>,
    span: Span,
}

/// Takes the words after `mol`.
pub fn copies(a: &mut Args, cx: &BuildCx) -> Result<Copies> {
    let word = a.expect("a molecule template")?;
    let Some(set) = cx.world.templates.get(&word.text) else {
        let d = Diagnostic::error(
            Code::UNKNOWN_NAME,
            word.span,
            format!("there is no molecule template `{}`", word.text),
        );
        let known = cx.world.templates.keys().map(String::as_str);
        return Err(match crate::diag::nearest(&word.text, known) {
            Some(n) => d.help(format!("did you mean `{n}`?")),
            None => d.help("read one before this line with `molecule ID FILE`"),
        }
        .into());
    };
    if set.len() > 1 {
        let text = format!("only the first of the {} molecules of this template is used", set.len());
        cx.note(Diagnostic::warning(Code::SUSPICIOUS, word.span, text));
    }
    let c = Copies { set: set.clone(), seed: common::marsaglia_seed(a)?, turned: None, span: word.span };
    fits(c.template(), cx, c.span)?;
    Ok(c)
}

/// Takes the words after `rotate`.
pub fn rotate(a: &mut Args) -> Result<Quat> {
    let angle = a.number("the angle [degrees]")?;
    let span = a.here();
    let axis = [a.number("the axis")?, a.number("the axis")?, a.number("the axis")?];
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length == 0.0 {
        return fail(Code::BAD_VALUE, span, "the axis must not be zero");
    }
    Ok(turn(axis.map(|x| x / length), angle * PI / 180.0))
}

/// Whether the particles of this scene can be what a template describes.
fn fits(t: &Template, cx: &BuildCx, span: Span) -> Result<()> {
    let style = cx.world.particles.style;
    if t.places.is_empty() || t.kinds.is_empty() {
        return fail(Code::INCOMPLETE, span, "the molecule file needs the sections Coords and Types");
    }
    if !t.radii.is_empty() && !style.sphere {
        return fail(
            Code::CONFLICT,
            span,
            "the molecule has diameters, but particles of this atom_style have none",
        );
    }
    if !t.masses.is_empty() && !style.own_mass() {
        return fail(
            Code::CONFLICT,
            span,
            "the molecule has masses, but particles of this atom_style have them by type",
        );
    }
    if !t.bonds.is_empty() && !style.bonded {
        return fail(
            Code::CONFLICT,
            span,
            "the molecule has bonds, but particles of this atom_style have none",
        );
    }
    let most = t.bonds.iter().map(|b| usize::from(b.0)).max().unwrap_or(0);
    if most > cx.world.bonds.types {
        let text = format!(
            "the molecule has bonds of type {most}, the scene has {} bond types",
            cx.world.bonds.types
        );
        return fail(Code::BAD_VALUE, span, text);
    }
    Ok(())
}

impl Copies {
    fn template(&self) -> &Template {
        &self.set[0]
    }

    /// Whether the types exist when `kind` is added to them.
    pub fn check_types(&self, kind: u16, types: usize) -> Result<()> {
        let most =
            usize::from(kind) + self.template().kinds.iter().map(|k| usize::from(*k)).max().unwrap_or(0);
        if most <= types {
            return Ok(());
        }
        fail(
            Code::BAD_VALUE,
            self.span,
            format!("the molecule would have types up to {most}; there are {types}"),
        )
    }

    /// Puts a copy at each of these places; their number of particles.
    pub fn put(&self, w: &mut World, places: &[New], kind: u16) -> Result<usize> {
        let t = self.template();
        let flat = w.settings.two_dimensional;
        let mut stream = Marsaglia::new(self.seed);
        let mut numbers = Numbering::behind(w, kind);
        let more = u32::try_from(places.len().saturating_mul(t.count)).ok();
        if more.and_then(|n| numbers.tag.checked_add(n)).is_none() {
            return fail(Code::TOO_LARGE, None, "more particles than there are ids");
        }
        for new in places {
            let q = self.turned.unwrap_or_else(|| any(&mut stream, flat));
            w.insert_molecule(t, &t.turned(new.x, q), &mut numbers);
        }
        if !t.bonds.is_empty() {
            w.bonds.find_special();
        }
        Ok(places.len() * t.count)
    }
}

/// A random turn, drawn as LAMMPS draws it: an axis inside a cube, then an angle; about z in the plane.
fn any(stream: &mut Marsaglia, flat: bool) -> Quat {
    let axis = match flat {
        true => [0.0, 0.0, 1.0],
        false => {
            let r = [stream.uniform() - 0.5, stream.uniform() - 0.5, stream.uniform() - 0.5];
            let scale = 1.0 / (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]).sqrt();
            r.map(|x| x * scale)
        }
    };
    turn(axis, stream.uniform() * 2.0 * PI)
}

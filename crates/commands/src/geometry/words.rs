//! The keywords that all bodies from files take: size, turn and place, type, density, group.

use crate::create_atoms::molecules::rotate;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::body::{Quat, turned};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::common::free_id;

/// Where the numbers of a file go: first they are multiplied, then turned about the origin, then shifted.
#[derive(Clone, Copy)]
pub struct Placement {
    /// Factor of lengths.
    pub scale: f64,
    /// The turn.
    pub turn: Option<Quat>,
    /// The shift.
    pub shift: [f64; 3],
}

impl Placement {
    /// The place of what stands at `x` in the file.
    pub fn place(&self, x: [f64; 3]) -> [f64; 3] {
        let x = self.direction(x.map(|x| self.scale * x));
        [0, 1, 2].map(|d| x[d] + self.shift[d])
    }

    /// A vector of the file that is turned with it.
    pub fn direction(&self, v: [f64; 3]) -> [f64; 3] {
        self.turn.map_or(v, |q| turned(q, v))
    }
}

/// A line's options for the particles it makes.
pub struct Making {
    /// Where they go.
    pub placement: Placement,
    /// The type of those that nothing else gives one.
    pub kind: Option<u16>,
    /// Mass over volume.
    pub density: Option<f64>,
    /// The group they join.
    pub group: Option<Word>,
}

impl Default for Making {
    fn default() -> Self {
        let placement = Placement { scale: 1.0, turn: None, shift: [0.0; 3] };
        Self { placement, kind: None, density: None, group: None }
    }
}

impl Making {
    /// Takes the values of a keyword; whether it is one of those that all take.
    ///
    /// # Errors
    /// Values that cannot be.
    pub fn keyword(&mut self, word: &Word, a: &mut Args, cx: &BuildCx) -> Result<bool> {
        match word.text.as_str() {
            "type" => self.kind = Some(kind(a, cx)?),
            "density" => {
                if !cx.world.particles.style.own_mass() {
                    let name = cx.world.particles.style.name();
                    let text =
                        format!("particles of atom_style {name} have no density: `mass` gives types a mass");
                    return fail(Code::CONFLICT, word.span, text);
                }
                self.density = Some(a.positive("the density")?);
            }
            "group" => {
                let word = a.expect("a group")?;
                free_id(word, "the group's ID")?;
                self.group = Some(word.clone());
            }
            "scale" => self.placement.scale = a.positive("the scale")?,
            "rotate" => self.placement.turn = Some(rotate(a)?),
            "shift" | "move" => {
                for s in &mut self.placement.shift {
                    *s = a.number("a component of the shift")?;
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    }
}

/// Takes a type.
///
/// # Errors
/// Types that there are not.
pub fn kind(a: &mut Args, cx: &BuildCx) -> Result<u16> {
    let (span, types) = (a.here(), cx.world.types);
    let unknown = a.peek().is_some_and(|w| w.unknown);
    let k = a.integer("the type")?;
    match u16::try_from(k) {
        Ok(t) if k >= 1 && usize::from(t) <= types => Ok(t),
        _ if unknown => Ok(1),
        _ => fail(Code::BAD_VALUE, span, format!("there are types 1 to {types}, not {k}")),
    }
}

impl Making {
    /// Which facts of the scene the particles settle.
    pub fn settles(&self) -> Vec<&'static str> {
        let mut settles = vec!["particles", "volume", "diameter"];
        settles.extend(self.density.iter().flat_map(|_| ["density", "mass"]));
        settles
    }
}

/// Refuses a line that gives particles no type, unless there is one only.
///
/// # Errors
/// Several types, and neither `type` nor `others`.
pub fn need_type(making: &mut Making, others: bool, cx: &BuildCx) -> Result<()> {
    if making.kind.is_some() || others {
        return Ok(());
    }
    if cx.world.types > 1 {
        let d = Diagnostic::error(Code::INCOMPLETE, cx.span, "which type the particles get is missing");
        return Err(d.help("`type T` gives all of them one").into());
    }
    making.kind = Some(1);
    Ok(())
}

//! The keywords that all bodies from files take: size, turn and place, type, density, group.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::body::{Quat, turned};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::common::free_id;
use perigrain_styles::words::{At, OneType, Turned, Words};

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

/// The words for it.
#[derive(Words)]
pub struct Options {
    /// The type of those that nothing else gives one.
    #[word(keyword = "type", name = "T", what = "the type", placed)]
    pub kind: Option<At<OneType>>,
    /// The density, as `set` would give it; without one spheres have density 1, as those of create_atoms, and others none yet
    /// [mass/volume].
    #[word(keyword, name = "ρ", positive, placed)]
    density: Option<At<f64>>,
    /// The group they join, made if it is not there.
    #[word(keyword, name = "ID", with = group, kind = Kind::Group)]
    group: Option<Word>,
    /// The scale, a factor on the lengths of the file.
    #[word(keyword, name = "S", positive, default = 1.0)]
    scale: f64,
    /// Then it is turned by an angle in degrees about an axis through the origin.
    #[word(keyword, name = "turn")]
    rotate: Option<Turned>,
    /// Then it is shifted, whatever the order of the words [length].
    #[word(keyword, name = "X Y Z", what = "a component of the shift")]
    shift: Option<At<[f64; 3]>>,
    /// As `shift`.
    #[word(keyword = "move", name = "X Y Z", what = "a component of the shift")]
    moved: Option<At<[f64; 3]>>,
}

/// The group that particles join.
fn group(args: &mut Args, _: &BuildCx) -> Result<Word> {
    let word = args.expect("a group")?;
    free_id(word, "the group's ID")?;
    Ok(word.clone())
}

impl Options {
    /// What they ask for.
    ///
    /// # Errors
    /// A density of particles that have none, an axis without a direction.
    pub fn making(self, cx: &BuildCx) -> Result<Making> {
        let style = cx.world.particles.style;
        if let Some(density) = self.density.filter(|_| !style.own_mass()) {
            let name = style.name();
            let text = format!("particles of atom_style {name} have no density: `mass` gives types a mass");
            return fail(Code::CONFLICT, density.span, text);
        }
        let turn = self.rotate.map(|turn| turn.quat()).transpose()?;
        let shift = [self.shift, self.moved].into_iter().flatten().max_by_key(|s| s.span.start);
        Ok(Making {
            placement: Placement { scale: self.scale, turn, shift: shift.map_or([0.0; 3], |s| s.value) },
            kind: self.kind.map(|kind| kind.value.0),
            density: self.density.map(|density| density.value),
            group: self.group,
        })
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

//! Walls for grains: shared by the fixes wall/gran, wall/gran/region and wall/mesh.

pub mod gran;
mod lent;
pub mod mesh;
mod op;
mod peace;
mod planes;
mod plastic;
pub mod region;
pub mod servo;
mod words;

use super::shared::forget;
use super::{Counted, Fix, needs_spheres, options};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_contact::Wrench;
use perigrain_contact::normal::plastic_grain;
use perigrain_contact::walls::{Touch, Wall};
use perigrain_lang::{Args, Param};
use perigrain_pairs::contact::durations;
use perigrain_plan::{Op, Tick};
use perigrain_styles::critical::WALL_SPRINGS;
use perigrain_styles::fix::GrainWall;
use perigrain_styles::ledger::WALL_TOUCHES;
use perigrain_styles::pair::Deck;
use perigrain_styles::probe::WallProbe;
use perigrain_styles::{BuildCx, SealCx, Shape};
use perigrain_world::contacts::Contacts;
use perigrain_world::{GroupId, Key, Numbers, Outline, World};
use words::Material;

/// A wall of some shape during a run.
trait Surface: Send {
    /// Moves the wall to its position at this step; returns an upper bound of the displacement of its points
    /// since the last call.
    fn place(&mut self, w: &mut World, t: &Tick) -> Result<f64>;

    /// Whether it is at rest for the whole run.
    fn stands(&self) -> bool {
        false
    }

    /// Passes the wall's current state to `see`, or that of its surfaces of one type.
    fn show(&self, w: &World, of: Option<u16>, see: &mut dyn FnMut(&dyn Wall));

    /// Moves it to where it is after a step, where the world alone shows this ([`Form::SHOWS`]).
    fn follow(&mut self, _w: &World) {}

    /// Which surface of the wall (from 0) has a part, and the number of the part among the triangles of its file (from 0).
    fn piece(&self, part: u32) -> [u32; 2] {
        [0, part]
    }

    /// Stores local values of the contacts found, [`Form::LOCAL`] columns.
    fn local(&mut self, _w: &mut World, _contacts: &[(&Touch, &Wrench)], _t: &Tick) -> Vec<f64> {
        vec![]
    }

    /// Takes note of the contacts of this step, if it [shares](Surface::shares) what it keeps, and of their sum: force, torque, heat.
    fn feel(&mut self, _w: &mut World, _contacts: &[(&Touch, &Wrench)], _felt: [f64; op::FELT], _t: &Tick) {}

    /// Whether other ops read or change what it keeps in `memo`.
    fn shares(&self) -> bool {
        false
    }

    /// Whether it depends on the contacts of all grains: each of several ranks finds them all.
    fn feels(&self) -> bool {
        false
    }
}

/// The shape of a declared wall; [`Common`] holds everything that does not depend on the shape.
trait Form: Clone + Send + 'static {
    /// Style name in the deck.
    const STYLE: &'static str;
    /// Columns of local values.
    const LOCAL: usize = 0;
    /// Whether `compute wall/local` can look at its contacts.
    const SHOWS: bool = false;

    /// The types of its surfaces, ascending, where these have types of their own.
    fn kinds(&self, _w: &World) -> Vec<u16> {
        vec![]
    }

    /// The wall for a run.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn surface(&self, fix: &Common, cx: &mut dyn SealCx) -> Result<Box<dyn Surface>>;

    /// Captures the state at declaration under `key`.
    fn declare(&self, w: &mut World, key: Numbers);

    /// Its outline for pictures.
    fn outline(&self) -> Outline;

    /// Options of `fix_modify`.
    ///
    /// # Errors
    /// Words that it does not know.
    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        options::<Counted>(args, cx).map(drop)
    }
}

/// Data of all walls.
#[derive(Clone)]
struct Common {
    id: String,
    group: GroupId,
    material: Material,
    /// Whether per-particle contact data is output.
    contacts: bool,
    /// Wall temperature.
    temperature: Option<(Param, Span)>,
    /// Reference point of the wall's torque.
    center: [f64; 3],
}

impl Common {
    /// Number of columns of the per-particle values.
    fn columns(&self) -> usize {
        op::COLUMNS + usize::from(self.temperature.is_some())
    }

    /// Whether it is a wall for plastic grains.
    fn is_plastic(&self) -> bool {
        plastic_grain(&self.material.model.normal).is_some()
    }

    /// Key of the fix's small state in the world.
    fn key(&self, style: &str) -> Numbers {
        Key::new(&format!("{style}/{}", self.id))
    }
}

#[derive(Clone)]
struct Declared<F> {
    common: Common,
    form: F,
}

impl<F: Form> Fix for Declared<F> {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        plastic::suits(&self.common.material, cx)?;
        let surface = self.form.surface(&self.common, cx)?;
        let kinds = self.form.kinds(cx.world());
        let op = op::WallOp::new((F::STYLE, F::LOCAL), &self.common, surface, &kinds, cx)?;
        Ok(if op.is_plastic() { op::halves(op) } else { vec![Box::new(op)] })
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.form.declare(w, self.common.key(F::STYLE));
        w.outlines.insert(Key::new(&self.common.id), self.form.outline());
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        let key = self.common.key(F::STYLE);
        forget(w, key);
        w.memo.remove(key);
        for k in 0..w.types.max(1).pow(2) {
            let contacts: Key<Contacts> = Key::new(&op::memory_name(&self.common.id, k));
            w.wall_contacts.remove(contacts);
            if let Some(springs) = w.facts.get_mut(*WALL_SPRINGS) {
                springs.lists.remove(contacts.of());
            }
            if let Some(all) = w.facts.get_mut(*WALL_TOUCHES) {
                all.remove(contacts.of());
            }
        }
        w.wall_contacts.remove(plastic::key(&self.common.id));
        w.outlines.remove(Key::new(&self.common.id));
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        self.form.modify(args, cx)
    }

    fn shape(&self) -> Shape {
        let atom = self.common.contacts.then(|| self.common.columns());
        Shape { vector: op::FELT, vector_extensive: true, atom, local: F::LOCAL, ..Shape::default() }
    }

    fn wall(&self) -> Option<&dyn GrainWall> {
        Some(self)
    }
}

impl<F: Form> GrainWall for Declared<F> {
    fn contact_time(&self, w: &World, deck: Deck) -> Option<f64> {
        let laws = self.common.material.laws(w, &self.form.kinds(w)).ok()?;
        let time = |words::Ruled { law, .. }: &words::Ruled| {
            durations::on_wall(w, law, self.common.group.bit(), deck)
        };
        laws.iter().filter_map(time).reduce(f64::min)
    }

    fn probe(&self, cx: &mut dyn SealCx) -> Result<Option<Box<dyn WallProbe>>> {
        if !F::SHOWS {
            return Ok(None);
        }
        let surface = self.form.surface(&self.common, cx)?;
        let kinds = self.form.kinds(cx.world());
        Ok(Some(Box::new(op::Looking::new(&self.common, surface, &kinds, cx)?)))
    }
}

/// Refuses a wall across a periodic direction.
fn not_across_periodic(cx: &BuildCx, axes: &[usize], span: Span) -> Result<()> {
    let Some(domain) = &*cx.world.domain else {
        let text = "the simulation box is not defined yet: a create_box must come first";
        return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, text).into());
    };
    let periodic = domain.periodic();
    match axes.iter().find(|d| periodic[**d]) {
        None => Ok(()),
        Some(d) => {
            let name = ["x", "y", "z"][*d];
            let text = format!("this wall stands across {name}, where the box is periodic");
            let d = Diagnostic::error(Code::CONFLICT, span, text);
            Err(d.help(format!("make {name} fixed or shrink-wrapped with `boundary`")).into())
        }
    }
}

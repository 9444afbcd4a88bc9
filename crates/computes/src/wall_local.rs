//! compute wall/local: where grains touch a wall of surfaces, forces and more of every contact.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::{dot, scale, sub};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::probe::{HISTORY, OnWall};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Alternative, Kind, Syntax, Value, Words, alternatives, one_in, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, UseKind};
use perigrain_world::field::{
    BOX, COLUMNS, FACTS, KIND, MASK, MASS, MEMO, OMEGA, RADIUS, SLOTS, TAG, V, WALL_CONTACTS, X,
};
use perigrain_world::{GroupId, SlotId, World};
use std::f64::consts::PI;

/// The style.
pub struct WallLocal;

impl Style for WallLocal {
    fn name(&self) -> &'static str {
        "wall/local"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Place, force and more of every contact of grains with a wall of surfaces.",
            text: "Not in LAMMPS. Local vector for one value, array for several; a row for each contact of a grain of the group \
                   with the wall, a `fix wall/mesh … of` surfaces, in the order of surfaces, triangles and IDs. `dump local` \
                   writes them, `compute reduce … inputs local` adds them up.\n\n\
                   Forces are those at the present positions and velocities; history is what the contact remembers of the last \
                   step. So in LIGGGHTS, but that its torque of `epsd` rolling is one step ahead.",
            example: "fix plate all surface blade.stl type 1 scale 0.001\n\
                      fix w grains wall/mesh granular hertz 1e6 50 tangential none of plate\n\
                      compute c grains wall/local w triangle id x1 y1 z1 forcex forcey forcez delta",
        }
    }
}

/// A value of a contact.
type Read = fn(&World, &OnWall) -> f64;

/// The part of the force along the normal.
fn normal(o: &OnWall, k: usize) -> f64 {
    dot(o.force, o.normal) * o.normal[k] + 0.0
}

/// The part of the force across the normal.
fn across(o: &OnWall, k: usize) -> f64 {
    sub(o.force, scale(dot(o.force, o.normal), o.normal))[k]
}

/// Overlap.
fn overlap(w: &World, o: &OnWall) -> f64 {
    w.particles.radius[o.grain as usize] - o.distance
}

const QUANTITIES: [(&str, Read); 34] = [
    ("surface", |_, o| f64::from(o.surface)),
    ("triangle", |_, o| f64::from(o.triangle)),
    ("id", |w, o| f64::from(w.particles.tag[o.grain as usize])),
    ("x1", |_, o| o.foot[0]),
    ("y1", |_, o| o.foot[1]),
    ("z1", |_, o| o.foot[2]),
    ("x2", |w, o| w.particles.x[o.grain as usize][0]),
    ("y2", |w, o| w.particles.x[o.grain as usize][1]),
    ("z2", |w, o| w.particles.x[o.grain as usize][2]),
    ("vx1", |_, o| o.velocity[0]),
    ("vy1", |_, o| o.velocity[1]),
    ("vz1", |_, o| o.velocity[2]),
    ("vx2", |w, o| w.particles.v[o.grain as usize][0]),
    ("vy2", |w, o| w.particles.v[o.grain as usize][1]),
    ("vz2", |w, o| w.particles.v[o.grain as usize][2]),
    ("forcex", |_, o| o.force[0]),
    ("forcey", |_, o| o.force[1]),
    ("forcez", |_, o| o.force[2]),
    ("fx", |_, o| normal(o, 0)),
    ("fy", |_, o| normal(o, 1)),
    ("fz", |_, o| normal(o, 2)),
    ("tx", |_, o| across(o, 0)),
    ("ty", |_, o| across(o, 1)),
    ("tz", |_, o| across(o, 2)),
    ("torquex", |_, o| o.torque[0]),
    ("torquey", |_, o| o.torque[1]),
    ("torquez", |_, o| o.torque[2]),
    ("nx", |_, o| o.normal[0]),
    ("ny", |_, o| o.normal[1]),
    ("nz", |_, o| o.normal[2]),
    ("delta", overlap),
    // Of the circle in which the sphere meets the plane: π δ (2R − δ).
    ("area", |w, o| PI * overlap(w, o).max(0.0) * (w.particles.radius[o.grain as usize] + o.distance)),
    ("dist", |_, o| o.distance),
    ("heat", |_, o| o.heat),
];

const NAMES: &[Alternative] = &alternatives(&QUANTITIES);

/// A column.
#[derive(Clone, Copy)]
enum Quantity {
    Read(Read),
    History(usize),
}

impl Quantity {
    fn of(self, w: &World, o: &OnWall) -> f64 {
        match self {
            Quantity::Read(read) => read(w, o),
            Quantity::History(k) => o.history[k],
        }
    }
}

impl Value for Quantity {
    const KIND: Kind = Kind::Or(&Kind::Choice(NAMES), &Kind::Text);
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let number = |text: &str| text.strip_prefix('h')?.parse::<usize>().ok();
        if let Some(n) = number(args.peek_text()).filter(|n| (1..=HISTORY).contains(n)) {
            args.next();
            return Ok(Quantity::History(n - 1));
        }
        one_in("value of a contact", args, &QUANTITIES).map(Quantity::Read)
    }
}

/// The ID of a wall.
struct WallFix(String, Span);

impl Value for WallFix {
    const KIND: Kind = Kind::Fix;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the ID of a fix wall/mesh")?;
        let r = ValueRef { kind: RefKind::Fix, name: word.text.clone(), index: vec![], span: word.span };
        let Some(style) = cx.names.fix_style(&r.name) else {
            cx.value(&r, false)?;
            return fail(Code::UNKNOWN_NAME, word.span, format!("there is no fix `{}`", r.name));
        };
        cx.uses(UseKind::Fix, &r.name);
        if style == "wall/mesh" {
            return Ok(Self(r.name, word.span));
        }
        let text = format!("fix `{}` (style {style}) is no wall of surfaces", r.name);
        let d = Diagnostic::error(Code::WRONG_KIND, word.span, text);
        Err(d.help("`fix ID group wall/mesh … of surfaceID` is; the others have `contacts`").into())
    }
}

#[derive(Words)]
struct Line {
    /// A `fix wall/mesh … of`.
    #[word(name = "fix-ID")]
    wall: WallFix,
    /// `surface`, its number behind `of`, and `triangle`, that in its file, both from 0; `id` of the grain; `x1 y1 z1`: the point of the wall
    /// next to its centre `x2 y2 z2`; `vx1 vy1 vz1 vx2 vy2 vz2`: their velocities; `forcex forcey forcez`, `torquex torquey torquez`: on the
    /// grain; `fx fy fz` the part of the force along the normal `nx ny nz` (towards the grain), `tx ty tz` that across it; `delta`: overlap;
    /// `dist`: of centre and wall; `area`: of the circle in which sphere and plane meet; `heat`: that flows into the grain; `h1` …
    /// `h12`: what the contact remembers, the tangential spring first.
    #[word(name = "value", what = "a value, as `delta`", least = 1)]
    values: Vec<Quantity>,
}

impl ComputeStyle for WallLocal {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { wall: WallFix(wall, at), values } = read(args, cx)?;
        super::need_spheres("compute wall/local", cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, wall, at, values }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    wall: String,
    at: Span,
    values: Vec<Quantity>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { local: self.values.len(), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let found = cx.wall_probes()?.into_iter().find(|(id, _)| *id == self.wall);
        let Some((_, mut probe)) = found else {
            let text = format!("fix `{}` does not lean on surfaces of `fix surface`", self.wall);
            let d = Diagnostic::error(Code::WRONG_KIND, self.at, text);
            return Err(d
                .help("declare the mesh by `fix surface`, and write `of ID` in the wall's line")
                .into());
        };
        let me = self.clone();
        let reads = X
            | V
            | OMEGA
            | RADIUS
            | MASS
            | KIND
            | MASK
            | BOX
            | COLUMNS
            | FACTS
            | TAG
            | MEMO
            | SLOTS
            | WALL_CONTACTS;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, t, out| {
            out.local_cols = me.values.len();
            out.local.clear();
            let own = |o: &&OnWall| w.particles.mask[o.grain as usize] & me.group.bit() != 0;
            for contact in probe.look(w, t.dt).iter().filter(own) {
                out.local.extend(me.values.iter().map(|v| v.of(w, contact)));
            }
            Ok(())
        }))
    }
}

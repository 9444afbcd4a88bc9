//! compute rigid/local: attributes of each rigid body.

use super::rigid_energy::RigidFix;
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{Vec3, dot, sub};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::unwrapped;
use perigrain_styles::rigid_bodies::{Body, bodies, body_column};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Alternative, At, Kind, Syntax, Value, Words, alternatives, one_in, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, COLUMNS, IMAGE, MASK, MEMO, MOLECULE, RIGID, SLOTS, TAG, X};
use perigrain_world::{GroupId, Key, Numbers, SlotId, World};

/// The style.
pub struct RigidLocal;

impl Style for RigidLocal {
    fn name(&self) -> &'static str {
        "rigid/local"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Attributes of each rigid body.",
            text: "Local vector for one attribute, array for several; a row for each body of the fix whose \
                   owner is in the group, in the order of the bodies. The owner is the particle nearest to the middle of the box around the \
                   body's particles when a run first finds it (of several the one with the least ID). The \
                   sides that the axes of the moments point to, and with them the quaternion, may be others than in LAMMPS. No rows before bodies are set up, when a run begins. LAMMPS' rows stand in the order of owners in memory.",
            example: "unfix motion\nset group plate diameter 0.0\nfix mine all property/atom mol\nset group plate mol 1\n\
                      fix body plate rigid/small molecule\ncompute b all rigid/local body mass x y z",
        }
    }
}

/// Arguments: body, id of its owner, offset of its image counts from the box.
type Read = fn(&Body, [f64; 2], Vec3) -> f64;

const ATTRIBUTES: [(&str, Read); 34] = [
    ("id", |_, owner, _| owner[0]),
    ("mol", |_, owner, _| owner[1]),
    ("mass", |b, _, _| b.mass),
    ("x", |b, _, by| b.x[0] - by[0]),
    ("y", |b, _, by| b.x[1] - by[1]),
    ("z", |b, _, by| b.x[2] - by[2]),
    ("xu", |b, _, _| b.x[0]),
    ("yu", |b, _, _| b.x[1]),
    ("zu", |b, _, _| b.x[2]),
    ("ix", |b, _, _| b.image[0]),
    ("iy", |b, _, _| b.image[1]),
    ("iz", |b, _, _| b.image[2]),
    ("vx", |b, _, _| b.v[0]),
    ("vy", |b, _, _| b.v[1]),
    ("vz", |b, _, _| b.v[2]),
    ("fx", |b, _, _| b.force[0]),
    ("fy", |b, _, _| b.force[1]),
    ("fz", |b, _, _| b.force[2]),
    ("omegax", |b, _, _| b.omega[0]),
    ("omegay", |b, _, _| b.omega[1]),
    ("omegaz", |b, _, _| b.omega[2]),
    ("angmomx", |b, _, _| b.momentum[0]),
    ("angmomy", |b, _, _| b.momentum[1]),
    ("angmomz", |b, _, _| b.momentum[2]),
    ("quatw", |b, _, _| b.q[0]),
    ("quati", |b, _, _| b.q[1]),
    ("quatj", |b, _, _| b.q[2]),
    ("quatk", |b, _, _| b.q[3]),
    ("tqx", |b, _, _| b.torque[0]),
    ("tqy", |b, _, _| b.torque[1]),
    ("tqz", |b, _, _| b.torque[2]),
    ("inertiax", |b, _, _| b.moments[0]),
    ("inertiay", |b, _, _| b.moments[1]),
    ("inertiaz", |b, _, _| b.moments[2]),
];

const NAMES: &[Alternative] = &alternatives(&ATTRIBUTES);

/// An attribute of a body.
struct Attribute(Read);

impl Value for Attribute {
    const KIND: Kind = Kind::Choice(NAMES);
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        one_in("attribute of a rigid body", args, &ATTRIBUTES).map(Self)
    }
}

#[derive(Words)]
struct Line {
    /// A `fix rigid/small` or `rigid/nve/small`.
    #[word(name = "fix-ID")]
    fix: At<RigidFix>,
    /// In the deck's units: `id`, of the owner; `mol`, its molecule ID; `mass`; `x y z`, the centre, wrapped into the box as of the
    /// last rebuild of neighbour lists, `xu yu zu` unwrapped, `ix iy iz` the image counts between them; `vx vy vz`; `fx fy fz`;
    /// `omegax omegay omegaz`; `angmomx angmomy angmomz`; `quatw quati quatj quatk`; `tqx tqy tqz`; `inertiax inertiay inertiaz`, the
    /// principal moments, ascending.
    #[word(name = "attribute", least = 1)]
    list: Vec<Attribute>,
}

impl ComputeStyle for RigidLocal {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { fix: At { value: fix, span: at, .. }, list } = read(args, cx)?;
        if !fix.style.ends_with("/small") {
            let text = format!("fix `{}` (style {}) is not of style rigid/small", fix.id, fix.style);
            let d = Diagnostic::error(Code::WRONG_KIND, at, text);
            return Err(d.help("its array holds the same for its bodies").into());
        }
        let list = list.into_iter().map(|a| a.0).collect();
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, fix, list }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    fix: RigidFix,
    list: Vec<Read>,
}

impl Declared {
    /// Key of the ids of owners.
    fn key(&self) -> Numbers {
        Key::new(&format!("compute {} owners", self.id))
    }

    /// Chooses owners of the bodies from number `known` on.
    fn owners(w: &World, column: Numbers, known: usize, count: usize) -> Vec<f64> {
        let of = w.columns.get_scalar(column).unwrap_or_default();
        let mut boxes = vec![([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]); count];
        let members = || (0..w.n()).filter_map(|i| Some((i, (*of.get(i)? as usize).checked_sub(1 + known)?)));
        for (i, k) in members().filter(|(_, k)| *k < count) {
            let (x, (lo, hi)) = (unwrapped(w, i), &mut boxes[k]);
            (0..3).for_each(|d| (lo[d], hi[d]) = (lo[d].min(x[d]), hi[d].max(x[d])));
        }
        let mut nearest = vec![(f64::INFINITY, u32::MAX); count];
        for (i, k) in members().filter(|(_, k)| *k < count) {
            let (lo, hi) = boxes[k];
            let d = sub(unwrapped(w, i), std::array::from_fn(|d| 0.5 * (lo[d] + hi[d])));
            let own = (dot(d, d), w.particles.tag[i]);
            if own < nearest[k] {
                nearest[k] = own;
            }
        }
        nearest.into_iter().map(|(_, tag)| f64::from(tag)).collect()
    }

    fn rows(&self, w: &World, owners: &[f64], bodies: &[Body]) -> Vec<f64> {
        let (p, index) = (&w.particles, perigrain_world::index::Index::new(&w.particles.tag));
        let edges = w.edges();
        let mut rows = vec![];
        for (body, owner) in bodies.iter().zip(owners) {
            let Some(i) = index.find(*owner as u32, &p.tag) else { continue };
            if p.mask[i] & self.group.bit() != 0 {
                let molecule = p.molecule.get(i).map_or(0.0, |m| f64::from(*m));
                let by = edges.shift(body.image);
                rows.extend(self.list.iter().map(|read| read(body, [*owner, molecule], by)));
            }
        }
        rows
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { local: self.list.len(), ..Shape::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
    }

    fn begins(&self) -> bool {
        true
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (me, key) = (self.clone(), self.key());
        let (kept, column) = (self.fix.bodies(), body_column(self.fix.style, &self.fix.id));
        let name = format!("compute {}", self.id);
        let op = StepOp::new(
            name,
            stage,
            Needs::new()
                .read(X | IMAGE | MASK | MEMO | RIGID | BOX | COLUMNS | MOLECULE | TAG)
                .write(SLOTS)
                .keep(MEMO),
            move |w: &mut World, t| {
                let bodies = bodies(w, kept);
                let mut owners = w.memo.remove(key).unwrap_or_default();
                owners.truncate(bodies.len());
                owners.extend(Self::owners(w, column, owners.len(), bodies.len() - owners.len()));
                let rows = me.rows(w, &owners, &bodies);
                w.memo.insert(key, owners);
                let out = w.slots.get_mut(slot);
                (out.step, out.local, out.local_cols) = (Some(t.step), rows, me.list.len());
                Ok(())
            },
        );
        Ok(op.when(when.clone()).in_setup(true).boxed())
    }
}

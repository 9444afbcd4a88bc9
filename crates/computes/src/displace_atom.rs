//! compute displace/atom: displacement of each particle since the compute was declared.

use super::origin::{Origin, PLACES};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::unwrapped;
use perigrain_styles::step_op::{StepOp, Wanted, fill};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, Wants};
use perigrain_world::field::{BOX, COLUMNS, IMAGE, MASK, X};
use perigrain_world::{GroupId, Registration, SlotId, World};

/// The style.
pub struct DisplaceAtom;

impl Style for DisplaceAtom {
    fn name(&self) -> &'static str {
        "displace/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Displacement of each particle since the compute was declared.",
            text: "Per-atom array of 4 columns in distance units: dx, dy, dz and their length, with positions unwrapped \
                   across periodic faces; 0 outside the group. Particles made later start where they are at the next run \
                   or use. With `refresh` of this line and of dump_modify, `dump_modify thresh` can show a particle each time \
                   that it has come some way.",
            example: "compute u all displace/atom",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&PLACES] }
    }
}

#[derive(Words)]
struct Line {
    /// An atom-style variable: after each snapshot of a dump with `dump_modify dump-ID refresh c_ID`, the particles for which it is
    /// not zero start anew where they are.
    #[word(keyword, name = "name", with = atom_variable, kind = Kind::Variable)]
    refresh: Option<ValueRef>,
}

fn atom_variable(args: &mut Args, cx: &BuildCx) -> Result<ValueRef> {
    let name = args.expect("the name of an atom-style variable")?;
    let r = ValueRef { kind: RefKind::Variable, name: name.text.clone(), index: vec![], span: name.span };
    cx.reading(&r, Wants::PerAtom)?;
    Ok(r)
}

impl ComputeStyle for DisplaceAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { refresh } = read(args, cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), origin: Origin::of(cx.id), group: cx.group, refresh }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    origin: Origin,
    group: GroupId,
    refresh: Option<ValueRef>,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(4), ..Shape::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.origin.capture(w, [0.0; 3]);
        Ok(())
    }

    fn particles_joined(&self, w: &mut World) {
        self.origin.extend(w, [0.0; 3]);
    }

    fn remove(&self, w: &mut World) {
        self.origin.forget(w);
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        self.particles_joined(cx.world());
        let (places, group) = (self.origin.places, self.group);
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            X | IMAGE | MASK | BOX | COLUMNS,
            move |w, _, out| {
                let (bit, start) = (group.bit(), w.columns.get_vector(places).unwrap_or(&[]));
                out.cols = 4;
                out.atom.resize(4 * w.n(), 0.0);
                par::each(out.atom.as_chunks_mut::<4>().0, |first, rows| {
                    for (k, row) in rows.iter_mut().enumerate() {
                        let i = first + k;
                        *row = [0.0; 4];
                        if w.particles.mask[i] & bit != 0 {
                            let x = unwrapped(w, i);
                            let d: [f64; 3] = std::array::from_fn(|k| x[k] - start[i][k]);
                            *row = [d[0], d[1], d[2], (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()];
                        }
                    }
                });
                Ok(())
            },
        ))
    }

    fn refresh(&self, cx: &mut dyn SealCx, stage: Stage, when: &When) -> Result<Option<Box<dyn Op>>> {
        let Some(r) = &self.refresh else { return Ok(None) };
        let reading = cx.reading(r, Wants::PerAtom, stage, when)?;
        let (places, group) = (self.origin.places, self.group);
        let name = format!("compute {} refresh", self.id);
        let op = StepOp::new(name, stage, Needs::new().read(X | IMAGE | MASK), move |w: &mut World, _| {
            let chosen = |i: &usize| w.particles.mask[*i] & group.bit() != 0 && reading.atom(w, *i) != 0.0;
            let new: Vec<(usize, [f64; 3])> =
                (0..w.n()).filter(chosen).map(|i| (i, unwrapped(w, i))).collect();
            let n = w.n();
            let places = w.columns.vector(places, n);
            new.into_iter().for_each(|(i, x)| places[i] = x);
            Ok(())
        });
        Ok(Some(op.when(when.clone()).in_setup(true).boxed()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn displacements_across_faces_and_of_newcomers() {
        let mut b = Bench::new(AtomStyle::default(), &[[9.0, 0.0, 0.0], [1.0; 3]]);
        let c = b.compute(&DisplaceAtom, "").unwrap();
        c.declare(&mut b.world).unwrap();
        // Across the periodic face of a box of width 20: 2 along x, 1 along z.
        b.world.particles.x[0] = [-9.0, 0.0, 1.0];
        b.world.particles.image[0] = [1, 0, 0];
        b.world.particles.mask[1] = 0;
        b.world.particles.push(3, 1, [5.0; 3]);
        let slot = b.evaluate(&*c).unwrap();
        assert_eq!(slot.atom, [2.0, 0.0, 1.0, 5f64.sqrt(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        c.remove(&mut b.world);
        assert!(b.world.columns.names().is_empty());
        assert!(b.compute(&DisplaceAtom, "fresh v").is_err());
    }
}

//! compute msd: mean squared displacement since the compute was declared.

use super::origin::{Origin, PLACES};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::{Masses, check_masses, count, sum, unwrapped};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, COLUMNS, IMAGE, KIND, MASK, MASS, MEMO, SLOTS, TYPE_MASS, X};
use perigrain_world::{GroupId, Key, Numbers, Registration, SlotId, World};

/// The style.
pub struct Msd;

impl Style for Msd {
    fn name(&self) -> &'static str {
        "msd"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Mean squared displacement of the group since the compute was declared.",
            text: "Vector of 4 (intensive) in squared distance units: the means of dx², dy², dz² and their sum, with \
                   positions unwrapped across periodic faces.",
            example: "compute m all msd com yes",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&PLACES] }
    }
}

#[derive(Words)]
struct Line {
    /// Takes the drift of the centre of mass away.
    #[word(keyword, what = "com", default = false)]
    com: bool,
    /// Measures from each particle's mean place over all uses of the compute so far, not from its first place.
    #[word(keyword, what = "average", default = false)]
    average: bool,
}

impl ComputeStyle for Msd {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { com, average } = read(args, cx)?;
        Ok(Box::new(Declared {
            id: cx.id.to_string(),
            origin: Origin::of(cx.id),
            group: cx.group,
            com,
            average,
        }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    origin: Origin,
    group: GroupId,
    com: bool,
    average: bool,
}

/// The centre of mass of a group, 0 if it has no mass.
fn center(w: &World, group: GroupId) -> [f64; 3] {
    let masses = Masses::of(w);
    let [x, y, z, m] = sum(w, group, |i| {
        let (m, [x, y, z]) = (masses.get(i), unwrapped(w, i));
        [x * m, y * m, z * m, m]
    });
    [x, y, z].map(|a| if m > 0.0 { a / m } else { 0.0 })
}

impl Declared {
    fn shift(&self, w: &World) -> [f64; 3] {
        if self.com { center(w, self.group) } else { [0.0; 3] }
    }

    /// Key of the number of samples in the mean positions.
    fn key(&self) -> Numbers {
        Key::new(&format!("compute {} uses", self.id))
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { vector: 4, ..Shape::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        w.memo.remove(self.key());
        let shift = self.shift(w);
        self.origin.capture(w, shift);
        Ok(())
    }

    fn particles_joined(&self, w: &mut World) {
        self.origin.extend(w, [0.0; 3]);
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key());
        self.origin.forget(w);
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        self.particles_joined(cx.world());
        let (me, span, key, places) = (self.clone(), cx.span(), self.key(), self.origin.places);
        if self.com {
            check_masses(cx.world(), span)?;
        }
        let name = format!("compute {}", self.id);
        let op = StepOp::new(
            name,
            stage,
            Needs::new()
                .read(X | IMAGE | MASS | MASK | BOX | TYPE_MASS | KIND)
                .write(SLOTS)
                .keep(COLUMNS | MEMO)
                .only(&[key.text()])
                .only(&self.origin.names()),
            move |w: &mut World, t| {
                let (shift, bit) = (me.shift(w), me.group.bit());
                if me.average {
                    let uses = w.memo.get_or(key, || vec![0.0]);
                    uses[0] += 1.0;
                    let (uses, part, n) = (uses[0], 1.0 / (uses[0] + 1.0), w.n());
                    let mut means = std::mem::take(w.columns.vector(places, n));
                    for (i, place) in
                        means.iter_mut().enumerate().filter(|(i, _)| w.particles.mask[*i] & bit != 0)
                    {
                        let x = unwrapped(w, i);
                        *place = std::array::from_fn(|d| (place[d] * uses + (x[d] - shift[d])) * part);
                    }
                    *w.columns.vector(places, n) = means;
                }
                let start = w.columns.get_vector(places).unwrap_or(&[]);
                let [x, y, z, all] = sum(w, me.group, |i| {
                    let x = unwrapped(w, i);
                    let [a, b, c]: [f64; 3] = std::array::from_fn(|d| {
                        let d = x[d] - shift[d] - start[i][d];
                        d * d
                    });
                    [a, b, c, a + b + c]
                });
                let n = count(w, me.group) as f64;
                let out = w.slots.get_mut(slot);
                out.step = Some(t.step);
                out.vector = [x, y, z, all].map(|a| if n > 0.0 { a / n } else { 0.0 }).to_vec();
                Ok(())
            },
        );
        let op = op.when(when.clone()).in_setup(true);
        // Running means are kept for all particles.
        Ok(if self.average { op.boxed() } else { op.summing().boxed() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn means(words: &str) -> Vec<f64> {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0; 3]]);
        let c = b.compute(&Msd, words).unwrap();
        c.declare(&mut b.world).unwrap();
        b.world.particles.x = vec![[2.0, 0.0, 0.0], [1.0, 1.0, 5.0]].into();
        b.evaluate(&*c).unwrap().vector.clone()
    }

    // By hand: squares 4 along x and 16 along z; the centre moves by (1, 0, 2); the mean position is halfway.
    #[test]
    fn plain_without_drift_and_from_the_mean() {
        assert_eq!(means(""), [2.0, 0.0, 8.0, 10.0]);
        assert_eq!(means("com yes"), [1.0, 0.0, 4.0, 5.0]);
        assert_eq!(means("average yes"), [0.5, 0.0, 2.0, 2.5]);
    }
}

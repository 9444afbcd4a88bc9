//! compute stress/atom: the stress of each particle times its volume.

use super::pressure::{Parts, Term, temperature};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::par;
use perigrain_lang::{Args, Word};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, check_masses};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Nullable, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{KIND, MASK, MASS, TALLY, TYPE_MASS, V};
use perigrain_world::{GroupId, SlotId, World};

/// The style.
pub struct StressAtom;

impl Style for StressAtom {
    fn name(&self) -> &'static str {
        "stress/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Stress of each particle, times its volume.",
            text: "Per-atom array of 6 columns, xx yy zz xy xz yz, in pressure·volume units: −m v_a v_b − W_ab; 0 outside the group. \
                   The virial W gives each end of a pair half of d_a F_b, with all forces of the pair, also across its line \
                   of centres; forces are those of the step, at the velocities of its middle. The sum over all particles of the first three \
                   columns is −3 V times the pressure.\n\nWithout terms all count, with terms only those named; those that no style \
                   of the scene has are 0. For peridynamic \
                   particles the virial carries one factor of volume, as in LAMMPS.",
            example: "compute s all stress/atom NULL virial",
        }
    }
}

#[derive(Words)]
struct Line {
    /// A temperature compute may be named, as in LAMMPS: velocities are taken as they are.
    #[word(name = "temp-ID", what = "the ID of a temperature compute, or NULL", kind = Kind::OrNull(&Kind::Compute))]
    temp: Nullable<Word>,
    #[word(name = "term", what = "keyword of compute stress/atom")]
    terms: Vec<Term>,
}

impl ComputeStyle for StressAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { temp: Nullable(temp), terms } = read(args, cx)?;
        if let Some(word) = temp {
            temperature(&word, cx)?;
        }
        let (ke, parts) = Term::chosen(&terms);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, ke, parts }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    ke: bool,
    parts: Parts,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { atom: Some(6), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (ke, parts, bit, span) = (self.ke, self.parts, self.group.bit(), cx.span());
        if parts.any() {
            cx.request_atom_virial(when);
        }
        if ke {
            check_masses(cx.world(), span)?;
        }
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            V | MASS | MASK | TALLY | KIND | TYPE_MASS,
            move |w, t, out| {
                known(w, parts, t.step)?;
                let (p, masses, units) = (&w.particles, Masses::of(w), w.settings.units.constants());
                let of = |list: &[[f64; 6]], yes: bool, i: usize| match list.get(i) {
                    Some(virial) if yes => *virial,
                    _ => [0.0; 6],
                };
                let stress = |i: usize| -> [f64; 6] {
                    let pair = of(&w.tally.atom_virial, parts.pair, i);
                    let bond = of(&w.tally.atom_bonds, parts.bond, i);
                    let fix = of(&w.tally.atom_fixes, parts.fix, i);
                    let [x, y, z] = p.v[i];
                    let m = if ke { units.mvv2e * masses.get(i) } else { 0.0 };
                    let kinetic = [x * x, y * y, z * z, x * y, x * z, y * z];
                    std::array::from_fn(|k| -(pair[k] + bond[k] + fix[k] + m * kinetic[k]) * units.nktv2p)
                };
                out.cols = 6;
                out.atom.resize(6 * w.n(), 0.0);
                let rows = par::Rows { data: &mut out.atom[..], width: 6 };
                par::each((rows, &p.mask[..]), |start, (rows, mask)| {
                    for (k, (row, mask)) in rows.data.chunks_exact_mut(6).zip(mask).enumerate() {
                        row.copy_from_slice(&if mask & bit != 0 { stress(start + k) } else { [0.0; 6] });
                    }
                });
                Ok(())
            },
        ))
    }

    fn tallied(&self) -> bool {
        true
    }
}

/// Checks that the virials of this step were tallied, if they are needed.
fn known(w: &World, parts: Parts, step: i64) -> Result<()> {
    match w.tally.step {
        Some(s) if parts.any() && (s != step || !w.tally.with_atom_virial) => {
            fail(Code::WRONG_ORDER, None, format!("virials per particle are not known at step {step}"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn terms_by_keyword() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.particles.v = vec![[1.0, 2.0, 3.0], [9.0; 3]].into();
        b.world.particles.mask[1] = 0;
        b.world.tally.clear(0, true, false, 2);
        b.world.tally.clear_atom_virial(true, 2);
        b.world.tally.atom_virial[0] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        b.world.tally.atom_fixes[0][5] = 100.0;
        // m = 2, by hand.
        for (words, xx, yz) in [
            ("NULL", -3.0, -118.0),
            ("NULL ke", -2.0, -12.0),
            ("NULL pair", -1.0, -6.0),
            ("NULL fix bond", 0.0, -100.0),
            ("NULL virial", -1.0, -106.0),
        ] {
            let c = b.compute(&StressAtom, words).unwrap();
            let slot = b.evaluate(&*c).unwrap();
            assert_eq!((slot.atom[0], slot.atom[5], slot.atom[6]), (xx, yz, 0.0), "{words}");
        }
        for words in ["", "T", "NULL pairs"] {
            assert!(b.compute(&StressAtom, words).is_err(), "{words}");
        }
        b.world.tally.clear(0, true, false, 2);
        let c = b.compute(&StressAtom, "NULL").unwrap();
        assert!(b.evaluate(&*c).is_err());
    }
}

//! fix external: forces from the host program of the session.

use super::{Facts, Fix, FixStyle, MODIFY, Minimizing, Virial, options};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::matter::{Chosen, change_forces, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Form, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{COLUMNS, F, FACTS, MASK, SLOTS, TAG, TALLY, X};
use perigrain_world::outside::{Each, HostCall, HostValues};
use perigrain_world::{GroupId, Key, Numbers, Outside, Registration, Under, Vectors, World};
use std::sync::Arc;

/// Forces and virials from the host.
static VALUES: Registration = Registration::moved("external/", "", Under::Anew);

/// The style.
pub struct External;

/// The name under which the world stores a fix's forces and the host program finds them.
pub fn name(id: &str) -> String {
    format!("external/{id}")
}

/// Where the facts of a scene have the host program of the fix with this column of forces.
pub fn program(forces: Vectors) -> Key<Arc<dyn Outside>> {
    forces.of()
}

/// The columns of the per-particle values from the host: energies, and virials as two vectors.
#[derive(Clone, Copy)]
pub struct Kept {
    energy: Numbers,
    virial: [Vectors; 2],
}

impl Kept {
    /// The columns of a fix.
    pub fn new(id: &str) -> Self {
        let key = Key::<()>::new(&name(id));
        let virial = ["/normal", "/shear"].map(|part| VALUES.key(&format!("{key}{part}")));
        Self { energy: key.with("/energy"), virial }
    }

    fn names(self) -> [&'static str; 3] {
        let [normal, shear] = self.virial;
        [self.energy.text(), normal.text(), shear.text()]
    }

    /// Stores the values; those beyond the last particle are ignored.
    ///
    /// # Errors
    /// Fewer values than particles.
    pub fn keep(self, w: &mut World, id: &str, each: Each) -> Result<()> {
        let n = w.n();
        let lengths = [each.energy.as_ref().map(Vec::len), each.virial.as_ref().map(Vec::len)];
        if let Some(few) = lengths.into_iter().flatten().find(|length| *length < n) {
            let text = format!("fix external `{id}` has values for {few} particles, and there are {n}");
            return Err(Diagnostic::error(Code::OUTSIDE, None, text).into());
        }
        if let Some(energy) = each.energy {
            w.columns.scalar(self.energy, n).copy_from_slice(&energy[..n]);
        }
        if let Some(virial) = each.virial {
            for (part, key) in self.virial.into_iter().enumerate() {
                let three = |v: &[f64; 6]| [v[3 * part], v[3 * part + 1], v[3 * part + 2]];
                *w.columns.vector(key, n) = virial[..n].iter().map(three).collect();
            }
        }
        Ok(())
    }

    fn remove(self, w: &mut World) {
        w.columns.remove(self.energy);
        self.virial.into_iter().for_each(|key| w.columns.remove(key));
    }

    /// Adds energies and virials where requested.
    fn add(self, w: &mut World, (energy, virial): (bool, bool)) {
        let World { columns, tally, .. } = w;
        if let Some(own) = columns.get_scalar(self.energy).filter(|_| energy) {
            tally.fix_atom.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        for (part, key) in self.virial.into_iter().enumerate() {
            let Some(own) = columns.get_vector(key).filter(|_| virial) else { continue };
            for (sum, own) in tally.atom_fixes.iter_mut().zip(own) {
                (0..3).for_each(|k| sum[3 * part + k] += own[k]);
            }
        }
    }
}

impl Style for External {
    fn name(&self) -> &'static str {
        "external"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed(MODIFY, Options::GRAMMAR)] },
            ),
            summary: "Adds forces that a program which hosts the run gives, such as a script in Python.",
            text: "Forces stay with their particles until they are written anew; those of new particles are 0. In \
                   minimizations the function is called at every evaluation and must say the energy of its forces. \
                   Forces and functions do not come back from a restart file. In a terminal no program hosts the run: \
                   `pf/array` adds nothing there, and `pf/callback` is refused where it would be called.\n\n\
                   Scalar (extensive): the energy the program says (`fix_external_set_energy_global`), part of the \
                   potential energy unless `fix_modify ID energy no`. The virial it says \
                   (`fix_external_set_virial_global`) counts in pressures, unless `fix_modify ID virial no`. \
                   `fix_modify ID vector N`: the fix offers N values of the program (intensive), which \
                   `fix_external_set_vector` sets.\n\n\
                   Energies and virials that it says of each particle (`fix_external_set_energy_peratom`, \
                   `fix_external_set_virial_peratom`) count in `compute pe/atom` and `stress/atom`, in no sum; they \
                   stay with their particles as forces do (LAMMPS forgets them with every step).",
            example: "fix probe grains external pf/array 1",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "mode")]
    mode: Mode,
    /// The forces are added to the particles of the group at every step that Napply divides [steps].
    #[word(name = "Napply", what = "how many steps lie between two additions of the forces", from = 1)]
    apply: i64,
}

/// Where the forces come from.
#[derive(Words)]
#[word(what = "mode")]
enum Mode {
    /// At every step that Ncall divides, in the setup of a run too, the function that the program has set
    /// (`lmp.set_fix_external_callback(ID, function, caller)`) is called with the step, how many particles there are, their ids,
    /// places and forces; it leaves the forces.
    #[word("pf/callback")]
    Callback(
        #[word(name = "Ncall", what = "how many steps lie between two calls of the function", from = 1)] i64,
    ),
    /// The program writes the forces between commands (`lmp.numpy.fix_external_get_force(ID)`).
    #[word("pf/array")]
    Array,
}

/// The options of `fix_modify`.
#[derive(Words)]
struct Options {
    #[word(flatten)]
    counts: Virial,
    /// How many values of the program the fix offers.
    #[word(keyword, name = "N", with = length, kind = Kind::Whole)]
    vector: Option<usize>,
}

fn length(args: &mut Args, _: &BuildCx) -> Result<usize> {
    match args.eat("0") {
        true => Ok(0),
        false => args.count("the number of values that the program sets", 4.0 * size_of::<f64>() as f64),
    }
}

impl FixStyle for External {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { mode, apply } = read(args, cx)?;
        let call = match mode {
            Mode::Callback(every) => Some(every),
            Mode::Array => None,
        };
        let key = VALUES.key(&name(cx.id));
        let (id, kept) = (cx.id.to_string(), Kept::new(cx.id));
        Ok(Box::new(Declared { id, group: cx.group, key, kept, call, apply, virial: true, length: 0 }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    key: Vectors,
    kept: Kept,
    /// Steps between calls, if the host is called.
    call: Option<i64>,
    /// Steps between applications of the forces.
    apply: i64,
    /// `fix_modify virial`.
    virial: bool,
    /// `fix_modify vector`.
    length: usize,
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        let n = w.n();
        w.columns.vector(self.key, n);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.columns.remove(self.key);
        self.kept.remove(w);
        w.facts.remove(program(self.key));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (span, own) = (cx.span(), self.clone());
        let chosen = Chosen::new(cx.world(), self.group, None, span)?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let counted = cx.energy_fixes().contains(&format!("f_{}", self.id));
        let access = Needs::new().read(X | MASK | FACTS).add(F | TALLY).write(SLOTS);
        let access = match self.call {
            Some(_) => access.read(TAG).write(COLUMNS),
            None => access.read(COLUMNS),
        };
        let access = access.only(&[self.key.text()]).only(&self.kept.names());
        let op = StepOp::new(format!("fix {} external", self.id), Stage::PostForce, access, move |w, t| {
            let outside = w.facts.get(program(own.key)).cloned();
            let due = |every: i64| t.step % every == 0;
            if own.call.is_some_and(due) && !t.unchanged {
                own.call_program(w, t, outside.as_deref()).map_err(|e| e.at(span))?;
            }
            if due(own.apply) && !t.unchanged {
                change_forces::<0>(w, &chosen, |w, i, f| {
                    if let Some(added) = w.columns.get_vector(own.key).and_then(|all| all.get(i)) {
                        (0..3).for_each(|d| f[d] += added[d]);
                    }
                    []
                });
            }
            let mut values = outside.map_or_else(HostValues::default, |program| program.values());
            own.kept.add(w, (t.atom_energy && counted, t.atom_virial && own.virial));
            if own.virial && t.virial {
                (0..6).for_each(|k| w.tally.fixes[k] += values.virial[k]);
            }
            values.vector.resize(own.length, 0.0);
            publish(w, slot, t, values.energy, &values.vector);
            Ok(())
        });
        Ok(vec![op.boxed()])
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let Options { counts, vector } = options(args, cx)?;
        self.virial = counts.virial.unwrap_or(self.virial);
        self.length = vector.unwrap_or(self.length);
        Ok(())
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: self.length, scalar_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts {
            minimizing: Minimizing::Acts,
            has_level: true,
            has_energy: true,
            adds_energy: true,
            ..Facts::default()
        }
    }
}

impl Declared {
    /// Calls the host program to write forces.
    fn call_program(&self, w: &mut World, t: &Tick, outside: Option<&dyn Outside>) -> Result<()> {
        let n = w.n();
        let mut f = std::mem::take(w.columns.vector(self.key, n));
        let p = &w.particles;
        let call = HostCall { step: t.step, ids: &p.tag, x: &p.x, f: &mut f };
        let answer = outside.and_then(|program| program.call(call));
        *w.columns.vector(self.key, n) = f;
        match answer {
            Some(Ok(())) => match outside {
                Some(program) => self.kept.keep(w, &self.id, program.each()),
                None => Ok(()),
            },
            Some(Err(words)) => {
                let text =
                    format!("the function of fix external `{}` failed in step {}: {words}", self.id, t.step);
                Err(Diagnostic::error(Code::OUTSIDE, None, text).into())
            }
            None => {
                let text = format!("fix external `{}` has no function to call", self.id);
                let help = format!(
                    "a Python program gives one before the run: `lmp.set_fix_external_callback(\"{}\", function)`",
                    self.id
                );
                Err(Diagnostic::error(Code::OUTSIDE, None, text).help(help).into())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;
    use std::sync::Arc;

    /// Adds the force (step, k, 0) to the particle with ID k, and fails in step 3.
    #[derive(Debug)]
    struct Program;

    impl Outside for Program {
        fn call(&self, call: HostCall<'_>) -> Option<std::result::Result<(), String>> {
            for (f, id) in call.f.iter_mut().zip(call.ids) {
                *f = [call.step as f64 + f[0], f64::from(*id), 0.0];
            }
            Some(if call.step == 3 { Err("three".into()) } else { Ok(()) })
        }

        fn values(&self) -> HostValues {
            HostValues { energy: 2.5, virial: [1.0; 6], vector: vec![7.0] }
        }

        fn each(&self) -> Each {
            let virial = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
            Each { energy: Some(vec![0.5, 1.5, 9.0]), virial: Some(vec![virial; 2]) }
        }
    }

    fn at_step(b: &mut Bench, ops: &mut [Box<dyn Op>], step: i64) -> Result<()> {
        b.world.particles.f = vec![[1.0, 0.0, 0.0]; 2].into();
        b.world.clock.step = step;
        b.stage(ops, Stage::PostForce)
    }

    #[test]
    fn forces_are_requested_and_added_at_their_intervals() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0; 3]]);
        let mut fix = b.fix(&External, "pf/callback 2 1").unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        let alone = at_step(&mut b, &mut ops, 2).unwrap_err();
        assert!(alone.to_string().contains("no function to call"), "{alone}");
        b.world.facts.insert(program(Key::new(&name("f"))), Arc::new(Program));
        at_step(&mut b, &mut ops, 2).unwrap();
        assert_eq!(b.world.particles.f, [[3.0, 1.0, 0.0], [3.0, 2.0, 0.0]]);
        // No call in step 3, which would fail: the forces of step 2 are applied again.
        at_step(&mut b, &mut ops, 3).unwrap();
        assert_eq!(b.world.particles.f, [[3.0, 1.0, 0.0], [3.0, 2.0, 0.0]]);
        at_step(&mut b, &mut ops, 4).unwrap();
        assert_eq!(b.world.particles.f[1], [7.0, 2.0, 0.0]);
        assert_eq!(b.slot_of("f_f").scalar, 2.5);
        fix.remove(&mut b.world);
        assert!(b.world.columns.names().is_empty() && b.world.facts.is_empty());
        fix = b.fix(&External, "pf/callback 1 1").unwrap();
        fix.declare(&mut b.world).unwrap();
        b.world.facts.insert(program(Key::new(&name("f"))), Arc::new(Program));
        let mut ops = b.seal(&*fix).unwrap();
        let failed = at_step(&mut b, &mut ops, 3).unwrap_err();
        assert!(failed.to_string().contains("failed in step 3: three"), "{failed}");
    }

    #[test]
    fn arrays_wait_for_their_steps_and_mistakes_are_named() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0; 3]]);
        let fix = b.fix(&External, "pf/array 2").unwrap();
        fix.declare(&mut b.world).unwrap();
        b.world.columns.vector(Key::new(&name("f")), 2)[1] = [0.0, 0.0, 5.0];
        let mut ops = b.seal(&*fix).unwrap();
        at_step(&mut b, &mut ops, 1).unwrap();
        assert_eq!(b.world.particles.f, [[1.0, 0.0, 0.0]; 2]);
        at_step(&mut b, &mut ops, 2).unwrap();
        assert_eq!(b.world.particles.f, [[1.0, 0.0, 0.0], [1.0, 0.0, 5.0]]);
        assert!(fix.facts(&b.world).adds_energy);
        for words in ["", "pf/array", "pf/array 0", "pf/callback 1", "pf/callback 0 1", "pf/file 1"] {
            assert!(b.fix(&External, words).is_err(), "{words}");
        }
    }

    #[test]
    fn energies_and_virials_of_particles_stay_until_they_are_set_anew() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0; 3]]);
        let fix = b.fix(&External, "pf/callback 2 2").unwrap();
        fix.declare(&mut b.world).unwrap();
        b.world.facts.insert(program(Key::new(&name("f"))), Arc::new(Program));
        let kept = Kept::new("f");
        let few = kept.keep(&mut b.world, "f", Each { energy: Some(vec![1.0]), virial: None }).unwrap_err();
        assert!(few.to_string().contains("values for 1 particles, and there are 2"), "{few}");
        kept.keep(&mut b.world, "f", Program.each()).unwrap();
        b.world.tally.clear(0, true, true, 2);
        b.world.tally.clear_atom_virial(true, 2);
        kept.add(&mut b.world, (true, true));
        assert_eq!(b.world.tally.fix_atom, [0.5, 1.5]);
        assert_eq!(b.world.tally.atom_fixes[1], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        kept.add(&mut b.world, (false, false));
        assert_eq!(b.world.tally.fix_atom, [0.5, 1.5]);
        fix.remove(&mut b.world);
        assert!(b.world.columns.names().is_empty());
    }
}

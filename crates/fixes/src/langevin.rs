//! fix langevin: friction and random forces of a heat bath.

use super::{Facts, Fix, FixStyle, MODIFY, Minimizing, options};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::rng::Marsaglia;
use perigrain_base::math::vec3::{Vec3, dot};
use perigrain_lang::{Args, Param, RefKind, ValueRef, Word};
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::ledger::COUPLED;
use perigrain_styles::matter::{Masses, check_masses, publish, sum};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{
    Alternative, At, Form, Kind, PerAtom, Positive, Syntax, Types, Value, Words, read,
};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style};
use perigrain_world::field::{
    COLUMNS, F, KIND, MASK, MASS, MEMO, OMEGA, RADIUS, RANK, SLOTS, TORQUE, TYPE_MASS, V,
};
use perigrain_world::{GroupId, Key, Numbers, Registration, SlotId, Under, Vectors, World};

/// The energy taken from particles.
static TAKEN: Registration = Registration::role("langevin/", "/coupled", &COUPLED);
/// Columns of the forces and torques of a step.
static FORCES: Registration = Registration::moved("langevin/", "", Under::Anew);

/// The style.
pub struct Langevin;

impl Style for Langevin {
    fn name(&self) -> &'static str {
        "langevin"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed(MODIFY, Options::GRAMMAR)] },
            ),
            summary: "Friction and random forces of a bath of some temperature.",
            text: "f ← f − m/damp v + √(24 k_B T m/(damp Δt)) (u − ½), with u uniform between 0 and 1 for each particle \
                   and direction. T goes from Tstart to Tstop during a run (`run … start stop`). Something else must \
                   move the particles (`fix nve/sphere`), and damping contacts are a second bath of temperature 0. Not \
                   in minimizations.\n\n\
                   Scalar (extensive): with `tally yes` the energy taken from the motion of translation so far, else 0; \
                   it is the thermo keyword `ecouple`, and `econserve` holds it.\n\n\
                   Random numbers are those of LAMMPS on one process: particles draw in the order of their creation \
                   (LAMMPS sorts them now and then: `atom_modify sort 0 0`). The stream continues from run to run, also \
                   through a restart file, and a run cut in two is one run; LAMMPS draws once more and begins to tally \
                   anew when a run begins (`-compat lammps`), and restart files do not hold its streams.\n\n\
                   `fix_modify ID temp` with a temperature that takes a flow away is refused.",
            example: "fix bath grains langevin 300.0 300.0 1.0e-3 48279 omega yes",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&TAKEN, &FORCES] }
    }
}

#[derive(Words)]
struct Line {
    /// The temperature Tstart [temperature]: a number, or `v_name` of an equal- or atom-style variable, evaluated each step.
    #[word(name = "Tstart", what = "the temperature Tstart")]
    start: At<PerAtom>,
    /// The temperature Tstop [temperature]; without meaning where Tstart is a variable.
    #[word(name = "Tstop", what = "the temperature Tstop", non_negative)]
    stop: f64,
    /// The time of damping [time].
    #[word(positive)]
    damp: f64,
    /// The seed.
    #[word(from = 1)]
    seed: At<i64>,
    /// The same for the spins of spheres: the torque is −(10/3) I/damp ω + √(80 k_B T I/(damp Δt)) (u − ½), I being the moment of
    /// inertia.
    #[word(keyword, what = "omega", shown = "no")]
    omega: Option<At<bool>>,
    /// The time of damping is damp·ratio for a type or range of types.
    #[word(keyword, name = "type ratio", what = "the ratio of times of damping")]
    scale: Vec<(Types, Positive)>,
    /// Whether the energy taken is counted.
    #[word(keyword, what = "tally", default = false)]
    tally: bool,
    /// Whether the mean of the random forces is taken away from each.
    #[word(keyword, what = "zero", default = false)]
    zero: bool,
    /// There are no ellipsoids here: write `omega yes`.
    #[word(keyword, placed)]
    angmom: Option<At<No>>,
    /// LAMMPS gives it up for a fix of its own.
    #[word(keyword, placed)]
    gjf: Option<At<No>>,
}

/// `no`, or whatever else stands behind what is not here.
#[derive(PartialEq)]
struct No(bool);

impl Value for No {
    const KIND: Kind = Kind::Choice(&[Alternative { word: "no", about: "", parts: &[] }]);
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let no = args.eat("no");
        if !no && !args.at_keyword() {
            args.next();
        }
        Ok(Self(no))
    }
}

/// The options of `fix_modify`.
#[derive(Words)]
struct Options {
    /// A temperature, without effect: one that takes a flow away is refused.
    #[word(keyword, name = "C", what = "the ID of a temperature", kind = Kind::Compute)]
    temp: Option<Word>,
}

impl FixStyle for Langevin {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        if let Some(angmom) = line.angmom.filter(|angmom| !angmom.value.0) {
            let text = "`angmom` is for ellipsoids: write `omega yes`";
            return fail(Code::NOT_SUPPORTED, angmom.span, text);
        }
        if let Some(gjf) = line.gjf.filter(|gjf| !gjf.value.0) {
            let text = "`gjf` of fix langevin, which LAMMPS gives up for a fix of its own";
            return fail(Code::NOT_SUPPORTED, gjf.span, text);
        }
        let start = temperature(line.start)?;
        let Some(seed) = u32::try_from(line.seed.value).ok().filter(|s| *s <= Marsaglia::MAX_SEED) else {
            let text = format!("seeds go from 1 to {}", Marsaglia::MAX_SEED);
            return fail(Code::BAD_VALUE, line.seed.span, text);
        };
        let mut ratios = vec![1.0; cx.world.types];
        for (Types(lo, hi), ratio) in line.scale {
            (lo..=hi).for_each(|k| ratios[usize::from(k) - 1] = ratio.0);
        }
        let omega = omega(line.omega, cx)?;
        let (stop, damp, tally, zero) = (line.stop, line.damp, line.tally, line.zero);
        if zero && tally {
            let text = "the energy that `tally` counts lacks what `zero` takes away";
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, cx.span, text));
        }
        let (id, group) = (cx.id.to_string(), cx.group);
        let key: Numbers = Key::new(&format!("langevin/{id}"));
        let columns = ["", "/torque"].map(|what| FORCES.key(&format!("{key}{what}")));
        let coupled = TAKEN.key(key.text());
        Ok(Box::new(Declared {
            id,
            key,
            coupled,
            columns,
            group,
            start,
            stop,
            damp,
            seed,
            ratios,
            omega,
            tally,
            zero,
        }))
    }
}

/// Refuses temperatures below zero.
fn temperature(start: At<PerAtom>) -> Result<Param> {
    match start.value.0 {
        Param::Number(t) if t < 0.0 => {
            fail(Code::BAD_VALUE, start.span, "a temperature must not be negative")
        }
        start => Ok(start),
    }
}

/// Whether the spins feel the bath; refuses that for particles without spin.
fn omega(named: Option<At<bool>>, cx: &BuildCx) -> Result<bool> {
    let Some(omega) = named.filter(|omega| omega.value) else { return Ok(false) };
    if !cx.world.particles.style.sphere {
        let d = Diagnostic::error(Code::WRONG_ORDER, omega.span, "only spheres spin");
        return Err(d.help("put `atom_style sphere` at the top of the deck, or leave `omega` out").into());
    }
    Ok(true)
}

#[derive(Clone)]
struct Declared {
    id: String,
    /// Key of the state that persists between steps.
    key: Numbers,
    /// Key of the energy exchanged.
    coupled: Numbers,
    /// Columns of the forces and torques added last.
    columns: [Vectors; 2],
    group: GroupId,
    start: Param,
    stop: f64,
    damp: f64,
    seed: u32,
    /// Damping times by type − 1, as multiples of `damp`.
    ratios: Vec<f64>,
    omega: bool,
    tally: bool,
    zero: bool,
}

/// State between steps: energy exchanged so far, power at the last step, and the random stream.
struct Account {
    energy: f64,
    power: f64,
    stream: Marsaglia,
}

impl Account {
    fn load(w: &World, key: Numbers, seed: u32) -> Self {
        let kept = w.memo.get(key).and_then(|list| {
            let (&[energy, power], stand) = list.split_first_chunk()?;
            Some(Self { energy, power, stream: Marsaglia::resumed(stand)? })
        });
        kept.unwrap_or_else(|| Self { energy: 0.0, power: 0.0, stream: Marsaglia::new(seed) })
    }

    fn store(&self, w: &mut World, key: Numbers) {
        let list = [self.energy, self.power].into_iter().chain(self.stream.stand()).collect();
        w.memo.insert(key, list);
    }
}

/// The particles of a group in their order of creation.
fn by_creation(w: &World, group: GroupId) -> Vec<usize> {
    let (p, bit) = (&w.particles, group.bit());
    let mut members: Vec<usize> = (0..p.len()).filter(|&i| p.mask[i] & bit != 0).collect();
    if !p.rank.is_empty() {
        members.sort_unstable_by_key(|&i| p.rank[i]);
    }
    members
}

impl Declared {
    /// The names of its state.
    fn names(&self) -> [&'static str; 4] {
        let [forces, torques] = self.columns;
        [self.key.text(), self.coupled.text(), forces.text(), torques.text()]
    }

    /// √T for each of these particles.
    fn roots(&self, w: &World, members: &[usize], start: Reading, span: Span) -> Result<Vec<f64>> {
        if let Param::Number(start) = self.start {
            let c = &w.clock;
            let (done, all) = ((c.step - c.start) as f64, (c.stop - c.start) as f64);
            let part = if done == 0.0 { 0.0 } else { done / all };
            let t: f64 = start + part * (self.stop - start);
            return Ok(vec![t.sqrt(); members.len()]);
        }
        let roots: Vec<f64> = members.iter().map(|&i| start.atom(w, i).sqrt()).collect();
        match roots.iter().position(|r| r.is_nan()) {
            None => Ok(roots),
            Some(k) => {
                let t = start.atom(w, members[k]);
                fail(
                    Code::BAD_VALUE,
                    span,
                    format!("the temperature has become {t}: it must not be negative"),
                )
            }
        }
    }

    /// Forces on these particles by inertia: `push` √m and `drag` m times the velocity, each divided by the
    /// damping time.
    fn bath(
        &self,
        w: &World,
        members: &[(usize, f64, f64)],
        stream: &mut Marsaglia,
        rotation: bool,
    ) -> Vec<Vec3> {
        let (units, p) = (w.settings.units.constants(), &w.particles);
        let by = if rotation { 80.0 } else { 24.0 };
        let push = (by * units.boltz / self.damp / w.clock.dt / units.mvv2e).sqrt() / units.ftm2v;
        let drag = if rotation { 10.0 / 3.0 } else { 1.0 } / self.damp / units.ftm2v;
        let ratio = |i: usize| self.ratios[usize::from(p.kind[i]) - 1];
        let mut forces: Vec<Vec3> = members
            .iter()
            .map(|&(i, inertia, root)| {
                let size = inertia.sqrt() * push / ratio(i).sqrt() * root;
                [0; 3].map(|_| size * (stream.uniform() - 0.5))
            })
            .collect();
        if self.zero && !rotation {
            let mut mean = [0.0; 3];
            forces.iter().for_each(|f| (0..3).for_each(|d| mean[d] += f[d]));
            let mean = mean.map(|a| a / forces.len() as f64);
            forces.iter_mut().for_each(|f| (0..3).for_each(|d| f[d] -= mean[d]));
        }
        for (f, &(i, inertia, _)) in forces.iter_mut().zip(members) {
            let v = if rotation { p.omega[i] } else { p.v[i] };
            (0..3).for_each(|d| f[d] -= inertia * drag / ratio(i) * v[d]);
        }
        forces
    }

    /// Draws the random numbers and adds forces and torques.
    fn act(&self, w: &mut World, t: &Tick, start: Reading, span: Span) -> Result<()> {
        if t.unchanged && !w.settings.lammps() {
            return Ok(());
        }
        let members = by_creation(w, self.group);
        let roots = self.roots(w, &members, start, span)?;
        let mut account = Account::load(w, self.key, self.seed);
        let masses = Masses::of(w);
        let with = |inertia: &dyn Fn(usize) -> f64| -> Vec<(usize, f64, f64)> {
            members.iter().zip(&roots).map(|(&i, root)| (i, inertia(i), *root)).collect()
        };
        let moved = with(&|i| masses.get(i));
        let mut parts = vec![(self.bath(w, &moved, &mut account.stream, false), false)];
        if self.omega {
            let turned = with(&|i| 0.4 * w.particles.mass[i] * w.particles.radius[i] * w.particles.radius[i]);
            parts.push((self.bath(w, &turned, &mut account.stream, true), true));
        }
        for (forces, rotation) in parts {
            self.add(w, t, (&members, &forces), rotation);
        }
        account.store(w, self.key);
        Ok(())
    }

    /// Adds forces or torques; where LAMMPS draws a second time, replaces those of the step before.
    fn add(&self, w: &mut World, t: &Tick, (members, forces): (&[usize], &[Vec3]), rotation: bool) {
        let (n, kept) = (w.n(), self.tally || w.settings.lammps());
        let column = self.columns[usize::from(rotation)];
        let mut own = if kept { std::mem::take(w.columns.vector(column, n)) } else { vec![] };
        let p = &mut w.particles;
        let to = if rotation { &mut p.torque } else { &mut p.f };
        if t.unchanged {
            to.iter_mut().zip(&own).for_each(|(f, last)| (0..3).for_each(|d| f[d] -= last[d]));
        }
        own.fill([0.0; 3]);
        for (&i, force) in members.iter().zip(forces) {
            (0..3).for_each(|d| to[i][d] += force[d]);
            if kept {
                own[i] = *force;
            }
        }
        if kept {
            *w.columns.vector(column, n) = own;
        }
    }

    /// Accumulates the energy of the step by the trapezoidal rule.
    fn count(&self, w: &mut World, t: &Tick, slot: SlotId) {
        let mut account = Account::load(w, self.key, self.seed);
        let (forces, p) = (w.columns.get_vector(self.columns[0]).unwrap_or(&[]), &w.particles);
        let [power] = sum::<1>(w, self.group, |i| [forces.get(i).map_or(0.0, |f| dot(*f, p.v[i]))]);
        if !t.setup {
            account.energy += 0.5 * w.clock.dt * (account.power + power);
        } else if w.settings.lammps() {
            account.energy = 0.0;
        }
        if !t.setup || !t.unchanged || w.settings.lammps() {
            account.power = power;
        }
        account.store(w, self.key);
        w.memo.insert(self.coupled, vec![-account.energy]);
        publish(w, slot, t, -account.energy, &[]);
    }
}

impl Fix for Declared {
    fn remove(&self, w: &mut World) {
        w.memo.remove(self.key);
        self.columns.iter().for_each(|column| w.columns.remove(*column));
        w.memo.remove(self.coupled);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        check_masses(cx.world(), span)?;
        let p = &cx.world().particles;
        let point = |i: usize| p.mask[i] & self.group.bit() != 0 && p.radius[i] <= 0.0;
        if self.omega && (0..p.len()).any(point) {
            return fail(Code::CONFLICT, span, "`omega yes` needs particles with a radius");
        }
        let start = cx.param(&self.start, Stage::PostForce, &When::Always)?;
        let slot = cx.slot(&format!("f_{}", self.id));
        let me = self.clone();
        let name = format!("fix {} langevin", self.id);
        let access = Needs::new()
            .read(V | OMEGA | MASS | RADIUS | KIND | MASK | RANK | MEMO | TYPE_MASS | SLOTS)
            .add(F | TORQUE)
            .keep(MEMO | COLUMNS)
            .only(&self.names());
        let push = StepOp::new(name.clone(), Stage::PostForce, access, move |w, t| me.act(w, t, start, span));
        let access = Needs::new().read(V | MASK | MEMO | COLUMNS).write(SLOTS).keep(MEMO).only(&self.names());
        let me = self.clone();
        let count = StepOp::new(name, Stage::EndOfStep, access, move |w, t| {
            match me.tally {
                true => me.count(w, t, slot),
                false => publish(w, slot, t, 0.0, &[]),
            }
            Ok(())
        });
        Ok(vec![push.boxed(), count.in_setup(true).boxed()])
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let Some(word) = options::<Options>(args, cx)?.temp else { return Ok(()) };
        let r = ValueRef { kind: RefKind::Compute, name: word.text.clone(), index: vec![], span: word.span };
        cx.value(&r, false)?;
        if cx.shape(&r).is_some_and(|s| s.flow) {
            let text = "fix langevin with a temperature that takes a flow away";
            return fail(Code::NOT_SUPPORTED, word.span, text);
        }
        let text = "without effect: this temperature takes nothing away from velocities";
        cx.note(Diagnostic::note(Code::NO_EFFECT, word.span, text));
        Ok(())
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Absent, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // m = 2, damp 4, Δt 0.005, k_B = 1 (lj): drag m/damp v = v/2, pushes √(24 · 2 · T/(4 · 0.005)) (u − ½).
    #[test]
    fn drag_and_pushes_by_hand() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0; 3], [2.0; 3]]);
        b.world.particles.v = vec![[1.0, 0.0, -2.0]; 3].into();
        b.world.particles.f = vec![[0.0; 3]; 3].into();
        b.world.particles.mask[1] = 0;
        let fix = b.fix(&Langevin, "1.5 1.5 4 12345").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        let mut stream = Marsaglia::new(12345);
        let push = (24.0f64 * 2.0 * 1.5 / (4.0 * 0.005)).sqrt();
        let f = &b.world.particles.f;
        assert_eq!(f[1], [0.0; 3]);
        for i in [0, 2] {
            for (d, v) in [1.0, 0.0, -2.0].into_iter().enumerate() {
                let expected = push * (stream.uniform() - 0.5) - 0.5 * v;
                // A few roundings.
                assert!((f[i][d] - expected).abs() < 1e-12, "{i} {d}");
            }
        }
        fix.remove(&mut b.world);
        assert!(b.world.memo.is_empty());
    }

    #[test]
    fn mistakes_are_named() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        b.equal.insert("n".into(), -1.0);
        for words in [
            "",
            "1 1 1",
            "-1 1 1 5",
            "1 1 0 5",
            "1 1 1 0",
            "1 1 1 1000000000",
            "v_q 1 1 5",
            "1 v_n 1 5",
            "1 1 1 5 omega yes",
            "1 1 1 5 scale 2 1",
            "1 1 1 5 scale 1 0",
            "1 1 1 5 angmom 3.3",
            "1 1 1 5 gjf vhalf",
            "1 1 1 5 zeros yes",
        ] {
            assert!(b.fix(&Langevin, words).is_err(), "{words}");
        }
        assert!(b.fix(&Langevin, "1 1 1 5 angmom no gjf no omega no").is_ok());
        let fix = b.fix(&Langevin, "v_n 1 1 5").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        assert!(b.stage(&mut ops, Stage::PostForce).is_err());
    }
}

//! fix adapt: sphere sizes and force coefficients that follow variables.

mod coefficients;

use super::window::forget;
use super::{Fix, FixStyle};
use coefficients::{Follows, OfBonds, OfPairs};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Param, RefKind, ValueRef, Word};
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::words::{
    Alternative, At, Grammar, Kind, Part, Placeholder, Syntax, Value, Words, read,
};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Style};
use perigrain_world::field::{COLUMNS, LISTS, MASK, MASS, MEMO, RADIUS, SLOTS};
use perigrain_world::{GroupId, Key, Numbers, World};
use std::f64::consts::PI;

/// The style.
pub struct Adapt;

impl Style for Adapt {
    fn name(&self) -> &'static str {
        "adapt"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Lets the diameter of spheres or coefficients of forces follow variables during a run.",
            text: "The variables are evaluated in the setup of a run and at multiples of N. They are equal-style, and \
                   for `atom` atom-style as well (LAMMPS 22Jul2025 has none of these): a value for each particle. \
                   Several changes can be written one after another; of `atom`, one. `kspace` and `atom charge` are \
                   refused.\n\n\
                   A particle that comes later begins with the factor that is in force, and with an atom-style variable \
                   with 1. Neighbour lists are made anew before particles have grown by a quarter of the skin (LAMMPS' \
                   are not, nor under `compat lammps`: there the skin must be as wide as what they grow by). After \
                   `reset yes` LAMMPS' masses are wrong in the next run; perigrain's are those of before.\n\n\
                   There are the coefficients `k r0` of bond style harmonic (as in LAMMPS), and in addition `s00 alpha` \
                   of all peridynamic styles, `c` of the bond-based ones, `k gamma` of pair style bpm/spring, and `a` \
                   of pair style soft (as in LAMMPS); a sub-style of `hybrid` is named by its own name. A new \
                   `pair_coeff` or `bond_coeff` ends what a fix has made of its coefficients.",
            example: "variable d equal ramp(0.001,0.0011)\nfix swell ball adapt 1 atom diameter v_d reset yes",
        }
    }
}

#[derive(Words)]
struct Line {
    /// Acts at multiples of N [steps]; 0: in the setup of runs only.
    #[word(name = "N", what = "the number of steps N", from = 0)]
    every: i64,
    #[word(name = "attribute", least = 1)]
    attributes: Vec<At<Supported>>,
    /// Whether values are factors: on the diameter that a particle had at first (each change multiplies the present one by the new
    /// factor over the last), or on what a coefficient was when the run began.
    #[word(keyword, default = false)]
    scale: bool,
    /// Whether what was changed is put back at the end of each run.
    #[word(keyword, default = false)]
    reset: bool,
    /// Whether the density stays, of a disc with `diameter/disc`, as LAMMPS 22Jul2025 does, and not the mass.
    #[word(keyword, default = true)]
    mass: bool,
}

/// What a variable changes.
#[derive(Words)]
#[word(what = "attribute")]
enum Attribute {
    /// The value becomes the diameter of every particle of the group.
    Atom(#[word(name = "size")] Size),
    /// The value becomes the coefficient of these types.
    Pair(#[word(name = "coefficient")] OfPairs),
    /// The value becomes the coefficient of these bond types.
    Bond(#[word(name = "coefficient")] OfBonds),
}

/// An attribute; those of LAMMPS that no style has here are refused.
struct Supported(Attribute);

/// What only LAMMPS' fix changes.
const REFUSED: [&str; 4] = ["angle", "dihedral", "improper", "kspace"];

impl Value for Supported {
    const KIND: Kind = <Attribute as Value>::KIND;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        if let Some(word) = args.peek().filter(|w| REFUSED.contains(&w.text.as_str())) {
            let text = format!("no style in perigrain has a parameter that `{}` could change", word.text);
            let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text);
            return Err(d
                .help("fix adapt changes `atom diameter`, and coefficients of `pair` and `bond` styles")
                .into());
        }
        Attribute::value(what, args, cx).map(Self)
    }
    fn begins(word: &Word) -> bool {
        Attribute::begins(word) || REFUSED.contains(&word.text.as_str())
    }
}

impl FixStyle for Adapt {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let (mut size, mut follows) = (None, vec![]);
        for At { value: Supported(attribute), span, .. } in line.attributes {
            match attribute {
                Attribute::Atom(_) if size.is_some() => {
                    let text = "this fix changes the diameter already: use another fix";
                    return fail(Code::CONFLICT, span, text);
                }
                Attribute::Atom(own) => size = Some(own),
                Attribute::Pair(OfPairs(own)) | Attribute::Bond(OfBonds(own)) => follows.push(own),
            }
        }
        Ok(Box::new(Declared {
            id: cx.id.to_string(),
            factor: Key::new(&format!("adapt/{}/factor", cx.id)),
            columns: ["radius", "mass"].map(|what| Key::new(&format!("adapt/{}/{what}", cx.id))),
            factors: Key::new(&format!("adapt/{}/factors", cx.id)),
            group: cx.group,
            every: line.every,
            size,
            follows,
            scale: line.scale,
            reset: line.reset,
            mass: line.mass,
        }))
    }
}

impl Value for Size {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::Word(Placeholder {
                name: "property",
                kind: Kind::Choice(&[
                    Alternative { word: "diameter", about: "", parts: &[] },
                    Alternative { word: "diameter/disc", about: "", parts: &[] },
                ]),
                about: "",
                unit: "",
            }),
            coefficients::VARIABLE,
        ],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let span = args.here();
        let what = args.choice("property of particles", &["diameter", "diameter/disc", "charge"])?;
        if what == "charge" {
            let text = "fix adapt does not change the charge in perigrain";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
            return Err(d.help("`set … charge` does, between runs").into());
        }
        if !cx.world.particles.style.sphere {
            let text = "the particles of this scene have no diameter";
            let d = Diagnostic::error(Code::CONFLICT, span, text);
            return Err(d.help("`atom_style sphere`, alone or in a hybrid, has it").into());
        }
        Ok(Self { variable: variable(args, true, cx)?, disc: what == "diameter/disc" })
    }
}

/// The attribute `atom diameter`.
#[derive(Clone)]
struct Size {
    variable: ValueRef,
    /// Particles are discs.
    disc: bool,
}

/// Reads `v_name`: an equal-style variable, or with `per_atom` an atom-style one as well.
fn variable(args: &mut Args, per_atom: bool, cx: &BuildCx) -> Result<ValueRef> {
    let word = args.expect("the variable v_name")?;
    match ValueRef::parse(&word.text, word.span)? {
        Some(r) if r.kind == RefKind::Variable => {
            cx.param(&Param::Ref(r.clone()), per_atom)?;
            Ok(r)
        }
        _ => fail(Code::WRONG_KIND, word.span, format!("a variable v_name is needed, not `{}`", word.text)),
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    /// Key of the factor applied by the last change.
    factor: Numbers,
    /// Columns that hold the radii and masses from before the run.
    columns: [Numbers; 2],
    /// Column of the last factor of each particle for atom-style variables; 0 before the first change.
    factors: Numbers,
    group: GroupId,
    every: i64,
    size: Option<Size>,
    follows: Vec<Follows>,
    scale: bool,
    reset: bool,
    mass: bool,
}

impl Declared {
    /// Common prefix of the keys above.
    fn key(&self) -> Numbers {
        Key::new(&format!("adapt/{}", self.id))
    }
}

impl Size {
    /// Volume of a particle of this radius; its area for discs.
    fn space(&self, r: f64) -> f64 {
        if self.disc { PI * r * r } else { 4.0 * PI / 3.0 * r * r * r }
    }
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        w.columns.remove(self.factors);
        w.memo.insert(self.factor, vec![1.0]);
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        forget(w, self.key());
        self.columns.into_iter().chain([self.factors]).for_each(|c| w.columns.remove(c));
    }

    fn particles_joined(&self, w: &mut World) {
        let [radius, mass] = self.columns;
        if !w.memo.contains(radius) {
            return;
        }
        let n = w.n();
        let mut kept = std::mem::take(w.columns.scalar(radius, n));
        let mut masses = std::mem::take(w.columns.scalar(mass, n));
        for (i, (radius, mass)) in kept.iter_mut().zip(&mut masses).enumerate() {
            if *mass == 0.0 {
                (*radius, *mass) = (w.particles.radius[i], w.particles.mass[i]);
            }
        }
        *w.columns.scalar(radius, n) = kept;
        *w.columns.scalar(mass, n) = masses;
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = if self.every == 0 { When::First } else { When::First.or(When::Every(self.every)) };
        let mut ops: Vec<Box<dyn Op>> = vec![];
        if let Some(size) = &self.size {
            let value = cx.value(&size.variable, Stage::PreForce, &when)?;
            let (name, when, size) = (format!("fix {} adapt", self.id), when.clone(), size.clone());
            ops.push(Box::new(Change { name, fix: self.clone(), when, size, value }));
        }
        for follows in &self.follows {
            ops.push(follows.op(&self.id, &when, self.scale, self.reset, cx)?);
        }
        Ok(ops)
    }
}

/// Value of a variable: one number for all particles, or one for each.
enum Values {
    One(f64),
    Each(Vec<f64>),
}

impl Values {
    fn of(reading: &Reading, w: &World) -> Self {
        if reading.per_atom() { Self::Each(reading.list(w)) } else { Self::One(reading.get(w)) }
    }

    fn get(&self, i: usize) -> f64 {
        match self {
            Self::One(value) => *value,
            Self::Each(values) => values[i],
        }
    }
}

impl Change {
    /// Refuses values that are not valid sizes.
    fn check(&self, values: &Values, w: &World, t: &Tick) -> Result<()> {
        let (p, bit) = (&w.particles, self.fix.group.bit());
        let wrong = |value: f64| !(value > 0.0 && value.is_finite());
        let (value, whose) = match values {
            Values::One(value) if wrong(*value) => (*value, String::new()),
            Values::One(_) => return Ok(()),
            Values::Each(all) => {
                let first = (0..all.len()).find(|&i| p.mask[i] & bit != 0 && wrong(all[i]));
                let Some(i) = first else { return Ok(()) };
                (all[i], format!(" for particle {}", p.tag[i]))
            }
        };
        let variable = &self.size.variable;
        let text = format!("`{variable}` is {value}{whose} at step {}: no size of particles", t.step);
        fail(Code::BAD_VALUE, variable.span, text)
    }

    /// The ratios of the new factors to the last ones; stores the new factors.
    fn factors(&self, values: &Values, w: &mut World) -> Values {
        match values {
            Values::One(new) => {
                let last = w.memo.insert(self.fix.factor, vec![*new]).and_then(|m| m.first().copied());
                Values::One(new / last.unwrap_or(1.0))
            }
            Values::Each(new) => {
                let last = w.columns.scalar(self.fix.factors, new.len());
                let ratio = |(last, new): (&mut f64, &f64)| {
                    let before = std::mem::replace(last, *new);
                    new / if before == 0.0 { 1.0 } else { before }
                };
                Values::Each(last.iter_mut().zip(new).map(ratio).collect())
            }
        }
    }
}

/// Sets the current sizes, and restores the original ones at the end.
struct Change {
    name: String,
    fix: Declared,
    when: When,
    size: Size,
    value: Reading,
}

impl Op for Change {
    fn about(&self) -> About {
        About {
            when: self.when.clone(),
            ..About::new(
                &self.name,
                Stage::PreForce,
                Needs::new().read(SLOTS | MASK).write(LISTS | RADIUS | MASS).keep(COLUMNS | MEMO),
            )
        }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.unchanged {
            return Ok(());
        }
        let values = Values::of(&self.value, w);
        let (fix, n) = (&self.fix, w.n());
        self.check(&values, w, t)?;
        let [radius, mass] = fix.columns;
        if t.setup && fix.reset && !w.memo.contains(radius) {
            let (radii, masses) = (w.particles.radius.clone(), w.particles.mass.clone());
            *w.columns.scalar(radius, n) = radii.to_vec();
            *w.columns.scalar(mass, n) = masses.to_vec();
            w.memo.insert(radius, vec![]);
        }
        let factors = fix.scale.then(|| self.factors(&values, w));
        let (p, mut most) = (&mut w.particles, 0.0_f64);
        for i in (0..n).filter(|&i| p.mask[i] & fix.group.bit() != 0) {
            let new = match &factors {
                Some(factors) => p.radius[i] * factors.get(i),
                None => 0.5 * values.get(i),
            };
            if fix.mass && p.radius[i] > 0.0 {
                let density = p.mass[i] / self.size.space(p.radius[i]);
                p.mass[i] = density * self.size.space(new);
            }
            most = most.max(new - p.radius[i]);
            p.radius[i] = new;
        }
        if fix.every > 0 && !w.settings.lammps() {
            w.rebuild.grow(most, w.settings.neighbor.skin);
        }
        Ok(())
    }
    fn finish(&mut self, w: &mut World) -> Result<()> {
        let [radius, mass] = self.fix.columns;
        if w.memo.remove(radius).is_none() {
            return Ok(());
        }
        let n = w.n();
        let (radii, masses) = (w.columns.scalar(radius, n).clone(), w.columns.scalar(mass, n).clone());
        (*w.particles.radius, *w.particles.mass) = (radii, masses);
        w.columns.remove(radius);
        w.columns.remove(mass);
        w.columns.remove(self.fix.factors);
        w.memo.insert(self.fix.factor, vec![1.0]);
        w.touch();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // A diameter of 3 instead of 1: 27 times the mass; the other particle is in no group.
    #[test]
    fn sizes_follow_and_come_back() {
        let style = AtomStyle { sphere: true, sphere_mass: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3], [5.0; 3]]);
        b.world.particles.mass = vec![2.0; 2].into();
        b.world.particles.mask[1] = 0;
        b.equal.insert("d".into(), 3.0);
        for (words, radius, mass) in [
            ("1 atom diameter v_d reset yes", 1.5, 54.0),
            ("1 atom diameter/disc v_d scale yes mass no reset yes", 1.5, 2.0),
        ] {
            let fix = b.fix(&Adapt, words).unwrap();
            fix.declare(&mut b.world).unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            let t = Tick { setup: true, ..b.tick() };
            ops[0].run(&mut b.world, &t).unwrap();
            assert_eq!(b.world.particles.radius, [radius, 0.5], "{words}");
            assert!((b.world.particles.mass[0] - mass).abs() < 1e-13, "{words}");
            ops[0].finish(&mut b.world).unwrap();
            assert_eq!((b.world.particles.radius[0], b.world.particles.mass[0]), (0.5, 2.0));
            fix.remove(&mut b.world);
            assert!(b.world.columns.names().is_empty() && b.world.memo.is_empty());
        }
        b.equal.insert("d".into(), -1.0);
        let fix = b.fix(&Adapt, "0 atom diameter v_d").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        assert!(b.stage(&mut ops, Stage::PreForce).is_err());
        for words in [
            "-1 atom diameter v_d",
            "1",
            "1 atom diameter 3",
            "1 atom diameter v_no",
            "1 atom charge v_d",
            "1 pair lj/cut epsilon 1 1 v_d",
            "1 atom diameter v_d scale maybe",
            "1 atom diameter v_d foo",
            "1 atom diameter c_d",
        ] {
            assert!(b.fix(&Adapt, words).is_err(), "{words}");
        }
    }
}

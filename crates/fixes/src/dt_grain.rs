//! fix dt/grain: compares the time step with the Rayleigh and Hertz times of grains.

use super::{Facts, Fix, FixStyle, needs_spheres};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::vec3::length;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick, When};
use perigrain_styles::common::about;
use perigrain_styles::matter::publish;
use perigrain_styles::mesh_surface::{MeshSurface, SURFACES};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Each, OneType, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::adapted::Coefficient;
use perigrain_world::field::{FACTS, KIND, MASK, MASS, MEMO, RADIUS, SLOTS, V};
use perigrain_world::{GroupId, World};
use std::f64::consts::PI;

/// The style.
pub struct DtGrain;

impl Style for DtGrain {
    fn name(&self) -> &'static str {
        "dt/grain"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Compares the time step with the Rayleigh and Hertz times of grains, and warns where it is too long.",
            text: "Not in LAMMPS. The Rayleigh time of a grain is π r √(ρ/G)/(0.1631 ν + 0.8766); the Hertz time, that of an impact with a \
                   grain like it, 2.87 (m²/(R̄ E*² v))^(1/5), where m is its whole mass, R̄ = r/2, 1/E* = 2 (1 − ν²)/E, and v the \
                   largest speed of a grain plus that speed or that of the fastest surface that moves, whichever is larger. The smallest of each over the \
                   group's grains counts. E and ν are those of `pair_coeff` of the grain's type, or those behind `material` where \
                   that law has none.\n\n\
                   Every N steps: where the step is a larger part of them than fr or fh, or grains move by more than the skin in a \
                   step, a warning at the end of the run states the worst of it, or an error ends the run. Vector (intensive): Δt over the \
                   Rayleigh time, Δt over the Hertz time, v Δt over the skin; 0 in the setup of a first run. It is for decks whose step was \
                   chosen by such parts: `fix dt/critical` sets the step from the stiffness of the contacts that are there.\n\n\
                   Source: LIGGGHTS manual, fix check/timestep/gran; the mass and the velocity of the Hertz time measured with LIGGGHTS 3.8.0.",
            example: "fix ts all dt/grain 100 0.1 0.1",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The number of steps between two looks [steps].
    #[word(name = "N", from = 1)]
    every: i64,
    /// The largest part of the Rayleigh time.
    #[word(name = "fr", positive)]
    rayleigh: f64,
    /// The largest part of the Hertz time.
    #[word(name = "fh", positive)]
    hertz: f64,
    /// The least relative velocity of an impact, for scenes whose grains will move faster [velocity].
    #[word(keyword, name = "V", non_negative, default = 0.0)]
    vmax: f64,
    /// Whether a step that is too long is warned of.
    #[word(keyword, default = true)]
    warn: bool,
    /// Whether a step that is too long ends the run.
    #[word(keyword, default = false)]
    error: bool,
    #[word(flatten)]
    materials: Each<OfType>,
}

/// The material of a type.
#[derive(Words)]
#[word(keywords)]
enum OfType {
    /// Young's modulus [pressure] and Poisson's ratio of the type T, where its law of pairs has none.
    Material {
        #[word(name = "T", what = "a type")]
        kind: OneType,
        #[word(name = "E", what = "Young's modulus", positive)]
        young: f64,
        #[word(name = "nu", what = "Poisson's ratio")]
        poisson: f64,
    },
}

impl FixStyle for DtGrain {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        needs_spheres(cx, "dt/grain")?;
        let Line { every, rayleigh, hertz, vmax, warn, error, materials } = read(args, cx)?;
        let limits = [rayleigh, hertz, 1.0];
        let given = by_type(materials, cx.world.types)?;
        let id = cx.id.to_string();
        Ok(Box::new(Declared { id, group: cx.group, every, limits, vmax, warn, error, given }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    every: i64,
    /// The largest parts of the two times and of the skin.
    limits: [f64; 3],
    vmax: f64,
    warn: bool,
    error: bool,
    /// Materials of the line.
    given: Materials,
}

/// Young's modulus and Poisson's ratio by type.
type Materials = Vec<Option<(f64, f64)>>;

/// The materials of a line, of which no type has two.
fn by_type(all: Each<OfType>, types: usize) -> Result<Materials> {
    let mut out = vec![None; types];
    for given in all.0 {
        let OfType::Material { kind, young, poisson } = given.value;
        if !(poisson > -1.0 && poisson <= 0.5) {
            return fail(Code::BAD_VALUE, given.word.span, "Poisson's ratio is above -1 and at most 0.5");
        }
        if out[usize::from(kind.0) - 1].replace((young, poisson)).is_some() {
            let text = format!("type {} has two materials", kind.0);
            return fail(Code::CONFLICT, given.word.span, &text);
        }
    }
    Ok(out)
}

impl Declared {
    /// The step over the Rayleigh time and over the Hertz time, and the way in a step over the skin; `fastest` is the speed of the
    /// fastest surface [velocity].
    fn parts(&self, w: &World, materials: &Materials, fastest: f64, dt: f64, span: Span) -> Result<[f64; 3]> {
        let (p, bit) = (&w.particles, self.group.bit());
        let speed = p.v.iter().map(|v| length(*v)).fold(0.0, f64::max);
        let v = (speed + speed.max(fastest)).max(self.vmax);
        // Forces are in units of mass times acceleration over this.
        let units = w.settings.units.constants().ftm2v;
        let (mut rayleigh, mut hertz) = (f64::INFINITY, f64::INFINITY);
        for i in (0..p.len()).filter(|&i| p.mask[i] & bit != 0 && p.radius[i] > 0.0) {
            let kind = p.kind[i];
            let Some((young, poisson)) = materials[usize::from(kind) - 1] else {
                let text = format!("fix dt/grain needs Young's modulus and Poisson's ratio of type {kind}");
                let d = Diagnostic::error(Code::INCOMPLETE, span, text);
                return Err(d
                    .help(format!("write `pair_coeff {kind} {kind} hertz/material E e nu …`, `material` behind the line, or leave the type out of the group"))
                    .into());
            };
            let (r, m) = (p.radius[i], p.mass[i]);
            let density = m / (4.0 / 3.0 * PI * r.powi(3));
            let shear = young * units / (2.0 * (1.0 + poisson));
            rayleigh = rayleigh.min(PI * r * (density / shear).sqrt() / (0.1631 * poisson + 0.8766));
            let plane = young * units / (2.0 * (1.0 - poisson * poisson));
            hertz = hertz.min(2.87 * (m * m / (0.5 * r * plane * plane * v)).powf(0.2));
        }
        let skin = w.settings.neighbor.skin;
        Ok([dt / rayleigh, dt / hertz, if v > 0.0 { v * dt / skin } else { 0.0 }])
    }

    /// What is too long, in words.
    fn judge(&self, parts: [f64; 3]) -> Option<String> {
        let of = ["the Rayleigh time", "the Hertz time", "the time in which grains cross the skin"];
        let too: Vec<String> = (0..3)
            .filter(|&k| parts[k] > self.limits[k])
            .map(|k| format!("{} times {} (at most {})", about(parts[k]), of[k], self.limits[k]))
            .collect();
        (!too.is_empty()).then(|| too.join(", "))
    }
}

/// Young's modulus and Poisson's ratio in the lines of the pair style.
fn material(kind: u16, cx: &dyn SealCx) -> Option<(f64, f64)> {
    cx.pair_styles().into_iter().find_map(|style| {
        let of = |name: &str| {
            let (style, name) = (style.to_string(), name.to_string());
            cx.coefficient(&Coefficient { bond: false, style, name, types: (kind, kind) })
        };
        of("E").zip(of("nu"))
    })
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let types = cx.world().types as u16;
        let of_line = |kind: u16| self.given.get(usize::from(kind) - 1).copied().flatten();
        let materials: Materials =
            (1..=types).map(|kind| of_line(kind).or_else(|| material(kind, cx))).collect();
        let slot = cx.slot(&format!("f_{}", self.id));
        cx.world().slots.get_mut(slot).vector.resize(3, 0.0);
        let all = cx.world().facts.get(*SURFACES);
        let surfaces: Vec<MeshSurface> = all.map_or(vec![], |all| all.values().cloned().collect());
        let names: Vec<&'static str> = surfaces.iter().flat_map(|surface| surface.keys.names()).collect();
        let needs =
            Needs::new().read(V | RADIUS | MASS | MASK | KIND | MEMO).write(SLOTS | FACTS).only(&names);
        let (me, when) = (self.clone(), When::Every(self.every));
        let mut warned = false;
        let look = move |w: &mut World, t: &Tick| {
            let fastest = surfaces.iter().map(|surface| surface.speed(w)).fold(0.0, f64::max);
            let parts = me.parts(w, &materials, fastest, t.dt, span)?;
            publish(w, slot, t, 0.0, &parts);
            let Some(text) = me.judge(parts) else { return Ok(()) };
            let text = format!("the time step is too long: at step {} it is {text}", t.step);
            let help = "shorten it by `timestep`";
            if me.error {
                return Err(Diagnostic::error(Code::UNSTABLE, span, text).help(help).into());
            }
            if me.warn && !std::mem::replace(&mut warned, true) {
                w.notes.push(Diagnostic::warning(Code::UNSTABLE, span, text).help(help));
            }
            Ok(())
        };
        let name = format!("fix {} dt/grain", self.id);
        Ok(vec![StepOp::new(name, Stage::EndOfStep, needs, look).when(when).boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts::default()
    }

    fn shape(&self) -> Shape {
        Shape { vector: 3, every: self.every, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn scene(radius: f64, speed: f64) -> Bench {
        let style = AtomStyle { sphere: true, sphere_mass: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3], [5.0; 3]]);
        b.world.settings.neighbor.skin = 0.002;
        b.world.settings.units = perigrain_base::units::UnitSystem::Si;
        let p = &mut b.world.particles;
        p.radius.fill(radius);
        p.mass.fill(4.0 / 3.0 * PI * radius.powi(3) * 2500.0);
        p.v[1] = [0.0, speed, 0.0];
        b
    }

    fn parts(b: &Bench, words: &str, fastest: f64) -> [f64; 3] {
        b.fix(&DtGrain, words).unwrap();
        let fix = Declared {
            id: "f".into(),
            group: GroupId::ALL,
            every: 1,
            limits: [0.1, 0.1, 1.0],
            vmax: 0.0,
            warn: true,
            error: false,
            given: vec![],
        };
        fix.parts(&b.world, &vec![Some((5e6, 0.45))], fastest, 1e-5, Span::default()).unwrap()
    }

    // LIGGGHTS 3.8.0, check/timestep/gran, 12 printed digits: 15 mm at 1 m/s, also with a surface at 3 m/s; 5 mm at 0.1 m/s.
    #[test]
    fn parts_are_those_of_liggghts() {
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] / b[k] - 1.0).abs() < 1e-10);
        let b = scene(0.015, 1.0);
        let found = parts(&b, "1 0.1 0.1", 0.0);
        assert!(near(found, [0.00529414932442, 0.00227247505048, 0.01]), "{found:?}");
        let found = parts(&b, "1 0.1 0.1", 3.0);
        assert!(near(found, [0.00529414932442, 0.00261038835226, 0.02]), "{found:?}");
        let found = parts(&scene(0.005, 0.1), "1 0.1 0.1", 0.0);
        assert!(near(found, [0.0158824479733, 0.00430150446974, 0.001]), "{found:?}");
    }

    #[test]
    fn what_is_too_long_is_named() {
        let fix = |words: &str| scene(0.01, 0.0).fix(&DtGrain, words).map(|_| ());
        for words in [
            "",
            "0 0.1 0.1",
            "1 0 0.1",
            "1 0.1",
            "1 0.1 0.1 vmax -1",
            "1 0.1 0.1 warn maybe",
            "1 0.1 0.1 material 1 5e6",
            "1 0.1 0.1 material 2 5e6 0.45",
            "1 0.1 0.1 material 1 5e6 0.6",
        ] {
            assert!(fix(words).is_err(), "{words}");
        }
        let fix = Declared {
            id: "f".into(),
            group: GroupId::ALL,
            every: 1,
            limits: [0.1, 0.2, 1.0],
            vmax: 0.0,
            warn: true,
            error: false,
            given: vec![],
        };
        assert_eq!(fix.judge([0.1, 0.2, 1.0]), None);
        let text = fix.judge([0.11, 0.2, 1.5]).unwrap();
        assert!(text.contains("Rayleigh") && !text.contains("Hertz") && text.contains("skin"), "{text}");
        // Without a material there is nothing to compare with.
        let b = scene(0.01, 1.0);
        assert!(fix.parts(&b.world, &vec![None], 0.0, 1.0, Span::default()).is_err());
    }
}

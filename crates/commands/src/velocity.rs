//! `velocity`: gives particles velocities, changes or scales them.

mod options;

use super::momentum::{Members, temperature as temperature_of};
use super::{Act, CommandStyle};
use options::{Distribution, Loop, Options};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, sub};
use perigrain_lang::{Args, Param};
use perigrain_styles::common::{self, on_particles, ramp};
use perigrain_styles::words::{At, Axis, Nullable, PerAtom, Seed, Syntax, VelocityAxis, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Flow, Motion, Style};
use perigrain_world::{GroupId, World};

/// The command.
pub struct Velocity;

impl Style for Velocity {
    fn name(&self) -> &'static str {
        "velocity"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Gives the particles of a group velocities.",
            text: "T = Σ m v² / ((3N − 3) k), in flat scenes (2N − 2). Velocities and coordinates of `set` and `ramp` are in \
                   lattice spacings (per time) unless `units box` is given: in SI decks with a fine lattice `units box` is nearly \
                   always meant; values of variables are not scaled.",
            example: "velocity bullet set 0.0 0.0 -35.0 units box",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "GROUP")]
    group: GroupId,
    #[word(name = "style")]
    action: At<Action>,
    #[word(flatten)]
    options: Options,
}

#[derive(Words)]
#[word(what = "style of velocity", style)]
enum Action {
    /// Draws velocities from LAMMPS' Park–Miller stream, number by number as LAMMPS does, and scales them to the temperature T.
    Create {
        #[word(name = "T", what = "the temperature", non_negative)]
        temperature: f64,
        #[word(name = "SEED")]
        seed: Seed,
    },
    /// Numbers, variables, or `NULL` for a component that stays.
    Set(#[word(name = "VX VY VZ", what = "the velocity")] [Nullable<PerAtom>; 3]),
    /// Scales velocities to the temperature T.
    Scale {
        #[word(name = "T", what = "the temperature", non_negative)]
        temperature: f64,
    },
    /// Linear between two coordinates and constant beyond.
    Ramp {
        #[word(name = "vx|vy|vz")]
        along: VelocityAxis,
        #[word(name = "VLO VHI", what = "the velocity at an end")]
        by: [f64; 2],
        #[word(name = "x|y|z", what = "axis of the ramp")]
        axis: Axis,
        #[word(name = "CLO CHI", what = "the end of the ramp")]
        between: [f64; 2],
    },
    /// Takes the momentum of the centre of mass or the rotation about it away.
    Zero(#[word(name = "momentum")] Momentum),
}

#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "momentum to take away")]
enum Momentum {
    Linear,
    Angular,
}

impl CommandStyle for Velocity {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let Line { group, action: At { value: action, span, .. }, options } = read(a, cx)?;
        options.check(cx)?;
        if cx.world.settings.two_dimensional && leaves_plane(&action) {
            let text = "velocities along z do not go with a flat scene (`dimension 2`)";
            return fail(Code::CONFLICT, span, text);
        }
        let at = cx.span;
        Ok(on_particles(vec!["velocity"], move |cx| {
            common::populated(cx.world, "velocity", at)?;
            apply(cx, group, &action, &options)?;
            cx.world.touch();
            Ok(())
        }))
    }
}

/// Whether velocities leave the plane of a flat scene.
fn leaves_plane(action: &Action) -> bool {
    match action {
        Action::Set([.., z]) => z.0.as_ref().is_some_and(|z| z.0 != Param::Number(0.0)),
        Action::Ramp { along, .. } => along.0 == 2,
        _ => false,
    }
}

fn apply(cx: &mut ActCx, group: GroupId, action: &Action, o: &Options) -> Result<()> {
    let scale = o.units.scales(cx.world);
    let members = Members::new(cx.world, group);
    if let (Some(fix), Action::Zero(momentum)) = (&o.rigid, action) {
        let what = if *momentum == Momentum::Linear { Motion::Linear } else { Motion::Angular };
        return cx.values.stop(cx.world, fix, what);
    }
    match action {
        Action::Create { temperature, seed } => {
            let old = members.velocities(cx.world);
            let flow = take_flow_away(cx, o)?;
            let mut new = created(cx.world, &members, seed.0, o)?;
            let now = match &flow {
                None => present(cx, &members, &new, o)?,
                Some(_) => temperature_of(cx.world, &members, &new),
            };
            rescale(&mut new, now, *temperature)?;
            members.write(cx.world, &new, false);
            give_back(cx.world, &flow);
            if o.sum {
                members.write(cx.world, &old, true);
            }
        }
        Action::Set(values) => {
            for (d, value) in values.iter().enumerate() {
                let Nullable(Some(PerAtom(value))) = value else { continue };
                let factor = if matches!(value, Param::Number(_)) { scale[d] } else { 1.0 };
                let v = cx.per_atom_of(value, &members.list)?;
                for &i in &members.list {
                    let old = if o.sum { cx.world.particles.v[i][d] } else { 0.0 };
                    cx.world.particles.v[i][d] = old + factor * v[i];
                }
            }
        }
        Action::Scale { temperature } => {
            let old = members.velocities(cx.world);
            let now = present(cx, &members, &old, o)?;
            let flow = take_flow_away(cx, o)?;
            let mut new = members.velocities(cx.world);
            rescale(&mut new, now, *temperature)?;
            members.write(cx.world, &new, false);
            give_back(cx.world, &flow);
            if o.sum {
                members.write(cx.world, &old, true);
            }
        }
        Action::Ramp { along: VelocityAxis(along), by, axis: Axis(axis), between } => {
            let by = by.map(|b| scale[*along] * b);
            let between = between.map(|c| scale[*axis] * c);
            for &i in &members.list {
                let v = ramp(cx.world.particles.x[i][*axis], between, by);
                let old = if o.sum { cx.world.particles.v[i][*along] } else { 0.0 };
                cx.world.particles.v[i][*along] = old + v;
            }
        }
        Action::Zero(Momentum::Linear) => {
            let mut v = members.velocities(cx.world);
            members.stop_drift(cx.world, &mut v);
            members.write(cx.world, &v, false);
        }
        Action::Zero(Momentum::Angular) => {
            let mut v = members.velocities(cx.world);
            members.stop_rotation(cx.world, &mut v);
            members.write(cx.world, &v, false);
        }
    }
    Ok(())
}

/// Random velocities, one per member, before they are scaled.
fn created(w: &World, members: &Members, seed: u32, o: &Options) -> Result<Vec<[f64; 3]>> {
    let mut v = draws(w, members, seed, o)?;
    for (v, &i) in v.iter_mut().zip(&members.list) {
        let factor = 1.0 / w.particles.mass[i].sqrt();
        *v = v.map(|x| x * factor);
        if w.settings.two_dimensional {
            v[2] = 0.0;
        }
    }
    if o.momentum {
        members.stop_drift(w, &mut v);
    }
    if o.rotation {
        members.stop_rotation(w, &mut v);
    }
    Ok(v)
}

/// Three random numbers for each member, in LAMMPS' order of drawing.
fn draws(w: &World, members: &Members, seed: u32, o: &Options) -> Result<Vec<[f64; 3]>> {
    let mut stream = ParkMiller::new(seed);
    let next = |stream: &mut ParkMiller| {
        let mut one =
            || if o.dist == Distribution::Gaussian { stream.gaussian() } else { stream.uniform() - 0.5 };
        [one(), one(), one()]
    };
    let p = &w.particles;
    match o.order {
        Loop::All => {
            if p.last_tag() as usize != p.len() {
                let text = "`loop all` needs ids that run from 1 to the number of particles";
                return fail(Code::CONFLICT, None, text);
            }
            let mut by_tag = vec![[0.0; 3]; p.len()];
            by_tag.iter_mut().for_each(|v| *v = next(&mut stream));
            Ok(members.list.iter().map(|&i| by_tag[p.tag[i] as usize - 1]).collect())
        }
        Loop::Local => {
            stream.skip(100);
            let mut all = vec![[0.0; 3]; p.len()];
            members.list.iter().for_each(|&i| all[i] = next(&mut stream));
            Ok(members.list.iter().map(|&i| all[i]).collect())
        }
        Loop::Geom => Ok(members
            .list
            .iter()
            .map(|&i| {
                stream.reset_at(seed, p.x[i]);
                next(&mut stream)
            })
            .collect()),
    }
}

/// With `bias yes`: takes the flow away from all particles and returns it.
fn take_flow_away(cx: &mut ActCx, o: &Options) -> Result<Option<Flow>> {
    let Some(compute) = o.compute.as_ref().filter(|_| o.keeps_flow()) else { return Ok(None) };
    let flow = cx.values.flow(cx.world, compute)?;
    for (v, taken) in cx.world.particles.v.iter_mut().zip(&flow.taken) {
        *v = sub(*v, *taken);
    }
    Ok(Some(flow))
}

/// Adds the flow again; components that are nothing but flow are what they were.
fn give_back(w: &mut World, flow: &Option<Flow>) {
    let Some(flow) = flow else { return };
    let p = &mut w.particles;
    for (i, (v, taken)) in p.v.iter_mut().zip(&flow.taken).enumerate() {
        let inside = p.mask[i] & flow.group.bit() != 0;
        for d in 0..3 {
            v[d] = if inside && flow.whole[d] { taken[d] } else { v[d] + taken[d] };
        }
    }
}

/// The present temperature of these velocities of the group.
fn present(cx: &mut ActCx, members: &Members, v: &[Vec3], o: &Options) -> Result<f64> {
    let Some(compute) = &o.compute else { return Ok(temperature_of(cx.world, members, v)) };
    // The compute sees the new velocities where its own group has them.
    let before = members.velocities(cx.world);
    members.write(cx.world, v, false);
    cx.world.slots.invalidate();
    let now = cx.number(&Param::Ref(compute.clone()));
    members.write(cx.world, &before, false);
    cx.world.slots.invalidate();
    now
}

fn rescale(v: &mut [Vec3], now: f64, target: f64) -> Result<()> {
    if now == 0.0 {
        return fail(Code::CONFLICT, None, "the group's velocities have temperature 0 and cannot be scaled");
    }
    let factor = (target / now).sqrt();
    v.iter_mut().flatten().for_each(|x| *x *= factor);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{act, more, refused, scene};
    use perigrain_world::World;

    /// Eight spheres of mixed mass at random places, half of them in group g.
    fn balls() -> World {
        let mut w = scene(
            "atom_style sphere\nboundary p p f\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\nlattice sc 1.0",
        );
        more(&mut w, "create_atoms 1 random 4 9281 NULL\nset group all diameter 0.3\nlattice fcc 0.7");
        more(
            &mut w,
            "region s sphere 1.5 1.5 1.5 1.2 units box\ncreate_atoms 1 random 4 77 s\nset atom 3*6 mass 0.7",
        );
        more(&mut w, "group g id 2:8:2 3");
        w
    }

    /// Oracle: the same lines in LAMMPS, printed with %.17g. Sums run in the same order; what is left are roundings
    /// of the inverse inertia tensor, a few ulp.
    fn agree(w: &World, i: usize, oracle: [f64; 3], ulps: f64) {
        for d in 0..3 {
            let v = w.particles.v[i][d];
            assert!((v - oracle[d]).abs() <= ulps * f64::EPSILON * 4.0, "{i} {d}: {v:?} {:?}", oracle[d]);
        }
    }

    #[test]
    fn creation_is_lammps_creation() {
        let mut w = balls();
        more(&mut w, "velocity all create 1.5 4928");
        agree(&w, 0, [-2.5409036010280941, -1.5463265645152058, 0.7714793541775451], 0.0);
        agree(&w, 7, [-0.2349458539270694, 0.034389181218136583, -1.8682718829951646], 0.0);
        more(&mut w, "velocity all create 1.5 4928 loop geom mom no dist gaussian");
        agree(&w, 0, [0.74748094108626983, 0.86416933834450127, -1.8668364711870886], 0.0);
        agree(&w, 5, [0.58299769286507197, -3.2906093449187379, 1.5912585417071607], 0.0);
        more(&mut w, "velocity g create 2.5 4928 loop local mom yes rot yes dist gaussian sum yes");
        agree(&w, 0, [0.74748094108626983, 0.86416933834450127, -1.8668364711870886], 0.0);
        agree(&w, 1, [2.719451286306322, -1.5792605250893599, -0.78646519900238143], 1.0);
        agree(&w, 7, [2.6667022134743501, -3.6444051336283803, -1.1375883599263843], 1.0);
    }

    #[test]
    fn changes_are_lammps_changes() {
        let mut w = balls();
        more(&mut w, "velocity all create 1.5 4928 loop geom mom no dist gaussian");
        more(
            &mut w,
            "velocity g create 2.5 4928 loop local mom yes rot yes dist gaussian sum yes\nvelocity g set 1 NULL 2",
        );
        agree(&w, 1, [1.7878070701931352, -1.5792605250893599, 3.5756141403862705], 1.0);
        more(&mut w, "velocity all ramp vy -1 2 x 0.5 1.5 sum yes");
        agree(&w, 0, [0.74748094108626983, 2.5833016335219523, -1.8668364711870886], 1.0);
        agree(&w, 6, [-1.0984469584747918, 1.4315095303514505, 1.1523445309408638], 1.0);
        more(&mut w, "velocity g zero linear\nvelocity all zero angular");
        agree(&w, 0, [0.37490033427277508, 2.0981088020008145, -1.3553146632411612], 2.0);
        agree(&w, 3, [0.44736442089703349, 4.4252175429366583, 0.32800448497489665], 2.0);
        more(&mut w, "velocity all scale 0.4");
        agree(&w, 2, [-0.27969410001790945, 0.5718517108692136, -0.22096095983479336], 2.0);
        let tenth: fn(&World, usize) -> f64 = |w, i| w.particles.x[i][0] * 0.1;
        act(&mut w, "velocity g set v_q 3 NULL sum yes units box", &[("q", tenth)]).unwrap();
        agree(&w, 7, [0.27756733348562534, 1.9578424142158071, -0.05055226252678742], 2.0);
    }

    #[test]
    fn blames_the_right_word() {
        let mut w = balls();
        for (line, word) in [
            ("velocity gg set 1 1 1", "gg"),
            ("velocity g set 1 1 q", "q"),
            ("velocity g spin 1 1 1", "spin"),
            ("velocity g create -1 3", "-1"),
            ("velocity g create 1 0", "0"),
            ("velocity g set 1 1 1 bias yes", "bias"),
            ("velocity g zero linear rigid mine", "mine"),
            ("velocity g scale 1 temp mine", "mine"),
            ("velocity g ramp vq 1 1 x 0 1", "vq"),
        ] {
            assert_eq!(refused(&w, line).0, word, "{line}");
        }
        assert!(refused(&w, "velocity g scale 1.0").1.contains("temperature 0"));
        more(&mut w, "delete_atoms group g compress no");
        assert!(refused(&w, "velocity all create 1 3").1.contains("ids"));
    }
}

//! fix wall/region: the surface of a region as a wall with normal forces and no friction.

use super::wall_law::Law;
use super::{AtRest, Facts, Fix, FixStyle, MODIFY, Minimizing, RegionId, Virial, options};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{Vec3, scale};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::matter::{Chosen, add_virial, change_forces, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Form, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{F, MASK, RADIUS, REGIONS, SLOTS, TAG, TALLY, X};
use perigrain_world::region::{Look, Near};
use perigrain_world::{GroupId, Key, Region, World};
use std::sync::atomic::{AtomicBool, Ordering};

/// The style.
pub struct WallRegion;

impl Style for WallRegion {
    fn name(&self) -> &'static str {
        "wall/region"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed(MODIFY, Virial::GRAMMAR)] },
            ),
            summary: "The surface of a region as a smooth wall that pushes and pulls particles.",
            text: "A particle of the group whose centre is at a distance r < cutoff from the surface of the region feels the force −dE/dr \
                   along the line from the nearest point of the surface; each face that is so near acts, as do the planes of a block \
                   near its edges. Energies are shifted to 0 at the cutoff. Other ε and D0 are energies, σ, r0 and the cutoff \
                   distances, alpha is 1/distance.\n\n\
                   All that `fix wall/gran/region` says of surfaces holds here: sides, unions, intersections, `open` faces, meshes, \
                   regions that move with variables. A particle that leaves the region, comes to its surface or (`colloid`) touches \
                   it ends the run, but for leaving regions with open faces. Distances are not taken across periodic faces.\n\n\
                   Scalar (extensive): the energy; `fix_modify ID energy yes` adds it to the potential energy, as minimizations need \
                   it. Vector of 3 (extensive): the force on the wall. `fix_modify ID virial yes` adds the wall to pressures and \
                   stresses, `respa` chooses the level of steps. LAMMPS 22Jul2025's `colloid` attracts where it should repel, and its \
                   energy is no integral of its force: so it is under `-compat lammps` alone.",
            example: "units lj\natom_style sphere\nregion b block -5 5 -5 5 -5 5\ncreate_box 1 b\nregion ball sphere 0 0 0 4\ncreate_atoms 1 single 0 0 2.9\n\
                      set group all diameter 1.0\nset group all density 1.0\nfix 1 all nve\nfix shell all wall/region ball lj93 1.0 1.0 2.5\nfix_modify shell energy yes\n\
                      thermo_style custom step pe f_shell f_shell[3]\nrun 100",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The region whose surface is the wall.
    #[word(name = "regionID")]
    region: At<RegionId>,
    #[word(name = "law")]
    law: At<Law>,
}

impl FixStyle for WallRegion {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { region, law: At { value: law, span: style, .. } } = read(args, cx)?;
        let (span, RegionId(region)) = (region.span, region.value);
        let law = if cx.world.settings.lammps() { law.inverted() } else { law };
        if law.needs_radii() {
            if !cx.world.particles.style.sphere {
                let d =
                    Diagnostic::error(Code::WRONG_ORDER, style, "`colloid` needs particles with a radius");
                return Err(d.help("put `atom_style sphere` at the top of the deck").into());
            }
            cx.fault(style, "`colloid` of fix wall/region that attracts where it should repel", false);
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, region, span, law, virial: false }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    region: String,
    /// Span of the region's name.
    span: Span,
    law: Law,
    /// `fix_modify virial yes`.
    virial: bool,
}

/// What one particle gets: energy, the force on the wall, whether it has left the region.
type Got = [f64; 5];

/// The wall in this step.
struct Wall<'w> {
    region: &'w Region,
    law: &'w Law,
    lammps: bool,
}

impl Wall<'_> {
    /// Calls `see` for each contact of a particle: contact point, force away from the wall and energy.
    /// Returns whether the particle's position is allowed.
    fn push(&self, x: Vec3, radius: f64, mut see: impl FnMut(&Near, f64, f64)) -> bool {
        let mut near = vec![];
        self.region.near(x, self.law.cutoff, &Look { before: None, lammps: self.lammps }, &mut near);
        let mut well = self.region.open != 0 || self.region.contains(x);
        for place in &near {
            if place.distance <= self.law.least(radius) {
                well = false;
                continue;
            }
            let [force, energy] = self.law.at(place.distance, radius);
            see(place, force, energy);
        }
        well
    }
}

impl Declared {
    fn radius(&self, w: &World, i: usize) -> f64 {
        if self.law.needs_radii() { w.particles.radius[i] } else { 0.0 }
    }

    /// Force of the wall on a particle.
    fn act(&self, wall: &Wall, w: &World, i: usize, f: &mut Vec3) -> Got {
        let mut got = [0.0; 5];
        let well = wall.push(w.particles.x[i], self.radius(w, i), |place, force, energy| {
            got[0] += energy;
            for d in 0..3 {
                let along = force * place.normal[d];
                f[d] += along;
                got[1 + d] -= along;
            }
        });
        got[4] = f64::from(u8::from(!well));
        got
    }

    /// Virial of a particle from the wall: xx yy zz xy xz yz.
    fn virial_of(&self, w: &World, key: Key<Region>, i: usize) -> [f64; 6] {
        let mut virial = [0.0; 6];
        let Some(region) = w.regions.get(key) else { return virial };
        let wall = Wall { region, law: &self.law, lammps: w.settings.lammps() };
        wall.push(w.particles.x[i], self.radius(w, i), |place, force, _| {
            let (f, d) = (scale(force, place.normal), scale(place.distance, place.normal));
            let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
            virial.iter_mut().zip(pairs).for_each(|(v, (a, b))| *v += f[a] * d[b]);
        });
        virial
    }

    /// The error for a particle that has left the region or reached its surface.
    fn left(&self, w: &World, key: Key<Region>, t: &Tick) -> Result<()> {
        let Some(region) = w.regions.get(key) else { return Ok(()) };
        let wall = Wall { region, law: &self.law, lammps: w.settings.lammps() };
        let p = &w.particles;
        let gone = |i: &usize| {
            p.mask[*i] & self.group.bit() != 0 && !wall.push(p.x[*i], self.radius(w, *i), |_, _, _| ())
        };
        let Some(i) = (0..w.n()).filter(gone).min_by_key(|i| p.tag[*i]) else { return Ok(()) };
        let (id, [x, y, z], name, step) = (p.tag[i], p.x[i], &self.region, t.step);
        let text = format!(
            "particle {id} at ({x}, {y}, {z}) is on or beyond the surface of region `{name}` in step {step}"
        );
        Err(Diagnostic::error(Code::BAD_VALUE, self.span, text)
            .help("a particle must begin inside the region (`side out`: outside of the shape); a greater epsilon or cutoff or a shorter time step holds it back")
            .into())
    }
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let chosen = Chosen::new(cx.world(), self.group, None, span)?;
        let Some(key) = cx.world().regions.find(&self.region) else {
            let text = format!("there is no region `{}` any more", self.region);
            let d = Diagnostic::error(Code::UNKNOWN_REGION, self.span, text);
            return Err(d.help("define it again before the run, or remove the fix with `unfix`").into());
        };
        let (slot, me) = (cx.slot(&format!("f_{}", self.id)), self.clone());
        let radii = if self.law.needs_radii() { X | RADIUS } else { X };
        let access = Needs::new().read(radii | MASK | TAG | REGIONS).add(F | TALLY).write(SLOTS);
        let name = format!("fix {} wall/region", self.id);
        let op = StepOp::new(name, Stage::PostForce, access, move |w, t| {
            if me.virial {
                add_virial(w, t, &chosen, |w, i| me.virial_of(w, key, i));
            }
            if t.unchanged {
                return Ok(());
            }
            let lammps = w.settings.lammps();
            let beyond = AtomicBool::new(false);
            let got: Got = change_forces(w, &chosen, |w, i, f| {
                let Some(region) = w.regions.get(key) else { return [0.0; 5] };
                let got = me.act(&Wall { region, law: &me.law, lammps }, w, i, f);
                if got[4] != 0.0 {
                    beyond.store(true, Ordering::Relaxed);
                }
                got
            });
            if w.anywhere(beyond.into_inner()) {
                w.whole(X);
                me.left(w, key, t)?;
            }
            publish(w, slot, t, got[0], &got[1..4]);
            Ok(())
        });
        Ok(vec![op.one_by_one().with_sums().boxed()])
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        self.virial = options::<Virial>(args, cx)?.virial.unwrap_or(self.virial);
        Ok(())
    }

    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 3, scalar_extensive: true, vector_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts {
            minimizing: Minimizing::Acts,
            at_rest: AtRest::Acts,
            has_level: true,
            has_energy: true,
            ..Facts::default()
        }
    }
}

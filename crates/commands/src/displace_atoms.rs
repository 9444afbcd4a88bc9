//! `displace_atoms`: moves particles once.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::length;
use perigrain_lang::{Args, Param};
use perigrain_styles::common::{self, on_particles};
use perigrain_styles::words::{At, Axis, PerAtom, Seed, Syntax, Units, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::contacts::Rolls;
use perigrain_world::{GroupId, Turn};

/// The command.
pub struct DisplaceAtoms;

impl Style for DisplaceAtoms {
    fn name(&self) -> &'static str {
        "displace_atoms"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Moves the particles of a group once.",
            text: "The particles of `rotate` are unwrapped across periodic faces; orientations of `bpm/sphere` particles turn \
                   along, and so do the springs of contacts between two of them (not under `compat lammps`), while velocities, \
                   spins and what holds particles to places in space (`fix move`, `fix spring/self`, `compute displace/atom`) stay \
                   as they are. Afterwards particles are wrapped into the box and shrink-wrapped faces follow.",
            example: "displace_atoms ball move 0 0 -0.001 units box",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "GROUP")]
    group: GroupId,
    #[word(name = "motion")]
    motion: At<Motion>,
    /// The unit of distances.
    #[word(keyword, default = Units::Lattice)]
    units: Units,
}

#[derive(Words)]
#[word(what = "style of displace_atoms", style)]
enum Motion {
    /// By a displacement, of which each component is a number or a variable.
    Move(#[word(name = "DX DY DZ", what = "the displacement")] [PerAtom; 3]),
    /// By DLO where the coordinate is CLO, by DHI where it is CHI, linearly between and constant beyond.
    Ramp {
        #[word(name = "x|y|z", what = "direction of the displacement")]
        along: Axis,
        #[word(name = "DLO DHI", what = "the displacement")]
        by: [f64; 2],
        #[word(name = "x|y|z", what = "axis of the ramp")]
        axis: Axis,
        #[word(name = "CLO CHI", what = "the end of the ramp")]
        between: [f64; 2],
    },
    /// By up to ±DX, ±DY, ±DZ, each particle by numbers that belong to its place, as in LAMMPS.
    Random {
        #[word(name = "DX DY DZ", what = "the range")]
        by: [f64; 3],
        #[word(name = "SEED")]
        seed: Seed,
    },
    /// By the angle THETA in degrees about the axis through P along R.
    Rotate {
        #[word(name = "PX PY PZ", what = "a point of the axis")]
        point: [f64; 3],
        #[word(name = "RX RY RZ", what = "the axis")]
        axis: [f64; 3],
        #[word(name = "THETA", what = "the angle")]
        degrees: At<f64>,
    },
}

impl CommandStyle for DisplaceAtoms {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let Line { group, motion: At { value: mut motion, span, .. }, units } = read(a, cx)?;
        if let Motion::Rotate { axis, degrees, .. } = &mut motion {
            let length = length(*axis);
            if length == 0.0 {
                return fail(Code::BAD_VALUE, degrees.span, "the axis of rotation has no direction");
            }
            *axis = axis.map(|x| x / length);
        }
        if cx.world.settings.two_dimensional && leaves_plane(&motion) {
            let text = "displacements along z do not go with a flat scene (`dimension 2`)";
            return fail(Code::CONFLICT, span, text);
        }
        let spacing = units.scales(cx.world);
        Ok(on_particles(vec![], move |cx| {
            cx.print("Displacing atoms ...");
            displace(cx, group, &motion, spacing)?;
            common::settle(cx.world);
            cx.world.touch();
            Ok(())
        }))
    }
}

/// Whether particles would leave the plane z = 0.
fn leaves_plane(motion: &Motion) -> bool {
    match motion {
        Motion::Move([.., PerAtom(z)]) => *z != Param::Number(0.0),
        Motion::Ramp { along, .. } => along.0 == 2,
        Motion::Random { by, .. } => by[2] != 0.0,
        Motion::Rotate { axis, .. } => axis[0] != 0.0 || axis[1] != 0.0,
    }
}

fn displace(cx: &mut ActCx, group: GroupId, motion: &Motion, spacing: [f64; 3]) -> Result<()> {
    let members: Vec<usize> =
        (0..cx.world.n()).filter(|&i| cx.world.particles.mask[i] & group.bit() != 0).collect();
    match motion {
        Motion::Move(params) => {
            // One direction after the other: a variable for y sees the shift in x already, as in LAMMPS.
            let before = cx.world.particles.x.clone();
            for (d, PerAtom(param)) in params.iter().enumerate() {
                match cx.per_atom_of(param, &members) {
                    Ok(by) => members.iter().for_each(|&i| cx.world.particles.x[i][d] += spacing[d] * by[i]),
                    Err(e) => {
                        cx.world.particles.x = before;
                        return Err(e);
                    }
                }
            }
        }
        Motion::Ramp { along: Axis(along), by, axis: Axis(axis), between } => {
            let by = by.map(|b| spacing[*along] * b);
            let between = between.map(|c| spacing[*axis] * c);
            for &i in &members {
                let x = &mut cx.world.particles.x[i];
                x[*along] += common::ramp(x[*axis], between, by);
            }
        }
        Motion::Random { by, seed: Seed(seed) } => {
            let mut stream = ParkMiller::new(*seed);
            for &i in &members {
                let x = &mut cx.world.particles.x[i];
                stream.reset_at(*seed, *x);
                for d in 0..3 {
                    x[d] += spacing[d] * by[d] * 2.0 * (stream.uniform() - 0.5);
                }
            }
        }
        Motion::Rotate { point, axis, degrees } => {
            let angle = std::f64::consts::PI * degrees.value / 180.0;
            let turn = Turn::new([0, 1, 2].map(|d| spacing[d] * point[d]), *axis, angle);
            // Without coefficients nothing touches yet.
            let probes = cx.values.probes(cx.world).unwrap_or_default();
            let rolls: Vec<Rolls> = probes.iter().flat_map(|probe| probe.rolls()).collect();
            let mask = cx.world.particles.mask.clone();
            cx.world.carry(&turn, &rolls, |i| mask[i] & group.bit() != 0);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::testing::{more, refused, scene};
    use perigrain_world::World;

    fn bar() -> World {
        let mut w = scene("units si\nboundary s p f\nlattice sc 0.5\nregion b block 0 4 0 3 0 3 units box");
        more(&mut w, "create_box 2 b\ncreate_atoms 1 box");
        w
    }

    // Oracle: the same lines in LAMMPS, %.17g.
    #[test]
    fn moves_wrap_and_shrink_like_lammps() {
        let mut w = bar();
        more(&mut w, "displace_atoms all move 0.1 0 0.2 units box");
        let domain = w.domain.clone().into_inner().unwrap();
        assert_eq!((domain.lo[0], domain.hi[0]), (0.099600000000000008, 4.1003999999999996));
        more(&mut w, "displace_atoms all random 0.1 0.02 0 332 units box");
        assert_eq!(w.particles.x[0], [0.039815216995689656, 0.014870409311200681, 0.2]);
        assert_eq!(w.particles.x[1], [0.53045676016735688, 2.9973536265535996, 0.2]);
        assert_eq!(w.particles.image[1], [0, -1, 0]);
        assert_eq!(w.particles.x[8], [4.1414832941915289, 0.0019450954077509675, 0.2]);
        // Farther than the box is long.
        let mut w = bar();
        more(&mut w, "displace_atoms all move 0 -7.3 0 units box");
        assert_eq!((w.particles.x[0][1], w.particles.image[0]), (1.7000000000000002, [0, -3, 0]));
    }

    #[test]
    fn ramps_are_linear_between_and_constant_beyond() {
        let mut w = bar();
        more(&mut w, "displace_atoms all ramp z 0 0.2 x 2 4");
        // Spacing 0.5: moves by 0 at x ≤ 1, by 0.1 at x ≥ 2.
        let z = |x: f64| w.particles.x.iter().find(|p| p[0] == x && p[2] < 0.3).unwrap()[2];
        assert_eq!([z(0.0), z(1.0), z(1.5), z(2.0), z(4.0)], [0.0, 0.0, 0.05, 0.1, 0.1]);
        assert_eq!(refused(&w, "displace_atoms all rotate 0 0 0 0 0 0 90").0, "90");
        assert_eq!(refused(&w, "displace_atoms all ramp w 0 0.2 x 2 4").0, "w");
        assert_eq!(
            refused(&w, "displace_atoms all move 1 2").1,
            "`displace_atoms` ends too early: the displacement is missing"
        );
    }
}

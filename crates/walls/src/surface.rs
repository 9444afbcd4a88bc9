//! fix surface: a mesh in its place, without a force of its own; walls lean on it, movers and a servo move it.

mod flat;
mod op;

use crate::shared::direction;
use crate::shared::forget;
use crate::wall::servo::{self, Controlled, Servo};
use crate::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail, nearest};
use perigrain_base::math::body::{turn, turned};
use perigrain_base::math::vec3::{Vec3, cross, sub};
use perigrain_lang::{Args, Param, Word};
use perigrain_mesh::{Facets, Triangle};
use perigrain_plan::Op;
use perigrain_styles::mesh_surface::{MeshSurface, SURFACES, SurfaceKeys, SurfacePose, in_plane};
use perigrain_styles::triangles;
use perigrain_styles::words::{At, Each, Form, Kind, OneType, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, UseKind};
use perigrain_world::{Key, Outline, World};
use std::sync::Arc;

/// The style.
pub struct Surface;

impl Style for Surface {
    fn name(&self) -> &'static str {
        "surface"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(const { &[Form::behind(Line::GRAMMAR), servo::MODIFIED] }),
            summary: "A surface of triangles from a file, for walls, movers, servos and dumps.",
            text: "Not in LAMMPS; what LIGGGHTS calls a mesh. The surface has no force of its own: `fix wall/mesh … of ID` \
                   leans on it, `fix move/mesh` moves it, `fix massflow/mesh` counts through it, `dump mesh/stl` and \
                   `dump mesh/vtk` write it. `scale`, `shift` and `turn` are done in the order in which they stand; \
                   `turn` is about an axis through the origin. One contact stands for a face, seam, edge or corner, as \
                   in `fix wall/mesh`.\n\n\
                   `speed` and `spin` give the surface a velocity that contacts feel while nothing moves, as a belt \
                   has: on each face the part of the velocity in its plane, lengthened to the whole; for `spin` at each \
                   corner, and linear between the corners.\n\n\
                   `servo` moves the surface so that it presses on grains with a wanted force. With p the force with \
                   which it presses along the axis and F the wanted value, e = (F − p)/|F| and v = vel_max clamp(kp e + \
                   ki ∫ e dt + kd de/dt, ±1) along the axis; the force is that of the step before, so that nothing \
                   moves in the first step. The gains are 0.01, 0 and 0 unless given; beyond the limit of the speed \
                   the integral is the one that gives the limit.\n\n\
                   With `mode auto ratio q` the gains are not used: v = u (1 − 9 |p/F|) e for \
                   |p/F| below 0.1, else 0.1 u e, with u = q r/Δt and r the least radius.\n\n\
                   With `ctrlPV torque` it turns about the axis through `com` instead. \
                   `fix_modify ID` changes `target_val`, `vel_max`, the gains by `ctrlParam kp ki kd`, and by \
                   `servo/integrate stop` holds the surface.\n\n\
                   `wear finnie K` adds for each contact 2 K f |F| |v| Δt/area to its triangle while the grain comes \
                   nearer: f = sin 2g − 3 sin² g for tan g < 1/3, else cos² g/3, g the angle between the velocity of \
                   the centre and the face (Finnie; LIGGGHTS has 0.33333 for 1/3).\n\n\
                   Global vector: force (1–3) and torque (4–6) of grains on the surface, each force at the point of the \
                   surface nearest to the grain, and the point about which the \
                   torque counts where it is now (7–9): `about`, or the `com` of a servo. The group means nothing.",
            example: "fix belt all surface blade.stl type 1 scale 0.001 shift 0 0 -0.0025 speed -4.5 0 0",
        }
    }
}

/// The words of the line.
#[derive(Words)]
struct Line {
    /// The file of triangles: STL (text or binary), OBJ, PLY, VTP or VTK (legacy, text).
    #[word(name = "FILE", what = "the name of a file of triangles", kind = Kind::File)]
    file: Word,
    /// The type whose coefficients the contacts of `wall/mesh coeff T` have.
    #[word(keyword = "type", name = "T", what = "the type of the surface", shown = "required")]
    kind: Option<OneType>,
    /// All triangles must lie in one plane.
    #[word(flag, placed)]
    planar: Option<Span>,
    #[word(flatten)]
    places: Each<Transform>,
    /// A velocity of the surface that moves nothing [length/time].
    #[word(keyword, name = "vx vy vz", what = "{}", once)]
    speed: Option<[f64; 3]>,
    #[word(keyword, once)]
    spin: Option<Spin>,
    /// The temperature of the surface [temperature], for contacts that conduct heat.
    #[word(keyword, name = "T", once)]
    temperature: Option<Param>,
    /// The point about which the torque on the surface counts, in its first position [length].
    #[word(keyword, name = "x y z", what = "{}", once)]
    about: Option<[f64; 3]>,
    #[word(keyword, once, placed)]
    servo: Option<At<servo::Line>>,
    #[word(keyword, once, placed)]
    wear: Option<At<Wear>>,
}

/// What is done to the corners of the file, in the order of the line.
#[derive(Words)]
#[word(keywords)]
enum Transform {
    /// Multiplies them.
    Scale(#[word(name = "s", what = "the scale", positive)] f64),
    /// Adds to them [length].
    Shift(#[word(name = "x y z", what = "{}")] [f64; 3]),
    /// Turns them about an axis through the origin.
    Turn {
        #[word(name = "x y z", with = direction, kind = Kind::Number)]
        axis: [f64; 3],
        #[word(name = "angle", what = "the angle [degrees]")]
        angle: f64,
    },
}

/// A turn of the surface about an axis that moves nothing.
#[derive(Words)]
struct Spin {
    /// A point of the axis, its direction, and the angular velocity [1/time].
    #[word(name = "ox oy oz", what = "{}")]
    point: [f64; 3],
    #[word(name = "ax ay az", with = direction, kind = Kind::Number)]
    axis: [f64; 3],
    #[word(name = "w", what = "the angular velocity")]
    omega: f64,
}

/// A law of wear.
#[derive(Words)]
#[word(what = "law of wear")]
enum Wear {
    /// Finnie's, with a coefficient for all grains or for each type of grains [length²/force].
    Finnie(#[word(name = "K", what = "the coefficient of wear", least = 1)] Vec<f64>),
}

/// The ID of a surface that there is.
pub struct SurfaceId(pub Word);

impl Value for SurfaceId {
    const KIND: Kind = Kind::Fix;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the ID of a surface")?;
        let all = cx.world.facts.get(*SURFACES);
        if all.is_some_and(|all| all.look_up(&word.text).is_some()) {
            cx.uses(UseKind::Fix, &word.text);
            return Ok(Self(word.clone()));
        }
        let names: Vec<&str> = all.map_or(vec![], |all| all.keys().map(Key::text).collect());
        let text = format!("there is no surface `{}`", word.text);
        let d = Diagnostic::error(Code::UNKNOWN_NAME, word.span, text);
        Err(match nearest(&word.text, names) {
            Some(name) => d.help(format!("did you mean `{name}`?")),
            None => d.help("declare it above this line with `fix ID all surface FILE type T`"),
        }
        .into())
    }
}

impl FixStyle for Surface {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let Some(OneType(kind)) = line.kind else {
            let text = "a surface needs the type whose coefficients its contacts have";
            let d = Diagnostic::error(Code::MISSING_ARGUMENT, cx.span, text);
            return Err(d.help("add `type 1`").into());
        };
        let (mut triangles, numbers) = match triangles::read_faces(&line.file, cx)? {
            Some(read) => {
                let numbers: Vec<u32> = (0..read.triangles.len()).map(|k| read.number(k) as u32).collect();
                (read.triangles, numbers)
            }
            None => (vec![], vec![]),
        };
        line.places.0.iter().for_each(|place| place.value.apply(&mut triangles));
        triangles::doubt_size(&line.file, &triangles, cx);
        let mesh = Facets::new(triangles).map_err(|bad| {
            let text = format!("triangle {} of `{}` is too small for its place", bad + 1, line.file.text);
            Diagnostic::error(Code::BAD_VALUE, line.file.span, text)
        })?;
        if mesh.open_edges > 0 {
            let text = format!(
                "the mesh `{}` is not closed: {} of its edges border one triangle only",
                line.file.text, mesh.open_edges
            );
            cx.note(Diagnostic::note(Code::SUSPICIOUS, line.file.span, text));
        }
        if let Some(span) = line.planar {
            flat::check(mesh.triangles(), &line.file, span)?;
        }
        let slide = slide(line.speed, line.spin, mesh.triangles(), cx)?;
        let servo = line.servo.map(|at| at.value.servo(at.span)).transpose()?;
        if let (Some(servo), true) = (&servo, slide.is_some()) {
            let _ = servo;
            return fail(Code::CONFLICT, cx.span, "a surface with a servo has no `speed` and no `spin`");
        }
        let wear = line.wear.map(|at| worn(at, cx.world.types)).transpose()?;
        let about = line.about.or(servo.as_ref().map(|servo| servo.com)).unwrap_or_default();
        let surface = MeshSurface {
            mesh: Arc::new(mesh),
            numbers: numbers.into(),
            kind,
            temperature: line.temperature,
            slide,
            about,
            movers: vec![],
            steered: servo.is_some(),
            wear,
            keys: SurfaceKeys::of(cx.id),
        };
        Ok(Box::new(Declared { id: cx.id.to_string(), surface, servo }))
    }
}

impl Transform {
    fn apply(&self, triangles: &mut [Triangle]) {
        let corners = triangles.as_flattened_mut().iter_mut();
        match self {
            Self::Scale(by) => corners.for_each(|p| *p = p.map(|x| by * x)),
            Self::Shift(way) => corners.for_each(|p| (0..3).for_each(|d| p[d] += way[d])),
            Self::Turn { axis, angle } => {
                let by = turn(*axis, angle.to_radians());
                corners.for_each(|p| *p = turned(by, *p));
            }
        }
    }
}

/// Velocities at the corners of each triangle.
fn slide(
    speed: Option<Vec3>,
    spin: Option<Spin>,
    triangles: &[Triangle],
    cx: &BuildCx,
) -> Result<Option<Arc<[[Vec3; 3]]>>> {
    let velocity = |p: Vec3| match (&speed, &spin) {
        (Some(v), _) => *v,
        (None, Some(Spin { point, axis, omega })) => cross(axis.map(|a| omega * a), sub(p, *point)),
        (None, None) => [0.0; 3],
    };
    match (&speed, &spin) {
        (None, None) => Ok(None),
        (Some(_), Some(_)) => {
            let d =
                Diagnostic::error(Code::CONFLICT, cx.span, "a surface has a `speed` or a `spin`, not both");
            Err(d.help("give the parts that spin a surface of their own").into())
        }
        _ => Ok(Some(triangles.iter().map(|t| t.map(|p| in_plane(t, velocity(p)))).collect())),
    }
}

/// Coefficients of wear by type.
fn worn(At { value: Wear::Finnie(given), span, .. }: At<Wear>, types: usize) -> Result<Arc<[f64]>> {
    match given.as_slice() {
        [one] => Ok(vec![*one; types].into()),
        all if all.len() == types => Ok(given.into()),
        all => {
            let text = format!("there are {} coefficients of wear for {types} types", all.len());
            let d = Diagnostic::error(Code::BAD_VALUE, span, text);
            Err(d.help("write one for all grains, or one for each type").into())
        }
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    surface: MeshSurface,
    servo: Option<Servo>,
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        let keys = self.surface.keys;
        SurfacePose::default().store(w, keys.pose);
        w.memo.insert(keys.load, vec![0.0; 6]);
        w.memo.insert(keys.touched, vec![]);
        if self.surface.wear.is_some() {
            w.memo.insert(keys.wear, vec![0.0; self.surface.mesh.triangles().len()]);
        }
        w.facts.get_or_default(*SURFACES).insert(Key::new(&self.id), self.surface.clone());
        let (mesh, pose) = (self.surface.mesh.clone(), keys.pose);
        let form = move |w: &World| {
            let pose = SurfacePose::load(w, pose);
            mesh.triangles().iter().map(|t| t.map(|p| pose.at(p))).collect()
        };
        w.outlines.insert(Key::new(&self.id), Outline::new(form));
        // Where the reference point is can be read before a run; what a restart file has brought stays.
        let slot = w.slots.id(&format!("f_{}", self.id));
        let vector = &mut w.slots.get_mut(slot).vector;
        if vector.is_empty() {
            vector.extend([0.0; 6].iter().chain(&self.surface.about));
        }
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        let key = Key::new(&format!("surface/{}", self.id));
        forget(w, key);
        w.memo.remove(key);
        w.outlines.remove(Key::new(&self.id));
        if let Some(all) = w.facts.get_mut(*SURFACES) {
            all.remove(Key::new(&self.id));
        }
    }

    fn shape(&self) -> Shape {
        Shape { vector: 9, vector_extensive: false, ..Shape::default() }
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        op::ops(&self.id, self.servo.as_ref(), cx)
    }

    fn modify(&mut self, args: &mut Args, cx: &BuildCx) -> Result<()> {
        Servo::modify_some(&mut self.servo, args, cx)
    }
}

/// Whether a servo turns its wall.
pub fn turns(servo: &Servo) -> bool {
    servo.control == Controlled::Torque
}

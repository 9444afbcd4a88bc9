//! fix wall/mesh: a surface of triangles from a file as a wall, at rest or moving.

mod leaning;
mod moving;

use super::words::{self, Material, Rest};
use super::{Common, Declared, Form, Surface, needs_spheres};
use crate::elapsed::Elapsed;
use crate::surface::SurfaceId;
use crate::{Fix, FixStyle};
use leaning::Leaning;
use moving::{Motion, Moving, Placed, Running};
use perigrain_base::comm::rows;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{cross, dot, length, scale, sub};
use perigrain_contact::Wrench;
use perigrain_contact::walls::{Touch, Wall};
use perigrain_lang::{Args, Word};
use perigrain_mesh::Facets;
use perigrain_plan::Tick;
use perigrain_styles::mesh_surface::SURFACES;
use perigrain_styles::triangles::{self, Placing};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::{Key, Numbers, Outline, World};
use std::sync::Arc;

/// The style.
pub struct WallMesh;

impl Style for WallMesh {
    fn name(&self) -> &'static str {
        "wall/mesh"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "A surface of triangles from a file as a wall on which grains lean, at rest or moving.",
            text: "Not in LAMMPS. Forces as those of `fix wall/gran` on a plane, with the nearest point of the surface: \
                   from both sides, whatever the order of corners. A face counts where it is the nearest of its \
                   surroundings, an edge or corner that several triangles share once, and only where no neighbour is \
                   nearer. Neighbours whose normals differ by less than 30° make one smooth patch: of places on one \
                   patch that look alike (normals within 45°) the nearest one counts, and the springs of friction pass \
                   from triangle to triangle. So a plane cut into triangles is a plane: a ball that rolls across feels \
                   no kick.\n\n\
                   Corners are shared where their numbers are the same. Corners on the edge of another triangle, \
                   corners that miss each other by less than a millionth of the mesh and faces that lie on each other \
                   make no seams either. Triangles without area are left out with a warning; edges that border one \
                   triangle only (holes, or the rim of a plate) are counted in another one.\n\n\
                   `of ID …` leans on surfaces of `fix surface` in place of a file.\n\n\
                   Global vector: force (1–3) and torque (4–6) on the wall, about the origin, the axis' point or \
                   `about`. Local values, a row for each triangle: its number in the file, the force on it (3), the \
                   work of sliding Σ F_n |v_t| Δt since the fix was declared, that work by area; `dump local` writes \
                   them. By Archard's law the depth worn off is the last column times k/H.",
            example: "fix blade grains wall/mesh granular hertz/material 5.0e7 0.7 0.3 damping tsuji tangential mindlin \
                      NULL 1.0 0.5 mesh blade.stl scale 0.001 shift 0 0 -0.0025 move rotate 0 0 0 0 0 1 0.5",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "force", with = force, kind = words::FORCE)]
    force: Material,
    #[word(name = "wall")]
    wall: Solid,
    /// The factor on the numbers of the file.
    #[word(keyword, name = "S", what = "the scale", positive, placed, shown = "1")]
    scale: Option<At<f64>>,
    /// What is added to them then, in box units [length].
    #[word(keyword, name = "X Y Z", what = "{}", placed, shown = "0 0 0")]
    shift: Option<At<[f64; 3]>>,
    #[word(keyword = "move", once, placed)]
    motion: Option<At<Moving>>,
    #[word(flatten)]
    rest: Rest,
}

/// The wall.
#[derive(Words)]
#[word(what = "wall")]
enum Solid {
    /// A file of triangles, STL (text or binary), OBJ, PLY or VTP, as for `region mesh`.
    Mesh(#[word(name = "FILE", what = "the name of a file of triangles", kind = Kind::File)] Word),
    /// Surfaces of `fix surface`, which have their own place, motion, velocity and temperature.
    Of(#[word(name = "surfaceID", what = "the ID of a surface", least = 1)] Vec<SurfaceId>),
}

fn force(args: &mut Args, cx: &BuildCx) -> Result<Material> {
    words::force(args, cx, &["mesh", "of"])
}

impl FixStyle for WallMesh {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        needs_spheres(cx, "wall/mesh")?;
        let Line { force, wall, scale, shift, motion, rest } = read(args, cx)?;
        let file = match wall {
            Solid::Mesh(file) => file,
            Solid::Of(ids) => {
                let words = [scale.map(|at| at.span), shift.map(|at| at.span), motion.map(|at| at.span)];
                if let Some(span) = words.into_iter().flatten().next() {
                    let d =
                        Diagnostic::error(Code::CONFLICT, span, "a surface has its place by its own line");
                    return Err(d
                        .help("write it in the line of `fix surface`, a motion as `fix move/mesh`")
                        .into());
                }
                return lean(ids, force, rest, cx);
            }
        };
        let scale = scale.map_or(1.0, |at| at.value);
        let shift = shift.map_or([0.0; 3], |at| at.value);
        let motion = motion.map(|at| at.value);
        let motion = motion.map_or(Motion::Rest, Moving::motion);
        let common = rest.common(force, motion.point().unwrap_or_default(), cx)?;
        let (mesh, numbers) = surface(&file, Placing { scale, shift }, cx)?;
        Ok(Box::new(Declared {
            common,
            form: Triangles { mesh: Arc::new(mesh), numbers: numbers.into(), motion },
        }))
    }
}

/// A wall of surfaces of other lines.
fn lean(ids: Vec<SurfaceId>, force: Material, rest: Rest, cx: &BuildCx) -> Result<Box<dyn Fix>> {
    let all = cx.world.facts.get(*SURFACES);
    let of = |id: &SurfaceId| all.and_then(|all| all.look_up(&id.0.text)?.temperature.clone());
    let first = ids.first().and_then(of);
    if let Some(other) = ids.iter().find(|id| of(id) != first) {
        let text = format!("surface `{}` has another temperature than the first", other.0.text);
        let d = Diagnostic::error(Code::CONFLICT, other.0.span, text);
        return Err(d.help("give surfaces of each temperature a wall of their own").into());
    }
    let span = ids.first().map_or(cx.span, |id| id.0.span);
    let common = rest.with_temperature(first, span)?.common(force, [0.0; 3], cx)?;
    let ids = ids.into_iter().map(|id| (id.0.text, id.0.span)).collect();
    Ok(Box::new(Declared { common, form: Leaning { ids } }))
}

/// Reads the file's triangles and places them; returns their numbers in the file as well.
fn surface(file: &Word, placing: Placing, cx: &BuildCx) -> Result<(Facets, Vec<u32>)> {
    let Some(mut read) = triangles::read_faces(file, cx)? else { return Ok((Facets::default(), vec![])) };
    placing.apply(&mut read.triangles, [1.0; 3]);
    triangles::doubt_size(file, &read.triangles, cx);
    let numbers = (0..read.triangles.len()).map(|k| read.number(k) as u32).collect();
    let mesh = Facets::new(read.triangles).map_err(|bad| {
        let text = format!("triangle {} of `{}` is too small for its place", bad + 1, file.text);
        Diagnostic::error(Code::BAD_VALUE, file.span, text)
    })?;
    if mesh.open_edges > 0 {
        let text = format!(
            "the mesh `{}` is not closed: {} of its edges border one triangle only",
            file.text, mesh.open_edges
        );
        let note = Diagnostic::warning(Code::SUSPICIOUS, file.span, text);
        cx.note(note.help("the rim of a plate or pipe is as meant; a hole lets grains through"));
    }
    Ok((mesh, numbers))
}

#[derive(Clone)]
struct Triangles {
    mesh: Arc<Facets>,
    /// Numbers of the triangles in the file, from 1.
    numbers: Arc<[u32]>,
    motion: Motion,
}

/// Key of the sliding work on each triangle.
fn work_key(key: Numbers) -> Numbers {
    key.with("/work")
}

impl Form for Triangles {
    const STYLE: &'static str = "wall/mesh";
    const LOCAL: usize = 6;

    fn declare(&self, w: &mut World, key: Numbers) {
        w.memo.remove(key);
        Elapsed::load(w, key).store(w, key);
        w.memo.insert(work_key(key), vec![0.0; self.mesh.triangles().len()]);
        w.memo.insert(moving::place_key(key), vec![]);
    }

    fn outline(&self) -> Outline {
        let mesh = self.mesh.clone();
        Outline::new(move |_| mesh.triangles().to_vec())
    }

    fn surface(&self, fix: &Common, cx: &mut dyn SealCx) -> Result<Box<dyn Surface>> {
        let key = fix.key(Self::STYLE);
        let running = Running::new(self.mesh.clone(), &self.motion, (key, Key::new(&fix.id)), cx)?;
        let areas = self.mesh.triangles().iter().map(perigrain_mesh::area).collect();
        Ok(Box::new(Tracked { running, work: work_key(key), areas, numbers: self.numbers.clone() }))
    }
}

/// The wall during a run, with loads per triangle.
struct Tracked {
    running: Running,
    work: Numbers,
    areas: Vec<f64>,
    numbers: Arc<[u32]>,
}

impl Surface for Tracked {
    fn place(&mut self, w: &mut World, t: &Tick) -> Result<f64> {
        self.running.place(w, t)
    }

    fn show(&self, _w: &World, _: Option<u16>, see: &mut dyn FnMut(&dyn Wall)) {
        see(&Placed(&self.running));
    }

    fn local(&mut self, w: &mut World, contacts: &[(&Touch, &Wrench)], t: &Tick) -> Vec<f64> {
        let mut rows: Vec<[f64; 6]> = vec![[0.0; 6]; self.areas.len()];
        let mut work = w.memo.remove(self.work).unwrap_or_default();
        work.resize(self.areas.len(), 0.0);
        let p = &w.particles;
        let mut done: Vec<rows::Row<2, 1>> = vec![];
        for (touch, wrench) in contacts {
            let (i, k, n) = (touch.grain as usize, touch.near.part as usize, touch.near.normal);
            let Some(row) = rows.get_mut(k) else { continue };
            (0..3).for_each(|d| row[1 + d] -= wrench.force[d]);
            if !t.setup {
                let spin = scale(p.radius[i], cross(p.omega[i], n));
                let slip = sub(sub(p.v[i], touch.near.velocity), spin);
                let across = sub(slip, scale(dot(slip, n), n));
                let work = dot(wrench.force, n).max(0.0) * length(across) * t.dt;
                done.push(([p.tag[i], touch.near.part], [work]));
            }
        }
        if w.is_narrow() {
            // By particle and triangle: summed in the order of a single process.
            done = rows::of_all(done);
        }
        done.iter().for_each(|([_, part], [more])| work[*part as usize] += more);
        for (k, row) in rows.iter_mut().enumerate() {
            (row[0], row[4], row[5]) = (f64::from(self.numbers[k]), work[k], work[k] / self.areas[k]);
        }
        w.memo.insert(self.work, work);
        rows.into_iter().flatten().collect()
    }
}

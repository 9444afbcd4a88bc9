//! `peri_crack`: cuts peridynamic bonds before or between runs.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_mesh::Sheet;
use perigrain_styles::peri_view::view;
use perigrain_styles::triangles::{self, Placing};
use perigrain_styles::words::{At, Forms, Syntax, Units, Words};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::{Crack, Region};

/// The command.
pub struct PeriCrack;

impl Style for PeriCrack {
    fn name(&self) -> &'static str {
        "peri_crack"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(Line::FORMS),
            summary: "Cuts bonds: a notch or crack without taking particles away.",
            text: "Bonds across a periodic face of the box count where they begin: keep surfaces away from there. Before the first \
                   run the crack waits until the families are built, then and between runs particles count where they are. Cut \
                   bonds are broken bonds: they count as damage, their ends repel each other when close, and nothing heals them. A \
                   crack that meets no bond is an error.",
            example: "region slit block INF 0.002 INF INF INF INF units box\n\
                      peri_crack plane 0 0.0015 0 0 1 0 region slit units box",
        }
    }
}

#[derive(Words)]
#[word(forms = "peri_crack", what = "what cuts")]
enum Line {
    /// Cuts every bond that crosses a plane.
    Plane(Plane),
    /// Cuts every bond that passes through a region.
    Region(Through),
    /// Cuts every bond that crosses a triangle of a surface, which may be open, closed, curved and in several pieces: an STL, OBJ, PLY or
    /// VTP file, placed as by `region mesh`. Bonds through common edges, corners and the rim are cut; a particle on the surface belongs to
    /// the side of larger x (of larger y or z, where the surface lies along x).
    Mesh(Surface),
}

#[derive(Words)]
struct Plane {
    /// A point of the plane [length].
    #[word(name = "px py pz", what = "a coordinate of the plane's point")]
    point: [f64; 3],
    #[word(flatten)]
    normal: Normal,
    /// Only where the bond meets the plane inside this region.
    #[word(keyword, name = "ID")]
    region: Option<Region>,
    /// The unit of distances.
    #[word(keyword, default = Units::Lattice)]
    units: Units,
}

#[derive(Words)]
struct Normal {
    /// The normal of the plane.
    #[word(name = "nx", what = "a component of the plane's normal")]
    x: At<f64>,
    /// The normal of the plane.
    #[word(name = "ny nz", what = "a component of the plane's normal")]
    others: [f64; 2],
}

#[derive(Words)]
struct Through {
    /// The region.
    #[word(name = "ID")]
    region: Region,
}

#[derive(Words)]
struct Surface {
    /// The file of triangles.
    #[word(name = "FILE", what = "the name of a file of triangles", kind = Kind::File)]
    file: Word,
    #[word(flatten)]
    placing: Placing,
    /// The unit of distances.
    #[word(keyword, default = Units::Lattice)]
    units: Units,
}

impl CommandStyle for PeriCrack {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        if !cx.world.particles.style.peri {
            return fail(
                Code::WRONG_ORDER,
                a.name_span(),
                "peri_crack needs particles with bonds: `atom_style peri`",
            );
        }
        let words: Vec<&str> = (0..).map_while(|k| a.peek_at(k)).map(|w| w.text.as_str()).collect();
        let line = format!("peri_crack {}", words.join(" "));
        let mut crack = Crack { plane: None, region: None, sheet: None, line };
        match Line::form(a, cx)? {
            Line::Region(Through { region }) => crack.region = Some(region),
            Line::Mesh(surface) => crack.sheet = Some(sheet(&surface, cx)?),
            Line::Plane(Plane { point, normal: Normal { x, others: [y, z] }, region, units }) => {
                let normal = [x.value, y, z];
                if normal == [0.0; 3] {
                    return fail(Code::BAD_VALUE, x.span, "the normal of the plane must not be zero");
                }
                let scale = units.scales(cx.world);
                crack.region = region;
                crack.plane = Some(([0, 1, 2].map(|k| point[k] * scale[k]), normal));
            }
        }
        Ok(Box::new(Cut { crack }))
    }
}

/// Reads the surface that a file holds, and puts it in its place.
fn sheet(Surface { file, placing, units }: &Surface, cx: &BuildCx) -> Result<Sheet> {
    let Some(surface) = triangles::read_faces(file, cx)? else { return Ok(Sheet::from(vec![])) };
    let mut placed = surface.triangles.clone();
    placing.apply(&mut placed, units.scales(cx.world));
    triangles::doubt_size(file, &placed, cx);
    Sheet::new(placed).map_err(|fault| {
        let text = format!("`{}` is no surface: {}", file.text, fault.text(&surface));
        Diagnostic::error(Code::BAD_VALUE, file.span, text).help(fault.help()).into()
    })
}

struct Cut {
    crack: Crack,
}

impl Act for Cut {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        let w = &mut *cx.world;
        let Some(mut families) = w.families.take() else {
            w.cracks.push(self.crack);
            w.touch();
            return Ok(());
        };
        let cut = view(w).map(|view| families.cut(&view, |a, b| self.crack.cuts(a, b)));
        w.families = Some(families).into();
        match cut? {
            0 => Err(Crack::missed(&self.crack).into()),
            n => {
                w.touch();
                cx.print(format!("{n} bonds cut"));
                Ok(())
            }
        }
    }
}

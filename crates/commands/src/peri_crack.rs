//! `peri_crack`: cuts peridynamic bonds before or between runs.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_mesh::Sheet;
use perigrain_styles::common::{scales, units_lattice};
use perigrain_styles::peri_view::view;
use perigrain_styles::triangles::{self, Placing};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::Crack;

/// The command.
pub struct PeriCrack;

impl Style for PeriCrack {
    fn name(&self) -> &'static str {
        "peri_crack"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "peri_crack plane px py pz nx ny nz [region ID] [units lattice|box]\nperi_crack region ID\n\
                     peri_crack mesh FILE [scale S] [shift X Y Z] [units lattice|box]",
            summary: "Cuts bonds: a notch or crack without taking particles away.",
            text: "`plane` cuts every bond that crosses the plane through (px py pz) with the normal (nx ny nz), with \
                   `region` only where the bond meets the plane inside that region. `region` alone cuts every bond that \
                   passes through the region. `mesh` cuts every bond that crosses a triangle of a surface, which may be open, closed, \
                   curved and in several pieces: an STL, OBJ, PLY or VTP file, placed as by `region mesh`. Bonds \
                   through common edges, corners and the rim are cut; a particle on the surface belongs to the side of larger x (of \
                   larger y or z, where the surface lies along x). Bonds across a periodic face of the box count where they \
                   begin: keep surfaces away from there. Before the first run the crack waits until the families are built, then and \
                   between runs particles count where they are. Cut bonds are broken bonds: they count as damage, their ends \
                   repel each other when close, and nothing heals them. A crack that meets no bond is an error. \
                   `units` concerns the point of the plane and the surface (lattice, as elsewhere).",
            example: "region slit block INF 0.002 INF INF INF INF units box\n\
                      peri_crack plane 0 0.0015 0 0 1 0 region slit units box",
        }
    }
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
        let what = a.choice("what cuts", &["plane", "region", "mesh"])?;
        if what == "region" {
            crack.region = Some(cx.region(a.expect("a region")?)?.clone());
        } else if what == "mesh" {
            crack.sheet = Some(sheet(a, cx)?);
        } else {
            let mut point = [0.0; 3];
            for x in &mut point {
                *x = a.number("a coordinate of the plane's point")?;
            }
            let at = a.here();
            let mut normal = [0.0; 3];
            for n in &mut normal {
                *n = a.number("a component of the plane's normal")?;
            }
            if normal == [0.0; 3] {
                return fail(Code::BAD_VALUE, at, "the normal of the plane must not be zero");
            }
            let mut lattice = true;
            while let Some(word) = a.next() {
                match word.text.as_str() {
                    "region" => crack.region = Some(cx.region(a.expect("a region")?)?.clone()),
                    "units" => lattice = units_lattice(a)?,
                    _ => return Err(a.unknown(word, &["region", "units"])),
                }
            }
            let scale = scales(cx.world, lattice);
            crack.plane = Some(([0, 1, 2].map(|k| point[k] * scale[k]), normal));
        }
        Ok(Box::new(Cut { crack }))
    }
}

/// Reads the surface that a file holds, and puts it in its place.
fn sheet(a: &mut Args, cx: &BuildCx) -> Result<Sheet> {
    let file = a.expect("the name of a file of triangles")?;
    let (mut placing, mut lattice) = (Placing::default(), true);
    while let Some(word) = a.next() {
        match word.text.as_str() {
            "units" => lattice = units_lattice(a)?,
            _ if placing.keyword(word, a)? => {}
            _ => return Err(a.unknown(word, &["scale", "shift", "units"])),
        }
    }
    let Some(surface) = triangles::read_faces(file, cx)? else { return Ok(Sheet::from(vec![])) };
    let mut placed = surface.triangles.clone();
    placing.apply(&mut placed, scales(cx.world, lattice));
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

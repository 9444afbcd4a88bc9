//! `clump`: a molecule template of spheres that overlap.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_geometry::text::find;
use perigrain_geometry::union::Union;
use perigrain_lang::{Args, Word};
use perigrain_styles::common;
use perigrain_styles::words::{At, Grammar, Kind, OneType, Part, Syntax, Value, Words, read};
use perigrain_styles::{ActCx, BuildCx, Doc, Style};
use perigrain_world::Template;

/// The command.
pub struct ClumpCommand;

impl Style for ClumpCommand {
    fn name(&self) -> &'static str {
        "clump"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Names a grain of several spheres, which may overlap, as a molecule template.",
            text: "Not in LAMMPS. A file has a line `x y z r` for each sphere; `#` begins a comment. `mixture … mol` gives the template a \
                   mass, centre and moments of inertia by its density, for which what several spheres have in common counts once; `mass` \
                   and `inertia` give them here. `fix insert` makes grains of it, `fix rigid/small … mol` moves them. Files are looked for \
                   in the working folder, then beside the deck. A restart file does not hold templates: the line stands again in the deck \
                   that reads it.\n\n\
                   Source: LIGGGHTS manual, fix particletemplate/multisphere.",
            example: "clump peanut 2 spheres -0.0002 0 0 0.0003 0.0002 0 0 0.0003\n\
                      mixture nuts number 32452843 mol peanut 2500 1",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The template's ID.
    #[word(name = "ID", what = "the ID of a template")]
    id: Word,
    /// The type of its spheres.
    #[word(name = "TYPE", what = "the type")]
    kind: OneType,
    #[word(name = "source")]
    source: Source,
    /// The scale, a factor on places and radii.
    #[word(keyword, name = "S", positive, default = 1.0)]
    scale: f64,
    /// How many spheres the file must have.
    #[word(keyword, name = "N", from = 2, placed)]
    count: Option<At<i64>>,
    /// The mass of the grain [mass].
    #[word(keyword, name = "M", positive, placed)]
    mass: Option<At<f64>>,
    /// The middle of its mass, with `mass` [length].
    #[word(
        keyword,
        name = "X Y Z",
        what = "{}",
        placed,
        shown = "the middle of the space that the spheres fill"
    )]
    com: Option<At<[f64; 3]>>,
    /// Its moments of inertia about that, with `mass` [mass length²].
    #[word(keyword, name = "XX YY ZZ XY XZ YZ", placed)]
    inertia: Option<At<Inertia>>,
}

/// Where the spheres come from.
#[derive(Words)]
#[word(what = "source of spheres")]
enum Source {
    /// A file with a line for each sphere.
    File(#[word(name = "FILE", what = "a file name", kind = Kind::File)] Word),
    /// Places and radii of the spheres, four numbers each [length].
    Spheres(#[word(name = "spheres")] Balls),
}

/// Six moments.
struct Inertia([f64; 6]);

impl Value for Inertia {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::number("XX"),
            Part::number("YY"),
            Part::number("ZZ"),
            Part::number("XY"),
            Part::number("XZ"),
            Part::number("YZ"),
        ],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let mut list = [0.0; 6];
        for x in &mut list {
            *x = args.number("a moment of inertia")?;
        }
        Ok(Self(list))
    }
}

/// Spheres of a line.
struct Balls(Vec<[f64; 4]>);

impl Value for Balls {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::Many(
            &[Part::number("X"), Part::number("Y"), Part::number("Z"), Part::number("R")],
            2,
        )],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let mut list = vec![];
        while list.len() < 2 || args.peek_text().parse::<f64>().is_ok() {
            let place = [args.number("x")?, args.number("y")?, args.number("z")?];
            let [x, y, z] = place;
            list.push([x, y, z, args.positive("the radius")?]);
        }
        Ok(Self(list))
    }
}

/// A line that has been read.
struct Reading {
    id: String,
    kind: u16,
    source: Source,
    scale: f64,
    count: Option<At<i64>>,
    mass: Option<f64>,
    com: Option<[f64; 3]>,
    inertia: Option<[f64; 6]>,
}

impl CommandStyle for ClumpCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let line: Line = read(a, cx)?;
        let id = common::id(&line.id, "the template's ID")?;
        if cx.world.templates.contains_key(&id) {
            let text = format!("there is a molecule template `{id}` already");
            return fail(Code::DUPLICATE_NAME, line.id.span, text);
        }
        let lone = [
            (line.inertia.as_ref().map(|i| i.span), "`inertia`"),
            (line.com.as_ref().map(|c| c.span), "`com`"),
        ];
        for (span, word) in lone {
            if span.is_some() && line.mass.is_none() {
                let d = Diagnostic::error(Code::INCOMPLETE, span, format!("{word} belongs to a `mass`"));
                return Err(d.help("write `mass M` as well, or leave both to `mixture … mol`").into());
            }
        }
        let OneType(kind) = line.kind;
        let (mass, inertia) = (line.mass.map(|m| m.value), line.inertia.map(|i| i.value.0));
        let com = line.com.map(|c| c.value);
        Ok(Box::new(Reading {
            id,
            kind,
            source: line.source,
            scale: line.scale,
            count: line.count,
            mass,
            com,
            inertia,
        }))
    }
}

impl Act for Reading {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        let balls = match &self.source {
            Source::Spheres(Balls(list)) => list.clone(),
            Source::File(file) => {
                let text = find(cx.world, file, "file of spheres")?;
                let balls = spheres(&text.text, file)?;
                if let Some(count) = self.count.as_ref().filter(|count| count.value != balls.len() as i64) {
                    let text = format!("`{}` has {} spheres, not {}", file.text, balls.len(), count.value);
                    return fail(Code::BAD_VALUE, count.span, text);
                }
                balls
            }
        };
        let s = self.scale;
        let places: Vec<[f64; 3]> = balls.iter().map(|[x, y, z, _]| [s * x, s * y, s * z]).collect();
        let radii: Vec<f64> = balls.iter().map(|[.., r]| s * r).collect();
        let middle = || self.mass.and_then(|_| Union::new(&places, &radii)).map(|union| union.centre);
        let com = self.com.or_else(middle);
        let count = places.len();
        let title = format!("a clump of {count} spheres");
        let kinds = vec![self.kind; count];
        let (mass, inertia) = (self.mass, self.inertia);
        let t = Template { title, count, places, kinds, radii, mass, com, inertia, ..Template::default() };
        cx.print(format!("Clump {}: {count} spheres", self.id));
        cx.world.templates.insert(self.id, vec![t].into());
        Ok(())
    }

    fn needs_particles(&self) -> bool {
        false
    }
}

/// The spheres of a file.
fn spheres(text: &str, file: &Word) -> Result<Vec<[f64; 4]>> {
    let mut list = vec![];
    for (k, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("");
        let numbers: Vec<Option<f64>> = line.split_whitespace().map(|w| w.parse().ok()).collect();
        match numbers.as_slice() {
            [] => {}
            [Some(x), Some(y), Some(z), Some(r)]
                if *r > 0.0 && [x, y, z, r].iter().all(|a| a.is_finite()) =>
            {
                list.push([*x, *y, *z, *r]);
            }
            _ => {
                let text = format!("line {} of `{}` is no sphere: `{}`", k + 1, file.text, line.trim());
                let d = Diagnostic::error(Code::BAD_VALUE, file.span, text);
                return Err(d.help("each line has x y z r, with a positive radius r").into());
            }
        }
    }
    if list.len() < 2 {
        let text = format!("`{}` has {} spheres, and a clump two at least", file.text, list.len());
        let d = Diagnostic::error(Code::BAD_VALUE, file.span, text);
        return Err(d.help("single spheres are `sphere` in a mixture").into());
    }
    Ok(list)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{more, refused, scene};

    const SPHERES: &str = "atom_style sphere\nregion b block 0 1 0 1 0 1\ncreate_box 2 b\n";

    #[test]
    fn spheres_are_read_and_scaled() {
        let w = scene(&format!("{SPHERES}clump c 2 spheres 1 2 3 4 5 6 7 8 scale 0.5"));
        let t = &w.templates["c"][0];
        assert_eq!((t.count, &t.kinds, &t.radii), (2, &vec![2, 2], &vec![2.0, 4.0]));
        assert_eq!(t.places[1], [2.5, 3.0, 3.5]);
        assert!(t.mass.is_none() && t.com.is_none());
        let mut w = scene(SPHERES);
        more(&mut w, "clump c 1 spheres 0 0 0 1 1 0 0 1 mass 2 inertia 1 2 2 0 0 0");
        let t = &w.templates["c"][0];
        assert!(t.mass == Some(2.0) && (t.com.unwrap()[0] - 0.5).abs() < 1e-12);
    }

    #[test]
    fn mistakes_are_named() {
        let mut w = scene(SPHERES);
        for (line, word) in [
            ("clump c 3 spheres 0 0 0 1 1 0 0 1", "3"),
            ("clump c 1 balls 0 0 0 1 1 0 0 1", "balls"),
            ("clump c 1 spheres 0 0 0 1 1 0 0 -1", "-1"),
            ("clump c 1 spheres 0 0 0 1 1 0 0 1 2", "2"),
        ] {
            let (blame, text) = refused(&w, line);
            assert!(blame == word || blame.starts_with("clump"), "{line}: {blame}: {text}");
        }
        assert!(refused(&w, "clump c 1 spheres 0 0 0 1").1.contains("ends too early"));
        assert_eq!(refused(&w, "clump c 1 spheres 0 0 0 1 1 0 0 1 com 0 0 0").0, "com");
        let (_, text) = refused(&w, "clump c 1 spheres 0 0 0 1 1 0 0 1 inertia 1 1 1 0 0 0");
        assert!(text.contains("belongs to a `mass`"), "{text}");
        more(&mut w, "clump c 1 spheres 0 0 0 1 1 0 0 1");
        assert_eq!(refused(&w, "clump c 1 spheres 0 0 0 1 1 0 0 1").0, "c");
    }

    #[test]
    fn files_of_spheres() {
        let there = tempfile::tempdir().unwrap();
        let write = |text: &str| {
            let path = there.path().join("s.txt");
            std::fs::write(&path, text).unwrap();
            path.display().to_string()
        };
        let file = write("# stone\n0 0 0 1\n\n1 0 0 0.5 # tip\n");
        let w = scene(&format!("{SPHERES}clump c 1 file {file} count 2"));
        assert_eq!(w.templates["c"][0].radii, [1.0, 0.5]);
        let w = scene(SPHERES);
        assert_eq!(refused(&w, &format!("clump c 1 file {file} count 3")).0, "count");
        write("0 0 0 1\n1 0 0\n");
        assert!(refused(&w, &format!("clump c 1 file {file}")).1.contains("line 2"));
        write("0 0 0 1\n");
        assert!(refused(&w, &format!("clump c 1 file {file}")).1.contains("two at least"));
    }
}

//! A dump: point clouds in the PLY format, one file for each snapshot.

use super::{refused, run};
use perigrain::diag::{Code, Result, fail};
use perigrain::lang::Args;
use perigrain::output::file::{Pattern, replace};
use perigrain::plan::{Needs, Op, Stage, When};
use perigrain::styles::step_op::StepOp;
use perigrain::styles::words::{Syntax, Words, read};
use perigrain::styles::{BuildCx, Doc, Dump, DumpStyle, SealCx, Style};
use perigrain::world::GroupId;
use perigrain::world::field::{MASK, X};
use perigrain_lang::Word;

struct Ply;

impl Style for Ply {
    fn name(&self) -> &'static str {
        "ply"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Writes the places of a group as point clouds.",
            text: "Text files of the PLY format, one for each snapshot.",
            example: "dump cloud all ply 100 cloud.*.ply",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The file's name; a `*` in it becomes the step.
    #[word(name = "FILE", what = "the file name", kind = Kind::File)]
    file: Word,
}

#[derive(Clone)]
struct Cloud {
    id: String,
    group: GroupId,
    file: Pattern,
}

impl DumpStyle for Ply {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let Line { file } = read(args, cx)?;
        let pattern = Pattern::new(&file.text).map_err(|e| e.at(file.span))?;
        if !pattern.many() {
            return fail(
                Code::BAD_VALUE,
                file.span,
                "dump ply writes one file per snapshot: the name needs a `*`",
            );
        }
        Ok(Box::new(Cloud { id: cx.id.to_string(), group: cx.group, file: pattern }))
    }
}

impl Dump for Cloud {
    fn op(&self, _cx: &mut dyn SealCx, every: i64) -> Result<Box<dyn Op>> {
        let (file, bit) = (self.file.clone(), self.group.bit());
        let needs = Needs::new().read(X | MASK);
        let op = StepOp::new(format!("dump {} ply", self.id), Stage::Output, needs, move |w, t| {
            let p = &w.particles;
            let rows: Vec<_> = p.x.iter().zip(p.mask.iter()).filter(|(_, mask)| *mask & bit != 0).collect();
            replace(&file.at(t.step), |to| {
                write!(to, "ply\nformat ascii 1.0\nelement vertex {}\n", rows.len())?;
                ["x", "y", "z"].iter().try_for_each(|axis| writeln!(to, "property double {axis}"))?;
                writeln!(to, "end_header")?;
                rows.iter().try_for_each(|([x, y, z], _)| writeln!(to, "{x} {y} {z}"))
            })
        });
        let when = if every == 0 { When::Always } else { When::Every(every) };
        Ok(op.when(when).in_setup(true).boxed())
    }

    fn modify(&mut self, args: &mut Args, _cx: &BuildCx) -> Result<()> {
        args.choice("option of dump ply", &[]).map(drop)
    }
}

#[test]
fn a_dump_in_one_file_and_one_line_writes_places_of_free_flight() {
    let folder = tempfile::tempdir().unwrap();
    let name = folder.path().join("cloud.*.ply").display().to_string();
    let deck = format!(
        "units lj\nregion b block 0 10 0 10 0 10\ncreate_box 1 b\ncreate_atoms 1 single 1 2 3\n\
         create_atoms 1 single 4 2 3\nmass 1 1.0\nvelocity all set 0.5 -0.25 1.0\ngroup first id 1\nfix move all nve\n\
         timestep 0.25\ndump cloud first ply 4 {name}\nrun 8\nwrite_dump all ply {name}\n"
    );
    let mut session = run(|tables| tables.dumps.push(&Ply), &deck);
    let snapshot = |step: i64| {
        let text = std::fs::read_to_string(name.replace('*', &step.to_string())).unwrap();
        let (head, rows) = text.split_once("end_header\n").unwrap();
        assert!(head.starts_with("ply\nformat ascii 1.0\nelement vertex "), "{head}");
        rows.to_string()
    };
    // Steps of a quarter are exact: x₀ + v t, and `write_dump` has written step 8 anew, with both.
    assert_eq!([0, 4].map(snapshot), ["1 2 3\n", "1.5 1.75 4\n"]);
    assert_eq!(snapshot(8), "2 1.5 5\n5 1.5 5\n");
    assert!(refused(&mut session, "dump more all ply 4 one.ply\n").contains("needs a `*`"));
    assert!(!refused(&mut session, "dump_modify cloud colour red\n").is_empty());
}

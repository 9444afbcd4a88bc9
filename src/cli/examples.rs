//! The subcommand `examples`: the decks of the folder `examples`, which the program carries with it.

use super::args::Usage;
use super::show;
use perigrain_base::diag::nearest;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// One example: its folder's name and its files, the README first.
struct Example {
    name: &'static str,
    files: &'static [(&'static str, &'static str)],
    /// What decks read, and what made it.
    data: &'static [(&'static str, &'static [u8])],
}

macro_rules! examples {
    ($($name:literal: $($deck:literal),+ $(=> $($data:literal),+)?;)*) => {
        &[$(Example {
            name: $name,
            files: &[
                ("README.md", include_str!(concat!("../../examples/", $name, "/README.md"))),
                ("expected.csv", include_str!(concat!("../../examples/", $name, "/expected.csv"))),
                $(($deck, include_str!(concat!("../../examples/", $name, "/", $deck)))),+
            ],
            data: &[$($(($data, include_bytes!(concat!("../../examples/", $name, "/", $data)))),+)?],
        }),*]
    };
}

/// Every example, by name; pictures stay in the repository.
const EXAMPLES: &[Example] = examples![
    "aerogel": "in.aerogel";
    "angle_of_repose": "in.angle_of_repose";
    "bicomponent_agglomerate": "in.bicomponent_agglomerate";
    "brittle_glass": "in.brittle_glass";
    "chute": "in.chute";
    "compact_tension": "in.compact_tension";
    "concrete_beam": "in.concrete_beam";
    "conveyor": "in.conveyor", "belt.stl", "wall.stl", "face.stl", "gate.stl", "plate.stl";
    "crack_branching": "in.crack_branching";
    "ct_fracture": "in.ct_fracture" => "rock.nrrd", "make_stack.py";
    "dcb": "in.dcb";
    "fragmenting_cylinder": "in.fragmenting_cylinder";
    "hertz_half_space": "in.hertz_half_space";
    "hopper": "in.hopper";
    "inverse_opal": "in.inverse_opal";
    "kalthoff_winkler": "in.kalthoff_winkler";
    "laminate_erosion": "in.laminate_erosion";
    "meshed_gear": "in.meshed_gear", "gear.obj";
    "mode_one": "in.mode_one";
    "multi_impact": "in.multi_impact";
    "multiscale_bed": "in.multiscale_bed";
    "notched_plate": "in.notched_plate";
    "plate_impact": "in.plate_impact", "in.oblique", "in.lammps";
    "quenched_plate": "in.quenched_plate";
    "rock_cylinder": "in.rock_cylinder";
    "rotating_drum": "in.rotating_drum";
    "rubber_cube": "in.rubber_cube";
    "rubber_sand_pack": "in.rubber_sand_pack";
    "shear_cell": "in.shear_cell";
    "squeezed_block": "in.squeezed_block";
    "taylor_bar": "in.taylor_bar";
    "thick_sphere": "in.thick_sphere";
];

/// The words of `examples`.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct Wanted {
    #[command(subcommand)]
    act: Option<Act>,
}

#[derive(Clone, Debug, PartialEq, Eq, clap::Subcommand)]
enum Act {
    /// Print the names of all examples and what each shows (the same without a word)
    List,
    /// Print the README of an example: what it shows, its variables, how long it takes
    Show {
        /// The example
        name: String,
    },
    /// Write the files of an example into a folder of its own
    Copy {
        /// The example
        name: String,
        /// The folder to make (the example's name)
        folder: Option<PathBuf>,
    },
}

/// Performs the request.
///
/// # Errors
/// An unknown name, a folder that exists already or cannot be made.
pub fn perform(wanted: &Wanted) -> Result<(), Usage> {
    match &wanted.act {
        None | Some(Act::List) => super::pager::page(&list()),
        Some(Act::Show { name }) => super::pager::page(find(name)?.files[0].1),
        Some(Act::Copy { name, folder }) => {
            let example = find(name)?;
            let folder = folder.clone().unwrap_or_else(|| name.into());
            copy(example, &folder)?;
            let deck = folder.join(example.files[2].0);
            show(&format!("run it: perigrain {}\n", deck.display()));
        }
    }
    Ok(())
}

/// All examples: name and the first sentence of the README.
fn list() -> String {
    let mut text = String::new();
    for example in EXAMPLES {
        let _ = writeln!(text, "  {:<24} {}", example.name, example.title());
    }
    text + "\n`perigrain examples show NAME` shows one, `perigrain examples copy NAME` writes its files here.\n"
}

impl Example {
    /// The first sentence of the README.
    fn title(&self) -> String {
        let body = self.files[0].1.split("\n\n").nth(1).unwrap_or_default().replace('\n', " ");
        let end = [". ", ": ", "; "].iter().filter_map(|stop| body.find(stop)).min();
        body[..end.unwrap_or(body.len())].trim_end_matches('.').to_string()
    }
}

fn find(name: &str) -> Result<&'static Example, Usage> {
    EXAMPLES.iter().find(|example| example.name == name).ok_or_else(|| {
        let help = match nearest(name, EXAMPLES.iter().map(|example| example.name)) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "`perigrain examples` lists them".into(),
        };
        Usage::new(format!("there is no example `{name}`")).help(help)
    })
}

/// Writes the files into a new folder; an existing one is never overwritten.
fn copy(example: &Example, folder: &Path) -> Result<(), Usage> {
    let trouble = |what: String| move |e: std::io::Error| Usage::new(format!("{what}: {e}"));
    if folder.exists() {
        let usage = Usage::new(format!("`{}` is there already", folder.display()));
        let other = format!("`perigrain examples copy {} OTHER_FOLDER`", example.name);
        return Err(usage.help(format!("name another folder: {other}")));
    }
    std::fs::create_dir_all(folder).map_err(trouble(format!("cannot make `{}`", folder.display())))?;
    let texts = example.files.iter().map(|(name, text)| (name, text.as_bytes()));
    for (name, text) in texts.chain(example.data.iter().map(|(name, bytes)| (name, *bytes))) {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(trouble(format!("cannot write `{}`", path.display())))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn all_that_stands_in_the_folder_is_carried() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
        let names = |folder: &Path| -> BTreeSet<String> {
            let entries = std::fs::read_dir(folder).unwrap();
            entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
        };
        assert_eq!(names(&root), EXAMPLES.iter().map(|e| e.name.to_string()).collect());
        for example in EXAMPLES {
            let decks: BTreeSet<String> = names(&root.join(example.name))
                .into_iter()
                .filter(|n| n.starts_with("in.") || n.ends_with(".obj") || n.ends_with(".stl"))
                .collect();
            assert_eq!(
                decks,
                example.files[2..].iter().map(|f| f.0.to_string()).collect(),
                "{}",
                example.name
            );
            assert!((20..200).contains(&example.title().len()), "{}: {}", example.name, example.title());
        }
    }

    #[test]
    fn an_example_is_copied_once_and_misspelt_ones_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let into = folder.path().join("glass");
        copy(find("brittle_glass").unwrap(), &into).unwrap();
        assert!(std::fs::read_to_string(into.join("in.brittle_glass")).unwrap().contains("pair_style"));
        assert!(
            copy(find("brittle_glass").unwrap(), &into).unwrap_err().help.unwrap().contains("OTHER_FOLDER")
        );
        assert_eq!(find("hoper").err().unwrap().help.as_deref(), Some("did you mean `hopper`?"));
    }
}

//! The material files of `potentials/`, embedded, and where a file of a deck is looked for.

use std::path::{Path, PathBuf};

macro_rules! embed {
    ($($name:literal)*) => { &[$(($name, include_str!(concat!("../../../potentials/", $name)))),*] };
}

/// Name and text of every file in `potentials/`.
pub const EMBEDDED: &[(&str, &str)] = embed! {
    "alumina.toml" "brittle-plate.toml" "impactor-steel.toml" "laminate-impactor.toml" "laminate-ply-1.toml"
    "laminate-ply-2.toml" "laminate-ply-3.toml" "laminate-ply-4.toml" "ofhc-copper.toml" "soda-lime-glass.toml"
    "steel-4340.toml" "steel.toml"
};

/// The embedded text of this name.
pub fn embedded(name: &str) -> Option<&'static str> {
    EMBEDDED.iter().find(|(n, _)| *n == name).map(|(_, text)| *text)
}

/// A file that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Where, for messages.
    pub place: String,
    /// All of it.
    pub text: String,
}

impl Found {
    /// Whether it is one of the embedded files.
    pub fn embedded(&self) -> bool {
        self.place.starts_with('<')
    }
}

/// Looks for `name` beside the deck, in the working folder, then among the embedded files.
/// An embedded file may also be called `potentials/NAME`.
///
/// # Errors
/// The error of reading a file that exists; `NotFound` when there is none.
pub fn find(name: &str, deck_folder: Option<&Path>) -> std::io::Result<Found> {
    let beside = deck_folder.map(|f| f.join(name));
    for path in beside.into_iter().chain([PathBuf::from(name)]) {
        match perigrain_base::gate::read_to_string(&path) {
            Ok(text) => return Ok(Found { place: path.display().to_string(), text }),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {}
            Err(e) => return Err(e),
        }
    }
    let plain = name.strip_prefix("potentials/").unwrap_or(name);
    match embedded(plain) {
        Some(text) => Ok(Found { place: format!("<embedded {plain}>"), text: text.to_owned() }),
        None => Err(std::io::ErrorKind::NotFound.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_folder() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../potentials");
        let mut names: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .filter(|n| n.ends_with(".toml"))
            .collect();
        names.sort();
        assert_eq!(names, EMBEDDED.iter().map(|e| e.0.to_owned()).collect::<Vec<_>>());
    }

    #[test]
    fn a_file_beside_the_deck_comes_before_the_embedded_one() {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("steel.toml");
        assert!(find("steel.toml", Some(folder.path())).unwrap().place.starts_with("<embedded"));
        std::fs::write(&own, "own").unwrap();
        assert_eq!(find("steel.toml", Some(folder.path())).unwrap().text, "own");
        assert_eq!(find("potentials/alumina.toml", None).unwrap().text, embedded("alumina.toml").unwrap());
        assert!(find("gold.toml", None).is_err());
    }
}

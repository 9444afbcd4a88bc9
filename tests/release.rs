//! What a release is made of agrees: versions and dates, a changelog that is quickly read, a short README, a gallery of all examples.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Lines of a README that is read to its end.
const README: usize = 90;

/// Lines of a version in the changelog.
const CHANGES: usize = 60;

/// What lines of the changelog stand under.
const GROUPS: [&str; 4] = ["Added", "Changed", "Fixed", "Faster"];

/// Bytes of a picture of the gallery.
const PICTURE: u64 = 150_000;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).into()
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap()
}

/// Names in a folder.
fn names(folder: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(root().join(folder)).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

/// What stands behind a key at the beginning of a line.
fn value<'a>(text: &'a str, key: &str) -> &'a str {
    text.lines()
        .find_map(|line| line.strip_prefix(key))
        .unwrap_or_else(|| panic!("no line begins with {key}"))
}

#[test]
fn all_files_name_one_version_and_one_date() {
    let citation = read("CITATION.cff");
    assert_eq!(value(&citation, "version: "), VERSION);
    let heading = format!("## {VERSION} ({})", value(&citation, "date-released: "));
    let changes = read("CHANGELOG.md");
    let newest = changes.lines().find(|line| line.starts_with("## ") && *line != "## Unreleased");
    assert_eq!(newest, Some(heading.as_str()));
    for file in ["docs/editor/README.md", "docs/howto/first-crack.md"] {
        assert!(read(file).contains(&format!("perigrain-{VERSION}")), "{file} names another version");
    }
    let extension: serde_json::Value =
        serde_json::from_str(&read("docs/editor/vscode/package.json")).unwrap();
    assert_eq!(extension["version"], VERSION);
}

#[test]
fn the_changelog_is_read_in_a_minute() {
    let text = read("CHANGELOG.md");
    let versions: Vec<&str> = text.split("\n## ").skip(1).collect();
    assert!(versions[0].starts_with("Unreleased"), "new lines go below `## Unreleased`");
    for version in versions {
        let (name, body) = version.split_once('\n').unwrap();
        assert!(
            name == "Unreleased" || body.lines().count() <= CHANGES,
            "{name} has more than {CHANGES} lines"
        );
        for line in body.lines() {
            let group = line.strip_prefix("### ").is_none_or(|group| GROUPS.contains(&group));
            assert!(group, "{name}: {line} is none of {GROUPS:?}");
            assert!(!line.starts_with(' '), "{name}: a change has one line, this is a second one: {line}");
        }
    }
}

#[test]
fn the_readme_is_short_and_names_the_test_command_once() {
    let text = read("README.md");
    let lines = text.lines().count();
    assert!(lines <= README, "README.md has {lines} lines, {README} at most");
    // `.ci/run` runs it.
    assert_eq!(
        text.lines().filter(|line| line.starts_with("cargo test")).collect::<Vec<_>>(),
        ["cargo test"]
    );
}

#[test]
fn the_gallery_shows_every_example() {
    let page = read("docs/gallery.md");
    let (examples, pictures) = (names("examples"), names("docs/gallery"));
    for name in &examples {
        assert!(
            page.contains(&format!("](../examples/{name}/in.")),
            "docs/gallery.md has no link to a deck of {name}"
        );
        assert!(
            page.contains(&format!("](gallery/{name}.jpg)")),
            "docs/gallery.md shows no picture of {name}"
        );
    }
    let both = page.clone() + &read("README.md");
    for picture in &pictures {
        assert!(both.contains(&format!("gallery/{picture})")), "docs/gallery/{picture} is shown nowhere");
        let bytes = fs::metadata(root().join("docs/gallery").join(picture)).unwrap().len();
        let most = if picture.ends_with(".gif") { 2_000_000 } else { PICTURE };
        assert!(bytes <= most, "docs/gallery/{picture} has {bytes} bytes, {most} at most");
    }
}

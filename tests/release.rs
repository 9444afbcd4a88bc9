//! What a release is made of agrees: versions and dates of all files, a changelog that is quickly read and a citation.

use std::fs;
use std::path::{Path, PathBuf};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Lines of a version in the changelog.
const CHANGES: usize = 60;

/// What lines of the changelog stand under.
const GROUPS: [&str; 4] = ["Added", "Changed", "Fixed", "Faster"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).into()
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap()
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

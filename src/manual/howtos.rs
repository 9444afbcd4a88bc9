//! The how-tos of `docs/howto`, which the program brings along: a question each, and what answers it.

/// A how-to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HowTo {
    /// Its file without the ending.
    pub name: &'static str,
    /// All of it, as Markdown.
    page: &'static str,
}

macro_rules! embed {
    ($($name:literal)*) => { &[$(HowTo { name: $name, page: include_str!(concat!("../../docs/howto/", $name, ".md")) }),*] };
}

/// All of them, by name.
pub const HOWTOS: &[HowTo] = embed! {
    "agglomerate" "bench" "bodies" "cluster" "cores" "drum" "erosion" "first-crack" "from-python" "heat" "hopper" "impact" "laminate"
    "long-runs" "material" "metal" "movie" "notch" "prompt" "report" "repose" "results" "slow" "sweep" "wrong-deck"
};

impl HowTo {
    /// Its name in requests: `howto notch`.
    pub fn title(&self) -> String {
        format!("howto {}", self.name)
    }

    /// The question it answers, which stands in italics below the heading.
    pub fn question(&self) -> &'static str {
        let italic = |line: &'static str| line.strip_prefix('*')?.strip_suffix('*');
        self.page.lines().find_map(italic).unwrap_or("")
    }

    /// Its text as a terminal shows it: no pictures, links as their words.
    pub fn text(&self) -> String {
        let lines = self.page.lines().filter(|line| !line.starts_with("!["));
        without_links(&lines.fold(String::new(), |text, line| text + line + "\n"))
    }

    /// Whether it has each of the words, in lower case.
    pub fn contains_all(&self, words: &[&str]) -> bool {
        let text = self.page.to_lowercase();
        words.iter().all(|word| text.contains(word))
    }
}

/// `[words](place)` as the words, which may continue in the next line.
fn without_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, link)) = rest.split_once('[') {
        let parts = link.split_once("](").and_then(|(words, more)| Some((words, more.split_once(')')?.1)));
        match parts.filter(|(words, _)| !words.contains('[') && !words.contains("\n\n")) {
            Some((words, after)) => {
                out += before;
                out += words;
                rest = after;
            }
            None => {
                out += before;
                out.push('[');
                rest = link;
            }
        }
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_folder() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/howto");
        let files = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = files.filter_map(|f| f.strip_suffix(".md").map(String::from)).collect();
        names.sort();
        assert_eq!(names, HOWTOS.iter().map(|h| h.name).collect::<Vec<_>>());
    }

    #[test]
    fn pages_are_texts_with_a_question() {
        for howto in HOWTOS {
            assert!(howto.question().ends_with('?'), "{}", howto.name);
            assert!(!howto.text().contains(".md)"), "{}", howto.text());
        }
        assert_eq!(without_links("a [`b`](c.md), `x[1]` and [d\nd](e) f"), "a `b`, `x[1]` and d\nd f");
    }
}

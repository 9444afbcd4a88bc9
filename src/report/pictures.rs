//! Pictures that a run has drawn, as far as a page has room for them.

use crate::plot::escaped;
use perigrain_base::base64;
use perigrain_base::gate;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// So many pictures of one dump at most.
const OF_EACH: usize = 12;
/// A larger file is left out.
const LARGEST: u64 = 4_000_000;
/// And what goes beyond this together.
const TOGETHER: u64 = 24_000_000;

/// A picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Its file's name.
    pub name: String,
    /// The MIME type.
    pub kind: &'static str,
    /// The file.
    pub bytes: Vec<u8>,
}

/// The pictures of a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Gallery {
    /// Those that are shown.
    pub pictures: Vec<Picture>,
    /// What was left out, and why.
    pub left_out: Vec<String>,
}

/// The pictures of these names, `*` in them stands for digits, that were written since a moment.
pub fn gathered<'a>(names: impl IntoIterator<Item = &'a str>, since: SystemTime) -> Gallery {
    let mut out = Gallery::default();
    let mut room = TOGETHER;
    for name in names {
        let Some(kind) = kind(name) else {
            out.left_out.push(format!("{name}: no browser shows pictures of this kind"));
            continue;
        };
        let all = files(name, since);
        let stride = all.len().div_ceil(OF_EACH).max(1);
        if stride > 1 {
            let few = all.len().div_ceil(stride);
            out.left_out.push(format!("{name}: {few} of {} are shown, evenly chosen", all.len()));
        }
        // From the end, so that the last one is among them.
        let mut chosen: Vec<_> = all.iter().rev().step_by(stride).collect();
        chosen.reverse();
        for path in chosen {
            out.take(path, kind, &mut room);
        }
    }
    out
}

impl Gallery {
    fn take(&mut self, path: &Path, kind: &'static str, room: &mut u64) {
        let name = path.display().to_string();
        let bytes = match gate::read(path) {
            Ok(bytes) => bytes,
            Err(e) => return self.left_out.push(format!("{name}: {e}")),
        };
        let size = bytes.len() as u64;
        if size > LARGEST.min(*room) {
            return self
                .left_out
                .push(format!("{name}: {:.1} MB are too much for this page", size as f64 / 1e6));
        }
        *room -= size;
        self.pictures.push(Picture { name, kind, bytes });
    }
}

impl Picture {
    /// The picture with its name below.
    pub fn html(&self) -> String {
        let name = escaped(&self.name);
        format!(
            "<figure><img src=\"data:{};base64,{}\" alt=\"picture {name}\" loading=\"lazy\"><figcaption>{name}</figcaption></figure>\n",
            self.kind,
            base64::encode(&self.bytes)
        )
    }
}

fn kind(name: &str) -> Option<&'static str> {
    let ending = Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "png" => Some("image/png"),
        "jpg" | "jpeg" => Some("image/jpeg"),
        _ => None,
    }
}

/// The files that a name with `*` for the step stands for, in the order of steps.
fn files(name: &str, since: SystemTime) -> Vec<PathBuf> {
    let is_new =
        |path: &Path| path.metadata().and_then(|m| m.modified()).is_ok_and(|written| written >= since);
    let path = Path::new(name);
    let last = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
    let Some((before, behind)) = last.split_once('*') else {
        return Some(path.to_owned()).filter(|p| is_new(p)).into_iter().collect();
    };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = gate::list(folder) else { return vec![] };
    let step = |name: &str| -> Option<i64> { name.strip_prefix(before)?.strip_suffix(behind)?.parse().ok() };
    let mut found: Vec<(i64, PathBuf)> = entries
        .flatten()
        .filter_map(|e| {
            let name = e.file_name().into_string().ok()?;
            Some((step(&name)?, path.with_file_name(&name)))
        })
        .filter(|(_, path)| is_new(path))
        .collect();
    found.sort();
    found.into_iter().map(|(_, path)| path).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_in_the_order_of_steps_and_what_is_too_much_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for step in 0..30 {
            std::fs::write(path(&format!("a.{step}.png")), [step]).unwrap();
        }
        std::fs::write(path("b.jpg"), vec![0; LARGEST as usize + 1]).unwrap();
        let names: Vec<String> =
            ["a.*.png", "b.jpg", "c.ppm", "d.png"].map(|n| path(n).display().to_string()).to_vec();
        let of = |since| gathered(names.iter().map(String::as_str), since);
        let gallery = of(SystemTime::UNIX_EPOCH);
        let steps: Vec<u8> = gallery.pictures.iter().map(|p| p.bytes[0]).collect();
        assert_eq!(steps, [2, 5, 8, 11, 14, 17, 20, 23, 26, 29]);
        let left = gallery.left_out.join("\n");
        for part in ["10 of 30 are shown", "b.jpg: 4.0 MB are too much", "c.ppm: no browser"] {
            assert!(left.contains(part), "{left}");
        }
        assert!(gallery.pictures[0].html().contains("data:image/png;base64,Ag==\""));
        let later = SystemTime::now() + std::time::Duration::from_secs(60);
        assert!(of(later).pictures.is_empty());
    }
}

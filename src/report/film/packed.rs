//! Snapshots as the page has them: what changed since the one before, low bytes and high bytes apart, deflated, as text.

use super::{Column, Frame, Values};
use crate::json::{number, quoted};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use perigrain_base::par;
use std::io::Write;
use std::sync::OnceLock;

/// Characters that all snapshots of a page may take.
const ROOM: usize = 48_000_000;

/// The snapshots of a page.
#[derive(Clone, Debug, Default)]
pub struct Packed {
    /// What scripts read of them.
    pub json: String,
    /// Their numbers.
    pub frames: Vec<String>,
    /// How many there would have been.
    pub of: usize,
}

impl Packed {
    /// The page's remark where snapshots are left out.
    pub fn thinned(&self) -> Option<String> {
        let shown = self.frames.len();
        (shown < self.of).then(|| {
            format!("The view shows {shown} of {} snapshots that were taken, evenly chosen: a page has room for so much.", self.of)
        })
    }
}

/// As many of these snapshots as there is room for, evenly chosen, the last one among them.
pub fn packed(frames: &[Frame]) -> Packed {
    within(frames, ROOM)
}

fn within(frames: &[Frame], room: usize) -> Packed {
    let mut stride = 1;
    loop {
        let mut chosen: Vec<&Frame> = frames.iter().rev().step_by(stride).collect();
        chosen.reverse();
        let texts = texts(&chosen);
        let size: usize = texts.iter().map(String::len).sum();
        if size <= room || chosen.len() <= 1 {
            let heads: Vec<String> = (0..chosen.len()).map(|k| head(&chosen, k)).collect();
            return Packed {
                json: format!("{{\"frames\":[{}]}}", heads.join(",\n")),
                frames: texts,
                of: frames.len(),
            };
        }
        // Fewer of them differ more from each other.
        stride = (stride * size).div_ceil(room).max(stride + 1);
    }
}

/// One snapshot by itself with its number, for an open page: the length of its header, the header, and its numbers.
pub fn packed_one(id: usize, frame: &Frame) -> Vec<u8> {
    let head = format!("{{\"id\":{id},\"frame\":{}}}", head(&[frame], 0));
    let mut out = (head.len() as u32).to_le_bytes().to_vec();
    out.extend(head.as_bytes());
    out.extend(deflated(&planes(frame, None)));
    out
}

/// Each snapshot as text, made on all threads.
fn texts(frames: &[&Frame]) -> Vec<String> {
    let slots: Vec<OnceLock<String>> = frames.iter().map(|_| OnceLock::new()).collect();
    par::for_rows(frames.len(), |k| {
        slots[k].get_or_init(|| {
            let before = k.checked_sub(1).map(|b| frames[b]).filter(|b| follows(frames[k], b));
            perigrain_base::base64::encode(&deflated(&planes(frames[k], before)))
        });
    });
    slots.into_iter().filter_map(OnceLock::into_inner).collect()
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(4));
    // Writing into memory does not fail.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

/// Whether one snapshot can be stored as its difference from another.
fn follows(frame: &Frame, before: &Frame) -> bool {
    let kind = |c: &Column| (c.name.clone(), bits(c));
    frame.len() == before.len()
        && frame.grid == before.grid
        && frame.columns.iter().map(kind).eq(before.columns.iter().map(kind))
}

fn bits(column: &Column) -> u32 {
    match column.values {
        Values::Same => 0,
        Values::Bytes(_) => 8,
        Values::Words(_) => 16,
    }
}

/// All numbers of a snapshot, without what they were before.
fn planes(frame: &Frame, before: Option<&Frame>) -> Vec<u8> {
    let mut out = Vec::with_capacity(frame.bytes());
    for d in 0..3 {
        words(&mut out, &frame.x[d], before.map(|b| &b.x[d][..]));
    }
    for (k, column) in frame.columns.iter().enumerate() {
        match (&column.values, before.map(|b| &b.columns[k].values)) {
            (Values::Same, _) => {}
            (Values::Bytes(now), Some(Values::Bytes(was))) => {
                out.extend(now.iter().zip(was).map(|(now, was)| now.wrapping_sub(*was)));
            }
            (Values::Bytes(now), _) => out.extend(now),
            (Values::Words(now), Some(Values::Words(was))) => words(&mut out, now, Some(was)),
            (Values::Words(now), _) => words(&mut out, now, None),
        }
    }
    out
}

fn words(out: &mut Vec<u8>, now: &[u16], was: Option<&[u16]>) {
    let change = |k: usize| now[k].wrapping_sub(was.map_or(0, |was| was[k]));
    out.extend((0..now.len()).map(|k| change(k) as u8));
    out.extend((0..now.len()).map(|k| (change(k) >> 8) as u8));
}

/// The walls of a snapshot where they are others than those of the one before: how many triangles, and their corners as packed text.
fn walls(frame: &Frame, before: Option<&Frame>) -> String {
    if before.is_some_and(|b| b.walls == frame.walls) {
        return "null".into();
    }
    let bytes: Vec<u8> =
        frame.walls.as_flattened().as_flattened().iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    quoted(&perigrain_base::base64::encode(&bytes))
}

/// The header of a snapshot.
fn head(frames: &[&Frame], k: usize) -> String {
    let frame = frames[k];
    let before = k.checked_sub(1).map(|b| frames[b]);
    let three = |v: [f64; 3]| format!("[{}]", v.map(number).join(","));
    let columns: Vec<String> = frame.columns.iter().map(of_column).collect();
    format!(
        "{{\"step\":{},\"time\":{},\"n\":{},\"follows\":{},\"origin\":{},\"cell\":{},\"corner\":{},\"edges\":[{}],\"units\":[{}],\"walls\":{},\"least\":{},\"most\":{},\"columns\":[{}]}}",
        frame.step,
        frame.time.map_or("null".into(), number),
        frame.len(),
        before.is_some_and(|b| follows(frame, b)),
        three(frame.grid.origin),
        three(frame.grid.cell),
        three(frame.cell.origin),
        frame.cell.edges.map(three).join(","),
        frame.units.map(quoted).join(","),
        walls(frame, before),
        three(frame.span[0]),
        three(frame.span[1]),
        columns.join(",")
    )
}

fn of_column(c: &Column) -> String {
    let [lo, hi, least, most] = [c.ends[0], c.ends[1], c.span[0], c.span[1]].map(number);
    format!(
        "{{\"name\":{},\"bits\":{},\"lo\":{lo},\"hi\":{hi},\"least\":{least},\"most\":{most}}}",
        quoted(&c.name),
        bits(c)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::film::{Cell, Grid};
    use flate2::write::ZlibDecoder;

    /// A snapshot decoded from its bytes, its header and the one before: what the page's script does.
    fn unpacked(bytes: &[u8], like: &Frame, before: Option<&Frame>) -> Option<Frame> {
        let mut decoder = ZlibDecoder::new(Vec::new());
        decoder.write_all(bytes).ok()?;
        let bytes = decoder.finish().ok()?;
        let (n, mut at) = (like.len(), 0);
        let before = before.filter(|b| follows(like, b));
        let mut take = |len: usize| {
            at += len;
            bytes.get(at - len..at)
        };
        let join = |low: &[u8], high: &[u8], was: Option<&[u16]>| -> Vec<u16> {
            let word = |k: usize| u16::from_le_bytes([low[k], high[k]]).wrapping_add(was.map_or(0, |w| w[k]));
            (0..n).map(word).collect()
        };
        let mut out = Frame { x: Default::default(), columns: vec![], ..like.clone() };
        for d in 0..3 {
            out.x[d] = join(take(n)?, take(n)?, before.map(|b| &b.x[d][..]));
        }
        for (k, column) in like.columns.iter().enumerate() {
            let was = before.map(|b| &b.columns[k].values);
            let values = match (&column.values, was) {
                (Values::Same, _) => Values::Same,
                (Values::Bytes(_), Some(Values::Bytes(was))) => {
                    Values::Bytes(take(n)?.iter().zip(was).map(|(c, w)| c.wrapping_add(*w)).collect())
                }
                (Values::Bytes(_), _) => Values::Bytes(take(n)?.to_vec()),
                (Values::Words(_), Some(Values::Words(was))) => {
                    Values::Words(join(take(n)?, take(n)?, Some(was)))
                }
                (Values::Words(_), _) => Values::Words(join(take(n)?, take(n)?, None)),
            };
            out.columns.push(Column { values, ..column.clone() });
        }
        Some(out)
    }

    fn frame(step: i64, shift: u16) -> Frame {
        let list: Vec<u16> = (0..500).map(|k| k * 131).collect();
        let moved: Vec<u16> = list.iter().map(|k| k.wrapping_add(shift)).collect();
        let values: Vec<f64> = (0..500).map(|k| f64::from(k) * 0.37 + f64::from(shift)).collect();
        Frame {
            step,
            time: None,
            cell: Cell::upright([[0.0; 3], [1.0; 3]]),
            units: ["m", "s", "m/s"],
            walls: [[[0.0; 3], [1.0; 3], [0.0, 0.0, 1.0]]].into(),
            span: [[0.0; 3], [1.0; 3]],
            grid: Grid { origin: [0.0; 3], cell: [1.0; 3] },
            x: [list.clone(), moved, list],
            columns: vec![Column::of("v", &values), Column::of("same", &[2.0; 500])],
        }
    }

    #[test]
    fn what_is_packed_is_unpacked_alike() {
        let frames = [frame(0, 0), frame(10, 3), frame(20, 65_000)];
        let packed = packed(&frames);
        assert_eq!((packed.frames.len(), packed.thinned()), (3, None));
        assert_eq!(packed.json.matches("\"follows\":true").count(), 2);
        // Walls that rest are there once: three corners of four bytes, 48 characters.
        assert_eq!(packed.json.matches("\"walls\":null").count(), 2);
        let text = packed.json.split("\"walls\":\"").nth(1).unwrap().split('"').next().unwrap();
        assert_eq!(text.len(), 48);
        let mut before: Option<Frame> = None;
        for (text, like) in packed.frames.iter().zip(&frames) {
            let back =
                unpacked(&perigrain_base::base64::decode(text.as_bytes()), like, before.as_ref()).unwrap();
            assert_eq!(back, *like);
            before = Some(back);
        }
        assert!(unpacked(b"no stream", &frames[0], None).is_none());
    }

    #[test]
    fn too_many_are_thinned_evenly_and_the_last_one_stays() {
        let frames: Vec<Frame> = (0..10).map(|k| frame(k, 777 * k as u16)).collect();
        let all = within(&frames, usize::MAX).frames;
        let few = within(&frames, all.iter().map(String::len).sum::<usize>() / 2);
        assert!(few.frames.len() < 7 && few.json.contains("\"step\":9,"), "{}", few.json);
        assert!(few.thinned().unwrap().contains("of 10 snapshots"));
        assert_eq!(within(&frames, 1).frames.len(), 1);
    }
}

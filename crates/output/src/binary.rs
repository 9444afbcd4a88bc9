//! LAMMPS' binary dumps: snapshots of the styles `atom` and `custom` as they lie in memory, written and read back as text.
//!
//! A snapshot (revision 2), all numbers little-endian: minus the length of the style's name (8 bytes) and that name, 1 and 2 (4 bytes
//! each), step and number of rows (8), whether the box is tilted and what its six faces do (4 each), the faces and tilts (8 each),
//! the number of columns and the length of the units' name (4 each), that name, one byte for whether a time follows, the time, the
//! length of the line of labels (4) and the line, the number of blocks; each block is how many numbers there are (4) and the
//! numbers (8 each), row by row.

use super::dump::Field;
use super::make;
use perigrain_base::math::cformat::shortest;
use perigrain_base::par;
use std::io::{Error, ErrorKind, Result, Write};

/// Endings of names of binary dumps.
pub const ENDINGS: [&str; 2] = [".bin", ".lammpsbin"];

/// What the faces of a box do, by the numbers that stand for it.
const FACES: [u8; 4] = *b"pfsm";

/// One snapshot.
pub struct Binary<'a> {
    /// The style's name in the file.
    pub magic: &'static str,
    /// Whether there is anything before the rows.
    pub header: bool,
    /// Step number.
    pub step: i64,
    /// Simulated time, for `dump_modify time yes`.
    pub time: Option<f64>,
    /// Unit system, for `dump_modify units yes`.
    pub units: Option<&'a str>,
    /// Lower and upper faces of the upright box around the box.
    pub bounds: [[f64; 2]; 3],
    /// How the box leans, where it is one that may.
    pub tilt: Option<[f64; 3]>,
    /// Boundary letters, as `pp ff sm`.
    pub boundary: &'a str,
    /// Particle indices in the order of the rows.
    pub rows: &'a [u32],
    /// Columns from left to right.
    pub fields: &'a [Field<'a>],
}

impl Binary<'_> {
    /// Writes the snapshot.
    ///
    /// # Errors
    /// Those of the file, and more numbers than a block can have.
    pub fn write(&self, to: &mut dyn Write) -> Result<()> {
        let count = i32::try_from(self.rows.len() * self.fields.len())
            .map_err(|_| Error::other("there are more than 2147483647 numbers in a snapshot"))?;
        if self.header {
            to.write_all(&self.head())?;
        }
        to.write_all(&count.to_le_bytes())?;
        let some = |rows: &[u32]| -> Vec<u8> {
            let numbers = rows.iter().flat_map(|&i| self.fields.iter().map(move |f| number(f, i as usize)));
            numbers.flat_map(f64::to_le_bytes).collect()
        };
        let chunks: Vec<&[u32]> = self.rows.chunks(par::CHUNK).collect();
        for batch in chunks.chunks(64) {
            for bytes in make(batch.len(), |k| some(batch[k])) {
                to.write_all(&bytes)?;
            }
        }
        Ok(())
    }

    fn head(&self) -> Vec<u8> {
        let mut out = vec![];
        let whole = |out: &mut Vec<u8>, k: i32| out.extend(k.to_le_bytes());
        out.extend((-(self.magic.len() as i64)).to_le_bytes());
        out.extend_from_slice(self.magic.as_bytes());
        whole(&mut out, 1);
        whole(&mut out, 2);
        out.extend(self.step.to_le_bytes());
        out.extend((self.rows.len() as i64).to_le_bytes());
        whole(&mut out, i32::from(self.tilt.is_some()));
        for letter in self.boundary.bytes().filter(|b| *b != b' ') {
            whole(&mut out, FACES.iter().position(|f| *f == letter).unwrap_or(0) as i32);
        }
        let tilt = self.tilt.iter().flatten();
        self.bounds.iter().flatten().chain(tilt).for_each(|face| out.extend(face.to_le_bytes()));
        whole(&mut out, self.fields.len() as i32);
        let units = self.units.unwrap_or("");
        whole(&mut out, units.len() as i32);
        out.extend_from_slice(units.as_bytes());
        out.push(u8::from(self.time.is_some()));
        self.time.into_iter().for_each(|time| out.extend(time.to_le_bytes()));
        let labels = self.fields.iter().map(|f| f.name).collect::<Vec<_>>().join(" ");
        whole(&mut out, labels.len() as i32);
        out.extend_from_slice(labels.as_bytes());
        whole(&mut out, 1);
        out
    }
}

/// A value as a number: a type's name is the type.
fn number(field: &Field, i: usize) -> f64 {
    match &field.data {
        super::dump::Data::Text(_, which) => which(i) as f64 + 1.0,
        data => data.number(i),
    }
}

/// A cursor over the bytes of a file.
struct Bytes<'a> {
    all: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8]> {
        let some = self.at.checked_add(n).and_then(|end| self.all.get(self.at..end));
        let some = some.ok_or_else(|| odd(format!("it breaks off after {} bytes", self.all.len())))?;
        self.at += n;
        Ok(some)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N)?);
        Ok(out)
    }

    fn whole(&mut self) -> Result<i32> {
        self.array().map(i32::from_le_bytes)
    }

    fn long(&mut self) -> Result<i64> {
        self.array().map(i64::from_le_bytes)
    }

    fn real(&mut self) -> Result<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// A length, which is not negative.
    fn length(&mut self) -> Result<usize> {
        let n = self.whole()?;
        usize::try_from(n).map_err(|_| odd(format!("byte {}: {n} is no length", self.at - 4)))
    }

    fn text(&mut self, n: usize) -> Result<&'a str> {
        std::str::from_utf8(self.take(n)?).map_err(|_| odd(format!("byte {}: no text", self.at - n)))
    }
}

fn odd(text: String) -> Error {
    Error::new(ErrorKind::InvalidData, text)
}

/// A binary dump as the text dump with the same content, numbers to the last bit.
///
/// # Errors
/// Other files, truncated files, files from a machine of the other byte order.
pub fn as_text(all: &[u8]) -> Result<String> {
    let (mut bytes, mut text) = (Bytes { all, at: 0 }, String::new());
    while bytes.at < all.len() {
        snapshot(&mut bytes, &mut text)?;
    }
    Ok(text)
}

fn snapshot(bytes: &mut Bytes, text: &mut String) -> Result<()> {
    let length = bytes.long()?;
    let known = ["DUMPATOM", "DUMPCUSTOM"].into_iter().find(|m| length == -(m.len() as i64));
    match known {
        Some(magic) if bytes.take(magic.len())? == magic.as_bytes() => {}
        _ => {
            return Err(odd(format!(
                "byte {}: no snapshot of a binary dump (revision 2) begins here",
                bytes.at
            )));
        }
    }
    if (bytes.whole()?, bytes.whole()?) != (1, 2) {
        return Err(odd("it is of another byte order or revision".into()));
    }
    let (step, rows) = (bytes.long()?, bytes.long()?);
    let leans = bytes.whole()?;
    if leans != 0 && leans != 1 {
        return Err(odd("its box is neither orthogonal nor a restricted triclinic one".into()));
    }
    let mut faces = String::new();
    for k in 0..6 {
        let face = bytes.whole()?;
        let letter = usize::try_from(face).ok().and_then(|f| FACES.get(f));
        faces.push(*letter.ok_or_else(|| odd(format!("a face of the box does {face}")))? as char);
        faces.push_str(if k % 2 == 1 { " " } else { "" });
    }
    let mut bounds = [0.0; 6];
    for face in &mut bounds {
        *face = bytes.real()?;
    }
    let mut tilt = vec![];
    for _ in 0..3 * leans {
        tilt.push(bytes.real()?);
    }
    let (columns, units) = (bytes.length()?, bytes.length()?);
    let units = bytes.text(units)?;
    let time = if bytes.take(1)? == [0] { None } else { Some(bytes.real()?) };
    let labels = bytes.length()?;
    let labels = bytes.text(labels)?;
    if columns == 0 || labels.split_ascii_whitespace().count() != columns {
        return Err(odd(format!("{columns} columns have the labels `{labels}`")));
    }
    for (item, value) in [
        ("UNITS", Some(units.to_string()).filter(|u| !u.is_empty())),
        ("TIME", time.map(|t| shortest(t).to_string())),
    ] {
        value.into_iter().for_each(|value| text.push_str(&format!("ITEM: {item}\n{value}\n")));
    }
    text.push_str(&format!(
        "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{rows}\nITEM: BOX BOUNDS {}{}\n",
        if leans == 1 { "xy xz yz " } else { "" },
        faces.trim()
    ));
    for (k, [lo, hi]) in bounds.as_chunks::<2>().0.iter().enumerate() {
        text.push_str(&format!("{} {}", shortest(*lo), shortest(*hi)));
        tilt.get(k).into_iter().for_each(|tilt| text.push_str(&format!(" {}", shortest(*tilt))));
        text.push('\n');
    }
    text.push_str(&format!("ITEM: ATOMS {labels}\n"));
    numbers(bytes, text, (rows, columns))
}

/// The blocks of a snapshot, one for each process that wrote it.
fn numbers(bytes: &mut Bytes, text: &mut String, (rows, columns): (i64, usize)) -> Result<()> {
    let (blocks, mut have) = (bytes.length()?, 0i64);
    for _ in 0..blocks {
        let count = bytes.length()?;
        if count % columns != 0 {
            return Err(odd(format!("{count} numbers are no rows of {columns}")));
        }
        for row in bytes.take(count.saturating_mul(8))?.chunks_exact(8 * columns) {
            for (k, number) in row.as_chunks::<8>().0.iter().enumerate() {
                text.push_str(if k > 0 { " " } else { "" });
                text.push_str(&shortest(f64::from_le_bytes(*number)).to_string());
            }
            text.push('\n');
            have += 1;
        }
    }
    match have == rows {
        true => Ok(()),
        false => Err(odd(format!("a snapshot has {have} rows and not {rows}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::dump::Data;
    use super::*;
    use proptest::prelude::*;

    fn written(header: bool) -> Vec<u8> {
        let (tags, x) = ([3, 1, 2], [0.1, -1e-300, 7.0]);
        let names = ["Si".to_string()];
        let field = |name, data| Field { name, format: None, data };
        let fields = [
            field("id", Data::int(|i| tags[i])),
            field("x", Data::slice(&x)),
            field("element", Data::Text(&names, Box::new(|_| 0))),
        ];
        let bounds = [[0.0, 4.0], [-0.5, 0.5], [0.0, 1.0 / 3.0]];
        let (time, units, boundary) = (Some(0.25), Some("si"), "pp fs mm");
        let mut out = vec![];
        Binary {
            magic: "DUMPCUSTOM",
            header,
            step: 7,
            time,
            units,
            bounds,
            tilt: None,
            boundary,
            rows: &[1, 2, 0],
            fields: &fields,
        }
        .write(&mut out)
        .unwrap();
        out
    }

    #[test]
    fn numbers_come_back_as_text() {
        let twice = [written(true), written(true)].concat();
        let once = "ITEM: UNITS\nsi\nITEM: TIME\n0.25\nITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n3\n\
                    ITEM: BOX BOUNDS pp fs mm\n0 4\n-0.5 0.5\n0 0.3333333333333333\nITEM: ATOMS id x element\n\
                    1 -1e-300 1\n2 7 1\n3 0.1 1\n";
        assert_eq!(as_text(&twice).unwrap(), once.repeat(2));
        assert!(as_text(&written(false)).is_err());
    }

    proptest! {
        #[test]
        fn damaged_files_are_refused_or_read(at in 0usize..400, byte: u8, end in 0usize..400) {
            let mut all = written(true);
            if let Some(b) = all.get_mut(at) {
                *b = byte;
            }
            all.truncate(end);
            let _ = as_text(&all);
        }
    }
}

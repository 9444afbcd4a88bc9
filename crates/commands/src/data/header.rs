//! The header of a data file: how many particles and types, and the box.

use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_geometry::text::{Line, Lines, not_here, number, whole};

/// The content of the header.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Number of particles.
    pub atoms: usize,
    /// Number of types.
    pub types: usize,
    /// Lower corner of the box [length].
    pub lo: [f64; 3],
    /// Upper corner.
    pub hi: [f64; 3],
    /// How the box leans (xy, xz, yz), if the file has it [length].
    pub tilt: Option<[f64; 3]>,
    /// Where the number of particles stands.
    pub atoms_at: Option<Span>,
    /// Number of bonds.
    pub bonds: usize,
    /// Number of bond types.
    pub bond_types: usize,
    /// Where the number of bonds or their types stands.
    pub bonds_at: Option<Span>,
    /// Number of angles.
    pub angles: usize,
    /// Number of angle types.
    pub angle_types: usize,
    /// Where the number of angles or their types stands.
    pub angles_at: Option<Span>,
}

impl Default for Header {
    /// LAMMPS' defaults: no particles in a box of edge length 1 around the origin.
    fn default() -> Self {
        let (lo, hi) = ([-0.5; 3], [0.5; 3]);
        Self {
            atoms: 0,
            types: 0,
            lo,
            hi,
            tilt: None,
            atoms_at: None,
            bonds: 0,
            bond_types: 0,
            bonds_at: None,
            angles: 0,
            angle_types: 0,
            angles_at: None,
        }
    }
}

/// Header words with a count that must be zero here.
const COUNTS: [&str; 11] = [
    "dihedrals",
    "impropers",
    "dihedral types",
    "improper types",
    "extra dihedral per atom",
    "extra improper per atom",
    "ellipsoids",
    "lines",
    "triangles",
    "bodies",
    "crossterms",
];

/// Header words of general triclinic boxes.
const SLANTED: [&str; 4] = ["avec", "bvec", "cvec", "abc origin"];

/// Reads the header; the first line of the file is a title. The cursor stands before the first section afterwards.
///
/// # Errors
/// Lines that are neither header nor section, dihedrals, general triclinic boxes, faces in the wrong order.
pub fn read(lines: &mut Lines) -> Result<Header> {
    let mut header = Header::default();
    lines.take();
    while let Some(line) = lines.peek() {
        if line.is_blank() {
            lines.take();
            continue;
        }
        let mut words: Vec<&str> = line.words().collect();
        let first = words.iter().position(|w| w.starts_with(|c: char| c.is_ascii_alphabetic()));
        // A section begins with its name, a header line with its values.
        let Some(first) = first.filter(|k| *k > 0) else {
            if first == Some(0) {
                break;
            }
            let text = "a line of numbers stands before the first section";
            return fail(Code::SYNTAX, line.span(), text);
        };
        let name = words.split_off(first).join(" ");
        take(&mut header, &line, &words, &name)?;
        lines.take();
    }
    Ok(header)
}

fn take(header: &mut Header, line: &Line, values: &[&str], name: &str) -> Result<()> {
    match name {
        "atoms" => {
            header.atoms = count(line, values, name)?;
            header.atoms_at = Some(line.span_of(values[0]));
        }
        "atom types" => header.types = count(line, values, name)?,
        "bonds" | "bond types" => {
            let n = count(line, values, name)?;
            if n > 0 {
                header.bonds_at = Some(line.span_of(values[0]));
            }
            *(if name == "bonds" { &mut header.bonds } else { &mut header.bond_types }) = n;
        }
        "angles" | "angle types" => {
            let n = count(line, values, name)?;
            if n > 0 {
                header.angles_at = Some(line.span_of(values[0]));
            }
            *(if name == "angles" { &mut header.angles } else { &mut header.angle_types }) = n;
        }
        // Lists grow as they must.
        "extra bond per atom" | "extra angle per atom" | "extra special per atom" => {
            count(line, values, name)?;
        }
        "xlo xhi" => edge(header, 0, line, values)?,
        "ylo yhi" => edge(header, 1, line, values)?,
        "zlo zhi" => edge(header, 2, line, values)?,
        "xy xz yz" => {
            let &[xy, xz, yz] = values else {
                return fail(Code::SYNTAX, line.span(), "`xy xz yz` takes three tilts before it");
            };
            let tilt = |word: &str, what: &str| number(line, word, what);
            header.tilt =
                Some([tilt(xy, "the tilt xy")?, tilt(xz, "the tilt xz")?, tilt(yz, "the tilt yz")?]);
        }
        _ if SLANTED.contains(&name) => {
            let d = not_here(line.span(), "a general triclinic box");
            return Err(d.help("a restricted one has xlo xhi, ylo yhi, zlo zhi and xy xz yz").into());
        }
        _ if COUNTS.contains(&name) => {
            if count(line, values, name)? > 0 {
                return Err(not_here(line.span(), &format!("`{name}` in a data file")).into());
            }
        }
        _ => {
            let known = [
                "atoms",
                "atom types",
                "bonds",
                "bond types",
                "angles",
                "angle types",
                "xlo xhi",
                "ylo yhi",
                "zlo zhi",
                "xy xz yz",
            ];
            let text = format!("`{name}` is no header line of a data file");
            let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, line.span(), text);
            return Err(match perigrain_base::diag::nearest(name, known) {
                Some(n) => d.help(format!("did you mean `{n}`?")),
                None => d.help(format!("known: {}", known.join(", "))),
            }
            .into());
        }
    }
    Ok(())
}

fn count(line: &Line, values: &[&str], name: &str) -> Result<usize> {
    let &[word] = values else {
        return fail(Code::SYNTAX, line.span(), format!("`{name}` takes one number before it"));
    };
    let k = whole(line, word, &format!("the number of {name}"))?;
    match usize::try_from(k) {
        Ok(n) if n <= u32::MAX as usize => Ok(n),
        _ => fail(Code::BAD_VALUE, line.span_of(word), format!("there cannot be {k} {name}")),
    }
}

fn edge(header: &mut Header, d: usize, line: &Line, values: &[&str]) -> Result<()> {
    let &[lo, hi] = values else {
        return fail(Code::SYNTAX, line.span(), "two numbers, the lower and the upper face, are needed here");
    };
    let (a, b) = (number(line, lo, "the lower face")?, number(line, hi, "the upper face")?);
    if b <= a {
        let text = format!("the upper face must lie above the lower one, but {hi} is not above {lo}");
        return fail(Code::BAD_VALUE, line.span_of(lo).to(line.span_of(hi)), text);
    }
    (header.lo[d], header.hi[d]) = (a, b);
    Ok(())
}

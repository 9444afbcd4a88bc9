//! Forged restart files: a real one with bytes changed and its checksum corrected.

use perigrain::session::{Mode, Options, Session};
use std::fs;
use std::path::{Path, PathBuf};

/// Where the scene begins: magic, format, fingerprint, and the program's version with its length.
fn begin(file: &[u8]) -> usize {
    17 + file.get(16).map_or(0, |n| usize::from(*n))
}

/// What follows the scene: its length, the checksum, the end's mark.
const TAIL: usize = 8 + 4 + 8;

/// The checksum's remainders by bytes (CRC-32, reflected).
const REMAINDERS: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut rest = byte as u32;
        let mut bit = 0;
        while bit < 8 {
            rest = if rest & 1 == 1 { 0xedb8_8320 ^ (rest >> 1) } else { rest >> 1 };
            bit += 1;
        }
        table[byte] = rest;
        byte += 1;
    }
    table
};

fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |rest: u32, b| REMAINDERS[usize::from(rest as u8 ^ b)] ^ (rest >> 8))
}

/// Numbers that make a difference where a number stands.
const NUMBERS: [f64; 10] =
    [0.0, -0.0, 1.0, -1.0, 1e-320, 1e308, -1e308, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// A restart file changed as a recipe says, with its length and checksum mended. Every six bytes of the recipe are a change: what,
/// where (three bytes), with what.
pub fn forge(file: &[u8], recipe: &[u8]) -> Vec<u8> {
    let (begin, end) = (begin(file), file.len().saturating_sub(TAIL));
    let (head, scene) = (&file[..begin.min(end)], &file[begin.min(end)..end]);
    let mut scene = scene.to_vec();
    for change in recipe.chunks_exact(6) {
        let at = usize::from(change[1]) << 16 | usize::from(change[2]) << 8 | usize::from(change[3]);
        let at = at % (scene.len() + 1);
        let (count, byte) = (1 + usize::from(change[4] % 8), change[5]);
        let upto = (at + count).min(scene.len());
        match change[0] % 10 {
            0 => scene[at..upto].fill(byte),
            1 => scene[at..upto.min(at + 1)].iter_mut().for_each(|b| *b ^= 1 << (byte % 8)),
            2 => scene[at..upto.min(at + 1)].iter_mut().for_each(|b| *b = b.wrapping_add(1)),
            3 => scene[at..upto.min(at + 1)].iter_mut().for_each(|b| *b = b.wrapping_sub(1)),
            4 => drop(scene.splice(at..at, vec![byte; count])),
            5 => drop(scene.drain(at..upto)),
            // The largest numbers of one to eight bytes, as the format writes them.
            6 => {
                scene[at..upto].fill(0xff);
                scene[at..upto].last_mut().into_iter().for_each(|b| *b = byte & 0x7f);
            }
            7 => {
                let number = NUMBERS[usize::from(byte) % NUMBERS.len()].to_le_bytes();
                scene[at..].iter_mut().zip(number).for_each(|(b, n)| *b = n);
            }
            8 => {
                let from = at.wrapping_mul(usize::from(byte) + 2) % (scene.len() + 1);
                let piece = scene[from..(from + count).min(scene.len())].to_vec();
                scene[at..].iter_mut().zip(piece).for_each(|(b, n)| *b = n);
            }
            // One number of eight bytes in the place of another.
            _ => {
                let from = at.saturating_sub(8 * count);
                let piece = scene[from..(from + 8).min(scene.len())].to_vec();
                scene[at..].iter_mut().zip(piece).for_each(|(b, n)| *b = n);
            }
        }
    }
    sealed([head, &scene].concat())
}

/// A file without its end, with it.
fn sealed(mut file: Vec<u8>) -> Vec<u8> {
    let length = file.len() as u64;
    file.extend(length.to_le_bytes());
    file.extend(checksum(&file).to_le_bytes());
    file.extend(*b"\x1aGRNDONE");
    file
}

/// A scene with a restart file in the middle of it.
pub struct Case {
    /// The file as it was written.
    pub file: Vec<u8>,
    /// What is said after it was read.
    pub again: String,
    /// Bonds are kept as a list.
    pub list: bool,
}

impl Case {
    /// Executes a deck that makes a scene, and keeps the file.
    pub fn new(make: &str, again: &str, steps: i64, list: bool) -> Self {
        let folder = tempfile::tempdir().expect("a folder for a file");
        let path = folder.path().join("a.restart");
        let deck = format!("{make}{again}run {steps}\nwrite_restart {}\n", path.display());
        let options = Options { force_list: list, folder: folder.path().to_path_buf(), ..Options::default() };
        let mut session = Session::new(options).expect("a session");
        session.run_text("make.in", &deck).unwrap_or_else(|e| panic!("{deck}\n{e}"));
        Self { file: fs::read(&path).expect("the file just written"), again: again.to_string(), list }
    }

    /// Reads the file changed by a recipe and makes a few steps; the outcome means nothing, a panic everything. `place` is a file
    /// of one's own that is written over. As [`Case::read_whole`].
    pub fn read(&self, recipe: &[u8], place: &Path) -> Option<String> {
        self.read_whole(&forge(&self.file, recipe), place)
    }

    /// The same of a file as it stands; what was said if it, or the run after it, was refused.
    pub fn read_whole(&self, file: &[u8], place: &Path) -> Option<String> {
        fs::write(place, file).ok()?;
        let options = Options {
            mode: Mode::Run,
            force_list: self.list,
            folder: place.parent().map_or(PathBuf::new(), Path::to_path_buf),
            ..Options::default()
        };
        let mut session = Session::new(options).ok()?;
        let read = session.run_text("read.in", &format!("read_restart {}\n", place.display()));
        if let Err(why) = read {
            return Some(why.to_string());
        }
        session.run_text("again.in", &format!("{}run 3\n", self.again)).err().map(|why| why.to_string())
    }
}

/// Any bytes as a recipe for one of a few small scenes, which the first byte chooses.
pub fn forged_restart(bytes: &[u8]) {
    thread_local! {
        static CASES: Vec<Case> = SMALL.iter().map(|[make, again]| Case::new(make, again, 4, false)).collect();
        // One folder for all: to make and remove one takes longer than most cases.
        static FOLDER: tempfile::TempDir = tempfile::tempdir().expect("a folder for files");
    }
    let Some((first, recipe)) = bytes.split_first() else { return };
    let place = FOLDER.with(|folder| folder.path().join("a"));
    CASES.with(|cases| drop(cases[usize::from(*first) % cases.len()].read(recipe, &place)));
}

/// Small scenes of each kind: what makes them, and what is said again.
const SMALL: [[&str; 2]; 4] = [
    [
        "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion b block 0 3 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 region b\n\
         set group all density 2400\nset group all volume 1e-9\nvariable u atom 6000.0*(x-0.0015)\nvelocity all set v_u 0 0 units box\n",
        "pair_style peri/pmb\npair_coeff * * 1.6e21 0.0020001 0.0015 0.25\nneighbor 0.0006 bin\nfix 1 all nve\ntimestep 5.0e-8\n\
         compute d all damage/atom\ncompute s all reduce sum c_d\nthermo_style custom step pe c_s\nthermo 1\n",
    ],
    [
        "units si\natom_style peri\nboundary s s s\nlattice sc 0.001\nregion b block 0 3 0 2 0 2\ncreate_box 1 b\ncreate_atoms 1 region b\n\
         displace_atoms all random 1e-4 1e-4 1e-4 4711 units box\nset group all density 2400\nset group all volume 1e-9\n",
        "pair_style peri/eps\npair_coeff * * 14e9 6e9 0.0020001 0.0035 0.25 1e7\nneighbor 0.0006 bin\nfix 1 all nve\ntimestep 5.0e-8\n\
         compute d all plasticity/atom\ncompute s all reduce sum c_d\nthermo_style custom step pe c_s\nthermo 1\n",
    ],
    [
        "units lj\natom_style sphere\nboundary p f s\nregion w block 0 3 0 3 0 4 units box\ncreate_box 1 w\nlattice sc 1.0\n\
         region i block 0 2.5 0 2.5 0 1.5\ncreate_atoms 1 region i\nset group all diameter 1.02 density 1\n",
        "pair_style granular\npair_coeff * * hertz 5000 20 tangential mindlin 4000 0.7 0.5\nfix 1 all nve/sphere\n\
         fix 2 all gravity 1 vector 0.2 0 -1\nfix 3 all wall/gran hertz/history 5000 NULL 20 NULL 0.5 1 zplane 0.1 NULL\n\
         fix 4 all ave/time 1 2 2 c_thermo_temp ave running\ntimestep 0.001\nthermo_style custom step ke f_4\nthermo 2\n",
    ],
    [
        "units si\natom_style bpm/sphere\nboundary f f f\nlattice sc 0.001\nregion w block -0.01 0.02 -0.01 0.02 -0.01 0.02 units box\n\
         region b block 0 2.1 0 1.1 0 1.1\ncreate_box 1 w bond/types 1 extra/bond/per/atom 20\ncreate_atoms 1 region b\n\
         set group all diameter 0.001 density 2000\ncreate_bonds many all all 1 0.0005 0.0012\nspecial_bonds lj 0 1 1 coul 1 1 1\n",
        "pair_style gran/hooke/history 1e5 NULL 50.0 NULL 0.5 1\npair_coeff * *\nbond_style bpm/rotational\n\
         bond_coeff 1 1.2e5 5e4 4e-3 5e-3 2.4 1.2 2e-4 2e-4 0.05 0.02 1e-6 1e-9\nfix 1 all nve/bpm/sphere\ntimestep 2e-7\n\
         thermo_style custom step ke ebond\nthermo 1\n",
    ],
];

//! K5: memory whose size the input determines is allocated through one function.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// 64 grains in a periodic box.
const GRAINS: &str = "units lj\natom_style hybrid sphere bond\nboundary p p p\nlattice sc 1\nregion b block 0 4 0 4 0 4\n\
     create_box 1 b bond/types 1\ncreate_atoms 1 box\nset group all diameter 0.5 density 1\n\
     special_bonds lj 0 1 1 coul 0 1 1\npair_style gran/hooke 10 NULL 1 NULL 0 0\npair_coeff * *\nfix n all nve/sphere\n";

/// A peridynamic block of 27.
const SOLID: &str = "units si\natom_style peri\nboundary s s s\nlattice sc 1e-3\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\n\
     create_atoms 1 region b\nset group all volume 1e-9\nset group all density 2400\nfix n all nve\ntimestep 1e-9\n";

/// An empty box of SI units.
const EMPTY: &str =
    "units si\natom_style hybrid sphere peri\nboundary f f f\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\n";

/// Every count that input can set: what it counts, the scene before, and the lines with an absurd one.
const ASKED: &[(&str, &str, &str)] = &[
    ("columns of property/atom", GRAINS, "fix p all property/atom d2_x 1000000000"),
    ("whole columns of property/atom", GRAINS, "fix p all property/atom i2_x 9000000000000000000"),
    ("bins of ave/histo", GRAINS, "variable t equal step\nfix a all ave/histo 1 1 1 0 1 1000000000 v_t"),
    ("bins of ave/histo/weight", GRAINS, "fix a all ave/histo/weight 1 1 1 0 1 1000000000 vx vy"),
    ("bins of rdf", GRAINS, "compute r all rdf 1000000000\nrun 0"),
    ("bins of temp/profile", GRAINS, "compute t all temp/profile 1 1 1 xyz 460 460 460\nrun 0"),
    (
        "layers",
        GRAINS,
        "compute c all chunk/atom bin/1d x lower 1e-300\nfix a all ave/chunk 1 1 1 c vx\nrun 1",
    ),
    (
        "bins in space",
        GRAINS,
        "compute c all chunk/atom bin/3d x lower 1e-7 y lower 1e-7 z lower 1e-7\nfix a all ave/chunk 1 1 1 c vx\nrun 1",
    ),
    (
        "shells",
        GRAINS,
        "compute c all chunk/atom bin/sphere 1 1 1 0 1 10000000000\nfix a all ave/chunk 1 1 1 c vx\nrun 1",
    ),
    (
        "chunks by a limit",
        GRAINS,
        "compute c all chunk/atom type limit 10000000000 exact\nfix a all ave/chunk 1 1 1 c vx\nrun 1",
    ),
    (
        "values of a range",
        GRAINS,
        "variable t equal step\nfix v all vector 1 v_t nmax 1000000000\nthermo_style custom step f_v[*]",
    ),
    (
        "values of an outer program",
        GRAINS,
        "fix e all external pf/array 1\nfix_modify e vector 10000000000\nrun 1",
    ),
    ("levels of respa", GRAINS, "run_style respa 1000000000 2 2"),
    ("types", "units lj\natom_style sphere\nregion b block 0 1 0 1 0 1\n", "create_box 60000 b"),
    (
        "types without bound",
        "units lj\natom_style sphere\nregion b block 0 1 0 1 0 1\n",
        "create_box 4000000000 b",
    ),
    ("particles at random", GRAINS, "create_atoms 1 random 1000000000000 1 NULL"),
    ("particles on sites", GRAINS, "lattice sc 1e9\ncreate_atoms 1 box"),
    ("particles per area", GRAINS, "create_atoms 1 mesh t.stl units box meshmode qrand 1e15"),
    ("halves of triangles", GRAINS, "create_atoms 1 mesh t.stl units box meshmode bisect 1e-12"),
    ("packed spheres", GRAINS, "create_atoms 1 pack b 0.5 1 sizes mono 1e-5"),
    ("spheres of an aggregate", GRAINS, "create_atoms 1 aggregate b 0.5 1 0.6 1 sizes mono 1e-5"),
    ("walls of an opal", GRAINS, "create_atoms 1 opal b 1 0.9 0.5 1 sizes mono 1e-5"),
    ("replicas", GRAINS, "replicate 10000 10000 1"),
    ("replicas without bound", GRAINS, "replicate 9000000000 9000000000 9000000000"),
    ("bonds by distance", GRAINS, "create_bonds many all all 1 0 100"),
    ("bonds by any distance", GRAINS, "create_bonds many all all 1 0 1e308"),
    (
        "neighbours by a cutoff",
        GRAINS,
        "pair_style granular\npair_coeff * * hooke 10 1 tangential linear_nohistory 1 0 cutoff 1e4\nrun 1",
    ),
    (
        "neighbours in a few images",
        GRAINS,
        "pair_style granular\npair_coeff * * hooke 10 1 tangential linear_nohistory 1 0 cutoff 100\nrun 1",
    ),
    ("neighbours by the skin", GRAINS, "neighbor 1e6 bin\nrun 1"),
    ("neighbours by the size", GRAINS, "set group all diameter 1e6\nrun 1"),
    (
        "spheres poured at once",
        GRAINS,
        "fix g all gravity 1 vector 0 0 -1\nfix p all pour 100000000000 1 1 region b diam one 1e-5\nrun 1",
    ),
    ("pixels", GRAINS, "write_dump all image x.png type type size 1000000 1000000"),
    (
        "characters of a number",
        GRAINS,
        "variable x equal 1\nvariable f format x %1999999999.3f\nprint \"${f}\"",
    ),
    ("particles of a data file", "units lj\natom_style sphere\n", "read_data atoms.data"),
    ("types of a data file", "units lj\natom_style sphere\n", "read_data types.data"),
    ("bonds of a data file", "units lj\natom_style bond\n", "read_data bonds.data"),
    ("particles of a molecule", GRAINS, "molecule m many.mol"),
    ("particles of a dump", GRAINS, "read_dump many.dump 0 x y z"),
    ("particles of a dump that is run again", GRAINS, "rerun many.dump dump x y z"),
    ("voxels of an NRRD file", EMPTY, "read_voxels deep.nrrd types 0:255 1"),
    ("slices of a packed NRRD file", EMPTY, "read_voxels packed.nrrd types 0:255 1"),
    ("pixels of an NRRD file", EMPTY, "read_voxels wide.nrrd types 0:255 1"),
    ("voxels of a VTI file", EMPTY, "read_voxels big.vti types 0:255 1"),
    ("nodes of a Gmsh file", EMPTY, "read_mesh many.msh type 1"),
    ("points of a VTK file", EMPTY, "read_mesh many.vtk type 1"),
    ("triangles of an STL file", EMPTY, "region m mesh many.stl"),
    ("corners of a PLY file", EMPTY, "region m mesh many.ply"),
    (
        "text",
        GRAINS,
        "variable s string xxxxxxxx\nvariable i loop 40\nlabel a\nvariable s string ${s}${s}\nnext i\njump SELF a",
    ),
];

/// The same for packed files: their size is unknown before.
const PACKED: &[(&str, &str, &str)] = &[
    ("bytes of a packed data file", EMPTY, "read_data b.data.gz add append"),
    ("bytes of a packed dump", GRAINS, "read_dump b.dump.gz 1 x y z"),
    ("bytes of a packed dump that is run again", GRAINS, "rerun b.dump.gz dump x y z"),
    ("bytes of a packed mesh", EMPTY, "read_mesh b.msh.gz type 1"),
    ("bytes of a packed VTK file", EMPTY, "read_mesh b.vtk.gz type 1"),
    ("bytes of a packed table", EMPTY, "read_points b.csv.gz type 1"),
];

/// Counts that are allowed, though they are absurd: nothing of their size is made.
const HARMLESS: &[(&str, &str, &str)] = &[
    ("values kept", GRAINS, "variable t equal step\nfix v all vector 1 v_t nmax 9000000000000000000\nrun 1"),
    (
        "averages in a window",
        GRAINS,
        "fix a all ave/time 1 1 1 c_thermo_temp ave window 9000000000000000000\nrun 1",
    ),
    (
        "ids",
        "units lj\natom_style sphere\n",
        "read_data ids.data\npair_style gran/hooke/history 10 NULL 1 NULL 0 0\npair_coeff * *\nfix n all nve/sphere\nrun 2",
    ),
    ("neighbours of one particle", GRAINS, "neigh_modify one 2000000000 page 2000000000\nrun 1"),
    ("cells of bins", GRAINS, "neigh_modify binsize 1e-9\nrun 1"),
    ("turns of a loop", GRAINS, "variable i loop 1000000000000"),
    ("attempts", GRAINS, "create_atoms 1 random 1 1 NULL maxtry 9000000000000000000"),
    ("steps", GRAINS, "thermo 9000000000000000000\nrestart 9000000000000000000 r.*\nrun 1"),
    (
        "bonds per particle",
        "units lj\natom_style bond\nregion b block 0 1 0 1 0 1\n",
        "create_box 1 b bond/types 1 extra/bond/per/atom 2000000000",
    ),
    ("sites of a horizon", SOLID, "pair_style peri/pmb\npair_coeff 1 1 2e21 1.0 0.004 0.0\nrun 1"),
];

/// The limit under `-safe` [MB].
const LIMIT: u64 = 500;
/// The same for packed files, which would unpack to 300 MB.
const PACKED_LIMIT: u64 = 200;

/// What the files hold that the lines name.
fn write_files(folder: &Path) {
    let write = |name: &str, text: &[u8]| fs::write(folder.join(name), text).unwrap();
    let atoms = "1 1 0.5 2 0 0 0 0 0 0\n2 1 0.5 2 1 0 0 0 0 0\n";
    let data = |counts: &str, rows: &str| {
        format!("t\n\n{counts}\n\n0 4 xlo xhi\n0 4 ylo yhi\n0 4 zlo zhi\n\nAtoms\n\n{rows}").into_bytes()
    };
    write("atoms.data", &data("1000000000 atoms\n2 atom types", atoms));
    write("types.data", &data("2 atoms\n60000 atom types", "1 1 0.5 2 0 0 0\n2 1 0.5 2 1 0 0\n"));
    let bonds = "1 1 1 0 0 0\n2 1 1 1 0 0\n\nBonds\n\n1 1 1 2\n";
    write("bonds.data", &data("2 atoms\n4000000000 bonds\n1 atom types\n1 bond types", bonds));
    write("ids.data", &data("2 atoms\n1 atom types", "1 1 0.5 2 0 0 0\n4294967294 1 0.5 2 1 0 0\n"));
    write("many.mol", b"t\n\n4000000000 atoms\n\nCoords\n\n1 0 0 0\n");
    write(
        "many.dump",
        b"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n4000000000\nITEM: BOX BOUNDS pp pp pp\n0 4\n0 4\n0 4\nITEM: ATOMS id x y z\n1 0 0 0\n",
    );
    for (name, sizes, encoding) in [
        ("deep.nrrd", "3 3 4294967295", "raw"),
        ("wide.nrrd", "100000 100000 1", "raw"),
        ("packed.nrrd", "3 3 4294967295", "gzip"),
    ] {
        let head = format!(
            "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {sizes}\nspacings: 1 1 1\nencoding: {encoding}\n\nx"
        );
        write(name, head.as_bytes());
    }
    write(
        "big.vti",
        b"<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 40000 0 40000 0 40000\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\
          <Piece Extent=\"0 40000 0 40000 0 40000\"><PointData><DataArray type=\"UInt8\" Name=\"g\" format=\"ascii\">1 2\
          </DataArray></PointData></Piece></ImageData></VTKFile>",
    );
    write("many.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4000000000\n1 0 0 0\n$EndNodes\n");
    write(
        "many.vtk",
        b"# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4000000000 double\n0 0 0\n",
    );
    write("many.stl", &[&[b' '; 80][..], &[0xff; 4], &[0; 50]].concat());
    write("many.ply", b"ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n");
    write("t.stl", b"solid t\nfacet normal 0 0 1\nouter loop\nvertex 1 1 1\nvertex 2 1 1\nvertex 1 2 1\nendloop\nendfacet\nendsolid t\n");
    write_packed(folder);
}

/// Small files that unpack to 300 MB: a head, and the same blanks behind each.
fn write_packed(folder: &Path) {
    let pack = |text: &[u8]| {
        let mut out = flate2::write::GzEncoder::new(vec![], flate2::Compression::fast());
        out.write_all(text).unwrap();
        out.finish().unwrap()
    };
    let blanks = pack(&vec![b'\n'; 1 << 20]).repeat(300);
    for (name, head) in [
        ("b.msh.gz", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n"),
        ("b.dump.gz", "ITEM: TIMESTEP\n"),
        ("b.data.gz", "title\n\n"),
        ("b.vtk.gz", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n"),
        ("b.csv.gz", "x,y,z\n"),
    ] {
        fs::write(folder.join(name), [pack(head.as_bytes()), blanks.clone()].concat()).unwrap();
    }
}

/// How a program ended, and the most memory that it had [MB].
struct Ended {
    status: ExitStatus,
    text: String,
    most: u64,
}

/// Runs the program with 4 GiB of addresses.
fn ended(folder: &Path, deck: &str, arguments: &[&str]) -> Ended {
    let printed = fs::File::create(folder.join(format!("{deck}.said"))).unwrap();
    #[expect(clippy::zombie_processes, reason = "wait4 below waits for it")]
    let child = Command::new("sh")
        .args(["-c", "ulimit -v 4194304; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_perigrain")])
        .args(["-in", deck, "-log", "none", "-threads", "1"])
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(printed.try_clone().unwrap())
        .stderr(printed)
        .spawn()
        .unwrap();
    let (mut status, mut usage) = (0, std::mem::MaybeUninit::<libc::rusage>::zeroed());
    // SAFETY: both places are ours, and the child is waited for nowhere else.
    let waited = unsafe { libc::wait4(child.id() as i32, &mut status, 0, usage.as_mut_ptr()) };
    assert!(waited > 0);
    // SAFETY: zeroed, and filled by wait4.
    let usage = unsafe { usage.assume_init() };
    let mut own = std::mem::MaybeUninit::<libc::rusage>::zeroed();
    // SAFETY: the place is ours, zeroed and filled by the call.
    let own = unsafe {
        libc::getrusage(libc::RUSAGE_SELF, own.as_mut_ptr());
        own.assume_init()
    };
    // A started process inherits the peak of its parent: a value not above that of the tests means nothing.
    let most = if usage.ru_maxrss > own.ru_maxrss { usage.ru_maxrss } else { 0 };
    let text = fs::read(folder.join(format!("{deck}.said"))).unwrap();
    Ended {
        status: ExitStatus::from_raw(status),
        text: String::from_utf8_lossy(&text[..text.len().min(3000)]).into_owned(),
        most: most as u64 / 1000,
    }
}

/// Runs all cases, two at a time; what is wrong with each.
fn all(cases: &[(&str, &str, &str)], arguments: &[&str], wrong: impl Fn(&Ended) -> bool + Sync) {
    let folder = tempfile::tempdir().unwrap();
    write_files(folder.path());
    let (next, faults) = (AtomicUsize::new(0), Mutex::new(vec![]));
    let work = || {
        while let Some((what, scene, lines)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
            let deck = format!("in.{}", what.replace([' ', '/'], "_"));
            fs::write(folder.path().join(&deck), format!("{scene}{lines}\n")).unwrap();
            let found = ended(folder.path(), &deck, arguments);
            if wrong(&found) {
                let fault = format!("{what}: {}, {} MB\n{}", found.status, found.most, found.text);
                faults.lock().unwrap().push(fault);
            }
        }
    };
    std::thread::scope(|scope| (0..2).for_each(|_| drop(scope.spawn(work))));
    let faults = faults.into_inner().unwrap();
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), cases.len(), faults.join("\n"));
}

/// Whether there was an error with a code and its line.
fn refused(e: &Ended) -> bool {
    e.status.code() == Some(1) && e.text.contains("error[PG0") && e.text.contains("--> ")
}

#[test]
fn every_count_is_refused_below_the_limit() {
    let limit = LIMIT.to_string();
    all(ASKED, &["-safe", "-limit", "memory", &limit], |e| !refused(e) || e.most > LIMIT);
}

#[test]
fn packed_files_are_no_larger_than_the_limit() {
    let wrong = |e: &Ended| !refused(e) || e.most > PACKED_LIMIT;
    all(PACKED, &["-safe", "-limit", "memory", &PACKED_LIMIT.to_string()], wrong);
}

#[test]
fn without_a_limit_the_machine_is_one() {
    all(ASKED, &[], |e| !refused(e));
}

#[test]
fn what_only_bounds_may_be_absurd() {
    let limit = LIMIT.to_string();
    let well = |e: &Ended| e.status.success() || refused(e);
    all(HARMLESS, &["-safe", "-limit", "memory", &limit], |e| !well(e) || e.most > LIMIT);
}

#[test]
fn a_message_comes_once() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "variable i loop 500\nlabel a\nfix x all nv\nnext i\njump SELF a\n";
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["check", "in.deck"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let printed = super::text(&out);
    let unknown = printed.matches("fix style `nv`").count().max(printed.matches("`nv`").count());
    assert!(printed.contains("this comes 500 times") && printed.contains("1 error"), "{printed}");
    assert!(unknown < 5 && printed.len() < 4000, "{printed}");
}

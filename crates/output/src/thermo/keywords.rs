//! The words of `thermo_style custom` with LAMMPS' column headers.

use super::Kind;

/// A thermo keyword as LAMMPS shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keyword {
    /// As written in a deck.
    pub name: &'static str,
    /// As it stands above the column.
    pub header: &'static str,
    /// Whole numbers or not.
    pub kind: Kind,
    /// Whether `thermo_modify norm yes` divides it by the number of particles.
    pub extensive: bool,
}

const fn int(name: &'static str, header: &'static str) -> Keyword {
    Keyword { name, header, kind: Kind::Int, extensive: false }
}

const fn float(name: &'static str, header: &'static str) -> Keyword {
    Keyword { name, header, kind: Kind::Float, extensive: false }
}

const fn energy(name: &'static str, header: &'static str) -> Keyword {
    Keyword { name, header, kind: Kind::Float, extensive: true }
}

/// LAMMPS 22Jul2025's keywords; whether perigrain can produce one is not decided here.
pub const KEYWORDS: &[Keyword] = &[
    int("step", "Step"),
    int("elapsed", "Elapsed"),
    int("elaplong", "Elaplong"),
    float("dt", "Dt"),
    float("time", "Time"),
    float("cpu", "CPU"),
    float("tpcpu", "T/CPU"),
    float("spcpu", "S/CPU"),
    float("cpuremain", "CPULeft"),
    int("part", "Part"),
    float("timeremain", "TimeoutLeft"),
    int("atoms", "Atoms"),
    float("temp", "Temp"),
    float("press", "Press"),
    energy("pe", "PotEng"),
    energy("ke", "KinEng"),
    energy("etotal", "TotEng"),
    energy("evdwl", "E_vdwl"),
    energy("ecoul", "E_coul"),
    energy("epair", "E_pair"),
    energy("ebond", "E_bond"),
    energy("eangle", "E_angle"),
    energy("edihed", "E_dihed"),
    energy("eimp", "E_impro"),
    energy("emol", "E_mol"),
    energy("elong", "E_long"),
    energy("etail", "E_tail"),
    energy("enthalpy", "Enthalpy"),
    energy("ecouple", "Ecouple"),
    energy("econserve", "Econserve"),
    float("vol", "Volume"),
    float("density", "Density"),
    float("lx", "Lx"),
    float("ly", "Ly"),
    float("lz", "Lz"),
    float("xlo", "Xlo"),
    float("xhi", "Xhi"),
    float("ylo", "Ylo"),
    float("yhi", "Yhi"),
    float("zlo", "Zlo"),
    float("zhi", "Zhi"),
    float("xy", "Xy"),
    float("xz", "Xz"),
    float("yz", "Yz"),
    float("xlat", "Xlat"),
    float("ylat", "Ylat"),
    float("zlat", "Zlat"),
    int("bonds", "Bonds"),
    int("angles", "Angles"),
    int("dihedrals", "Diheds"),
    int("impropers", "Impros"),
    float("pxx", "Pxx"),
    float("pyy", "Pyy"),
    float("pzz", "Pzz"),
    float("pxy", "Pxy"),
    float("pxz", "Pxz"),
    float("pyz", "Pyz"),
    float("fmax", "Fmax"),
    float("fnorm", "Fnorm"),
    int("nbuild", "Nbuild"),
    int("ndanger", "Ndanger"),
    float("cella", "Cella"),
    float("cellb", "Cellb"),
    float("cellc", "Cellc"),
    float("cellalpha", "CellAlpha"),
    float("cellbeta", "CellBeta"),
    float("cellgamma", "CellGamma"),
    float("avecx", "Avecx"),
    float("avecy", "Avecy"),
    float("avecz", "Avecz"),
    float("bvecx", "Bvecx"),
    float("bvecy", "Bvecy"),
    float("bvecz", "Bvecz"),
    float("cvecx", "Cvecx"),
    float("cvecy", "Cvecy"),
    float("cvecz", "Cvecz"),
];

/// Looks a keyword up.
pub fn keyword(name: &str) -> Option<&'static Keyword> {
    KEYWORDS.iter().find(|k| k.name == name)
}

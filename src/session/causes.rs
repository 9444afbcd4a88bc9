//! Check mode reports causes, not their consequences: what a refused line would have provided is not missed again.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics};
use perigrain_lang::Command;
use std::collections::BTreeSet;

/// What refused lines would have provided.
#[derive(Default)]
pub(super) struct Refused {
    names: BTreeSet<String>,
    /// Messages about groups that there are not.
    groups: BTreeSet<String>,
    scene: bool,
    /// A step table was refused, so that its columns are unknown.
    table: bool,
    /// The atom style was refused, so that the properties of particles are unknown.
    particles: bool,
    /// And it is LAMMPS', so that much of what goes with it is so, too.
    particles_of_lammps: bool,
    /// And it is one of LIGGGHTS, so that all of the deck is about other particles.
    foreign: bool,
    /// What words of LIGGGHTS without counterpart were about.
    subjects: BTreeSet<String>,
}

/// Commands that name what they make in their first word.
const NAMING: [&str; 7] = ["variable", "region", "group", "compute", "fix", "dump", "material"];

/// Commands that change what is there, but whose lack makes no later line wrong.
const HARMLESS: [&str; 9] =
    ["thermo", "thermo_style", "thermo_modify", "timestep", "velocity", "print", "run", "if", "dump_modify"];

/// Commands that may stand only before or behind others.
const SETTING: [&str; 20] = [
    "units",
    "atom_style",
    "boundary",
    "dimension",
    "newton",
    "lattice",
    "create_box",
    "create_atoms",
    "read_data",
    "read_mesh",
    "read_points",
    "read_voxels",
    "read_restart",
    "replicate",
    "clear",
    "mass",
    "pair_style",
    "pair_coeff",
    "bond_style",
    "bond_coeff",
];

impl Refused {
    /// Those of a line's problems that no earlier refusal explains; the line counts as refused from now on.
    ///
    /// Where none is left, the line is a consequence.
    pub fn causes(&mut self, line: &str, problems: Diagnostics) -> Diagnostics {
        let elsewhere = problems.0.iter().any(|d| d.code == Code::NOT_SUPPORTED);
        let foreign = problems.0.iter().any(|d| d.code == Code::NO_COUNTERPART);
        let subjects: Vec<String> = problems.0.iter().filter_map(subject).collect();
        let unknown_groups: Vec<String> =
            problems.0.iter().filter(|d| d.code == Code::UNKNOWN_GROUP).map(|d| d.message.clone()).collect();
        let causes = problems.0.into_iter().filter(|d| !self.explains(d)).collect();
        self.groups.extend(unknown_groups);
        let mut words = line.split_whitespace();
        let (command, first) = (words.next().unwrap_or(""), words.next());
        self.table |= command == "thermo_style";
        if command == "atom_style" {
            self.particles = true;
            self.particles_of_lammps |= elsewhere;
            self.foreign |= foreign;
        }
        self.subjects.extend(subjects);
        if NAMING.contains(&command) {
            self.names.extend(first.map(String::from));
        } else if !HARMLESS.contains(&command) {
            self.scene = true;
        }
        Diagnostics(causes)
    }

    /// Notes a line of which only a run determines whether it is reached: the names and the scene it changes may be as before or
    /// changed.
    pub fn perhaps(&mut self, cmd: &Command) {
        let name = cmd.name.text.as_str();
        if NAMING.contains(&name) || ["unfix", "uncompute", "undump"].contains(&name) {
            self.names.extend(cmd.args.first().map(|w| w.text.clone()));
        }
        self.scene |= SETTING.contains(&name);
    }

    fn explains(&self, d: &Diagnostic) -> bool {
        if self.foreign || subject(d).is_some_and(|what| self.subjects.contains(&what)) {
            return true;
        }
        match d.code {
            Code::UNKNOWN_NAME if self.table && d.message.starts_with("no thermo column") => true,
            // A group that is missing is one mistake, in however many lines it stands.
            Code::UNKNOWN_GROUP if self.groups.contains(&d.message) => true,
            code if code.is_unknown_name() || code == Code::DUPLICATE_NAME => {
                self.names.iter().any(|n| d.message.contains(&format!("`{n}`")))
            }
            Code::WRONG_ORDER | Code::INCOMPLETE => self.scene,
            Code::CONFLICT | Code::NEVER_SET => self.particles,
            Code::NOT_SUPPORTED | Code::NO_COUNTERPART => self.particles_of_lammps,
            _ => false,
        }
    }
}

/// What a word of LIGGGHTS without counterpart is about: `couple/cfd`, a coupling to another program, is …
fn subject(d: &Diagnostic) -> Option<String> {
    let about = d.message.split(", ").nth(1).filter(|_| d.code == Code::NO_COUNTERPART)?;
    Some(about.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(code: Code, text: &str) -> Diagnostics {
        Diagnostic::error(code, None, text).into()
    }

    #[test]
    fn a_name_whose_own_line_was_refused_is_not_missed_again() {
        let mut refused = Refused::default();
        let missing = || problem(Code::UNKNOWN_NAME, "there is no compute `dmg`");
        assert!(!refused.causes("thermo_style custom c_dmg", missing()).is_empty());
        assert!(!refused.causes("compute dmg all damge/atom", problem(Code::UNKNOWN_STYLE, "x")).is_empty());
        assert!(refused.causes("thermo_style custom c_dmg", missing()).is_empty());
    }

    #[test]
    fn particles_of_a_refused_kind_lack_nothing() {
        let mut refused = Refused::default();
        let lacks = || problem(Code::CONFLICT, "particles of this atom_style have no diameter");
        let dipoles =
            || problem(Code::NOT_SUPPORTED, "keyword of set `dipole/random` is not in perigrain yet");
        assert!(!refused.causes("set group all diameter 1", lacks()).is_empty());
        refused.causes("atom_style spere", problem(Code::UNKNOWN_STYLE, "x"));
        assert!(refused.causes("set group all diameter 1", lacks()).is_empty());
        assert!(!refused.causes("set group all dipole/random 1 1", dipoles()).is_empty());
        refused.causes("atom_style dipole", problem(Code::NOT_SUPPORTED, "x"));
        assert!(refused.causes("set group all dipole/random 1 1", dipoles()).is_empty());
    }

    #[test]
    fn without_a_box_everything_comes_too_early() {
        let mut refused = Refused::default();
        let early = || problem(Code::WRONG_ORDER, "no box has been defined");
        assert!(!refused.causes("create_atoms 1 box", early()).is_empty());
        assert!(refused.causes("create_atoms 1 box", early()).is_empty());
    }
}

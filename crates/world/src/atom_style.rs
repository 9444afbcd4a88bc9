//! Which columns particles have (`atom_style`), and the words for it.

/// Which optional columns exist (`atom_style`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct AtomStyle {
    /// A style has been chosen.
    pub chosen: bool,
    /// Radius, angular velocity, torque, mass per particle.
    pub sphere: bool,
    /// Volume, reference position, mass per particle.
    pub peri: bool,
    /// An orientation per particle: `bpm/sphere`.
    pub oriented: bool,
    /// Masses start as those of spheres: `sphere`, unless `peri` follows it in `hybrid`.
    pub sphere_mass: bool,
    /// Molecule IDs.
    pub molecules: bool,
    /// Bonds between particles.
    pub bonded: bool,
    /// Angles between bonds.
    #[serde(default)]
    pub angled: bool,
    /// A charge per particle.
    #[serde(default)]
    pub charged: bool,
    /// A dipole moment per particle.
    #[serde(default)]
    pub dipole: bool,
    /// Named `molecular`, not `angle`: the two have the same columns here.
    pub molecular: bool,
    /// Named as `hybrid …`, which decides the columns of data files.
    pub hybrid: bool,
    /// The own columns of a hybrid in data files, in the order in which its styles name them.
    pub own: [Option<Own>; 6],
}

/// A column of data files that only some atom styles have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Own {
    /// Molecule ID.
    Molecule,
    /// Twice the radius.
    Diameter,
    /// Density.
    Density,
    /// Volume.
    Volume,
    /// Charge.
    Charge,
    /// The three components of the dipole moment.
    Moment,
}

impl AtomStyle {
    /// Whether each particle has its own mass (else masses go by type).
    pub fn own_mass(&self) -> bool {
        self.sphere || self.peri
    }

    /// Whether types may have masses that nothing uses: LAMMPS requires them where spheres or peridynamic particles are in a
    /// hybrid with bonds or charges.
    pub fn idle_type_mass(&self) -> bool {
        self.own_mass() && self.hybrid && (self.bonded || self.charged)
    }

    /// Whether particles turn under torques and carry something that turns with them.
    pub fn turns(&self) -> bool {
        self.oriented || self.dipole
    }

    /// The word after `atom_style`.
    pub fn name(&self) -> &'static str {
        match (self.hybrid, self.sphere, self.peri, self.bonded) {
            (false, ..) if self.dipole => "dipole",
            (false, .., true) if self.charged => "full",
            (false, ..) if self.charged => "charge",
            (false, true, false, false) => "sphere",
            (false, true, false, true) => "bpm/sphere",
            (false, false, true, false) => "peri",
            (false, false, false, false) => "atomic",
            (false, false, false, true) if self.molecular => "molecular",
            (false, false, false, true) if self.angled => "angle",
            (false, false, false, true) => "bond",
            _ => "hybrid",
        }
    }

    /// The words after `atom_style`: for a hybrid with styles that give its data files their columns in their order. One that brings
    /// no column (`atomic`), or none that is new, is left out.
    pub fn words(&self) -> String {
        if !self.hybrid {
            return self.name().to_string();
        }
        let bond = match (self.molecular, self.angled) {
            (true, _) => "molecular",
            (false, true) => "angle",
            (false, false) => "bond",
        };
        let styles = ["bpm/sphere", bond, "sphere", "peri", "dipole", "charge"];
        let (mut words, mut made) = (String::from("hybrid"), Self::default());
        let begins = |made: &Self| made.own.iter().zip(&self.own).all(|(a, b)| a.is_none() || a == b);
        while made.own != self.own {
            let next = styles.iter().skip(usize::from(!self.oriented)).find_map(|word| {
                let mut with = made;
                with.add(word);
                (with.own != made.own && begins(&with)).then_some((word, with))
            });
            let Some((word, with)) = next else { break };
            words = format!("{words} {word}");
            made = with;
        }
        if self.own == [None; 6] { format!("{words} atomic") } else { words }
    }

    /// Whether data files of the style that these words name have the columns of this one; after `hybrid` styles may be left out.
    pub fn is_laid_out_as(&self, words: &str) -> bool {
        let styles = words.strip_prefix("hybrid").filter(|_| self.hybrid);
        let Some(styles) = styles else { return words == self.name() };
        let mut other = Self::default();
        styles.split_whitespace().all(|word| other.add(word))
            && (styles.trim().is_empty() || other.own == self.own)
    }

    /// Adds a style of this name, as `hybrid` does; `false` if there is none.
    pub fn add(&mut self, name: &str) -> bool {
        let own: &[Own] = match name {
            "atomic" => &[],
            "sphere" | "bpm/sphere" => {
                (self.sphere, self.sphere_mass) = (true, true);
                self.bonded |= name == "bpm/sphere";
                self.oriented |= name == "bpm/sphere";
                self.molecules |= self.bonded;
                match name {
                    "sphere" => &[Own::Diameter, Own::Density],
                    _ => &[Own::Molecule, Own::Diameter, Own::Density],
                }
            }
            "peri" => {
                (self.peri, self.sphere_mass) = (true, false);
                &[Own::Volume, Own::Density]
            }
            "bond" | "angle" | "molecular" => {
                (self.bonded, self.molecules) = (true, true);
                self.angled |= name != "bond";
                self.molecular |= name == "molecular";
                &[Own::Molecule]
            }
            "charge" => {
                self.charged = true;
                &[Own::Charge]
            }
            "dipole" => {
                (self.charged, self.dipole) = (true, true);
                &[Own::Charge, Own::Moment]
            }
            "full" => {
                (self.bonded, self.molecules, self.angled, self.charged) = (true, true, true, true);
                &[Own::Molecule, Own::Charge]
            }
            _ => return false,
        };
        for &column in own {
            if !self.own.contains(&Some(column))
                && let Some(free) = self.own.iter_mut().find(|c| c.is_none())
            {
                *free = Some(column);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hybrid(styles: &str) -> AtomStyle {
        let mut style = AtomStyle { hybrid: true, ..AtomStyle::default() };
        assert!(styles.split(' ').all(|word| style.add(word)));
        style
    }

    /// Columns of a hybrid's data file stand in the order of its styles: the words must lead back to it.
    #[test]
    fn words_of_a_hybrid_lead_to_its_columns() {
        let styles = ["atomic", "sphere", "peri", "bond", "molecular", "dipole", "full", "bpm/sphere"];
        let mut lists = vec![vec![]];
        for length in 1..=4 {
            let longer = |list: &Vec<&'static str>| -> Vec<Vec<&'static str>> {
                let free = styles.iter().filter(|s| !list.contains(s));
                free.map(|s| [list.as_slice(), &[s]].concat()).collect()
            };
            let next: Vec<_> = lists.iter().filter(|l| l.len() == length - 1).flat_map(longer).collect();
            lists.extend(next);
        }
        for list in lists.iter().filter(|l| !l.is_empty()) {
            let style = hybrid(&list.join(" "));
            let words = style.words();
            let again = hybrid(&words["hybrid ".len()..]);
            assert_eq!(again.own, style.own, "{list:?} are {words}");
            assert_eq!(
                (again.bonded, again.oriented),
                (style.bonded, style.oriented),
                "{list:?} are {words}"
            );
            assert!(style.is_laid_out_as(&words) && style.is_laid_out_as("hybrid"));
        }
        assert_eq!(hybrid("sphere peri").words(), "hybrid sphere peri");
        assert_eq!(hybrid("peri bond sphere").words(), "hybrid peri bond sphere");
    }

    #[test]
    fn another_order_is_another_layout() {
        assert!(!hybrid("sphere peri").is_laid_out_as("hybrid peri sphere"));
        assert!(!hybrid("sphere peri").is_laid_out_as("hybrid sphere dipole"));
        assert_eq!(hybrid("sphere dipole").words(), "hybrid sphere dipole");
        assert!(!hybrid("sphere").is_laid_out_as("sphere"));
        assert!(hybrid("bond sphere").is_laid_out_as("hybrid atomic molecular sphere"));
        let mut plain = AtomStyle::default();
        plain.add("peri");
        assert!(plain.is_laid_out_as("peri") && !plain.is_laid_out_as("hybrid peri"));
        assert_eq!(plain.words(), "peri");
    }
}

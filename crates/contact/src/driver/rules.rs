//! Contact rules by pair of types.

use crate::{Arm, Granular};

/// The number of simultaneous contacts among which a force is divided (Walayat et al., eq. 14 and 19, made
/// momentum-conserving: every contact's force and its reaction are divided by the same N).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Average {
    /// N = 1: forces are added.
    #[default]
    None,
    /// N = the larger of the two particles' numbers of contacts.
    Particle,
    /// N = the number of contacts between the two bodies; a body is a grain or a peridynamic solid.
    Body,
}

/// The effective radius R̄ of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Curvature {
    /// R_i R_j / (R_i + R_j).
    #[default]
    Both,
    /// The grain's radius where it meets a peridynamic solid, whose surface is treated as flat.
    Impactor,
}

/// The rule for contacts of one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// The law.
    pub law: Granular,
    /// Averaging.
    pub average: Average,
    /// Effective radius.
    pub curvature: Curvature,
}

/// Rules by pair of types (from 1), symmetric.
#[derive(Clone, Debug)]
pub struct Rules {
    types: usize,
    table: Vec<Option<Rule>>,
}

impl Rules {
    /// Without rules.
    pub fn new(types: usize) -> Self {
        Self { types, table: vec![None; types * types] }
    }

    /// The number of types.
    pub fn types(&self) -> usize {
        self.types
    }

    /// Sets the rule of two types.
    pub fn set(&mut self, a: u16, b: u16, rule: Rule) {
        let (a, b) = (usize::from(a) - 1, usize::from(b) - 1);
        self.table[a * self.types + b] = Some(rule);
        self.table[b * self.types + a] = Some(rule);
    }

    /// All rules, each with its types, the lower one first.
    pub fn pairs(&self) -> impl Iterator<Item = ([u16; 2], &Rule)> {
        let last = self.types as u16;
        let types = (1..=last).flat_map(move |a| (a..=last).map(move |b| [a, b]));
        types.filter_map(|types| Some((types, self.get(types[0], types[1])?)))
    }

    /// The rule of two types.
    #[inline]
    pub fn get(&self, a: u16, b: u16) -> Option<&Rule> {
        self.table[(usize::from(a) - 1) * self.types + usize::from(b) - 1].as_ref()
    }

    /// The largest history size.
    pub fn memory(&self) -> usize {
        self.table.iter().flatten().map(|r| r.law.memory()).max().unwrap_or(0)
    }

    /// The rules for repeated evaluation of contacts ([`Granular::again`]).
    #[must_use]
    pub fn again(&self, setup: bool) -> Self {
        let again = |rule: &Rule| Rule { law: rule.law.again(setup), ..*rule };
        Self { types: self.types, table: self.table.iter().map(|r| r.as_ref().map(again)).collect() }
    }

    /// Whether some rule needs to know which particles belong to solids.
    pub fn needs_bodies(&self) -> bool {
        let needs = |r: &Rule| {
            r.average == Average::Body || r.curvature == Curvature::Impactor || r.law.arm == Arm::Point
        };
        self.any(needs)
    }

    /// Whether `is` holds for some rule.
    pub fn any(&self, is: impl Fn(&Rule) -> bool) -> bool {
        self.table.iter().flatten().any(is)
    }
}

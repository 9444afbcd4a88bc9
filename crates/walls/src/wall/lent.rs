//! The force `coeff T` of walls: laws that `pair_coeff` gives to grains and a type.

use super::words::Ruled;
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_contact::{Arm, Cohesion, Friction, Granular, Heat, Model, Rolling, Twisting};
use perigrain_pairs::GRANULAR_RULES;
use perigrain_styles::words::{At, Nullable, OneType, Words};
use perigrain_world::World;

/// Whose laws a wall has.
#[derive(Clone, Words)]
pub struct Lent {
    /// `NULL`: the types of the surfaces behind `of`, each of which has its own.
    #[word(name = "T", what = "the type of the wall")]
    kind: At<Nullable<OneType>>,
    /// The parts of the laws that the wall has; without this word it has all of them.
    #[word(keyword, name = "part", list, least = 1)]
    only: Vec<Section>,
}

/// A part of a law.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "part of a law")]
enum Section {
    Normal,
    Damping,
    Tangential,
    /// The friction of the law without its spring: γ_t v_t, at most μ F_n.
    #[word("no_history")]
    NoHistory,
    Rolling,
    Twisting,
    Cohesion,
    Heat,
    /// `limit_damping`, where the law has it.
    Limit,
}

impl Lent {
    /// The type; `None` where each surface of the wall has its own.
    pub fn kind(&self) -> Option<u16> {
        self.kind.value.0.map(|OneType(kind)| kind)
    }

    /// The laws of all types of grains with this wall, those that are equal together, type by type of the surfaces it has.
    ///
    /// # Errors
    /// Another pair style, and laws that walls cannot have.
    pub fn laws(&self, w: &World, surfaces: &[u16]) -> Result<Vec<Ruled>> {
        if let Some(own) = self.kind() {
            return self.laws_with(w, own);
        }
        if surfaces.is_empty() {
            let text = "`coeff NULL` belongs to a wall of surfaces";
            let d = Diagnostic::error(Code::CONFLICT, self.kind.span, text);
            return Err(d.help("write the type of the wall, or `fix … wall/mesh coeff NULL of ID …`").into());
        }
        let mut laws = vec![];
        for own in surfaces {
            let of_surface = |rule: Ruled| Ruled { surface: Some(*own), ..rule };
            laws.extend(self.laws_with(w, *own)?.into_iter().map(of_surface));
        }
        Ok(laws)
    }

    /// The laws of all types of grains with one type, those that are equal together.
    ///
    /// # Errors
    /// Another pair style, and laws that walls cannot have.
    fn laws_with(&self, w: &World, own: u16) -> Result<Vec<Ruled>> {
        let error = |text: String, help: &str| {
            Err(Diagnostic::error(Code::INCOMPLETE, self.kind.span, text).help(help.to_string()).into())
        };
        let Some(rules) = w.facts.get(*GRANULAR_RULES) else {
            let text = "a wall with `coeff` has the laws of `pair_style granular`, and there are none".into();
            return error(
                text,
                "write `pair_style granular` and its `pair_coeff` lines, or `granular MODELS` for this wall",
            );
        };
        let mut laws: Vec<(Granular, Vec<bool>)> = vec![];
        for kind in 1..=w.types as u16 {
            let Some(rule) = rules.get(kind, own) else {
                let text = format!("there is no `pair_coeff` for types {kind} and {own}");
                return error(text, "give these types a line of their own");
            };
            if rule.law.arm == Arm::Point || rule.law.is_precomputed() {
                let text = format!("a wall cannot have the law of types {kind} and {own}");
                return error(
                    text,
                    "`arms point` and `mdr` are refused here: write `granular MODELS` for this wall",
                );
            }
            let (law, at) = (self.cut(rule.law, w), usize::from(kind) - 1);
            let known = laws.iter().position(|(other, _)| *other == law);
            let known = known.unwrap_or_else(|| {
                laws.push((law, vec![false; w.types]));
                laws.len() - 1
            });
            laws[known].1[at] = true;
        }
        let one = laws.len() == 1;
        let ruled = |(law, kinds)| Ruled { law, kinds: (!one).then_some(kinds), surface: None };
        Ok(laws.into_iter().map(ruled).collect())
    }

    /// A law without the parts that the line leaves out.
    fn cut(&self, law: Granular, w: &World) -> Granular {
        let has = |section: Section| self.only.is_empty() || self.only.contains(&section);
        let none = Model::none().law(w.settings.compat);
        let mut law = law;
        if !has(Section::Normal) {
            law.normal = none.normal;
        }
        if !has(Section::Damping) {
            (law.damping, law.damping_constant) = (none.damping, none.damping_constant);
        }
        let glides = self.only.contains(&Section::NoHistory);
        if !has(Section::Tangential) && !glides {
            law.spring = none.spring;
        }
        if glides && law.spring.kind != Friction::None {
            law.spring.kind = Friction::LinearNohistory;
        }
        if !has(Section::Rolling) {
            law.rolling = Rolling::None;
        }
        if !has(Section::Twisting) {
            law.twisting = Twisting::None;
        }
        if !has(Section::Cohesion) {
            law.cohesion = Cohesion::None;
        }
        if !has(Section::Heat) {
            law.heat = Heat::None;
        }
        law.limit_damping &= has(Section::Limit);
        law
    }
}

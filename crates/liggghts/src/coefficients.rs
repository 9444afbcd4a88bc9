//! `pair_style gran` and its coefficients: native `pair_coeff` lines made from the table of properties before a run.

use crate::Translator;
use crate::model::{Cohesion, Given, Normal, Rolling, Tangential, parts, switch, switches};
use crate::native::{Line, instead};
use crate::reading::{inside, unknown, value};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Word};

/// Damping along the normal that stands for none where damping across it is all there is [force/velocity].
const FAINT: &str = "1e-100";

/// A spring across the normal with 2/7 of the normal stiffness (`ktToKnUser`; the property of that name is not read: measured).
const SOFTER: &str = "linear_history ratio 0.2857142857142857";

impl Translator {
    /// `pair_style gran …`.
    pub(crate) fn pair_style(&mut self, cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
        let reader = args.expect("the style")?.clone();
        let mut given = parts(args, &cmd.name)?;
        while let Some(word) = args.peek().cloned() {
            match switch(args, &mut given.model)? {
                Some(note) => self.notes.0.extend(note),
                None if crate::model::PARTS.contains(&word.text.as_str()) => {
                    let text = format!("`{}` stands behind a switch", word.text);
                    let d = Diagnostic::error(Code::WRONG_ORDER, word.span, text);
                    return Err(d.help("switches come last").into());
                }
                None => return Err(unknown(&word, "switch of a contact model", switches()).into()),
            }
        }
        self.early_walls(&given.model)?;
        self.written = None;
        self.pair = Some((cmd.clone(), given));
        let mut line = Line::new(cmd, "pair_style");
        line.put("granular", reader.span);
        Ok(vec![line.done()])
    }

    /// The coefficients, where there are none yet or a property has changed since.
    pub(crate) fn coefficients(&mut self) -> Result<Vec<Command>> {
        let Some((cmd, given)) = self.pair.clone() else { return Ok(vec![]) };
        if self.written == Some((self.version, self.types())) {
            return Ok(vec![]);
        }
        // One that fails is refused once.
        self.written = Some((self.version, self.types()));
        let (mut lines, types) = (vec![], self.types().max(1));
        for i in 0..types {
            for j in i..types {
                let mut line = Line::new(&cmd, "pair_coeff");
                line.put(&format!("{} {}", i + 1, j + 1), cmd.name.span);
                self.law(&mut line, &given, (i, j), true)?;
                lines.push(line.done());
            }
        }
        self.note_unread();
        Ok(lines)
    }

    /// The law of a pair of atom types, counted from 0, with what it conducts if that is `warm`.
    pub(crate) fn law(
        &mut self,
        line: &mut Line,
        given: &Given,
        (i, j): (usize, usize),
        warm: bool,
    ) -> Result<()> {
        let (model, reader) = (&given.model, &given.reader);
        if model.is_stiffness() {
            self.springs(line, given, i, j)?;
        } else {
            self.material(line, given, i, j)?;
        }
        let at = given.rolling;
        let full = if model.torsion { " full" } else { "" };
        if model.rolling != Rolling::Off {
            let mu = self.of("coefficientRollingFriction", reader, i, j)?;
            let name = match model.rolling {
                Rolling::Cdt => "cdt",
                Rolling::Epsd2 => "epsd2",
                _ => "epsd",
            };
            line.put(&format!("rolling {name}"), at).word(&mu);
            if matches!(model.rolling, Rolling::Epsd | Rolling::Epsd3) {
                line.word(&self.of("coefficientRollingViscousDamping", reader, i, j)?);
            }
            if model.rolling == Rolling::Epsd3 {
                line.word(&self.of("rollingStiffness", reader, i, j)?);
            }
            line.put(full, at);
        }
        let name = match model.cohesion {
            Cohesion::Off => None,
            Cohesion::Sjkr => Some("cohesion sjkr"),
            Cohesion::Sjkr2 => Some("cohesion sjkr2"),
        };
        if let Some(name) = name {
            line.put(name, given.cohesion).word(&self.of("cohesionEnergyDensity", reader, i, j)?);
            line.put(if model.reduce { "reduce" } else { "" }, given.cohesion);
        }
        // LIGGGHTS has no limit where grains stick in this way (measured).
        let limit = model.limit && model.normal != Normal::Hysteresis;
        line.put(if limit { "limit_damping" } else { "" }, given.normal);
        if warm {
            self.conduction(line, model, i, j)?;
        }
        if i != j && !model.is_stiffness() {
            let (e, nu) = (self.of("youngsModulus", reader, j, j)?, self.of("poissonsRatio", reader, j, j)?);
            line.put("material", given.normal).word(&e).word(&nu);
        }
        Ok(())
    }

    /// Laws whose constants come from materials.
    fn material(&mut self, line: &mut Line, given: &Given, i: usize, j: usize) -> Result<()> {
        let (model, reader, at) = (&given.model, &given.reader, given.normal);
        let modulus = self.of("youngsModulus", reader, i, i)?;
        let nu = self.of("poissonsRatio", reader, i, i)?;
        let e = self.of("coefficientRestitution", reader, i, j)?;
        let name = match model.normal {
            Normal::Hertz => "hertz/material",
            Normal::Hysteresis => "hooke/hysteresis",
            _ => "hooke/velocity",
        };
        line.put(name, at).word(&modulus).word(&e).word(&nu);
        if model.normal != Normal::Hertz {
            line.word(&self.of("characteristicVelocity", reader, i, j)?);
        }
        if model.normal == Normal::Hysteresis {
            for name in [
                "coefficientMaxElasticStiffness",
                "coefficientAdhesionStiffness",
                "coefficientPlasticityDepth",
            ] {
                line.word(&self.of(name, reader, i, j)?);
            }
        }
        line.put("damping coeff_restitution", at);
        let (spring, drag) = match (model.is_hertz(), model.softer) {
            (true, _) => ("mindlin NULL", "NULL"),
            (false, false) => ("linear_history NULL", "NULL"),
            // The damping across the normal stays that of a spring as stiff as the normal one.
            (false, true) => (SOFTER, "1"),
        };
        self.friction(line, given, spring, if model.undamped { "0" } else { drag }, (i, j))
    }

    /// The tangential model with its spring and its damping, a ratio to the normal one.
    fn friction(
        &mut self,
        line: &mut Line,
        given: &Given,
        spring: &str,
        damping: &str,
        (i, j): (usize, usize),
    ) -> Result<()> {
        let at = given.tangential;
        match given.model.tangential {
            Tangential::Off => drop(line.put("tangential none", at)),
            Tangential::History => {
                let mu = self.of("coefficientFriction", &given.reader, i, j)?;
                line.put(&format!("tangential {spring} {damping}"), at).word(&mu).put("slip spring", at);
            }
            Tangential::NoHistory => {
                let mu = self.of("coefficientFriction", &given.reader, i, j)?;
                // Without a spring the word chooses the arms R - d/2 and the limit mu |F_n| (measured).
                line.put(&format!("tangential linear_nohistory {damping}"), at)
                    .word(&mu)
                    .put("slip spring", at);
            }
        }
        Ok(())
    }

    /// Laws whose constants are those of springs and dampers: kn, kt, gamman, gammat.
    fn springs(&mut self, line: &mut Line, given: &Given, i: usize, j: usize) -> Result<()> {
        let (model, reader, at) = (&given.model, &given.reader, given.normal);
        let names = if model.absolute { ["gamman_abs", "gammat_abs"] } else { ["gamman", "gammat"] };
        let [kn, kt] = [self.of("kn", reader, i, j)?, self.of("kt", reader, i, j)?];
        let [normal, across] = [self.of(names[0], reader, i, j)?, self.of(names[1], reader, i, j)?];
        let across = if model.undamped { instead(&across, "0") } else { across };
        let (normal, ratio) = ratio(&normal, &across);
        let (name, damping) = match (model.is_hertz(), model.absolute) {
            (true, _) => ("hertz", "viscoelastic"),
            (false, true) => ("hooke", "velocity"),
            (false, false) => ("hooke", "mass_velocity"),
        };
        line.put(name, at).word(&kn).word(&normal).put(&format!("damping {damping}"), at);
        let kind = if model.is_hertz() { "mindlin" } else { "linear_history" };
        if model.rolling == Rolling::Epsd2 && model.tangential != Tangential::History {
            return rolls_on(line, given, kind, &kt);
        }
        self.friction(line, given, &format!("{kind} {}", kt.text), &ratio, (i, j))
    }
}

/// `epsd2` takes its stiffness from kt (measured), also where no friction acts: a spring that slides without force has it.
fn rolls_on(line: &mut Line, given: &Given, kind: &str, kt: &Word) -> Result<()> {
    let at = given.tangential;
    if given.model.tangential == Tangential::Off {
        line.put(&format!("tangential {kind} {} 0 0 slip spring", kt.text), at);
        return Ok(());
    }
    let d = Diagnostic::error(
        Code::NO_COUNTERPART,
        at,
        "`no_history` has no spring for `rolling_friction epsd2`",
    );
    Err(d.help("take `tangential history`, or `rolling_friction epsd`").into())
}

/// The damping along the normal, and the ratio of that across it to it.
fn ratio(normal: &Word, across: &Word) -> (Word, String) {
    match (value(normal), value(across)) {
        (_, Some(0.0)) => (normal.clone(), "0".into()),
        (Some(0.0), Some(b)) => {
            let faint: f64 = FAINT.parse().unwrap_or(1e-100);
            (instead(normal, FAINT), format!("{:e}", b / faint))
        }
        (Some(a), Some(b)) => (normal.clone(), format!("{}", b / a)),
        _ => (normal.clone(), format!("$({}/{})", inside(across), inside(normal))),
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::{behind, coefficients, wrong};

    const SPRINGS: &str = "fix r all property/global coefficientRollingFriction peratomtypepair 1 0.1\n\
        fix s1 all property/global kn peratomtypepair 1 2000.\nfix s2 all property/global kt peratomtypepair 1 1000.\n\
        fix s3 all property/global gamman peratomtypepair 1 50.\nfix s4 all property/global gammat peratomtypepair 1 20.\n";

    #[test]
    fn rolling_springs_have_the_stiffness_kt_also_without_friction() {
        let line = coefficients("model hertz/stiffness tangential off rolling_friction epsd2", SPRINGS);
        assert!(line.contains("tangential mindlin 1000. 0 0 slip spring rolling epsd2 0.1"), "{line}");
        let line = coefficients("model hooke/stiffness tangential no_history", SPRINGS);
        assert!(line.contains("tangential linear_nohistory 0.4 0.5 slip spring"), "{line}");
        let d = wrong(&format!(
            "{SPRINGS}pair_style gran model hooke/stiffness tangential no_history rolling_friction epsd2\nrun 1\n"
        ));
        assert!(d.has_errors() && d.to_string().contains("has no spring"), "{d}");
    }

    #[test]
    fn materials_of_springs_stand_in_the_check_of_the_time_step() {
        let lines = behind(&format!(
            "{SPRINGS}pair_style gran model hooke/stiffness\nfix ts all check/timestep/gran 100 0.1 0.1\n"
        ));
        assert_eq!(lines[1], "fix ts all dt/grain 100 0.1 0.1 material 1 5.e6 0.45");
        let sums = "compute pl all pair/gran/local delta\ncompute s all reduce sum c_pl\ncompute t all reduce sum vx\n";
        let lines = behind(&format!("pair_style gran\n{sums}"));
        assert_eq!(lines[2..], ["compute s all reduce sum c_pl inputs local", "compute t all reduce sum vx"]);
    }
}

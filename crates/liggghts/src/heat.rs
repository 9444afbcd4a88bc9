//! `fix heat/gran`: conduction of heat through contacts, and what it gives grains: `Temp`, `heatFlux`, `heatSource`.

use crate::Translator;
use crate::model::Model;
use crate::native::{Line, instead};
use crate::reading::{choice, inside, number, unknown, value, without_counterpart};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Command, Word};
use std::collections::BTreeSet;

const KEYWORDS: &[&str] = &["initial_temperature", "contact_area", "area_correction", "store_contact_data"];

/// What grains have with `fix heat/gran`: LIGGGHTS' name, the native property, the compute that shows it.
const PROPERTIES: &[(&str, &str, &str)] = &[
    ("Temp", "temperature", "f_Temp"),
    ("heatFlux", "heatflow", "f_heatFlux"),
    ("heatSource", "d_heatSource", "f_heatSource"),
];

/// A `fix heat/gran` line.
#[derive(Clone, Debug)]
pub(crate) struct Heat {
    cmd: Command,
    /// The style, which reads properties.
    reader: Word,
    /// Native words of the area of contact.
    area: Vec<Word>,
    /// `area_correction yes`.
    corrected: bool,
    /// The version of the properties that its native line was written for.
    written: u64,
}

impl Heat {
    /// The ID of the fix.
    pub fn id(&self) -> &str {
        &self.cmd.args[0].text
    }
}

impl Translator {
    /// `fix ID group heat/gran[/conduction] initial_temperature T …`.
    pub(crate) fn heat(&mut self, cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
        let reader = cmd.args[2].clone();
        let (mut initial, mut area, mut corrected) = (None, vec![], None);
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "initial_temperature" => initial = Some(number(args, "the initial temperature")?),
                "contact_area" => {
                    area = vec![instead(word, "area")];
                    area.extend(args.peek().cloned());
                    match choice(args, "area of contact", &["overlap", "constant", "projection"])? {
                        "constant" => area.push(number(args, "the area of contact")?),
                        "overlap" => area.clear(),
                        _ => {}
                    }
                }
                "area_correction" => {
                    let yes = choice(args, "state of `area_correction`", &["yes", "no"])? == "yes";
                    corrected = yes.then(|| word.clone());
                }
                "store_contact_data" => {
                    if choice(args, "state of `store_contact_data`", &["yes", "no"])? == "yes" {
                        let help =
                            "`compute contact/atom` counts contacts, `contacts` behind a wall has its heat";
                        return Err(without_counterpart(word, "columns of contacts", help).into());
                    }
                }
                _ => return Err(unknown(word, "keyword of fix heat/gran", KEYWORDS).into()),
            }
        }
        let Some(initial) = initial else {
            let text = format!("`{}` lacks `initial_temperature T`", reader.text);
            return Err(Diagnostic::error(Code::MISSING_ARGUMENT, reader.span, text).into());
        };
        if let Some(word) = corrected.as_ref().filter(|_| !area.is_empty()) {
            let text = "`area_correction` is for `contact_area overlap`";
            return Err(Diagnostic::error(Code::CONFLICT, word.span, text).into());
        }
        let known = PROPERTIES.iter().all(|(.., compute)| self.shown.contains(*compute));
        let mut lines = if known { vec![] } else { properties(cmd, &initial) };
        self.shown.extend(PROPERTIES.iter().map(|(.., compute)| compute.to_string()));
        self.written = None;
        let corrected = corrected.is_some();
        let heat = Heat { cmd: cmd.clone(), reader, area, corrected, written: self.version };
        lines.push(self.integration(&heat)?);
        self.heat = Some(heat);
        Ok(Some(lines))
    }

    /// The native fix that changes temperatures.
    fn integration(&mut self, heat: &Heat) -> Result<Command> {
        let types = self.types().max(1);
        let mut line = Line::styled(&heat.cmd, "heat/flow");
        line.put(if types == 1 { "constant" } else { "type" }, heat.reader.span);
        for k in 0..types {
            line.word(&self.of("thermalCapacity", &heat.reader, k, k)?);
        }
        line.put("source d_heatSource", heat.reader.span);
        Ok(line.done())
    }

    /// That fix again, where a property has changed since.
    pub(crate) fn heat_again(&mut self) -> Result<Option<Command>> {
        let version = self.version;
        let Some(heat) = self.heat.as_mut().filter(|heat| heat.written != version) else { return Ok(None) };
        heat.written = version;
        let heat = heat.clone();
        self.integration(&heat).map(Some)
    }

    /// Adds to a law what contacts conduct: 2 k_i k_j/(k_i + k_j) of two types, counted from 0.
    pub(crate) fn conduction(&mut self, line: &mut Line, model: &Model, i: usize, j: usize) -> Result<()> {
        let Some(heat) = self.heat.clone() else { return Ok(()) };
        let a = self.of("thermalConductivity", &heat.reader, i, i)?;
        let b = self.of("thermalConductivity", &heat.reader, j, j)?;
        let k = match (value(&a), value(&b)) {
            _ if a.text == b.text => a,
            (Some(x), Some(y)) if x + y == 0.0 => instead(&a, "0"),
            (Some(x), Some(y)) => instead(&a, format!("{}", 2.0 * x * y / (x + y))),
            _ => instead(&a, format!("$(2*{0}*{1}/({0}+{1}))", inside(&a), inside(&b))),
        };
        line.put("heat contact", heat.reader.span).word(&k).words(&heat.area);
        if heat.corrected {
            let factor = self.correction(&heat.reader, model, i, j)?;
            line.put("scaled", heat.reader.span).word(&factor);
        }
        Ok(())
    }

    /// The factor of overlaps, (Y*/Y*_original)^p with p = 2/3 for hertz and 1 for hooke.
    fn correction(&mut self, reader: &Word, model: &Model, i: usize, j: usize) -> Result<Word> {
        // 1/Y* is the sum of (1 − nu²)/Y.
        let (mut now, mut original) = (vec![], vec![]);
        for k in [i, j] {
            let nu = self.of("poissonsRatio", reader, k, k)?;
            now.push((self.of("youngsModulus", reader, k, k)?, nu.clone()));
            original.push((self.of("youngsModulusOriginal", reader, k, k)?, nu));
        }
        let sum = |all: &[(Word, Word)]| {
            let each = all.iter().map(|(young, nu)| Some((1.0 - value(nu)?.powi(2)) / value(young)?));
            each.sum::<Option<f64>>()
        };
        let text = |all: &[(Word, Word)]| {
            let each = all.iter().map(|(young, nu)| format!("(1-({})^2)/({})", inside(nu), inside(young)));
            each.collect::<Vec<_>>().join("+")
        };
        let at = &original[0].0;
        Ok(match (sum(&now), sum(&original), model.is_hertz()) {
            (Some(now), Some(original), true) => instead(at, format!("{}", (original / now).powf(2.0 / 3.0))),
            (Some(now), Some(original), false) => instead(at, format!("{}", original / now)),
            (_, _, true) => instead(at, format!("$((({})/({}))^(2/3))", text(&original), text(&now))),
            (_, _, false) => instead(at, format!("$(({})/({}))", text(&original), text(&now))),
        })
    }

    /// `set … property/atom NAME value`, and what else differs in a line of `set`.
    pub(crate) fn set(&mut self, cmd: &Command) -> Result<Option<Vec<Command>>> {
        let at = |k: usize| {
            cmd.args.get(k).is_some_and(|w| ["property/atom", "property/peratom"].contains(&&*w.text))
        };
        if !(0..cmd.args.len()).any(at) {
            return self.sized(cmd);
        }
        let mut line = Line::new(cmd, "set");
        let (mut k, mut changes) = (0, false);
        while let Some(word) = cmd.args.get(k) {
            let (true, Some(name)) = (at(k), cmd.args.get(k + 1)) else {
                changes |= k >= 2;
                line.word(word);
                k += 1;
                continue;
            };
            let value = cmd.args.get(k + 2);
            k += 3;
            if name.text == "heatFlux" {
                self.idle(name, "heat fluxes are computed anew in each step");
                continue;
            }
            let native = PROPERTIES
                .iter()
                .find(|(own, ..)| *own == name.text)
                .map(|(_, native, _)| native.to_string());
            line.word(&instead(name, native.unwrap_or_else(|| format!("d_{}", name.text))));
            line.words(value.map_or(&[], std::slice::from_ref));
            changes = true;
        }
        if !changes {
            return Ok(Some(vec![]));
        }
        let line = line.done();
        Ok(Some(self.sized(&line)?.unwrap_or_else(|| vec![line])))
    }

    /// A line with native references in place of `f_Temp[0]` and the like, and the names that columns of a dump keep.
    pub(crate) fn with_references(&self, cmd: &Command) -> Option<(Command, Vec<Command>)> {
        if self.shown.is_empty() || !cmd.args.iter().any(|w| w.text.contains("f_")) {
            return None;
        }
        let mut line = Line::new(cmd, &cmd.name.text);
        let mut renamed = vec![];
        let columns =
            cmd.name.text == "dump" && cmd.args.get(2).is_some_and(|w| w.text.starts_with("custom"));
        for word in &cmd.args {
            let text = referred(&word.text, &self.shown);
            if columns && text != word.text {
                let mut own = Line::new(cmd, "dump_modify");
                own.word(&cmd.args[0])
                    .put("colname", word.span)
                    .word(&instead(word, text.clone()))
                    .word(word);
                renamed.push(own.done());
            }
            line.word(&Word { text, ..word.clone() });
        }
        let line = line.done();
        (line.args != cmd.args).then_some((line, renamed))
    }
}

/// The properties of grains, and computes that show them.
fn properties(cmd: &Command, initial: &Word) -> Vec<Command> {
    let at = cmd.args[2].span;
    let fix = |name: &str, words: &str| {
        let mut line = Line::new(cmd, "fix");
        line.put(&format!("{name} all property/atom {words}"), at);
        line
    };
    let mut warm = fix("Temp", "temperature initial");
    warm.word(initial);
    let others = PROPERTIES[1..].iter().map(|(name, native, _)| fix(name, native).done());
    let shown = PROPERTIES.iter().map(|(_, native, compute)| {
        let mut line = Line::new(cmd, "compute");
        line.put(&format!("{compute} all property/atom {native}"), at);
        line.done()
    });
    std::iter::once(warm.done()).chain(others).chain(shown).collect()
}

/// A text with `c_f_Temp` in place of `f_Temp` and `f_Temp[0]`, and so for all that have a compute.
fn referred(text: &str, shown: &BTreeSet<String>) -> String {
    let part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find("f_") {
        let (before, from) = rest.split_at(at);
        let end = from.find(|c| !part(c)).unwrap_or(from.len());
        let (name, behind) = from.split_at(end);
        out += before;
        let whole = !out.ends_with(part);
        if whole && shown.contains(name) {
            out += &format!("c_{name}");
            rest = behind.strip_prefix("[0]").unwrap_or(behind);
        } else {
            out += name;
            rest = behind;
        }
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::{PROPERTIES, referred};

    #[test]
    fn references_are_whole_names() {
        let shown = PROPERTIES.iter().map(|(.., compute)| compute.to_string()).collect();
        for (text, wanted) in [
            ("f_Temp[0]", "c_f_Temp"),
            ("f_Temp", "c_f_Temp"),
            ("2*f_Temp[0]-f_heatFlux[0]/f_heatSource", "2*c_f_Temp-c_f_heatFlux/c_f_heatSource"),
            ("f_Temp[3]", "c_f_Temp[3]"),
            ("f_Temp2 v_f_Temp f_heat", "f_Temp2 v_f_Temp f_heat"),
        ] {
            assert_eq!(referred(text, &shown), wanted);
        }
    }
}

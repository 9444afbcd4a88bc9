//! IDs of fixes: one style for each, and those of tables that nothing uses.

use crate::{Translator, properties};
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result};
use perigrain_lang::Command;

/// Fixes that are tables and do nothing in a step.
const TABLES: [&str; 3] = ["property/global", "particletemplate/", "particledistribution/"];

/// What stands for a kind of grain, or for a mixture of them.
const PARTS: [(&str, &str, &str); 2] = [
    ("particletemplate/", "particletemplate", "add it to a particledistribution, or leave the line out"),
    ("particledistribution/", "particledistribution", "name it in a line `insert/…`, or leave the line out"),
];

impl Translator {
    /// A fix whose ID has another style already, one of the two only here: LIGGGHTS refuses this, too (measured).
    pub(crate) fn one_style(&mut self, cmd: &Command) -> Result<()> {
        let [id, _, style] = match (cmd.name.text.as_str(), &cmd.args[..]) {
            ("fix", [id, group, style, ..]) => [id, group, style],
            ("unfix", [id, ..]) => {
                self.fixes.remove(&id.text);
                return Ok(());
            }
            _ => return Ok(()),
        };
        let table = |style: &str| TABLES.iter().any(|start| style.starts_with(start));
        match self.fixes.get(&id.text) {
            Some(before) if *before != style.text && (table(before) || table(&style.text)) => {
                let text =
                    format!("fix `{}` is a {before} already, and cannot become a {}", id.text, style.text);
                let d = Diagnostic::error(Code::DUPLICATE_NAME, id.span, text);
                Err(d.help("give one of the two another ID").into())
            }
            _ => {
                let named = cmd.args.get(3).filter(|name| properties::is_known(&name.text));
                if let Some(name) = named.filter(|_| style.text != "property/global") {
                    // The style is misspelt, which is a mistake of its own.
                    self.refused.insert(name.text.clone());
                }
                self.use_names(cmd);
                self.fixes.insert(id.text.clone(), style.text.clone());
                Ok(())
            }
        }
    }

    /// Notes which templates and distributions a line defines, and which it uses.
    fn use_names(&mut self, cmd: &Command) {
        let style = cmd.args[2].text.as_str();
        let defines = PARTS.iter().any(|(start, ..)| style.starts_with(start));
        if style.starts_with("insert/") || style.starts_with("particledistribution/") {
            for word in &cmd.args[3..] {
                self.unused.remove(&word.text);
            }
        }
        if defines {
            self.unused.insert(cmd.args[0].text.clone(), cmd.args[0].span);
        }
    }

    /// Warnings about templates and distributions that no line of the deck uses.
    pub fn unused(&self) -> Diagnostics {
        let warning = |(id, span): (&String, &_)| {
            let style = self.fixes.get(id)?;
            let (_, kind, help) = PARTS.iter().find(|(start, ..)| style.starts_with(start))?;
            let text = format!("{kind} `{id}` is never inserted");
            Some(Diagnostic::warning(Code::UNUSED, *span, text).help(*help))
        };
        Diagnostics(self.unused.iter().filter_map(warning).collect())
    }
}

//! Words of LIGGGHTS before 3: styles of LAMMPS with their numbers in the line (the decks are still around, LIGGGHTS 3 refuses them).

use crate::Translator;
use crate::native::Line;
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Command};

/// The old pair styles, with the word that a wall of LAMMPS has for them.
const STYLES: &[(&str, &str)] = &[
    ("gran/hooke", "hooke"),
    ("gran/hooke/history", "hooke/history"),
    ("gran/hertz/history", "hertz/history"),
];

impl Translator {
    /// A `pair_style` line of any kind: old walls take their law from it.
    pub(crate) fn note_pair(&mut self, cmd: &Command) {
        let style = cmd.args.first().map_or("", |w| w.text.as_str());
        self.pair = None;
        self.old_pair = STYLES.iter().find(|(name, _)| *name == style).map(|(_, wall)| *wall);
    }

    /// `fix ID group wall/gran Kn Kt …`: the law of the pair style, unless a word names one.
    pub(crate) fn old_wall(&self, cmd: &Command) -> Option<Vec<Command>> {
        let first = cmd.args.get(3)?;
        first.text.parse::<f64>().ok()?;
        let law = self.old_pair?;
        let mut line = Line::styled(cmd, "wall/gran");
        line.put(law, first.span).words(&cmd.args[3..]);
        Some(vec![line.done()])
    }
}

/// `fix pour … diam lo hi dens lo hi`: in LAMMPS `diam range lo hi`.
pub(crate) fn pour(cmd: &Command, args: &mut Args) -> Result<Option<Vec<Command>>> {
    let mut line = Line::styled(cmd, "pour");
    let mut changed = false;
    while let Some(word) = args.next() {
        line.word(word);
        if word.text == "diam" && args.peek().is_some_and(|w| w.text.parse::<f64>().is_ok()) {
            line.put("range", word.span);
            changed = true;
        }
    }
    Ok(changed.then(|| vec![line.done()]))
}

//! Dumps of LIGGGHTS: grains and surfaces for ParaView, surfaces as STL.

use crate::Translator;
use crate::clumps::named;
use crate::native::Line;
use crate::reading::{number, rounded, without_counterpart};
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Command};

/// Fields of surfaces that need no value of their own.
const FIELDS: &[&str] = &["stress", "stresscomponents", "vel", "wear", "id", "area", "owner"];

/// `dump ID group custom/vtk N FILE attribute …`: an attribute counts once.
pub(crate) fn custom(cmd: &Command, args: &mut Args) -> Result<Vec<Command>> {
    let mut line = Line::styled(cmd, "vtk");
    line.word(&rounded(&number(args, "how often it is written")?).0);
    line.word(args.expect("a file name")?);
    let mut seen = std::collections::BTreeSet::new();
    while let Some(word) = args.next() {
        if ["p", "rho"].contains(&word.text.as_str()) {
            let help = "grains and solids alone are computed here";
            return Err(without_counterpart(word, "a fluid of particles", help).into());
        }
        let word = named(word);
        if seen.insert(word.text.clone()) {
            line.word(&word);
        }
    }
    Ok(vec![line.done()])
}

/// `dump_modify ID … format "%d %g"`: the format of a whole line, as LAMMPS wrote it before `format line`.
pub(crate) fn modified(cmd: &Command) -> Option<Vec<Command>> {
    let old =
        |k: usize| cmd.args[k].text == "format" && cmd.args.get(k + 1).is_some_and(|w| w.text.contains('%'));
    let at = (0..cmd.args.len()).find(|k| old(*k))?;
    let mut line = Line::new(cmd, "dump_modify");
    line.words(&cmd.args[..=at]).put("line", cmd.args[at].span).words(&cmd.args[at + 1..]);
    Some(vec![line.done()])
}

impl Translator {
    /// `dump ID group mesh/vtk|mesh/stl N FILE fields … ID …`: without IDs all surfaces of the deck.
    pub(crate) fn mesh_dump(
        &mut self,
        cmd: &Command,
        args: &mut Args,
        style: &str,
    ) -> Result<Option<Vec<Command>>> {
        let mut line = Line::styled(cmd, style);
        line.word(&rounded(&number(args, "how often it is written")?).0);
        line.word(args.expect("a file name")?);
        let mut names = 0;
        while let Some(word) = args.next() {
            if !FIELDS.contains(&word.text.as_str()) {
                self.surface_of(word)?;
                names += 1;
            }
            line.word(word);
        }
        if names == 0 {
            let ids: Vec<&str> = self.surfaces.keys().map(String::as_str).collect();
            line.put(&ids.join(" "), cmd.args[2].span);
        }
        Ok(Some(vec![line.done()]))
    }

    /// A fix without effect here.
    pub(crate) fn idle_fix(&mut self, cmd: &Command) -> Result<Vec<Command>> {
        self.idle(&cmd.args[2], "`fix_modify` and `comm_style` of ranks have their own words");
        self.own.insert(cmd.args[0].text.clone());
        Ok(vec![])
    }

    /// A dump of what does not exist here.
    pub(crate) fn idle_dump(&mut self, cmd: &Command) -> Result<Vec<Command>> {
        self.idle(&cmd.args[2], "the box is not divided among processes");
        self.own.insert(cmd.args[0].text.clone());
        Ok(vec![])
    }
}

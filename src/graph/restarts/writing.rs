//! Restart files written during a run, and what is written into them.

use super::{Restarts, Rhythm};
use crate::graph::node::{FixNode, Graph};
use crate::graph::seal::Sealer;
use perigrain_base::diag::Result;
use perigrain_contact::mdr;
use perigrain_output::file::Pattern;
use perigrain_output::restart::{Saving, write};
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::peri_view::BOND_FACTORS;
use perigrain_styles::{SealCx, Use, UseKind};
use perigrain_world::adapted;
use perigrain_world::columns::LEVEL;
use perigrain_world::field::{Fields, MEMO};
use perigrain_world::{Constant, DeclaredLine, World};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Where the world keeps which of two files comes next: a restarted run does not begin with the file it came from.
static NEXT: Constant<Vec<f64>> = Constant::new("restart/next");

impl Rhythm {
    fn when(&self, s: &mut Sealer) -> Result<When> {
        match self {
            Rhythm::Every(n) => Ok(When::Every(*n)),
            Rhythm::Named(r) => s.steps(r),
        }
    }
}

impl Restarts {
    /// The ops that write them.
    ///
    /// # Errors
    /// A variable that does not lead on.
    pub fn ops(&self, graph: &Graph, s: &mut Sealer) -> Result<Vec<Box<dyn Op>>> {
        let each = self.each.clone().map(|(n, p)| (n, Names::Each(p)));
        let turn = self.turn.clone().map(|(n, files)| (n, Names::Turn(files)));
        let mut ops: Vec<Box<dyn Op>> = vec![];
        for (rhythm, names) in each.into_iter().chain(turn) {
            let (pair, declared) = (graph.force_lines(), graph.declared());
            ops.push(Box::new(Write { when: rhythm.when(s)?, names, pair, declared, written: None }));
        }
        Ok(ops)
    }
}

enum Names {
    Each(Pattern),
    Turn([PathBuf; 2]),
}

/// Writes a restart file at its steps, but not where a run begins; and where a run ended early.
struct Write {
    when: When,
    names: Names,
    pair: Vec<DeclaredLine>,
    declared: Vec<String>,
    /// The step of the last file.
    written: Option<i64>,
}

impl Op for Write {
    fn about(&self) -> About {
        About {
            when: self.when.clone(),
            in_setup: false,
            at_parting: true,
            ..About::new("restart", Stage::Output, Needs::new().read(Fields::ALL).keep(MEMO))
        }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let passes = if t.ending { self.written == Some(t.step) } else { t.step == t.first };
        if passes {
            return Ok(());
        }
        let path: PathBuf = match &self.names {
            Names::Each(p) => p.at(t.step),
            Names::Turn(files) => {
                let next = w.memo.get(*NEXT).is_some_and(|m| m.first() == Some(&1.0));
                w.memo.insert(*NEXT, vec![if next { 0.0 } else { 1.0 }]);
                files[usize::from(next)].clone()
            }
        };
        save(&path, w, true, &self.pair, &self.declared)?;
        self.written = Some(t.step);
        Ok(())
    }
}

/// Writes a restart file of a scene, at whole steps of a run (`ran`) or between runs: the only function that does.
///
/// Forces are valid during a run, and after it as long as no line changes the scene. A minimization leaves none: velocities may
/// change before the next run.
///
/// # Errors
/// The disk's.
pub fn save(path: &Path, w: &World, ran: bool, pair: &[DeclaredLine], declared: &[String]) -> Result<()> {
    let ran = ran && !w.clock.minimizing;
    let standing = ran && (w.clock.running || !*w.changed);
    write(path, &Saving { world: w, ran, standing, pair, declared })
}

/// Whether a name belongs to state that a fix or compute of the restarted deck may claim.
pub fn claimable(name: &str) -> bool {
    // The pair style comes with the file, and what its plastic grains and fixes have made of it; factors belong to particles; the forces of each level of
    // steps belong to the run style, which is a setting.
    name != NEXT.text()
        && !adapted::is(name)
        && name != mdr::BEGUN.text()
        && !name.starts_with(mdr::BEGIN)
        && !name.starts_with(LEVEL)
        && BOND_FACTORS.iter().all(|factors| name != factors.text())
}

impl Graph {
    /// The lines of the pair style and the bond style in force.
    pub fn force_lines(&self) -> Vec<DeclaredLine> {
        let pair = self.pair.iter().flat_map(|p| &p.lines);
        pair.chain(self.bond.iter().flat_map(|b| &b.lines)).cloned().collect()
    }

    /// All lines in force that decide about forces and motion: those of the pair style, of fixes, and of the variables
    /// and computes they use.
    pub fn declared(&self) -> Vec<String> {
        let lines = self.force_lines();
        let pair = lines.iter().map(|l| l.words.join(" "));
        let fixes = self.fixes.iter().flat_map(|f| f.lines.iter().cloned());
        pair.chain(fixes).chain(self.behind_fixes()).collect()
    }

    /// The lines of the variables and computes that fixes use, directly or through others, sorted.
    fn behind_fixes(&self) -> BTreeSet<String> {
        let provider = |u: &Use| self.lines.provider(u);
        let fix = |f: &FixNode| provider(&Use { kind: UseKind::Fix, name: f.id.clone() });
        let mut open: Vec<&Use> = self.fixes.iter().filter_map(fix).flat_map(|n| &n.uses).collect();
        let (mut seen, mut lines) = (BTreeSet::new(), BTreeSet::new());
        while let Some(u) = open.pop() {
            let followed = matches!(u.kind, UseKind::Variable | UseKind::Compute);
            let Some(node) = provider(u).filter(|_| followed && seen.insert(u)) else { continue };
            lines.insert(node.text.split_whitespace().collect::<Vec<_>>().join(" "));
            open.extend(&node.uses);
        }
        lines
    }
}

//! What is in force, each with the line it came from.

use super::catalogue::Tables;
use super::record::Record;
use super::restarts::Restarts;
use super::thermo::Thermo;
use perigrain_base::diag::Span;
use perigrain_lang::{RefKind, ValueRef};
use perigrain_pairs::bond::BondForce;
use perigrain_styles::{Compute, Dump, Fix, Names, Pair, Shape, Use, UseKind};
use perigrain_world::adapted::Coefficient;
use perigrain_world::{DeclaredLine, GroupId, World};
use std::collections::BTreeMap;

/// The pair style in force.
#[derive(Clone)]
pub struct PairNode {
    /// The style with its coefficients.
    pub pair: Box<dyn Pair>,
    /// The `pair_style` line.
    pub span: Span,
    /// All its lines, for restart files.
    pub lines: Vec<DeclaredLine>,
}

/// The bond style in force.
#[derive(Clone)]
pub struct BondNode {
    /// The style with its coefficients.
    pub force: Box<dyn BondForce>,
    /// The `bond_style` line.
    pub span: Span,
    /// All its lines, for restart files.
    pub lines: Vec<DeclaredLine>,
}

/// A fix in force.
#[derive(Clone)]
pub struct FixNode {
    /// Its ID.
    pub id: String,
    /// Its style's name.
    pub style: &'static str,
    /// The group it acts on.
    pub group: GroupId,
    /// The fix.
    pub fix: Box<dyn Fix>,
    /// `fix_modify energy yes`.
    pub energy: bool,
    /// `fix_modify respa`, from 0.
    pub level: Option<usize>,
    /// Its line.
    pub span: Span,
    /// Its line and those that modify it, as words with one blank between.
    pub lines: Vec<String>,
}

/// A compute in force.
#[derive(Clone)]
pub struct ComputeNode {
    /// Its ID.
    pub id: String,
    /// Its style's name.
    pub style: &'static str,
    /// The compute.
    pub compute: Box<dyn Compute>,
    /// Its line.
    pub span: Span,
}

/// A dump in force.
#[derive(Clone)]
pub struct DumpNode {
    /// Its ID.
    pub id: String,
    /// Its style's name.
    pub style: &'static str,
    /// Interval in steps.
    pub every: i64,
    /// The name of its file, with `*` for the step.
    pub file: String,
    /// The dump.
    pub dump: Box<dyn Dump>,
    /// Its line.
    pub span: Span,
}

/// Everything declared so far, and every line as a node.
#[derive(Clone, Default)]
pub struct Graph {
    /// The styles that lines may name.
    pub tables: std::sync::Arc<Tables>,
    /// The pair style.
    pub pair: Option<PairNode>,
    /// The bond style.
    pub bond: Option<BondNode>,
    /// Fixes in order of definition.
    pub fixes: Vec<FixNode>,
    /// Computes in order of definition.
    pub computes: Vec<ComputeNode>,
    /// Dumps in order of definition.
    pub dumps: Vec<DumpNode>,
    /// Restart files during runs.
    pub restarts: Restarts,
    /// What the step table shows.
    pub thermo: Thermo,
    /// Every line.
    pub lines: Record,
    /// Variables by name and what they offer. Kept in step with the variable table for look-ups.
    pub variables: BTreeMap<String, Shape>,
    /// While a fix is read: variables that the deck defines somewhere, perhaps after it.
    pub later: std::sync::Arc<std::collections::BTreeSet<String>>,
}

impl Graph {
    /// The pair style in force or its sub-style of this name, the first if there are several.
    fn pair_part(&self, style: &str) -> Option<&dyn Pair> {
        let pair = self.pair.as_ref()?.pair.as_ref();
        std::iter::once(pair).chain(pair.parts()).find(|p| p.facts().name == style)
    }

    /// The value of a coefficient in the deck's lines.
    pub fn coefficient(&self, of: &Coefficient) -> Option<f64> {
        match of.bond {
            true => self.bond.as_ref()?.force.coefficient(&of.name, of.types.0),
            false => self.pair_part(&of.style)?.coefficient(&of.name, of.types),
        }
    }

    /// The fix with this ID.
    pub fn find_fix(&self, id: &str) -> Option<&FixNode> {
        self.fixes.iter().find(|f| f.id == id)
    }

    /// The compute with this ID.
    pub fn find_compute(&self, id: &str) -> Option<&ComputeNode> {
        self.computes.iter().find(|c| c.id == id)
    }

    /// Takes up what a command has left behind for formulas, in place of what it left before under this ID.
    pub fn leave(&mut self, id: String, style: &'static str, compute: Box<dyn Compute>, span: Span) {
        self.computes.retain(|c| c.id != id);
        self.computes.push(ComputeNode { id, style, compute, span });
    }
}

impl Graph {
    /// The temperature that knows the flow which a compute takes away: itself, or that of its `bias`.
    pub fn knows_flow(&self, id: &str) -> Option<&ComputeNode> {
        let mut node = self.find_compute(id)?;
        // At most as many as there are computes: none is its own bias.
        for _ in 0..self.computes.len() {
            let Some(r) = node.compute.bias() else { return Some(node) };
            node = self.find_compute(&r.name)?;
        }
        None
    }
}

impl Names for Graph {
    fn compute_style(&self, id: &str) -> Option<&'static str> {
        self.find_compute(id).map(|c| c.style)
    }

    fn compute(&self, id: &str) -> Option<Shape> {
        self.find_compute(id).map(|c| c.compute.shape())
    }

    fn elements(&self, id: &str) -> Vec<String> {
        self.find_compute(id).map(|c| c.compute.elements()).unwrap_or_default()
    }

    fn fix(&self, id: &str) -> Option<Shape> {
        self.find_fix(id).map(|f| f.fix.shape())
    }

    fn defined_later(&self, name: &str) -> bool {
        self.later.contains(name)
    }

    fn variable_shape(&self, name: &str) -> Option<Shape> {
        self.variables.get(name).copied()
    }

    fn extensive(&self, r: &ValueRef) -> bool {
        match r.kind {
            RefKind::Fix => self.find_fix(&r.name).is_some_and(|f| f.fix.extensive(&r.index)),
            RefKind::Compute => {
                self.find_compute(&r.name).is_some_and(|c| c.compute.shape().extensive(&r.index))
            }
            _ => false,
        }
    }

    fn fix_style(&self, id: &str) -> Option<&'static str> {
        self.find_fix(id).map(|f| f.style)
    }

    fn counting_fix(&self, w: &World) -> Option<(&str, &'static str)> {
        self.fixes.iter().find(|f| f.fix.facts(w).counts_steps).map(|f| (f.id.as_str(), f.style))
    }

    fn growing_dump(&self) -> Option<&str> {
        self.dumps.iter().find(|d| d.dump.growing()).map(|d| d.id.as_str())
    }

    fn pair_styles(&self) -> Vec<&'static str> {
        let Some(node) = &self.pair else { return vec![] };
        let parts = node.pair.parts();
        std::iter::once(node.pair.facts().name).chain(parts.iter().map(|p| p.facts().name)).collect()
    }

    fn coefficients(&self, bond: bool, style: &str) -> Option<&'static [&'static str]> {
        if bond {
            return self.bond.as_ref().filter(|b| b.force.name() == style).map(|b| b.force.coefficients());
        }
        self.pair_part(style).map(|p| p.facts().coefficients)
    }

    fn users(&self, name: &Use) -> Vec<String> {
        let uses = |kind: UseKind, id: &str, span: Span| {
            self.lines.uses(Some(&Use { kind, name: id.to_string() }), span, name)
        };
        let fixes = self.fixes.iter().filter(|f| uses(UseKind::Fix, &f.id, f.span));
        let fixes = fixes.map(|f| format!("fix {}", f.id));
        let computes = self.computes.iter().filter(|c| uses(UseKind::Compute, &c.id, c.span));
        let computes = computes.map(|c| format!("compute {}", c.id));
        let dumps = self.dumps.iter().filter(|d| uses(UseKind::Dump, &d.id, d.span));
        let dumps = dumps.map(|d| format!("dump {}", d.id));
        fixes.chain(computes).chain(dumps).collect()
    }

    fn all(&self, kind: UseKind) -> Vec<String> {
        match kind {
            UseKind::Compute => self.computes.iter().map(|c| c.id.clone()).collect(),
            UseKind::Fix => self.fixes.iter().map(|f| f.id.clone()).collect(),
            UseKind::Variable => self.variables.keys().cloned().collect(),
            UseKind::Group | UseKind::Region | UseKind::Material | UseKind::Dump => vec![],
        }
    }
}

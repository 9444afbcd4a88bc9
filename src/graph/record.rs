//! The deck's lines as nodes: one for each place and name, however often a loop passes it; what has gone makes room.

use perigrain_base::diag::{FileId, Span};
use perigrain_styles::{Use, UseKind};
use std::collections::{BTreeMap, BTreeSet};

/// Which node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct NodeId(pub usize);

/// The three kinds of node that keep LAMMPS' imperative order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Replaces or removes an earlier declaration.
    Declare,
    /// Changes the world once.
    Act,
    /// Seals the declarations and steps.
    Run,
}

/// A line of the deck as a node.
#[derive(Clone, Debug)]
pub struct Node {
    /// Kind.
    pub role: Role,
    /// What it provides, as `fix ball`, `group left`; empty for most acts.
    pub provides: Option<Use>,
    /// The line after substitution, as it was last.
    pub text: String,
    /// Where it stands.
    pub span: Span,
    /// What it names.
    pub uses: Vec<Use>,
    /// Facts an act settles (`volume`, `density` …).
    pub settles: Vec<&'static str>,
    /// When it was taken up last, in turns of the session.
    turn: u64,
    /// What it provided has been deleted.
    gone: bool,
}

impl Node {
    /// A line that names and settles nothing yet.
    pub fn new(role: Role, provides: Option<Use>, text: String, span: Span) -> Self {
        Self { role, provides, text, span, uses: vec![], settles: vec![], turn: 0, gone: false }
    }

    /// Whether forces may follow the variables it names: all that declares without a name of its own but for tables and dumps, and what
    /// is between variables and forces. What acts has taken a variable's value when it acted, as `if` and `print` have.
    fn leads_to_forces(&self) -> bool {
        let between = [UseKind::Fix, UseKind::Region, UseKind::Group];
        match &self.provides {
            Some(name) => between.contains(&name.kind),
            None => {
                let command = self.text.split_whitespace().next().unwrap_or_default();
                self.role == Role::Declare && !["thermo", "thermo_style", "dump_modify"].contains(&command)
            }
        }
    }

    /// The variable it defines.
    fn variable(&self) -> Option<&str> {
        self.provides.as_ref().filter(|p| p.kind == UseKind::Variable).map(|p| p.name.as_str())
    }

    /// The positive number given for a fact.
    fn given(&self, fact: &str) -> Option<f64> {
        let mut words = self.text.split_whitespace().skip_while(|w| *w != fact);
        words.nth(1)?.parse::<f64>().ok().filter(|d| *d > 0.0)
    }
}

/// A span as a key.
type Place = (FileId, u32, u32);

fn place(span: Span) -> Place {
    (span.file, span.start, span.end)
}

/// Counts a name once more, or once less.
fn tally(counts: &mut BTreeMap<String, usize>, name: &str, more: bool) {
    if more {
        *counts.entry(name.to_owned()).or_default() += 1;
    } else if let Some(count) = counts.get_mut(name) {
        *count -= 1;
        if *count == 0 {
            counts.remove(name);
        }
    }
}

/// The smallest and the largest of some positive numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// The smallest.
    pub least: f64,
    /// The largest.
    pub most: f64,
}

/// Every line so far.
#[derive(Clone, Default)]
pub struct Record {
    nodes: Vec<Node>,
    /// The node of each place and of what it provides there.
    known: BTreeMap<Place, BTreeMap<Option<Use>, usize>>,
    /// Nodes of a place whose names have gone, for the next name.
    free: BTreeMap<Place, Vec<usize>>,
    /// The nodes that provide a name, the latest last.
    providers: BTreeMap<Use, Vec<usize>>,
    /// How many nodes that lead to forces name a variable.
    followed: BTreeMap<String, usize>,
    /// In how many definitions of other variables a variable is named.
    within: BTreeMap<String, BTreeMap<String, usize>>,
    /// What has been settled, with the given numbers.
    settled: BTreeMap<&'static str, Option<Extremes>>,
    /// The latest turn that may have changed particles.
    changed: u64,
}

impl Record {
    /// All nodes, in the order in which their lines were first met.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The turn that may have changed particles last: two records that agree in it belong to the same particles.
    pub fn changed(&self) -> u64 {
        self.changed
    }

    /// Notes that particles may have changed in this turn.
    pub fn change(&mut self, turn: u64) {
        self.changed = turn;
    }

    /// Takes up once more a line that has not changed since its last turn; `false` if it has.
    pub fn again(&mut self, span: Span, provides: &Option<Use>, text: &str, turn: u64) -> bool {
        let Some(k) = self.found(place(span), provides) else { return false };
        if self.nodes[k].text != text {
            return false;
        }
        self.nodes[k].turn = turn;
        self.is_latest(k);
        true
    }

    /// Takes a line up.
    pub fn add(&mut self, mut node: Node, turn: u64) {
        node.turn = turn;
        for fact in &node.settles {
            let before = self.settled.entry(fact).or_default();
            let Some(x) = node.given(fact) else { continue };
            let old = before.unwrap_or(Extremes { least: x, most: x });
            *before = Some(Extremes { least: old.least.min(x), most: old.most.max(x) });
        }
        let place = place(node.span);
        let same = self.found(place, &node.provides);
        let Some(k) = same.or_else(|| self.free.get_mut(&place)?.pop()) else {
            self.nodes.push(node);
            return self.put(self.nodes.len() - 1);
        };
        self.count(k, false);
        let old = std::mem::replace(&mut self.nodes[k], node);
        // Declarations without a name add to earlier ones.
        if same.is_some() && old.provides.is_none() && old.role == Role::Declare {
            let uses = &mut self.nodes[k].uses;
            uses.extend(old.uses);
            uses.sort();
            uses.dedup();
        }
        self.put(k);
    }

    /// The node of a place and of what it provides there.
    fn found(&self, place: Place, provides: &Option<Use>) -> Option<usize> {
        self.known.get(&place)?.get(provides).copied()
    }

    /// Changes the text of the line at a place that provides no name, as by something that became of it.
    pub fn amend(&mut self, span: Span, text: impl FnOnce(&str) -> String) {
        if let Some(k) = self.found(place(span), &None) {
            self.nodes[k].text = text(&self.nodes[k].text);
        }
    }

    fn put(&mut self, k: usize) {
        let node = &self.nodes[k];
        self.known.entry(place(node.span)).or_default().insert(node.provides.clone(), k);
        self.count(k, true);
        self.is_latest(k);
    }

    /// Counts the variables that a node names, or no longer.
    fn count(&mut self, k: usize, more: bool) {
        let node = &self.nodes[k];
        if node.gone {
            return;
        }
        for u in node.uses.iter().filter(|u| u.kind == UseKind::Variable) {
            if let Some(other) = node.variable() {
                let others = self.within.entry(u.name.clone()).or_default();
                tally(others, other, more);
                if others.is_empty() {
                    self.within.remove(&u.name);
                }
            } else if node.leads_to_forces() {
                tally(&mut self.followed, &u.name, more);
            }
        }
    }

    fn is_latest(&mut self, k: usize) {
        let Some(name) = &self.nodes[k].provides else { return };
        match self.providers.get_mut(name) {
            Some(list) if list.last() == Some(&k) => {}
            Some(list) => {
                list.retain(|n| *n != k);
                list.push(k);
            }
            None => drop(self.providers.insert(name.clone(), vec![k])),
        }
    }

    /// Removes the provider of a deleted name: a loop over names leaves no more nodes than it has lines.
    pub fn delete(&mut self, name: &Use) {
        for k in self.providers.remove(name).unwrap_or_default() {
            self.count(k, false);
            let node = &mut self.nodes[k];
            node.gone = true;
            let place = place(node.span);
            if let Some(here) = self.known.get_mut(&place) {
                here.remove(&node.provides);
                if here.is_empty() {
                    self.known.remove(&place);
                }
            }
            self.free.entry(place).or_default().push(k);
        }
    }

    /// The latest node that provides a name.
    pub fn provider(&self, wanted: &Use) -> Option<&Node> {
        self.providers.get(wanted)?.last().map(|k| &self.nodes[*k])
    }

    /// The latest line of this command.
    pub fn latest(&self, command: &str) -> Option<&Node> {
        let of = |n: &&Node| n.text.split_whitespace().next() == Some(command);
        self.nodes.iter().filter(of).max_by_key(|n| n.turn)
    }

    /// Whether a line at this place uses a name, and is the one that provides `by` if that is known.
    pub fn uses(&self, by: Option<&Use>, span: Span, name: &Use) -> bool {
        if let Some(node) = by.and_then(|by| self.provider(by)) {
            return node.span == span && node.uses.contains(name);
        }
        let here = self.known.get(&place(span)).into_iter().flat_map(BTreeMap::values);
        here.map(|k| &self.nodes[*k]).any(|n| n.uses.contains(name))
    }

    /// Whether some fix or the pair style depends on this variable, directly or through variables, regions and groups.
    pub fn forces_use_variable(&self, name: &str) -> bool {
        let (mut seen, mut left) = (BTreeSet::from([name]), vec![name]);
        while let Some(name) = left.pop() {
            if self.followed.contains_key(name) {
                return true;
            }
            let others = self.within.get(name).into_iter().flat_map(BTreeMap::keys);
            left.extend(others.map(String::as_str).filter(|other| seen.insert(*other)));
        }
        false
    }

    /// Whether some act has settled a fact.
    pub fn settled(&self, fact: &str) -> bool {
        self.settled.contains_key(fact)
    }

    /// The positive numbers that acts have given for a fact, if any.
    pub fn given(&self, fact: &str) -> Option<Extremes> {
        self.settled.get(fact).copied().flatten()
    }

    /// For each node the nodes before it whose names it uses.
    pub fn edges(&self) -> Vec<Vec<NodeId>> {
        let mut providers: BTreeMap<&Use, usize> = BTreeMap::new();
        let mut edges = vec![];
        for (k, node) in self.nodes.iter().enumerate() {
            let from = node.uses.iter().filter_map(|u| providers.get(u).map(|n| NodeId(*n)));
            edges.push(from.collect());
            if let Some(name) = &node.provides {
                providers.insert(name, k);
            }
        }
        edges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(kind: UseKind, name: &str) -> Use {
        Use { kind, name: name.into() }
    }

    fn line(at: usize, provides: Option<Use>, text: &str, uses: &[Use]) -> Node {
        let span = Span::new(FileId(0), at, at + 5);
        let mut node = Node::new(Role::Declare, provides, text.into(), span);
        node.uses = uses.to_vec();
        node
    }

    #[test]
    fn a_loop_leaves_a_node_for_each_of_its_lines() {
        let mut r = Record::default();
        for turn in 0..1000 {
            // Names that stay the same, and names that are new in each turn.
            for (at, id) in [(0, "f".to_string()), (20, format!("f{turn}"))] {
                let (fix, v) = (name(UseKind::Fix, &id), name(UseKind::Variable, &format!("v{turn}")));
                r.add(line(at, Some(fix.clone()), &format!("fix {id}"), &[v]), turn);
                assert!(r.forces_use_variable(&format!("v{turn}")) && r.provider(&fix).is_some());
                r.add(line(at + 10, None, "unfix", &[]), turn);
                r.delete(&fix);
                assert!(!r.forces_use_variable(&format!("v{turn}")) && r.provider(&fix).is_none());
            }
        }
        assert_eq!(r.nodes().len(), 4);
        let known: usize = r.known.values().map(BTreeMap::len).sum();
        let indexed = known + r.providers.len() + r.followed.len() + r.free.len();
        assert!(indexed <= 8, "{indexed} entries are left");
    }

    #[test]
    fn the_latest_turn_provides_a_name_wherever_it_stands() {
        let mut r = Record::default();
        let v = name(UseKind::Variable, "v");
        r.add(line(0, Some(v.clone()), "variable v equal 1", &[]), 1);
        r.add(line(50, Some(v.clone()), "variable v equal 2", &[]), 2);
        assert!(
            r.provider(&v).unwrap().text.ends_with('2') && r.latest("variable").unwrap().text.ends_with('2')
        );
        assert!(r.again(Span::new(FileId(0), 0, 5), &Some(v.clone()), "variable v equal 1", 3));
        assert!(
            r.provider(&v).unwrap().text.ends_with('1') && r.latest("variable").unwrap().text.ends_with('1')
        );
        assert!(!r.again(Span::new(FileId(0), 0, 5), &Some(v.clone()), "variable v equal 3", 4));
        assert_eq!(r.nodes().len(), 2);
    }

    #[test]
    fn declarations_without_a_name_keep_what_they_use() {
        let mut r = Record::default();
        for id in ["a", "b"] {
            r.add(line(0, None, "pair_coeff", &[name(UseKind::Variable, id)]), 1);
        }
        assert!(r.forces_use_variable("a") && r.forces_use_variable("b"));
        assert_eq!(r.nodes().len(), 1);
    }

    #[test]
    fn variables_lead_to_forces_through_others_that_do() {
        let mut r = Record::default();
        let variable = |id: &str| name(UseKind::Variable, id);
        r.add(line(0, Some(variable("force")), "variable force", &[variable("share")]), 1);
        r.add(line(10, Some(variable("share")), "variable share", &[variable("part")]), 1);
        r.add(
            line(20, Some(variable("shown")), "variable shown", &[variable("first"), variable("shown")]),
            1,
        );
        let mut reader = line(30, None, "if", &[variable("shown")]);
        reader.role = Role::Act;
        r.add(reader, 1);
        r.add(line(35, None, "thermo_style", &[variable("shown")]), 1);
        assert!(["force", "share", "part", "shown", "first"].iter().all(|v| !r.forces_use_variable(v)));
        r.add(line(40, Some(name(UseKind::Fix, "f")), "fix f", &[variable("force")]), 1);
        assert!(["force", "share", "part"].iter().all(|v| r.forces_use_variable(v)));
        assert!(["shown", "first"].iter().all(|v| !r.forces_use_variable(v)));
        r.delete(&name(UseKind::Fix, "f"));
        assert!(!r.forces_use_variable("part"));
    }

    #[test]
    fn numbers_given_in_all_turns_count() {
        let mut r = Record::default();
        for (turn, density) in [2, 5, 3].into_iter().enumerate() {
            let mut set = line(0, None, &format!("set type {turn} density {density}"), &[]);
            set.settles = vec!["density"];
            r.add(set, turn as u64);
        }
        assert_eq!(r.given("density"), Some(Extremes { least: 2.0, most: 5.0 }));
        assert!(r.settled("density") && !r.settled("mass") && r.given("mass").is_none());
    }
}

//! What an op states about the fields it touches, and whether that is true.

use perigrain_world::field::{CLOCK, COLUMNS, MEMO, RIGID, SITES};
use perigrain_world::{Fields, Numbers, Touched};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::panic::Location;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// The fields an op reads, writes, adds to, and keeps for itself. To write, to add and to keep is to read as well; the clock
/// may be read by all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    reads: Fields,
    writes: Fields,
    adds: Fields,
    keeps: Fields,
    /// The columns and entries of the memo that it uses, by name or by role; `None` where the statement names none of them.
    names: Option<&'static [&'static str]>,
    /// Where this stands in the program: one place for each kind of op.
    at: &'static Location<'static>,
}

impl Default for Needs {
    #[track_caller]
    fn default() -> Self {
        Self::new()
    }
}

impl Needs {
    /// Nothing yet.
    #[track_caller]
    pub fn new() -> Self {
        let none = Fields::NONE;
        Self { reads: none, writes: none, adds: none, keeps: none, names: None, at: Location::caller() }
    }

    /// The whole scene, to read and to write.
    #[track_caller]
    pub fn all() -> Self {
        Self { reads: Fields::ALL, writes: Fields::ALL, ..Self::new() }
    }

    /// Reads these.
    #[must_use]
    pub fn read(mut self, fields: Fields) -> Self {
        self.reads |= fields;
        self
    }

    /// Writes these.
    #[must_use]
    pub fn write(mut self, fields: Fields) -> Self {
        self.writes |= fields;
        self
    }

    /// Adds to these, after those that came before in the order of ops.
    #[must_use]
    #[allow(clippy::should_implement_trait)] // a word of the statement, as `read` and `write`
    pub fn add(mut self, fields: Fields) -> Self {
        self.adds |= fields;
        self
    }

    /// The op keeps its own state in these fields; no other op uses what it writes there.
    #[must_use]
    pub fn keep(mut self, fields: Fields) -> Self {
        self.keeps |= fields;
        self
    }

    /// Of columns and of the memo it uses these alone: entries of these names, and those that play these roles.
    #[must_use]
    pub fn only(mut self, names: &[&'static str]) -> Self {
        let all = self.names.into_iter().flatten().chain(names).copied();
        self.names = Some(interned(all.collect()));
        self
    }

    /// Whether it may use a column or an entry of the memo.
    fn allows(&self, key: Numbers) -> bool {
        let role = key.role().map(Numbers::text);
        let is_named = |names: &[&str]| names.iter().any(|name| *name == key.text() || Some(*name) == role);
        self.touched().has(COLUMNS | MEMO) && self.names.is_none_or(is_named)
    }

    /// Whether it reads one of these without changing it.
    pub fn reads(&self, any: Fields) -> bool {
        self.reads.has(any)
    }

    /// Whether it changes one of these.
    pub fn changes(&self, any: Fields) -> bool {
        self.changed().has(any)
    }

    /// What it writes and adds to, if that is less than the whole scene.
    pub fn written_by_name(&self) -> Fields {
        if self.writes == Fields::ALL { Fields::NONE } else { self.writes | self.adds }
    }

    /// What it writes, adds to and keeps.
    pub(super) fn changed(&self) -> Fields {
        self.writes | self.adds | self.keeps
    }

    /// What it reads and does not change.
    pub(super) fn read_alone(&self) -> Fields {
        self.reads.without(self.changed())
    }

    /// All that it reads or changes.
    pub(super) fn touched(&self) -> Fields {
        self.reads | self.changed()
    }

    /// What is stated and can be found to be used: to read, to change.
    fn named(&self) -> [Fields; 2] {
        // The use of sites leaves no mark, and that of bodies the mark of the memo.
        let unseen = SITES | RIGID;
        let named =
            |fields: Fields| if fields == Fields::ALL { Fields::NONE } else { fields.without(unseen) };
        [self.reads, self.changed()].map(named)
    }
}

/// The same list for each set of names: plans are made anew for every run.
fn interned(names: BTreeSet<&'static str>) -> &'static [&'static str] {
    static LISTS: Mutex<BTreeSet<&'static [&'static str]>> = Mutex::new(BTreeSet::new());
    let names: Vec<&str> = names.into_iter().collect();
    let mut lists = LISTS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(known) = lists.get(&names[..]) {
        return known;
    }
    let list: &[&str] = names.leak();
    lists.insert(list);
    list
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts =
            [("reads", self.reads), ("writes", self.writes), ("adds to", self.adds), ("keeps", self.keeps)];
        let parts = parts.into_iter().filter(|(_, fields)| !fields.is_empty());
        let parts: Vec<String> =
            parts
                .map(|(how, fields)| {
                    if fields == Fields::ALL {
                        format!("{how} everything")
                    } else {
                        format!("{how} {fields}")
                    }
                })
                .collect();
        f.write_str(&parts.join("; "))?;
        self.names.map_or(Ok(()), |names| write!(f, " ({})", names.join(", ")))
    }
}

/// What was stated and touched, and touched without being stated, by all ops of one kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Account {
    /// Stated to be read, and to be changed.
    pub stated: [Fields; 2],
    /// Read and written.
    pub touched: [Fields; 2],
    /// By op: the fields it read, and those it changed, without stating them.
    pub unstated: BTreeMap<String, [Fields; 2]>,
}

impl Account {
    /// What was stated and never used: to be read, to be changed.
    pub fn idle(&self) -> [Fields; 2] {
        std::array::from_fn(|k| self.stated[k].without(self.touched[k]))
    }
}

type Accounts = BTreeMap<(&'static str, u32), Account>;

/// Accounts by the place of the statement, while they are collected.
static ACCOUNTS: Mutex<Accounts> = Mutex::new(BTreeMap::new());
static COLLECTING: AtomicBool = AtomicBool::new(false);

/// From now on the fields that ops state and touch are noted, for each op by itself and never for a fused pass. An op with a
/// wrong statement is not stopped, as debug builds do otherwise.
pub fn collect() {
    COLLECTING.store(true, Ordering::Relaxed);
}

/// Whether accounts are collected.
pub fn collecting() -> bool {
    cfg!(debug_assertions) && COLLECTING.load(Ordering::Relaxed)
}

/// What was noted.
pub fn collected() -> Accounts {
    ACCOUNTS.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone()
}

/// What ops have touched that none of them states, in words. With several that acted at once it is enough that one of them
/// states it.
pub fn lie<'a>(ops: impl Iterator<Item = (&'a str, Needs)> + Clone, touched: Touched) -> Option<String> {
    let all = |of: fn(&Needs) -> Fields| ops.clone().fold(Fields::NONE, |all, (_, n)| all | of(&n));
    let (reads, changed) = (all(|n| n.reads), all(Needs::changed));
    let read = touched.read.without(reads | changed | CLOCK);
    let written = touched.written.without(changed);
    let unnamed: Vec<&str> = touched
        .names
        .iter()
        .filter(|key| !ops.clone().any(|(_, n)| n.allows(**key)))
        .map(|key| key.text())
        .collect();
    let true_enough = read.is_empty() && written.is_empty();
    if collecting() {
        let mut accounts = ACCOUNTS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        for (name, n) in ops {
            let a = accounts.entry((n.at.file(), n.at.line())).or_default();
            for (k, stated) in n.named().into_iter().enumerate() {
                a.stated[k] |= stated;
                a.touched[k] |= [touched.read, touched.written][k];
            }
            if !true_enough {
                let more = a.unstated.entry(name.to_string()).or_default();
                *more = [more[0] | read, more[1] | written];
            }
        }
        return None;
    }
    (!true_enough || !unnamed.is_empty()).then(|| {
        let names: Vec<String> = ops.map(|(name, n)| format!("`{name}` ({})", n.at)).collect();
        let mut what = vec![how([read, written])];
        what.push(if unnamed.is_empty() { String::new() } else { format!("touches {}", unnamed.join(", ")) });
        what.retain(|part| !part.is_empty());
        format!("op {} {} and does not state it", names.join(", "), what.join(" and "))
    })
}

/// What is read and what is written in words.
pub fn how([read, written]: [Fields; 2]) -> String {
    let how = [("reads", read), ("writes", written)];
    let how: Vec<String> =
        how.iter().filter(|(_, f)| !f.is_empty()).map(|(how, f)| format!("{how} {f}")).collect();
    how.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{About, Op, Placed, Stage, StepPlan, Tick};
    use perigrain_base::diag::Result;
    use perigrain_world::field::{F, V, X};
    use perigrain_world::{Constant, World};

    static OWN: Constant<Vec<f64>> = Constant::new("own/1");
    static LIST: Constant<Vec<f64>> = Constant::new("own/1/list");
    static OTHER: Constant<Vec<f64>> = Constant::in_role("other/temperature", "temperature");

    /// States one thing and does another.
    struct Stated(Needs, fn(&mut World));

    impl Op for Stated {
        fn about(&self) -> About {
            About::new("fix 1 says", Stage::PostForce, self.0)
        }
        fn run(&mut self, w: &mut World, _: &Tick) -> Result<()> {
            (self.1)(w);
            Ok(())
        }
    }

    fn acts(needs: Needs, does: fn(&mut World)) {
        let (mut plan, mut w) = (StepPlan::default(), World::default());
        w.particles.push(1, 1, [0.5; 3]);
        plan.add(Placed::new(Box::new(Stated(needs, does)), None));
        let t = Tick::between_runs(&w.clock);
        plan.run(&mut w, &t, &[Stage::PostForce]).unwrap();
    }

    #[test]
    fn an_op_may_touch_what_it_states() {
        acts(Needs::new().read(X).add(F), |w| w.particles.f[0][0] += w.particles.x[0][0]);
        acts(Needs::new().write(V), |w| w.particles.v[0] = w.particles.v[0].map(|v| -v));
        acts(Needs::all(), |w| w.particles.push(2, 1, [1.0; 3]));
        // The number of particles and the clock need no statement.
        acts(Needs::new(), |w| assert!(w.n() == 1 && w.clock.step == 0));
    }

    #[cfg(debug_assertions)]
    #[test]
    #[should_panic(expected = "reads v and does not state it")]
    fn an_op_that_reads_more_is_stopped() {
        acts(Needs::new().read(X).add(F), |w| w.particles.f[0] = w.particles.v[0]);
    }

    #[cfg(debug_assertions)]
    #[test]
    #[should_panic(expected = "writes x and does not state it")]
    fn an_op_that_writes_what_it_states_to_read_is_stopped() {
        acts(Needs::new().read(X), |w| w.particles.x[0] = [0.0; 3]);
    }

    #[test]
    fn an_op_may_use_the_columns_that_it_names() {
        let own = Needs::new().keep(COLUMNS | MEMO).only(&["own/1"]).only(&["own/1/list"]);
        assert_eq!(own.to_string(), "keeps columns memo (own/1, own/1/list)");
        assert_eq!(own.names, Needs::new().only(&["own/1/list", "own/1"]).names, "one list for each set");
        acts(own, |w| drop(w.memo.insert(*LIST, vec![1.0])));
        acts(own, |w| w.columns.scalar(*OWN, 1)[0] = 2.0);
        acts(Needs::new().keep(COLUMNS), |w| w.columns.scalar(*OTHER, 1)[0] = 2.0);
        // A role stands for all entries that play it.
        acts(Needs::new().keep(COLUMNS).only(&["temperature"]), |w| w.columns.scalar(*OTHER, 1)[0] = 2.0);
    }

    #[cfg(debug_assertions)]
    #[test]
    #[should_panic(expected = "touches other/temperature and does not state it")]
    fn an_op_that_uses_a_column_of_another_name_is_stopped() {
        acts(Needs::new().keep(COLUMNS).only(&["own/1"]), |w| w.columns.scalar(*OTHER, 1)[0] = 2.0);
    }

    #[test]
    fn what_is_stated_and_never_used_is_reported() {
        let needs = Needs::new().read(X | V).add(F);
        let stated = needs.named();
        let account = Account { stated, touched: [X | F, Fields::NONE], ..Account::default() };
        assert_eq!(account.idle(), [V, F]);
        assert_eq!(Needs::all().named(), [Fields::NONE; 2], "a statement of everything names no fields");
        assert_eq!(needs.to_string(), "reads x v; adds to f");
        assert_eq!(Needs::new().write(Fields::ALL).keep(V).to_string(), "writes everything; keeps v");
    }
}

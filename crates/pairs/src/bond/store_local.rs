//! `store/local`: what is kept of bonds that break, as local values of a fix that the bond style brings along.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::{Fix, SealCx, Shape};
use perigrain_world::field::{COLUMNS, Fields, MEMO, SLOTS, X};
use perigrain_world::{Key, Numbers, Registration, Slot, Under, Vectors, World};

/// The style's name among fixes.
pub const NAME: &str = "store/local";

/// Columns of places in the setup of the first run.
static FIRST: Registration = Registration::moved("store/local/", "/first", Under::Anchor);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Value {
    /// The ID of an end, the lower first.
    Id(usize),
    /// The step in which it broke.
    Time,
    /// The middle between its ends then [length].
    Middle(usize),
    /// The middle between its ends in the setup of the first run [length].
    First(usize),
}

const VALUES: [(&str, Value); 9] = [
    ("id1", Value::Id(0)),
    ("id2", Value::Id(1)),
    ("time", Value::Time),
    ("x", Value::Middle(0)),
    ("y", Value::Middle(1)),
    ("z", Value::Middle(2)),
    ("x/ref", Value::First(0)),
    ("y/ref", Value::First(1)),
    ("z/ref", Value::First(2)),
];

/// The words of a bond style's line about bonds that break.
#[derive(Clone)]
pub struct Store {
    id: String,
    every: i64,
    values: Vec<Value>,
    /// Rows since the last multiple of `every`.
    rows: Numbers,
    /// Positions in the setup of the first run.
    first: Vectors,
}

impl Store {
    /// Reads `ID N value …`.
    ///
    /// # Errors
    /// Every mistake in it.
    pub fn read(args: &mut Args) -> Result<Self> {
        let id = args.expect("the ID under which broken bonds are kept")?.text.clone();
        let every = args.integer_from(1, "the interval N")?;
        let mut values = vec![];
        while let Some(value) =
            args.peek().and_then(|w| VALUES.iter().find(|(name, _)| *name == w.text)).map(|(_, v)| *v)
        {
            args.next();
            values.push(value);
        }
        if values.is_empty() {
            let known: Vec<&str> = VALUES.iter().map(|(name, _)| *name).collect();
            let text =
                format!("`store/local` needs the values to keep of bonds that break: {}", known.join(" "));
            return fail(Code::INCOMPLETE, args.here(), text);
        }
        let own = format!("{NAME}/{id}");
        let (rows, first) = (Key::new(&own), FIRST.key(&own));
        Ok(Self { id, every, values, rows, first })
    }

    /// The ID.
    pub fn id(&self) -> &str {
        &self.id
    }

    fn looks_back(&self) -> bool {
        self.values.iter().any(|v| matches!(v, Value::First(_)))
    }

    /// What `keep` reads; it writes the memory of fixes.
    pub fn reads(&self) -> Fields {
        if self.looks_back() { COLUMNS } else { Fields::NONE }
    }

    /// Keeps broken bonds, given by the places of their ends, that of the lower ID first.
    pub fn keep(&self, w: &mut World, step: i64, broken: &[[usize; 2]]) {
        let p = &w.particles;
        // Read only where it is stated: see `reads`.
        let first = if self.looks_back() { w.columns.get_vector(self.first).unwrap_or(&[]) } else { &[] };
        let middle = |list: &[[f64; 3]], [a, b]: [usize; 2], k: usize| {
            list.get(a).zip(list.get(b)).map_or(0.0, |(a, b)| 0.5 * (a[k] + b[k]))
        };
        let mut rows = vec![];
        for &ends in broken {
            rows.extend(self.values.iter().map(|v| match *v {
                Value::Id(k) => f64::from(p.tag[ends[k]]),
                Value::Time => step as f64,
                Value::Middle(k) => middle(&p.x, ends, k),
                Value::First(k) => middle(first, ends, k),
            }));
        }
        let mut all = w.memo.remove(self.rows).unwrap_or_default();
        all.extend(rows);
        w.memo.insert(self.rows, all);
    }
}

impl Fix for Store {
    fn shape(&self) -> Shape {
        Shape { local: self.values.len(), every: self.every, ..Shape::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        let name = format!("f_{}", self.id);
        let slot = w.slots.id(&name);
        *w.slots.get_mut(slot) = Slot { name, local_cols: self.values.len(), ..Slot::default() };
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.rows);
        w.columns.remove(self.first);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let slot = cx.slot(&format!("f_{}", self.id));
        let mut access = Needs::new().write(SLOTS).keep(MEMO).only(&[self.rows.text(), self.first.text()]);
        if self.looks_back() {
            access = access.read(X).keep(COLUMNS);
        }
        let me = self.clone();
        let op = StepOp::new(format!("fix {} {NAME}", self.id), Stage::PostForce, access, move |w, t| {
            if t.setup && me.looks_back() && w.columns.get_vector(me.first).is_none() {
                let n = w.n();
                *w.columns.vector(me.first, n) = w.particles.x.to_vec();
            }
            if t.setup || t.step % me.every != 0 {
                return Ok(());
            }
            let rows = w.memo.remove(me.rows).unwrap_or_default();
            let out = w.slots.get_mut(slot);
            (out.step, out.local_cols, out.local) = (Some(t.step), me.values.len(), rows);
            Ok(())
        });
        Ok(vec![op.in_setup(true).boxed()])
    }
}

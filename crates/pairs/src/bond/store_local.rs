//! `store/local`: what is kept of bonds that break, as local values of a fix that the bond style brings along.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Args, Kind, Value, Words, inner};
use perigrain_styles::{BuildCx, Fix, SealCx, Shape};
use perigrain_world::field::{COLUMNS, Fields, MEMO, SLOTS, X};
use perigrain_world::{Key, Numbers, Registration, Slot, Under, Vectors, World};

/// The style's name among fixes.
pub const NAME: &str = "store/local";

/// Columns of places in the setup of the first run.
static FIRST: Registration = Registration::moved("store/local/", "/first", Under::Anchor);

/// The words behind `store/local`.
#[derive(Words)]
struct Line {
    /// The ID under which broken bonds are kept.
    #[word(name = "ID")]
    id: String,
    /// The interval N.
    #[word(name = "N", from = 1)]
    every: i64,
    values: Vec<Kept>,
}

/// A value of a bond that breaks.
#[derive(Clone, Copy, Debug, PartialEq, Words)]
#[word(what = "value of a bond that breaks")]
enum Kept {
    /// The ID of an end, the lower of both.
    Id1,
    /// The ID of the other end.
    Id2,
    /// The step in which it broke.
    Time,
    /// The middle between its ends then.
    X,
    /// The middle between its ends then.
    Y,
    /// The middle between its ends then.
    Z,
    /// The middle between its ends in the setup of the first run.
    #[word("x/ref")]
    RefX,
    /// The middle between its ends in the setup of the first run.
    #[word("y/ref")]
    RefY,
    /// The middle between its ends in the setup of the first run.
    #[word("z/ref")]
    RefZ,
}

impl Kept {
    /// Whether it is of the setup of the first run.
    fn is_first(self) -> bool {
        matches!(self, Self::RefX | Self::RefY | Self::RefZ)
    }
}

/// The words of a bond style's line about bonds that break.
#[derive(Clone)]
pub struct Store {
    id: String,
    every: i64,
    values: Vec<Kept>,
    /// Rows since the last multiple of `every`.
    rows: Numbers,
    /// Positions in the setup of the first run.
    first: Vectors,
}

impl Value for Store {
    const KIND: Kind = Kind::Words(<Line as Words>::GRAMMAR);

    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let Line { id, every, values } = inner(args, cx)?;
        if values.is_empty() {
            let known: Vec<&str> = Kept::KIND.choices().iter().map(|value| value.word).collect();
            let text =
                format!("`store/local` needs the values to keep of bonds that break: {}", known.join(" "));
            return fail(Code::INCOMPLETE, args.here(), text);
        }
        let own = format!("{NAME}/{id}");
        let (rows, first) = (Key::new(&own), FIRST.key(&own));
        Ok(Self { id, every, values, rows, first })
    }
}

impl Store {
    /// The ID.
    pub fn id(&self) -> &str {
        &self.id
    }

    fn looks_back(&self) -> bool {
        self.values.iter().any(|value| value.is_first())
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
            rows.extend(self.values.iter().map(|value| match value {
                Kept::Id1 => f64::from(p.tag[ends[0]]),
                Kept::Id2 => f64::from(p.tag[ends[1]]),
                Kept::Time => step as f64,
                Kept::X => middle(&p.x, ends, 0),
                Kept::Y => middle(&p.x, ends, 1),
                Kept::Z => middle(&p.x, ends, 2),
                Kept::RefX => middle(first, ends, 0),
                Kept::RefY => middle(first, ends, 1),
                Kept::RefZ => middle(first, ends, 2),
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

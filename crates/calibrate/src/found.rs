//! What `calibrate` leaves behind: numbers and fields that formulas and dumps read as those of a compute.

use perigrain_base::diag::Result;
use perigrain_base::math::cformat::general;
use perigrain_plan::{Op, Stage, When};
use perigrain_statics::six::{Matrix6, Six};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::{Compute, SealCx, Shape};
use perigrain_world::field::{COLUMNS, MEMO};
use perigrain_world::{Key, Numbers, Registration, SlotId, Under, Vectors, World};

/// How many numbers there are of every kind of calibration.
pub const NUMBERS: usize = 10;

/// Fields that an earlier line of the same ID may have left.
const MOST_FIELDS: usize = 2;

/// Vectors per particle.
pub static FIELDS: Registration = Registration::moved("calibrate ", "", Under::Record);

/// The values under an ID.
#[derive(Clone, Debug)]
pub struct Found {
    id: String,
    /// Coefficients that were fitted.
    coefficients: usize,
    /// Whether there is a tensor.
    tensor: bool,
    /// Vectors per particle.
    fields: usize,
}

impl Found {
    /// Under this ID.
    pub fn new(id: &str, coefficients: usize, tensor: bool, fields: usize) -> Self {
        Self { id: id.to_string(), coefficients, tensor, fields }
    }

    fn numbers(&self) -> Numbers {
        Key::new(&format!("calibrate {}", self.id))
    }

    fn field(&self, k: usize) -> Vectors {
        FIELDS.key(&format!("calibrate {}/{k}", self.id))
    }

    /// Keeps the numbers, the coefficients fitted, and the tensor behind them.
    pub fn keep(
        &self,
        w: &mut World,
        numbers: [f64; NUMBERS],
        coefficients: &[f64],
        tensor: Option<&Matrix6>,
    ) {
        let mut all = [&numbers[..], coefficients].concat();
        all.extend(tensor.into_iter().flatten().flatten());
        w.memo.insert(self.numbers(), all);
        (self.fields..MOST_FIELDS).for_each(|k| w.columns.remove(self.field(k)));
        // A reader of an earlier line's values in this step must not get them again.
        if let Some(slot) = w.slots.find(&format!("c_{}", self.id)) {
            w.slots.get_mut(slot).step = None;
        }
    }

    /// Keeps a vector of each of some particles, at these places in the world; zero for all others.
    pub fn keep_field(&self, w: &mut World, k: usize, places: &[usize], of: impl Fn(usize) -> [f64; 3]) {
        let n = w.n();
        let column = w.columns.vector(self.field(k), n);
        column.fill([0.0; 3]);
        places.iter().enumerate().for_each(|(row, place)| column[*place] = of(row));
    }

    /// Keeps displacements and rotations.
    pub fn keep_motion(&self, w: &mut World, places: &[usize], u: &[Six]) {
        self.keep_field(w, 0, places, |k| [u[k][0], u[k][1], u[k][2]]);
        self.keep_field(w, 1, places, |k| [u[k][3], u[k][4], u[k][5]]);
    }
}

impl Compute for Found {
    fn shape(&self) -> Shape {
        let array = if self.tensor { 6 } else { 0 };
        let atom = (self.fields > 0).then_some(3 * self.fields);
        let vector = NUMBERS + self.coefficients;
        Shape { vector, array, array_rows: array, atom, ..Shape::default() }
    }

    fn remove(&self, w: &mut World) {
        w.memo.remove(self.numbers());
        (0..self.fields).for_each(|k| w.columns.remove(self.field(k)));
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (numbers, many) = (self.numbers(), NUMBERS + self.coefficients);
        let fields: Vec<Vectors> = (0..self.fields).map(|k| self.field(k)).collect();
        let wanted = Wanted { slot, stage, when };
        let reads = if fields.is_empty() { MEMO } else { COLUMNS | MEMO };
        Ok(fill(&self.id, &wanted, reads, move |w, _, out| {
            let all = w.memo.get(numbers).map_or(&[][..], Vec::as_slice);
            let (numbers, tensor) = all.split_at(many.min(all.len()));
            out.vector = numbers.to_vec();
            out.array = tensor.to_vec();
            out.array_cols = if tensor.is_empty() { 0 } else { 6 };
            out.cols = 3 * fields.len();
            out.atom = vec![0.0; out.cols * w.n()];
            for (k, key) in fields.iter().enumerate() {
                for (i, v) in w.columns.get_vector(*key).unwrap_or_default().iter().enumerate() {
                    out.atom[i * out.cols + 3 * k..][..3].copy_from_slice(v);
                }
            }
            Ok(())
        }))
    }
}

/// The lines of a tensor for the log.
pub fn lines(c: &Matrix6) -> impl Iterator<Item = String> {
    let text =
        |row: &[f64; 6]| row.iter().fold(" ".to_string(), |line, a| format!("{line} {:>11}", general(*a, 5)));
    c.map(|row| text(&row)).into_iter()
}

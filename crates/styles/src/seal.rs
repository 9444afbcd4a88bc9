//! What styles may request while a run is sealed into a plan.

use crate::BondForce;
use crate::probe::{Probe, WallProbe};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_lang::{Param, ValueRef};
use perigrain_output::log::Log;
use perigrain_plan::{Level, Op, Stage, When};
use perigrain_world::adapted::Coefficient;
use perigrain_world::field::{
    BOX, COLUMNS, CONTROLS, IMAGE, KIND, MASK, MASS, MEMO, MOLECULE, OMEGA, RADIUS, REGIONS, SLOTS, TAG,
    TYPE_MASS, V, X,
};
use perigrain_world::{Fields, GroupId, SlotId, World};

/// Where an op finds a value while it runs; the plan makes sure it is fresh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// A constant.
    Const(f64),
    /// A slot's single number.
    Scalar(SlotId),
    /// An element (from 0) of a slot's global vector.
    Element(SlotId, usize),
    /// A column (from 0) of a slot's per-particle values.
    Atom(SlotId, usize),
    /// Row and column (from 0) of a slot's global array.
    Cell(SlotId, usize, usize),
    /// A slot's whole global vector.
    Vector(SlotId),
    /// A column (from 0) of a slot's global array, as a vector.
    Column(SlotId, usize),
    /// A column (from 0) of a slot's local values.
    Local(SlotId, usize),
}

impl Reading {
    /// The number; of a per-particle reading the first particle's, of a vector its first element. 0 for an element that
    /// a vector of varying length does not have at present, as in LAMMPS.
    pub fn get(&self, w: &World) -> f64 {
        match *self {
            Reading::Const(a) => a,
            Reading::Scalar(s) => w.slots.get(s).scalar,
            Reading::Element(s, k) => w.slots.get(s).vector.get(k).copied().unwrap_or(0.0),
            Reading::Atom(..) => self.atom(w, 0),
            Reading::Cell(s, r, c) => w.slots.get(s).cell(r, c).unwrap_or(0.0),
            Reading::Vector(..) | Reading::Column(..) | Reading::Local(..) => {
                self.list(w).first().copied().unwrap_or(0.0)
            }
        }
    }

    /// How many elements (or rows) there are at present, where that is too few for the one this is to read.
    pub fn too_few(&self, w: &World) -> Option<usize> {
        let slot = match *self {
            Reading::Element(s, _) | Reading::Cell(s, ..) => w.slots.get(s),
            _ => return None,
        };
        let (wanted, there) = match *self {
            Reading::Element(_, k) => (k, slot.vector.len()),
            Reading::Cell(_, row, _) => (row, slot.array.len() / slot.array_cols.max(1)),
            _ => return None,
        };
        (wanted >= there).then_some(there)
    }

    /// The number of particle `i`: its own, or the common one.
    pub fn atom(&self, w: &World, i: usize) -> f64 {
        match *self {
            Reading::Atom(s, c) => {
                let slot = w.slots.get(s);
                slot.atom.get(i * slot.cols + c).copied().unwrap_or(0.0)
            }
            _ => self.get(w),
        }
    }

    /// All its values: a vector's elements, an array column's, local values, those of the particles by index; the one
    /// number of everything else.
    pub fn list(&self, w: &World) -> Vec<f64> {
        match *self {
            Reading::Vector(s) => w.slots.get(s).vector.clone(),
            Reading::Column(s, c) => w.slots.get(s).array_column(c),
            Reading::Local(s, c) => w.slots.get(s).local_column(c),
            Reading::Atom(..) => (0..w.n()).map(|i| self.atom(w, i)).collect(),
            _ => vec![self.get(w)],
        }
    }

    /// How many values `list` gives.
    pub fn len(&self, w: &World) -> usize {
        let rows = |values: usize, cols: usize| values.checked_div(cols).unwrap_or(0);
        match *self {
            Reading::Vector(s) => w.slots.get(s).vector.len(),
            Reading::Column(s, _) => rows(w.slots.get(s).array.len(), w.slots.get(s).array_cols),
            Reading::Local(s, _) => rows(w.slots.get(s).local.len(), w.slots.get(s).local_cols),
            Reading::Atom(..) => w.n(),
            _ => 1,
        }
    }

    /// Whether `list` gives no value.
    pub fn is_empty(&self, w: &World) -> bool {
        self.len(w) == 0
    }

    /// Whether it is the same in every step.
    pub fn is_const(&self) -> bool {
        matches!(self, Reading::Const(_))
    }

    /// Whether particles differ.
    pub fn per_atom(&self) -> bool {
        matches!(self, Reading::Atom(..))
    }
}

/// The kind of value a reader needs from a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wants {
    /// One number: `c_ID`, `c_ID[k]` of a vector, `c_ID[i][j]` of an array.
    Number,
    /// One number per particle: `c_ID`, `c_ID[k]`.
    PerAtom,
    /// A global vector: `c_ID`, or a column `c_ID[k]` of a global array.
    Vector,
    /// Local values: `c_ID`, or a column `c_ID[k]` of several.
    Local,
}

/// What formulas may read besides forces and torques.
pub const FORMULAS: Fields = X
    .and(V)
    .and(OMEGA)
    .and(RADIUS)
    .and(MASS)
    .and(KIND)
    .and(TYPE_MASS)
    .and(MASK)
    .and(IMAGE)
    .and(TAG)
    .and(MOLECULE)
    .and(COLUMNS)
    .and(CONTROLS)
    .and(MEMO)
    .and(BOX)
    .and(REGIONS)
    .and(SLOTS);

/// A text whose values are inserted at each call; an op that holds one may read what [`FORMULAS`] allows.
pub type Text = Box<dyn FnMut(&World) -> Result<String> + Send>;

/// Decides about a place: whether a variable is not zero there.
pub type PlaceTest = Box<dyn FnMut(&World, [f64; 3]) -> Result<bool> + Send>;

/// Gives the values of a bond-style variable for all living bonds, in the order of `Families::living`; an op that holds one may read
/// what [`FORMULAS`] allows, and families.
pub type BondFormula = Box<dyn FnMut(&World) -> Result<Vec<f64>> + Send>;

/// The acceleration that a fix gives to all particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pull {
    /// Always the same [acceleration in force/mass units].
    Constant([f64; 3]),
    /// Given by variables.
    Varying,
}

/// A fix gravity in force.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gravity {
    /// Its ID.
    pub id: String,
    /// Its group.
    pub group: GroupId,
    /// Whether it pulls the particles of the group by itself.
    pub acts: bool,
    /// The slot whose vector is its acceleration at the present step, in force/mass units.
    pub slot: SlotId,
}

/// What a style may request while a run is sealed.
pub trait SealCx {
    /// The world as the run starts: columns may be made here.
    fn world(&mut self) -> &mut World;
    /// The line that declared the style.
    fn span(&self) -> Span;
    /// In which of several levels of steps the fix adds its force (`fix_modify respa`).
    fn level(&self) -> Level {
        Level::Outermost
    }
    /// Whether steps are load steps of `statics`, from one equilibrium to the next.
    fn at_rest(&self) -> bool {
        false
    }
    /// The slot `f_ID`, `c_ID` … of this name.
    fn slot(&mut self, name: &str) -> SlotId;
    /// A reference's value, fresh whenever `when` fires, before the ops of this style at `stage`.
    ///
    /// # Errors
    /// Unknown names, wrong kinds, circles.
    fn value(&mut self, r: &ValueRef, stage: Stage, when: &When) -> Result<Reading>;
    /// As `value`, for a reader that needs exactly this kind: `c_ID` is a number, a whole vector or a value per particle, and
    /// `c_ID[2]` an element, a column of an array, of per-particle or of local values.
    ///
    /// # Errors
    /// As `value`.
    fn reading(&mut self, r: &ValueRef, wants: Wants, stage: Stage, when: &When) -> Result<Reading>;
    /// As `value` for a number or a reference.
    ///
    /// # Errors
    /// As `value`.
    fn param(&mut self, p: &Param, stage: Stage, when: &When) -> Result<Reading> {
        match p {
            Param::Number(a) => Ok(Reading::Const(*a)),
            Param::Ref(r) => self.value(r, stage, when),
        }
    }
    /// A thermo keyword's value (`temp`, `pe`, `vol` …), fresh as with `value`.
    ///
    /// # Errors
    /// Unknown keywords.
    fn keyword(&mut self, name: &str, span: Span, stage: Stage, when: &When) -> Result<Reading>;
    /// A text with `$x`, `${name}` and `$(formula)` in it, its values fresh as with `value`.
    ///
    /// # Errors
    /// Formulas that cannot be read, and what they name that is not there.
    fn text(&mut self, text: &str, span: Span, stage: Stage, when: &When) -> Result<Text>;
    /// The steps that a variable names one after another, each time from the step named before (`logfreq`, `stride` …).
    ///
    /// # Errors
    /// Unknown variables, and a step that is not later than the one before.
    fn steps(&mut self, r: &ValueRef) -> Result<When>;
    /// A test of places: the internal-style variables `sets` take x, y, z, then the equal-style variable `r` decides.
    ///
    /// # Errors
    /// Unknown variables, and those of other styles.
    fn test(
        &mut self,
        r: &ValueRef,
        sets: &[Option<ValueRef>; 3],
        stage: Stage,
        when: &When,
    ) -> Result<PlaceTest>;
    /// A bond-style variable, its values fresh as with `value`.
    ///
    /// # Errors
    /// Unknown variables, and those of other styles.
    fn bond_formula(&mut self, r: &ValueRef, _stage: Stage, _when: &When) -> Result<BondFormula> {
        fail(Code::UNKNOWN_VARIABLE, r.span, format!("there is no variable `{}`", r.name))
    }
    /// The accelerations of the fixes gravity in force.
    fn pulls(&self) -> Vec<Pull>;
    /// The same fixes as those see them that pull bodies for them.
    fn gravities(&mut self) -> Vec<Gravity> {
        vec![]
    }
    /// Of a fix of this ID, of which molecule templates new copies become its rigid bodies; `None` without such a fix.
    fn adopts(&self, _id: &str) -> Option<Vec<String>> {
        None
    }
    /// ID and style of the fix that moves copies of a molecule template as rigid bodies.
    fn adopter(&self, _template: &str) -> Option<(String, &'static str)> {
        None
    }
    /// The log of the run.
    fn log(&self) -> Log;
    /// The op that gives a compute a new beginning after a snapshot (`dump_modify refresh`); `None` if it has none.
    ///
    /// # Errors
    /// An unknown compute.
    fn refresh(&mut self, _id: &str, _stage: Stage, _when: &When) -> Result<Option<Box<dyn Op>>> {
        Ok(None)
    }
    /// The pair style in force and its sub-styles.
    fn pair_styles(&self) -> Vec<&'static str> {
        vec![]
    }
    /// The value of a coefficient of the pair or bond style in force, as the deck's lines set it.
    fn coefficient(&self, _of: &Coefficient) -> Option<f64> {
        None
    }
    /// The bond style in force.
    fn bonds(&self) -> Option<Box<dyn BondForce>> {
        None
    }
    /// The temperature that knows the flow which compute `r` takes away: itself, or that of its `bias`.
    fn bias(&self, r: &ValueRef) -> Option<Box<dyn crate::Compute>>;
    /// Energies must be tallied whenever `when` fires.
    fn request_energy(&mut self, when: &When);
    /// The virial must be tallied whenever `when` fires.
    fn request_virial(&mut self, when: &When);
    /// Per-particle energies must be tallied whenever `when` fires.
    fn request_atom_energy(&mut self, when: &When);
    /// Per-particle virials must be tallied whenever `when` fires.
    fn request_atom_virial(&mut self, when: &When);
    /// Probes of the pair styles for single pairs. The caller's op reads `contacts`.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn probes(&mut self) -> Result<Vec<Box<dyn Probe>>>;
    /// Probes for computes: as `probes`, and those of a solid that has some.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn singles(&mut self) -> Result<Vec<Box<dyn Probe>>> {
        self.probes()
    }
    /// Probes of walls of surfaces, with the IDs of their fixes. The caller's op reads `wall_contacts`.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn wall_probes(&mut self) -> Result<Vec<(String, Box<dyn WallProbe>)>> {
        Ok(vec![])
    }
    /// The largest cutoff of forces of the pair style in force [length].
    fn cutoff(&mut self) -> Option<f64> {
        None
    }
    /// Slots of fixes whose energy counts (`fix_modify ID energy yes`), for the potential energy.
    fn energy_fixes(&self) -> Vec<String>;
    /// Records what this scene does without, and why.
    fn leave_out(&mut self, what: &str, why: &str);
}

//! Types of words: how each is read, and what kind of word it is.

use super::{Kind, Words};
use crate::BuildCx;
use crate::common::{self, variable_param};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_base::math::body::{Quat, turn};
use perigrain_lang::{Args, Param, RefKind, ValueRef, Word, blame};
use perigrain_world::{GroupId, Key, Region, World};
use std::f64::consts::PI;
use std::marker::PhantomData;
use std::path::PathBuf;

/// What a word of a line, or a few words, can be read as.
pub trait Value: Sized {
    /// What may stand there.
    const KIND: Kind;

    /// Takes it; `what` is its name in messages.
    ///
    /// # Errors
    /// A missing word, or one that is none.
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self>;

    /// Whether a word may begin one; a list of them ends before the first word that does not.
    fn begins(_: &Word) -> bool {
        true
    }
}

/// Whole numbers with a bound.
pub trait Whole: Sized {
    /// Takes one of at least `least`.
    ///
    /// # Errors
    /// A missing word, one that is no whole number, and smaller numbers.
    fn from(args: &mut Args, least: i64, what: &str) -> Result<Self>;
}

macro_rules! whole {
    ($($ty:ty: $least:expr),*) => {$(
        impl Whole for $ty {
            fn from(args: &mut Args, least: i64, what: &str) -> Result<Self> {
                let k = args.integer_from(least, what)?;
                Ok(<$ty>::try_from(k).unwrap_or(<$ty>::MAX))
            }
        }
    )*};
}
whole!(i64: i64::MIN, u64: 0, u32: 0, usize: 0);

impl Value for f64 {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.number(what)
    }
}

impl Value for i64 {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.integer(what)
    }
}

impl Value for usize {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        <Self as Whole>::from(args, 0, what)
    }
}

impl Value for u32 {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        <Self as Whole>::from(args, 0, what)
    }
}

impl Value for u64 {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        <Self as Whole>::from(args, 0, what)
    }
}

impl Value for bool {
    const KIND: Kind = Kind::Switch;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.flag(what)
    }
}

impl Value for Word {
    const KIND: Kind = Kind::Text;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.expect(what).cloned()
    }
}

impl Value for String {
    const KIND: Kind = Kind::Text;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        Ok(args.expect(what)?.text.clone())
    }
}

impl Value for PathBuf {
    const KIND: Kind = Kind::File;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        Ok(Self::from(&args.expect(what)?.text))
    }
}

/// A number or a variable with one value.
impl Value for Param {
    const KIND: Kind = Kind::Param;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let param = variable_param(args, what)?;
        cx.param(&param, false)?;
        Ok(param)
    }
}

/// A number, or a variable with one value or with one for each particle.
#[derive(Clone, Debug, PartialEq)]
pub struct PerAtom(pub Param);

impl From<PerAtom> for Param {
    fn from(param: PerAtom) -> Self {
        param.0
    }
}

impl Value for PerAtom {
    const KIND: Kind = Kind::Param;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let param = variable_param(args, what)?;
        cx.param(&param, true)?;
        Ok(Self(param))
    }
}

/// The name of an atom-style variable, without `v_`.
#[derive(Clone, Debug, PartialEq)]
pub struct AtomVariable(pub ValueRef);

impl Value for AtomVariable {
    const KIND: Kind = Kind::Variable;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        common::atom_variable(cx, args.expect("a variable")?).map(Self)
    }
}

/// A number above zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Positive(pub f64);

impl Value for Positive {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.positive(what).map(Self)
    }
}

/// A number that is not below zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NonNegative(pub f64);

impl Value for NonNegative {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.non_negative(what).map(Self)
    }
}

impl Value for GroupId {
    const KIND: Kind = Kind::Group;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        cx.group(args.expect("a group")?)
    }
}

impl Value for Region {
    const KIND: Kind = Kind::Region;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        cx.region(args.expect("a region")?).cloned()
    }
}

/// The ID of a region.
impl Value for Key<Region> {
    const KIND: Kind = Kind::Region;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("a region")?;
        cx.region(word).map(|_| Self::new(&word.text))
    }
}

/// A type or a range of types, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Types(pub u16, pub u16);

impl Value for Types {
    const KIND: Kind = Kind::Types;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let (first, last) = args.type_range(cx.world.types)?;
        Ok(Self(first, last))
    }
}

/// `x`, `y` or `z` as 0, 1 or 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis(pub usize);

impl Value for Axis {
    const KIND: Kind = Kind::Choice(&[
        super::Alternative { word: "x", about: "", parts: &[] },
        super::Alternative { word: "y", about: "", parts: &[] },
        super::Alternative { word: "z", about: "", parts: &[] },
    ]);
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        common::axis(args, what).map(Self)
    }
    fn begins(word: &Word) -> bool {
        ["x", "y", "z"].contains(&word.text.as_str())
    }
}

/// A global value, `c_ID`, `f_ID` or `v_name`, as it stands there: what it must offer depends on other words of the line.
#[derive(Clone, Debug, PartialEq)]
pub struct GlobalValue(pub Word);

impl Value for GlobalValue {
    const KIND: Kind = Kind::Value;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect("a value such as c_ID or v_name")?;
        if Self::begins(word) {
            return Ok(Self(word.clone()));
        }
        let text = format!("`{}` is no value: c_ID, f_ID or v_name is expected", word.text);
        fail(Code::WRONG_KIND, word.span, text)
    }
    fn begins(word: &Word) -> bool {
        ["c_", "f_", "v_"].iter().any(|p| word.text.starts_with(p))
    }
}

/// `v_name` of a variable with a numeric value.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference(pub ValueRef);

impl Value for Reference {
    const KIND: Kind = Kind::Reference;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("an equal-style variable, as `v_name`")?;
        match ValueRef::parse(&word.text, word.span)?.filter(|r| r.kind == RefKind::Variable) {
            Some(r) => cx.value(&r, false).map(|()| Self(r)),
            None => {
                Err(blame(word, Code::BAD_VALUE, "this must be an equal-style variable, as `v_name`").into())
            }
        }
    }
    fn begins(word: &Word) -> bool {
        word.text.starts_with("v_")
    }
}

/// A number of steps, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps(pub i64);

impl Value for Steps {
    const KIND: Kind = Kind::Whole;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.integer_from(0, what).map(Self)
    }
}

/// A bond type that there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BondType(pub u16);

impl Value for BondType {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        common::bond_type(args, cx.world.bonds.types).map(Self)
    }
}

/// A seed of the Park–Miller stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed(pub u32);

impl Value for Seed {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        common::seed(args).map(Self)
    }
}

/// A seed of Marsaglia's stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MarsagliaSeed(pub u32);

impl Value for MarsagliaSeed {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        common::marsaglia_seed(args).map(Self)
    }
}

/// A number from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fraction(pub f64);

impl Value for Fraction {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        common::fraction(args).map(Self)
    }
}

/// A type that there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OneType(pub u16);

impl Value for OneType {
    const KIND: Kind = Kind::Types;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let (span, types) = (args.here(), cx.world.types);
        let unknown = args.peek().is_some_and(|w| w.unknown);
        let k = args.integer(what)?;
        match u16::try_from(k) {
            Ok(t) if k >= 1 && k as usize <= types => Ok(Self(t)),
            _ if unknown => Ok(Self(1)),
            _ => fail(Code::BAD_VALUE, span, format!("there are types 1 to {types}, not {k}")),
        }
    }
}

/// In which units the distances of a line are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, perigrain_words::Words)]
#[word(what = "value of units")]
pub enum Units {
    /// In spacings of the `lattice`.
    #[default]
    Lattice,
    /// In those of the box.
    Box,
}

impl Units {
    /// Factors from the line's distances to the box's.
    pub fn scales(self, world: &World) -> [f64; 3] {
        common::scales(world, self == Self::Lattice)
    }
}

/// `vx`, `vy` or `vz` as 0, 1 or 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VelocityAxis(pub usize);

impl Value for VelocityAxis {
    const KIND: Kind = Kind::Choice(&[
        super::Alternative { word: "vx", about: "", parts: &[] },
        super::Alternative { word: "vy", about: "", parts: &[] },
        super::Alternative { word: "vz", about: "", parts: &[] },
    ]);
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        common::velocity_axis(args).map(Self)
    }
}

/// A value that is read and not used.
#[derive(Clone, Copy, Debug)]
pub struct Idle<T>(PhantomData<T>);

impl<T: Value> Value for Idle<T> {
    const KIND: Kind = T::KIND;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        T::value(what, args, cx).map(|_| Self(PhantomData))
    }
    fn begins(word: &Word) -> bool {
        T::begins(word)
    }
}

/// Something, or `NULL` for nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Nullable<T>(pub Option<T>);

impl<T: Value> Value for Nullable<T> {
    const KIND: Kind = Kind::OrNull(&T::KIND);
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        if args.eat("NULL") {
            return Ok(Self(None));
        }
        T::value(what, args, cx).map(|value| Self(Some(value)))
    }
}

/// A word of some, or else something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Or<W, T> {
    /// One of these words.
    Word(W),
    /// What stands there in place of them.
    Else(T),
}

impl<W: Value, T: Value> Value for Or<W, T> {
    const KIND: Kind = Kind::Or(&W::KIND, &T::KIND);
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        match args.peek().is_some_and(W::begins) {
            true => W::value(what, args, cx).map(Self::Word),
            false => T::value(what, args, cx).map(Self::Else),
        }
    }
    fn begins(word: &Word) -> bool {
        W::begins(word) || T::begins(word)
    }
}

/// A value with its place, for what is checked once the line is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At<T> {
    /// The value.
    pub value: T,
    /// Where it stands.
    pub span: Span,
    /// `perigrain check` cannot know it: the value only stands in for it.
    pub unknown: bool,
}

impl<T> At<T> {
    /// Reads a value and keeps its place.
    ///
    /// # Errors
    /// Those of reading it.
    pub fn read(args: &mut Args, value: impl FnOnce(&mut Args) -> Result<T>) -> Result<Self> {
        let (span, unknown) = (args.here(), args.peek().is_some_and(|word| word.unknown));
        Ok(Self { value: value(args)?, span, unknown })
    }
}

/// A turn about an axis.
#[derive(Words)]
pub struct Turned {
    #[word(name = "ANGLE", what = "the angle [degrees]")]
    angle: f64,
    #[word(name = "X Y Z", what = "the axis")]
    axis: [At<f64>; 3],
}

impl Turned {
    /// The turn.
    ///
    /// # Errors
    /// An axis without a direction.
    pub fn quat(&self) -> Result<Quat> {
        let axis = self.axis.map(|x| x.value);
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            return fail(Code::BAD_VALUE, self.axis[0].span, "the axis must not be zero");
        }
        Ok(turn(axis.map(|x| x / length), self.angle * PI / 180.0))
    }
}

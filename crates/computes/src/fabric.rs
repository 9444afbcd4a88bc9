//! compute fabric: tensors of contact orientations and contact forces.

use super::pair_local::{Cutoff, answering, of_group, touches};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::length;
use perigrain_lang::{Args, Word};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::probe::{Interaction, Request, look_all};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA, RADIUS,
    TAG, TRAVEL, V, X,
};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct Fabric;

impl Style for Fabric {
    fn name(&self) -> &'static str {
        "fabric"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Tensors of the directions, lengths and forces of contacts.",
            text: "Scalar (extensive): the number of pairs. Vector (intensive) of xx yy zz xy xz yz for each tensor named, in that order, over the \
                   pairs with both ends in the group. With n the direction of a pair and r its distance, ⟨⟩ is the mean over all N pairs.",
            example: "compute fabric all fabric radius contact force/normal force/tangential",
        }
    }
}

#[derive(Words)]
struct Line {
    cutoff: Cutoff,
    #[word(name = "tensor", least = 1)]
    tensors: Vec<Tensor>,
    /// Only pairs of one type of the first list with one of the second count: types or ranges with commas, as `1,3*4`; several of them
    /// add up.
    #[word(keyword = "type/include", name = "list1 list2", what = "a list of types")]
    included: Vec<[TypeList; 2]>,
}

/// The tensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "tensor")]
enum Tensor {
    /// C = 15/2 (⟨n n⟩ − 1/3 I).
    Contact,
    /// 15/(2 tr D) (D − tr D/3 I) with D = ⟨r n n / (1 + n·C n)⟩.
    Branch,
    /// The same with the force f_n along n in the place of r.
    #[word("force/normal")]
    Normal,
    /// 15/(3 tr N) (T − tr T/3 I) with T = ⟨f_t n n / (1 + n·C n)⟩, f_t the size of the force across n and N that of `force/normal`
    /// (Ouadfel and Rothenburg 2001).
    #[word("force/tangential")]
    Tangential,
}

/// Selected types (index type − 1).
struct TypeList(Vec<bool>);

impl Value for TypeList {
    const KIND: Kind = Kind::Types;
    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        type_list(args.expect(what)?, cx.world.types).map(Self)
    }
}

impl ComputeStyle for Fabric {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let Line { cutoff, tensors, included } = read(args, cx)?;
        let touching = cutoff == Cutoff::Radius;
        if touching {
            super::need_spheres("`radius`", cx)?;
        }
        let included = included.into_iter().map(|lists| lists.map(|list| list.0)).collect();
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, touching, tensors, included }))
    }
}

/// `1,3*4`: the selected types (index type − 1).
fn type_list(word: &Word, types: usize) -> Result<Vec<bool>> {
    let mut chosen = vec![false; types];
    for part in word.text.split(',') {
        let (lo, hi) = part.split_once('*').unwrap_or((part, part));
        let bound = |text: &str, open: usize| if text.is_empty() { Ok(open) } else { text.parse() };
        let (open_lo, open_hi) = if part.contains('*') { (1, types) } else { (0, 0) };
        match (bound(lo, open_lo), bound(hi, open_hi)) {
            (Ok(lo), Ok(hi)) if lo >= 1 && lo <= hi && hi <= types => chosen[lo - 1..hi].fill(true),
            _ => {
                let text = format!("`{part}` is no type or range of types from 1 to {types}");
                return Err(Diagnostic::error(Code::BAD_VALUE, word.span, text)
                    .help("lists look as `1,3*4`")
                    .into());
            }
        }
    }
    Ok(chosen)
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    touching: bool,
    tensors: Vec<Tensor>,
    /// Selected types of the two ends; all if none is given.
    included: Vec<[Vec<bool>; 2]>,
}

impl Declared {
    fn has_types(&self, a: u16, b: u16) -> bool {
        let is = |list: &[bool], kind: u16| list.get(usize::from(kind) - 1).copied().unwrap_or(false);
        self.included.is_empty()
            || self.included.iter().any(|[p, q]| (is(p, a) && is(q, b)) || (is(p, b) && is(q, a)))
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, vector: 6 * self.tensors.len(), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let mut probes = answering(&self.id, cx)?;
        let me = self.clone();
        let reads = X
            | V
            | OMEGA
            | RADIUS
            | MASS
            | KIND
            | MASK
            | CONTACTS
            | BONDS
            | BOX
            | COLUMNS
            | FACTS
            | FAMILIES
            | TAG
            | LISTS
            | MEMO
            | MOLECULE
            | TRAVEL;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, _, out| {
            let mut pairs = look_all(&mut probes, w, Request::idle(!me.touching))?;
            let kind = |i: u32| w.particles.kind[i as usize];
            pairs.retain(|p| {
                of_group(w, me.group, p)
                    && (!me.touching || touches(w, p))
                    && me.has_types(kind(p.i), kind(p.j))
            });
            out.scalar = pairs.len() as f64;
            out.vector = vector(&me.tensors, &pairs);
            Ok(())
        }))
    }
}

type Symmetric = [f64; 6];

/// Off-diagonal components count twice in a product with a symmetric tensor.
const INDICES: [(usize, usize, f64); 6] =
    [(0, 0, 1.0), (1, 1, 1.0), (2, 2, 1.0), (0, 1, 2.0), (0, 2, 2.0), (1, 2, 2.0)];

fn vector(tensors: &[Tensor], pairs: &[Interaction]) -> Vec<f64> {
    let contact = deviator(&mean(pairs, |_, _| 1.0), 15.0 / 2.0);
    let weighted = |what: &dyn Fn(&Interaction) -> f64| {
        mean(pairs, |p, n| {
            let along: f64 =
                INDICES.iter().zip(contact).map(|((a, b, twice), c)| twice * c * n[*a] * n[*b]).sum();
            what(p) / (1.0 + along)
        })
    };
    let normal = weighted(&Interaction::central);
    let over = |number: f64, tensor: &Symmetric| match trace(tensor) {
        0.0 => 0.0,
        tr => 15.0 / (number * tr),
    };
    let one = |tensor: &Tensor| match tensor {
        Tensor::Contact => contact,
        Tensor::Branch => {
            let branch = weighted(&Interaction::distance);
            deviator(&branch, over(2.0, &branch))
        }
        Tensor::Normal => deviator(&normal, over(2.0, &normal)),
        Tensor::Tangential => {
            let across = |p: &Interaction| length(p.across());
            deviator(&weighted(&across), over(3.0, &normal))
        }
    };
    tensors.iter().flat_map(one).collect()
}

/// ⟨a n n⟩ over all pairs; zero without pairs.
fn mean(pairs: &[Interaction], a: impl Fn(&Interaction, [f64; 3]) -> f64) -> Symmetric {
    let mut sum = [0.0; 6];
    for p in pairs {
        let n = p.d.map(|x| x / p.distance());
        let a = a(p, n);
        sum.iter_mut().zip(INDICES).for_each(|(s, (k, l, _))| *s += a * n[k] * n[l]);
    }
    sum.map(|s| if pairs.is_empty() { 0.0 } else { s / pairs.len() as f64 })
}

fn trace(t: &Symmetric) -> f64 {
    t[0] + t[1] + t[2]
}

/// a (t − tr t/3 I).
fn deviator(t: &Symmetric, a: f64) -> Symmetric {
    let third = trace(t) / 3.0;
    std::array::from_fn(|k| a * (t[k] - if k < 3 { third } else { 0.0 }))
}

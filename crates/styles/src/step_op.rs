//! Ops made of a closure: all that most fixes and computes need.

use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_plan::{About, Acts, BlockSums, Level, Needs, Op, Room, Span, Stage, Tick, Way, When, fuse};
use perigrain_world::field::Fields;
use perigrain_world::field::SLOTS;
use perigrain_world::{GroupId, Slot, SlotId, World};

/// An op whose whole work is one closure at one stage.
pub struct StepOp<F> {
    about: About,
    fusing: Option<Fusing>,
    /// Where particles are shared out to ranks.
    span: Span,
    /// Where that is not the same at all ticks.
    spans: Option<Box<Spans>>,
    act: F,
}

type Spans = dyn Fn(&mut World, &Tick) -> Span + Send;

/// What an op offers to do to blocks of particles, and what it makes of what comes of them.
struct Fusing {
    offer: Box<Offer>,
    took: Box<Took>,
    /// Where it acts in a pass of its own: room for the act and for what comes of it.
    alone: (Room, Vec<BlockSums>),
}

type Offer = dyn Fn(&World, &Tick, &mut Room) -> bool + Send;
type Took = dyn FnMut(&mut World, &Tick, BlockSums) + Send;

impl<F> StepOp<F>
where
    F: FnMut(&mut World, &Tick) -> Result<()> + Send + 'static,
{
    /// Acts every step at `stage`, and in the setup of a run where that stage usually does.
    pub fn new(name: impl Into<String>, stage: Stage, access: Needs, act: F) -> Self {
        Self { about: About::new(name, stage, access), fusing: None, span: Span::All, spans: None, act }
    }

    /// Acts at other times.
    #[must_use]
    pub fn when(mut self, when: When) -> Self {
        self.about.when = when;
        self
    }

    /// Acts in the setup of a run too, or not.
    #[must_use]
    pub fn in_setup(mut self, yes: bool) -> Self {
        self.about.in_setup = yes;
        self
    }

    /// Acts in every one of several levels of steps: moves particles, or takes components of their forces away.
    #[must_use]
    pub fn in_every_level(mut self) -> Self {
        self.about.level = Level::Every;
        self
    }

    /// Acts in the shortest of several levels of steps alone.
    #[must_use]
    pub fn innermost(mut self) -> Self {
        self.about.level = Level::At(0);
        self
    }

    /// Reports to the account of ways how far it moves particles.
    #[must_use]
    pub fn reporting(mut self) -> Self {
        self.about.reports_travel = true;
        self
    }

    /// Begins the next step as well where [`Tick::on`] is set.
    #[must_use]
    pub fn beginning_next(mut self) -> Self {
        self.about.begins_next = true;
        self
    }

    /// Acts on each particle by itself: where `offer(world, tick, room)` puts something to do to blocks of particles into the room, that is done
    /// instead of what else it does, and `took` gets what came of it.
    #[must_use]
    pub fn fusing(
        mut self,
        offer: impl Fn(&World, &Tick, &mut Room) -> bool + Send + 'static,
        took: impl FnMut(&mut World, &Tick, BlockSums) + Send + 'static,
    ) -> Self {
        self.fusing =
            Some(Fusing { offer: Box::new(offer), took: Box::new(took), alone: Default::default() });
        self.about.collective = true;
        self
    }

    /// Reads and changes each particle by itself: each of several ranks does so for those that [`World::moved_in`] names.
    #[must_use]
    pub fn one_by_one(mut self) -> Self {
        self.span = Span::Own;
        self
    }

    /// Reads each particle by itself for sums alone ([`sum`](crate::matter::sum)): each of several ranks does so for its own, where
    /// [`World::sums_by_leaves`].
    #[must_use]
    pub fn summing(self) -> Self {
        self.spanning(|w, _| if w.sums_by_leaves() { Span::Own } else { Span::All })
    }

    /// Requests the rows it needs by [`World::whole`], on all ranks alike.
    #[must_use]
    pub fn requesting_rows(mut self) -> Self {
        self.span = Span::Requested;
        self
    }

    /// Of which rows it needs values differs from tick to tick.
    #[must_use]
    pub fn spanning(mut self, spans: impl Fn(&mut World, &Tick) -> Span + Send + 'static) -> Self {
        self.spans = Some(Box::new(spans));
        self
    }

    /// Makes sums over particles that others may read.
    #[must_use]
    pub fn with_sums(mut self) -> Self {
        self.about.collective = true;
        self
    }

    /// What comes of blocks of particles is read by the account of ways alone.
    #[must_use]
    pub fn without_sums(mut self) -> Self {
        self.about.collective = false;
        self
    }

    /// The op as the plan takes it.
    pub fn boxed(self) -> Box<dyn Op> {
        Box::new(self)
    }
}

impl<F> Op for StepOp<F>
where
    F: FnMut(&mut World, &Tick) -> Result<()> + Send,
{
    fn about(&self) -> About {
        About { fuses: self.fusing.is_some(), ..self.about.clone() }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if let Some(Fusing { offer, took, alone: (room, came) }) = &mut self.fusing
            && offer(w, t, room)
        {
            fuse(w, Acts::new(std::slice::from_ref(room), &[0]), came);
            came.iter().for_each(|sums| took(w, t, *sums));
            return Ok(());
        }
        (self.act)(w, t)
    }
    fn way(&mut self, w: &mut World, t: &Tick, room: &mut Room) -> Way {
        match &self.fusing {
            Some(fusing) if (fusing.offer)(w, t, room) => Way::Blocks,
            _ => Way::Alone,
        }
    }
    fn span(&mut self, w: &mut World, t: &Tick) -> Span {
        match &self.fusing {
            Some(fusing) if (fusing.offer)(w, t, &mut Room::default()) => Span::Own,
            _ => self.spans.as_ref().map_or(self.span, |spans| spans(w, t)),
        }
    }
    fn fused(&mut self, w: &mut World, t: &Tick, sums: BlockSums) {
        if let Some(fusing) = &mut self.fusing {
            (fusing.took)(w, t, sums);
        }
    }
}

/// Where and when a compute's values are wanted.
pub struct Wanted<'a> {
    /// Where they go.
    pub slot: SlotId,
    /// The stage their first reader acts at.
    pub stage: Stage,
    /// When they are read.
    pub when: &'a When,
}

/// The op of a compute: reads the world and fills the slot.
#[track_caller]
pub fn fill<F>(name: &str, wanted: &Wanted, reads: Fields, read: F) -> Box<dyn Op>
where
    F: FnMut(&World, &Tick, &mut Slot) -> Result<()> + Send + 'static,
{
    filling(name, wanted, reads, read).boxed()
}

/// As [`fill`], of a compute that reads particles for sums alone ([`StepOp::summing`]).
#[track_caller]
pub fn fill_sums<F>(name: &str, wanted: &Wanted, reads: Fields, read: F) -> Box<dyn Op>
where
    F: FnMut(&World, &Tick, &mut Slot) -> Result<()> + Send + 'static,
{
    fill_sums_if(true, name, wanted, reads, read)
}

/// As [`fill_sums`] where that is so, and else as [`fill`].
#[track_caller]
pub fn fill_sums_if<F>(sums: bool, name: &str, wanted: &Wanted, reads: Fields, read: F) -> Box<dyn Op>
where
    F: FnMut(&World, &Tick, &mut Slot) -> Result<()> + Send + 'static,
{
    let op = filling(name, wanted, reads, read);
    if sums { op.summing().boxed() } else { op.boxed() }
}

#[track_caller]
fn filling<F>(
    name: &str,
    wanted: &Wanted,
    reads: Fields,
    mut read: F,
) -> StepOp<impl FnMut(&mut World, &Tick) -> Result<()> + Send + use<F>>
where
    F: FnMut(&World, &Tick, &mut Slot) -> Result<()> + Send + 'static,
{
    let slot = wanted.slot;
    let act = move |w: &mut World, t: &Tick| {
        let mut out = w.slots.take(slot);
        let outcome = read(w, t, &mut out);
        w.slots.put(slot, out, t.step);
        outcome
    };
    StepOp::new(format!("compute {name}"), wanted.stage, Needs::new().read(reads).write(SLOTS), act)
        .when(wanted.when.clone())
        .in_setup(true)
}

/// Fills a per-atom vector: `value(i)` for the particles of the group, 0 for all others.
pub fn per_particle(w: &World, group: GroupId, out: &mut Slot, value: impl Fn(usize) -> f64 + Sync) {
    let bit = group.bit();
    out.cols = 1;
    out.atom.resize(w.n(), 0.0);
    par::each((&mut out.atom[..], &w.particles.mask[..]), |start, (out, mask)| {
        for (k, (out, mask)) in out.iter_mut().zip(mask).enumerate() {
            *out = if mask & bit != 0 { value(start + k) } else { 0.0 };
        }
    });
}

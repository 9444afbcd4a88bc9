//! Ops made of a closure: all that most fixes and computes need.

use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_plan::{Act, Gist, Level, Needs, Op, Stage, Tick, When, take_turns};
use perigrain_world::field::Fields;
use perigrain_world::field::SLOTS;
use perigrain_world::{GroupId, Slot, SlotId, World};

/// An op whose whole work is one closure at one stage.
pub struct StepOp<F> {
    name: String,
    stage: Stage,
    access: Needs,
    when: When,
    in_setup: bool,
    level: Level,
    reports: bool,
    on: Option<On>,
    turn: Option<Turn>,
    act: F,
}

/// What ends a step and begins the next one.
type On = Box<dyn FnMut(&mut World, &Tick) + Send>;

/// What an op offers to do to stretches of particles, and what it makes of what comes of them.
struct Turn {
    offer: Box<Offer>,
    took: Box<Took>,
}

type Offer = dyn Fn(&World, &Tick, bool) -> Option<Act> + Send;
type Took = dyn FnMut(&mut World, &Tick, Gist) + Send;

impl<F> StepOp<F>
where
    F: FnMut(&mut World, &Tick) -> Result<()> + Send + 'static,
{
    /// Acts every step at `stage`, and in the setup of a run where that stage usually does.
    pub fn new(name: impl Into<String>, stage: Stage, access: Needs, act: F) -> Self {
        Self {
            name: name.into(),
            stage,
            access,
            when: When::Always,
            in_setup: stage.in_setup(),
            level: Level::Outermost,
            reports: false,
            on: None,
            turn: None,
            act,
        }
    }

    /// Acts at other times.
    #[must_use]
    pub fn when(mut self, when: When) -> Self {
        self.when = when;
        self
    }

    /// Acts in the setup of a run too, or not.
    #[must_use]
    pub fn in_setup(mut self, yes: bool) -> Self {
        self.in_setup = yes;
        self
    }

    /// Acts in every one of several levels of steps: moves particles, or takes components of their forces away.
    #[must_use]
    pub fn in_every_level(mut self) -> Self {
        self.level = Level::Every;
        self
    }

    /// Acts in the shortest of several levels of steps alone.
    #[must_use]
    pub fn innermost(mut self) -> Self {
        self.level = Level::At(0);
        self
    }

    /// Reports to the account of ways how far it moves particles.
    #[must_use]
    pub fn reporting(mut self) -> Self {
        self.reports = true;
        self
    }

    /// Can end a step and begin the next one at once.
    #[must_use]
    pub fn and_on(mut self, on: impl FnMut(&mut World, &Tick) + Send + 'static) -> Self {
        self.on = Some(Box::new(on));
        self
    }

    /// Acts on each particle by itself: where `offer(world, tick, on)` gives something to do to stretches of particles, that
    /// is done instead of what else it does, and `took` gets what came of it. For `on` see [`Op::on_stretches`].
    #[must_use]
    pub fn taking_turns(
        mut self,
        offer: impl Fn(&World, &Tick, bool) -> Option<Act> + Send + 'static,
        took: impl FnMut(&mut World, &Tick, Gist) + Send + 'static,
    ) -> Self {
        self.turn = Some(Turn { offer: Box::new(offer), took: Box::new(took) });
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
    fn name(&self) -> &str {
        &self.name
    }
    fn stage(&self) -> Stage {
        self.stage
    }
    fn needs(&self) -> Needs {
        self.access.clone()
    }
    fn when(&self) -> When {
        self.when.clone()
    }
    fn in_setup(&self) -> bool {
        self.in_setup
    }
    fn level(&self) -> Level {
        self.level
    }
    fn reports_travel(&self) -> bool {
        self.reports
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        match self.on_stretches(w, t, false) {
            Some(act) => {
                let gists = take_turns(w, &[act]);
                gists.into_iter().for_each(|gist| self.took_turns(w, t, gist));
                Ok(())
            }
            None => (self.act)(w, t),
        }
    }
    fn run_on(&mut self, w: &mut World, t: &Tick) -> Result<bool> {
        Ok(self.on.as_mut().map(|on| on(w, t)).is_some())
    }
    fn on_stretches(&self, w: &World, t: &Tick, on: bool) -> Option<Act> {
        self.turn.as_ref().and_then(|turn| (turn.offer)(w, t, on))
    }
    fn took_turns(&mut self, w: &mut World, t: &Tick, gist: Gist) {
        if let Some(turn) = &mut self.turn {
            (turn.took)(w, t, gist);
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
pub fn fill<F>(name: &str, wanted: &Wanted, reads: Fields, mut read: F) -> Box<dyn Op>
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
        .boxed()
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

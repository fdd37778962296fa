//! Common parts of all pairs: two processes, the commands and mishaps, and the sequence of a tick.

use std::{fmt::Debug, sync::Arc};

use interfaces::{
    CommonMemory, ExternalInputs,
    process::{Inputs, Process},
};
use rcs_core::tick::Tick;
use taskdata::files::TaskData;

use crate::{
    data::data,
    search::{DeliveryFault, World, Wrong},
};

pub type Data = TaskData<'static>;

pub trait Stepped: Clone {
    fn step(&mut self, inputs: &Inputs<'_, Data>);
    fn restart(&mut self);
}

pub struct Half<P: Process<Data>> {
    pub state: P::State,
    pub out: P::Outputs,
}

impl<P: Process<Data, State: Copy, Outputs: Copy>> Clone for Half<P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Process<Data, State: Copy, Outputs: Copy>> Copy for Half<P> {}

impl<P: Process<Data, State: Copy + Default, Outputs: Copy + Default>> Default for Half<P> {
    fn default() -> Self {
        Self { state: P::State::default(), out: P::Outputs::default() }
    }
}

impl<P: Process<Data, State: Copy + Default, Outputs: Copy> + Default> Stepped for Half<P> {
    fn step(&mut self, inputs: &Inputs<'_, Data>) {
        let mut process = P::default();
        process.restore(self.state);
        process.step(inputs, &mut self.out);
        self.state = *process.state();
    }

    fn restart(&mut self) {
        self.state = P::State::default();
    }
}

/// The environment of the two processes of a pair, and its conditions.
pub trait Scene: Clone {
    type Upper: Stepped;
    type Lower: Stepped;
    type Line: Clone;
    type Command: Copy;
    /// Behaviour of the environment in a tick.
    type Does: Copy + Debug;

    const LONG: u64;
    /// Events that can happen to the processes.
    const DELIVERY_FAULTS: &'static [DeliveryFault] = DeliveryFault::RESTARTS;
    /// A command can arrive in the tick of a mishap.
    const COMMANDS_IN_MISHAPS: bool = false;

    fn choices(pair: &Pair<Self>) -> Vec<Choice<Self::Does>>;
    fn has_ended(pair: &Pair<Self>) -> bool;
    /// True if a command can replace the last one.
    fn is_other(pair: &Pair<Self>, line: &Self::Line) -> bool;
    /// True if a command can arrive after the end of the last one.
    fn may(_pair: &Pair<Self>, _line: &Self::Line) -> bool {
        true
    }
    fn command(pair: &mut Pair<Self>, nth: usize);
    /// Other changes of an event before the tick.
    fn begin(_pair: &mut Pair<Self>, _event: &Event<Self::Does>) {}
    fn inputs(pair: &Pair<Self>) -> (CommonMemory, ExternalInputs);
    /// The environment reads the outputs of the previous tick, and reacts. The error is the fault in its orders.
    fn act(pair: &mut Pair<Self>, event: &Event<Self::Does>, memory: &CommonMemory) -> Result<(), Wrong>;
    /// Record values that `judge` needs in later ticks.
    fn note(_pair: &mut Pair<Self>, _before: &Pair<Self>) {}
    /// Check each tick; `before` is the pair as the processes read it. The error is the violated condition.
    fn judge(pair: &Pair<Self>, before: &Pair<Self>, event: &Event<Self::Does>) -> Result<(), Wrong>;
    /// Check a steady state.
    fn judge_rest(_pair: &Pair<Self>, _before: &Pair<Self>, _event: &Event<Self::Does>) -> Result<(), Wrong> {
        Ok(())
    }
    /// Restart numbers and times that no longer matter.
    fn renumber(pair: &mut Pair<Self>);
    fn image(pair: &Pair<Self>) -> Vec<u8>;
    fn rests(pair: &Pair<Self>) -> bool;
    fn pauses(pair: &Pair<Self>) -> bool;
}

#[derive(Clone, Copy, Debug)]
pub struct Choice<Does> {
    pub does: Does,
    pub prompt: bool, // every order ends in this tick
    pub mishaps: u8,
    pub short: bool, // possible in a tick without a long time before
    pub long: bool,  // after a long time without other events
    pub quiet: bool, // only without a command or a mishap
}

impl<Does> Choice<Does> {
    pub const fn new(does: Does, prompt: bool) -> Self {
        Self { does, prompt, mishaps: 0, short: true, long: false, quiet: false }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Event<Does> {
    pub told: Option<usize>, // index of the arriving command
    pub does: Does,
    pub mishap: DeliveryFault,
    pub mishaps: u8,
    pub long: bool, // after a long time without other events
}

#[derive(Clone)]
pub struct Pair<S: Scene> {
    pub tick: Tick,
    pub lines: Arc<[S::Line]>,
    /// Commands that may still replace the last one; any number for `None`.
    pub early: Option<u8>,
    pub mishaps: u8,
    pub command: S::Command,
    pub upper: S::Upper,
    pub lower: S::Lower,
    pub scene: S,
}

impl<S: Scene<Upper: Default, Command: Default>> Pair<S> {
    /// `early` is the number of commands that may replace others.
    pub fn new(
        lines: impl Into<Arc<[S::Line]>>,
        (early, mishaps): (Option<u8>, u8),
        lower: S::Lower,
        scene: S,
    ) -> Self {
        Self {
            tick: Tick(10_000),
            lines: lines.into(),
            early,
            mishaps,
            command: S::Command::default(),
            upper: S::Upper::default(),
            lower,
            scene,
        }
    }
}

impl<S: Scene> Pair<S> {
    fn told(&self) -> impl Iterator<Item = Option<usize>> + use<S> {
        let (ended, early) = (S::has_ended(self), self.early != Some(0));
        let may = |line| (ended || (early && S::is_other(self, line))) && S::may(self, line);
        let told: Vec<_> = (0..self.lines.len()).filter(|nth| may(&self.lines[*nth])).collect();
        core::iter::once(None).chain(told.into_iter().map(Some))
    }
}

impl<S: Scene> World for Pair<S> {
    type Event = Event<S::Does>;

    fn events(&self) -> Vec<(Self::Event, bool)> {
        let (choices, mut events) = (S::choices(self), Vec::new());
        for mishap in DeliveryFault::choices(self.mishaps, S::DELIVERY_FAULTS) {
            for told in self.told() {
                for &Choice { does, prompt, mishaps, short, long, quiet: only_quiet } in &choices {
                    let mishaps = mishaps + u8::from(mishap != DeliveryFault::None);
                    if mishaps > self.mishaps || (mishaps > 0 && told.is_some() && !S::COMMANDS_IN_MISHAPS) {
                        continue;
                    }
                    let event = Event { told, does, mishap, mishaps, long: false };
                    let quiet = told.is_none() && mishaps == 0;
                    if short && (quiet || !only_quiet) {
                        events.push((event, quiet && prompt));
                    }
                    if quiet && long {
                        events.push((Event { long: true, ..event }, true));
                    }
                }
            }
        }
        events
    }

    fn step(&mut self, event: Self::Event) -> Result<(), Wrong> {
        if let Some(nth) = event.told {
            if !S::has_ended(self) {
                self.early = self.early.map(|early| early - 1);
            }
            S::command(self, nth);
        }
        self.mishaps -= event.mishaps;
        S::begin(self, &event);
        let before = self.clone();
        self.tick = if event.long { Tick(self.tick.0 + S::LONG) } else { self.tick.next() };
        let (mut upper, mut lower) = (self.upper.clone(), self.lower.clone());
        match event.mishap {
            DeliveryFault::RestartUpper => upper.restart(),
            DeliveryFault::RestartLower => lower.restart(),
            DeliveryFault::None | DeliveryFault::SilentLower | DeliveryFault::Slip => {}
        }
        let (memory, external) = S::inputs(self);
        let data = data();
        let inputs = Inputs { tick: self.tick, memory: &memory, external: &external, data: &data };
        upper.step(&inputs);
        if event.mishap != DeliveryFault::SilentLower {
            lower.step(&inputs);
        }
        S::act(self, &event, &memory)?;
        (self.upper, self.lower) = (upper, lower);
        S::note(self, &before);
        S::judge(self, &before, &event)?;
        S::renumber(self);
        S::judge_rest(self, &before, &event)
    }

    fn image(&self) -> Vec<u8> {
        S::image(self)
    }

    fn rests(&self) -> bool {
        S::rests(self)
    }

    fn pauses(&self) -> bool {
        S::pauses(self)
    }
}

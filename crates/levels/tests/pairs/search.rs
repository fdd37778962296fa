//! Breadth-first search over all states of a pair, with a set of visited ones; then the longest path from each
//! state to one in which the pair rests.

use std::{
    collections::{HashMap, VecDeque},
    fmt::Debug,
    hash::{DefaultHasher, Hasher as _},
};

use interfaces::process::Process;

pub type Wrong = &'static str;

/// Disturbance of a tick, in addition to failing orders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeliveryFault {
    None,
    RestartUpper, // the upper process restarts
    RestartLower,
    SilentLower, // the lower process is not stepped, and writes nothing
    /// The potentiometer of the rotary table reads differently than before.
    Slip,
}

impl DeliveryFault {
    pub const RESTARTS: &[Self] = &[Self::RestartUpper, Self::RestartLower];

    /// No disturbance, and each of `some` if any is left.
    pub fn choices(left: u8, some: &[Self]) -> Vec<Self> {
        let some = if left > 0 { some } else { &[] };
        [&[Self::None], some].concat()
    }
}

pub fn resumed<P: Process<Data> + Default, Data>(state: P::State, is_restarted: bool) -> P {
    let mut process = P::default();
    if !is_restarted {
        process.restore(state);
    }
    process
}

pub trait World: Clone {
    type Event: Copy + Debug;

    /// All possible events of the next tick, and whether each is *prompt*: no command, no loss, and every order
    /// ends in this tick or exceeds its time limit.
    fn events(&self) -> Vec<(Self::Event, bool)>;

    /// Step a tick. The error is the violated condition.
    fn step(&mut self, event: Self::Event) -> Result<(), Wrong>;

    /// All values that affect the future, as bytes.
    fn image(&self) -> Vec<u8>;

    fn rests(&self) -> bool;

    fn pauses(&self) -> bool;
}

/// The result, or the shortest path to a violated condition.
#[derive(Debug)]
pub struct Found<Event> {
    pub states: usize,
    pub ticks: u64,
    pub pause: u32, // prompt ticks until rest, if the last command is PAUSE
    pub any: u32,
    pub wrong: Option<(Vec<Event>, Wrong)>,
}

const NONE: u32 = u32::MAX;

struct Space<Event> {
    /// States by a fingerprint of 64 bits. Two of a million states share one with a chance of 1 in 37 million.
    known: HashMap<u64, u32>,
    from: Vec<(u32, Option<Event>)>,
    rests: Vec<bool>,
    pauses: Vec<bool>,
    ranges: Vec<(usize, usize)>, // prompt successors of each state: a range of `onward`
    onward: Vec<u32>,
    ticks: u64,
}

impl<Event: Copy> Space<Event> {
    fn number(&mut self, world: &impl World, from: (u32, Option<Event>)) -> (u32, bool) {
        let mut hasher = DefaultHasher::new();
        hasher.write(&world.image());
        let next = u32::try_from(self.from.len()).expect("too many states");
        let number = *self.known.entry(hasher.finish()).or_insert(next);
        if number == next {
            self.from.push(from);
            self.rests.push(world.rests());
            self.pauses.push(world.pauses());
            self.ranges.push((0, 0));
        }
        (number, number == next)
    }

    /// The ticks to a state, followed by `last`.
    fn way(&self, mut state: u32, last: Option<Event>) -> Vec<Event> {
        let mut way = Vec::from_iter(last);
        while state != NONE {
            let (before, event) = self.from[state as usize];
            way.extend(event);
            state = before;
        }
        way.reverse();
        way
    }

    /// The greatest number of prompt ticks until the pair rests, for each state. The error is a state on a cycle.
    fn longest(&self) -> Result<Vec<u32>, u32> {
        const OPEN: u32 = u32::MAX;
        const UNKNOWN: u32 = u32::MAX - 1;
        let mut most: Vec<u32> = self.rests.iter().map(|rests| if *rests { 0 } else { UNKNOWN }).collect();
        for first in 0..most.len() {
            // Depth first: a state, and the index of its next successor.
            let mut open = vec![(first, 0)];
            while let Some((state, nth)) = open.pop() {
                if nth == 0 {
                    if most[state] != UNKNOWN {
                        continue;
                    }
                    most[state] = OPEN;
                }
                let (from, to) = self.ranges[state];
                let Some(next) = self.onward[from..to].get(nth).map(|next| *next as usize) else {
                    let behind = self.onward[from..to].iter().map(|next| most[*next as usize]).max();
                    most[state] = behind.unwrap_or_default() + 1;
                    continue;
                };
                open.push((state, nth + 1));
                match most[next] {
                    OPEN => return Err(u32::try_from(next).unwrap_or(NONE)),
                    UNKNOWN => open.push((next, 0)),
                    _ => {}
                }
            }
        }
        Ok(most)
    }
}

/// Search states in order of distance, up to `most` of them.
pub fn search<W: World>(first: W, most: usize) -> Found<W::Event> {
    let mut space = Space {
        known: HashMap::new(),
        from: Vec::new(),
        rests: Vec::new(),
        pauses: Vec::new(),
        ranges: Vec::new(),
        onward: Vec::new(),
        ticks: 0,
    };
    let mut wrong = None;
    space.number(&first, (NONE, None));
    let mut open = VecDeque::from([(0_u32, first)]);
    'all: while let Some((number, world)) = open.pop_front() {
        if space.from.len() > most {
            wrong = Some((Vec::new(), "more states than expected"));
            break;
        }
        let from = space.onward.len();
        for (event, prompt) in world.events() {
            space.ticks += 1;
            let mut next = world.clone();
            if let Err(found) = next.step(event) {
                wrong = Some((space.way(number, Some(event)), found));
                break 'all;
            }
            let (to, new) = space.number(&next, (number, Some(event)));
            if prompt && !space.onward[from..].contains(&to) {
                space.onward.push(to);
            }
            if new {
                open.push_back((to, next));
            }
        }
        space.ranges[number as usize] = (from, space.onward.len());
    }
    let (mut pause, mut any) = (0, 0);
    if wrong.is_none() {
        match space.longest() {
            Ok(most) => {
                let of_pause = most.iter().zip(&space.pauses).filter(|(_, pauses)| **pauses);
                pause = of_pause.map(|(most, _)| *most).max().unwrap_or_default();
                any = most.into_iter().max().unwrap_or_default();
            }
            Err(state) => {
                wrong =
                    Some((space.way(state, None), "a cycle of prompt ticks in which the command never ends"));
            }
        }
    }
    Found { states: space.from.len(), ticks: space.ticks, pause, any, wrong }
}

//! Breadth-first search over all states, then the time from each state to its good end.

use std::collections::{HashMap, VecDeque};

use crate::model::{Event, Panel, QUIET, Setting, State, Wrong};

const NONE: u32 = u32::MAX;

type Onward = (u32, bool); // the next state without further faults; true for a good tick

#[derive(Debug)]
pub struct Found {
    pub states: usize,
    pub ticks: u64,
    /// Ticks to the next acknowledged command or reported stop: without the operator, and with one who answers at once.
    pub alone: u32,
    pub helped: u32,
    pub wrong: Option<(Vec<Event>, Wrong)>,
}

#[derive(Default)]
struct Space {
    known: HashMap<u64, u32>,
    from: Vec<(u32, Event)>,
    onward: Vec<[Onward; 2]>, // the next state of each state: without the operator, and with help
    ticks: u64,
}

impl Space {
    fn number(&mut self, state: &State, from: (u32, Event)) -> (u32, bool) {
        let next = u32::try_from(self.from.len()).unwrap();
        let number = *self.known.entry(state.image().fingerprint()).or_insert(next);
        if number == next {
            self.from.push(from);
            self.onward.push([(NONE, false); 2]);
        }
        (number, number == next)
    }

    fn way(&self, mut state: u32, last: Option<Event>) -> Vec<Event> {
        let mut way = Vec::from_iter(last);
        while let Some((before, event)) = self.from.get(state as usize).filter(|(before, _)| *before != NONE)
        {
            way.push(*event);
            state = *before;
        }
        way.reverse();
        way
    }

    fn longest(&self, which: usize) -> Result<u32, u32> {
        const OPEN: u32 = u32::MAX;
        let mut ticks = vec![0_u32; self.onward.len()];
        for first in 0..self.onward.len() {
            let mut way = Vec::new();
            let mut at = first;
            let mut known = loop {
                if ticks[at] == OPEN {
                    return Err(u32::try_from(first).unwrap());
                }
                if ticks[at] > 0 {
                    break ticks[at];
                }
                let (next, good) = self.onward[at][which];
                if good {
                    ticks[at] = 1;
                    break 1;
                }
                ticks[at] = OPEN;
                way.push(at);
                at = next as usize;
            };
            for state in way.into_iter().rev() {
                known += 1;
                ticks[state] = known;
            }
        }
        Ok(ticks.into_iter().max().unwrap_or_default())
    }
}

pub fn search(setting: &Setting) -> Found {
    let first = State::first(setting);
    let mut space = Space::default();
    space.number(&first, (NONE, QUIET));
    let mut open = VecDeque::from([(0_u32, first)]);
    let mut wrong = None;
    while let Some((number, state)) = open.pop_front() {
        let help = Event { panel: state.help(), ..QUIET };
        let searched = state.each_next(setting, |event, next| {
            space.ticks += 1;
            let (next, good) = match next {
                Err(found) => {
                    wrong = Some((space.way(number, Some(event)), found));
                    return Err(found);
                }
                Ok(next) => next,
            };
            let (to, new) = space.number(&next, (number, event));
            if event == QUIET {
                space.onward[number as usize][0] = (to, good);
            }
            if event == help {
                space.onward[number as usize][1] = (to, good && help.panel == Panel::Nothing);
            }
            if new {
                open.push_back((to, next));
            }
            Ok(())
        });
        if searched.is_err() {
            break;
        }
    }
    let (mut alone, mut helped) = (0, 0);
    if wrong.is_none() {
        let ends = [space.longest(0), space.longest(1)];
        let words = ["a stop is never reported", "the link never runs again"];
        for (end, words) in ends.iter().zip(words) {
            if let (Err(state), None) = (end, &wrong) {
                wrong = Some((space.way(*state, None), words));
            }
        }
        (alone, helped) = (ends[0].unwrap_or_default(), ends[1].unwrap_or_default());
    }
    Found { states: space.from.len(), ticks: space.ticks, alone, helped, wrong }
}

//! Searches the real [`depc::host::Host`] against the real [`depc::controller::Controller`], breadth first over all
//! states of both ends, line, panel and user that a bounded number of faults can reach.
//!
//! ```text
//!   user ── next point, restart, cancel ──► Host ── frame: as sent, lost, damaged, doubled, late ──► Controller ──► robot
//!                                            ▲                                                     panel │
//!                                            └── answer: as sent, lost, damaged, doubled, late, DTR ─────┘
//! ```
//!
//! In every state: no point is executed twice (without functions: the robot never moves backwards) or skipped, one
//! command is outstanding, and the host's state is true. From every state, without further faults, the next command is
//! acknowledged or a stop is reported within a bound; with an operator who answers at once it is acknowledged.
//! `DEPC_FAULTS=3` searches three faults, without Hold; `DEPC_ALL_BITS=1` damages every bit and byte.

#![expect(clippy::print_stdout, reason = "the figures of a search are printed")]

mod explore;
mod image;
mod model;

use explore::{Found, search};
use model::{Carried, Event, KINDS, Kind, Panel, QUIET, Setting, Wrong};

/// Most ticks until a report or an acknowledgement: a second of silence, and the ticks before it.
const BOUND: u32 = RESTART + 11;
const RESTART: u32 = depc::host::RESTART_TICKS as u32;

/// A serial line does not duplicate frames. A duplicated frame together with another fault can deceive this protocol.
const fn is_doubling(kind: Kind) -> bool {
    matches!(kind, Kind::CommandDoubled | Kind::AnswerDoubled)
}

fn number(name: &str) -> Option<u8> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name}: expected a number, found {text:?}")))
}

fn is_sound(setting: &Setting) -> Found {
    let found = search(setting);
    println!(
        "faults {}, functions {}: {} states, {} ticks; a good end after {} ticks at most, with an operator {}",
        setting.faults, setting.functions, found.states, found.ticks, found.alone, found.helped
    );
    assert!(found.wrong.is_none(), "{setting:?}: {:#?}", found.wrong);
    assert!(found.alone.max(found.helped) <= BOUND, "{setting:?}: {} and {}", found.alone, found.helped);
    found
}

/// Compares the size of the search with sizes.txt: a smaller search could hide an error by merging states.
fn is_stated(found: &Found) {
    let size = format!("| {} | {} |", found.states, found.ticks);
    let sizes = include_str!("sizes.txt").replace(',', "");
    assert!(sizes.contains(&size), "crates/depc/tests/both_ends/sizes.txt needs a row with `{size}`");
}

#[test]
fn one_fault_of_any_kind_is_detected_and_over_or_reported_in_time() {
    for functions in [false, true] {
        is_stated(&is_sound(&Setting { functions, faults: 1, kinds: KINDS.to_vec(), all_bits: true }));
    }
}

fn several_faults(functions: bool) {
    let faults = number("DEPC_FAULTS").unwrap_or(2);
    let mut kinds = KINDS.to_vec();
    kinds.retain(|kind| !is_doubling(*kind) && (faults <= 2 || *kind != Kind::Hold));
    let all_bits = number("DEPC_ALL_BITS").is_some_and(|value| value > 0);
    let found = is_sound(&Setting { functions, faults, kinds, all_bits });
    if faults == 2 && !all_bits {
        is_stated(&found);
    }
}

#[test]
fn two_faults_are_detected_with_positions() {
    several_faults(false);
}

#[test]
fn two_faults_are_detected_with_functions() {
    several_faults(true);
}

fn shortest(functions: bool, kinds: [Kind; 2]) -> Option<(Vec<Event>, Wrong)> {
    search(&Setting { functions, faults: 2, kinds: kinds.to_vec(), all_bits: false }).wrong
}

const START: Event = Event { panel: Panel::Start, ..QUIET };

/// An answer has no number: the host assigns it to the next command, which is lost.
#[test]
fn duplicated_answer_hides_a_lost_command() {
    let twice = Event { answer: Carried::Doubled(1), ..QUIET };
    let lost = Event { command: Carried::Lost, ..QUIET };
    let wrong = "a false answer is accepted";
    let found = shortest(true, [Kind::AnswerDoubled, Kind::CommandLost]);
    assert_eq!(found, Some((vec![START, twice, lost, QUIET], wrong)));
}

/// A command has no number either: the copy is executed if no other command arrives in between.
#[test]
fn duplicated_command_is_executed_twice_if_its_answer_is_lost() {
    let twice = Event { command: Carried::Doubled(1), answer: Carried::Lost, ..QUIET };
    let wrong = "a point is executed twice";
    let found = shortest(true, [Kind::CommandDoubled, Kind::AnswerLost]);
    assert_eq!(found, Some((vec![START, twice, QUIET], wrong)));
    // A repeated command to the present position does not move the robot.
    assert_eq!(shortest(false, [Kind::CommandDoubled, Kind::AnswerLost]), None);
}

/// Each pair of faults with a duplicated frame, for positions and for functions.
#[test]
fn only_these_faults_go_undetected_with_a_duplicated_frame() {
    use Kind::*;
    let with = |functions, doubling| {
        let deceives = |other: &Kind| shortest(functions, [doubling, *other]).is_some();
        KINDS.into_iter().filter(deceives).collect::<Vec<_>>()
    };
    let answer = [CommandLost, CommandDamaged, CommandDoubled, CommandLate, CtsLow, Hold, Interrupt];
    assert_eq!(with(false, AnswerDoubled), answer);
    assert_eq!(with(true, AnswerDoubled), answer);
    assert_eq!(with(false, CommandDoubled), [CommandLost, CommandLate, AnswerDoubled]);
    let command =
        [CommandLost, CommandLate, AnswerLost, AnswerDamaged, AnswerDoubled, AnswerLate, DtrLow, Restart];
    assert_eq!(with(true, CommandDoubled), command);
}

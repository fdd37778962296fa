//! The tables of a gripper change against a world in which no order has an effect (docs/design/recovery.md
//! "Exchange").

use interfaces::{emove::EmoveVerb, prim::JoystickGrip};
use rcs_core::handshake::Lower;

use crate::{
    emove::{
        motion::route::Ahead,
        tables::{
            Along, At, AtDrum, Bias, FingerMotion, Fingers, Held, Holster, Knowledge, Link, Lock, Mate,
            Opening, PlaceKnowledge, Reach, Readiness, Shut, Sight, Situation, Spread, Step, Tooling, Tries,
            of_command,
        },
    },
    execution::Work,
    halt::Commanding as _,
};

/// All that the two tables ask for.
fn situations() -> impl Iterator<Item = Situation> {
    let exchange = Mate::ALL.iter().flat_map(|&mate| {
        Lock::ALL.iter().flat_map(move |&lock| {
            Holster::ALL
                .iter()
                .flat_map(move |&holster| Along::ALL.iter().map(move |&along| (mate, lock, holster, along)))
        })
    });
    exchange.flat_map(|(mate, lock, holster, along)| {
        Held::ALL.iter().flat_map(move |&held| {
            Shut::ALL.iter().flat_map(move |&shut| {
                Readiness::ALL.iter().flat_map(move |&readiness| {
                    At::ALL.iter().map(move |&at| Situation {
                        work: Work::Over,
                        ahead: Ahead::Nothing,
                        opening: Opening::Set,
                        held,
                        fingers: Fingers::Empty,
                        spread: Spread::Narrow,
                        readiness,
                        mate,
                        lock,
                        holster,
                        along,
                        shut,
                        at,
                        drum: AtDrum::Off,
                        bias: Bias::Missing,
                        sight: Sight::Missing,
                        aim: Knowledge::Unknown,
                        reach: Reach::Inside,
                        tries: Tries::Left,
                        link: Link::Up,
                        prim: Lower::Done,
                        motion: FingerMotion::AtRest,
                        tooling: Tooling::Ready,
                        place: PlaceKnowledge::Known,
                        button: JoystickGrip::None,
                    })
                })
            })
        })
    })
}

/// The orders that a command gives from its first step until it ends, or until EFFECT ends it: the row that
/// ordered last orders again, and nothing has changed.
fn orders(verb: EmoveVerb, situation: &Situation) {
    let (mut step, mut last) = (Step::first(verb), None);
    let mut orders = Vec::new();
    loop {
        let choice = of_command(verb, step, situation);
        let row = Some((choice.table, choice.row));
        let futile = last == row;
        if futile || !choice.action.is_order() {
            return;
        }
        orders.push(choice.action);
        assert!(orders.len() < 12, "no end: {orders:?}");
        (step, last) = (choice.next, row);
    }
}

#[test]
fn a_gripper_change_ends_in_a_world_that_ignores_every_order() {
    for situation in situations() {
        orders(EmoveVerb::QcAttach, &situation);
        orders(EmoveVerb::QcDetach, &situation);
    }
}

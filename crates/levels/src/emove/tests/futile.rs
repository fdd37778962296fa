//! The tables of a gripper change against a world in which no order has an effect (docs/design/recovery.md
//! "Exchange").

use interfaces::prim::JoystickGrip;
use rcs_core::{handshake::Lower, table::Decision};

use crate::{
    emove::{
        motion::route::Ahead,
        tables::{
            Action, Along, At, AtDrum, Bias, FingerMotion, Fingers, Held, Holster, Knowledge, Link, Lock,
            Mate, Opening, PlaceKnowledge, Reach, Readiness, Shut, Sight, Situation, Spread, Tooling, Tries,
            qc_attach::{QcAttachStep, qc_attach},
            qc_detach::{QcDetachStep, qc_detach},
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

/// The orders that a table gives from its first step until it ends, or until EFFECT ends it: the row that
/// ordered last orders again, and nothing has changed.
fn orders<Step: Copy>(first: Step, decide: impl Fn(Step) -> Decision<Action, Step>) {
    let (mut step, mut last) = (first, None);
    let mut orders = Vec::new();
    loop {
        let decision = decide(step);
        let futile = last == Some(decision.row);
        if futile || !decision.action.is_order() {
            return;
        }
        orders.push(decision.action);
        assert!(orders.len() < 12, "no end: {orders:?}");
        (step, last) = (decision.next, Some(decision.row));
    }
}

#[test]
fn a_gripper_change_ends_in_a_world_that_ignores_every_order() {
    for situation in situations() {
        orders(QcAttachStep::Start, |step| qc_attach(step, &situation));
        orders(QcDetachStep::Start, |step| qc_detach(step, &situation));
    }
}

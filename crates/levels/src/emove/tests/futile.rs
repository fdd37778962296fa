//! The tables of a gripper exchange against a world in which no order has an effect (docs/design/recovery.md
//! "Exchange").

use interfaces::emove::EmoveVerb;

use crate::{
    emove::tables::{
        At, EmoveHolster, ExchangePosition, Held, Lock, Mate, Readiness, Shut, Situation, Step,
        exchange::ExchangeSituation,
        of_command,
        qc_attach::{QcAttachSituation, QcLiftSituation},
        qc_detach::{QcDetachSituation, QcLeaveSituation},
    },
    execution::Work,
    halt::Commanding as _,
};

fn pairs<A: Copy, B: Copy>(all: &[A], with: &'static [B]) -> Vec<(A, B)> {
    all.iter().flat_map(|&a| with.iter().map(move |&b| (a, b))).collect()
}

type Exchange = ((((Mate, Lock), EmoveHolster), ExchangePosition), At);

fn exchanges() -> Vec<Exchange> {
    pairs(&pairs(&pairs(&pairs(Mate::ALL, Lock::ALL), EmoveHolster::ALL), ExchangePosition::ALL), At::ALL)
}

fn attach() -> impl Iterator<Item = Situation> {
    pairs(&pairs(&exchanges(), Shut::ALL), Readiness::ALL).into_iter().map(
        |((((((mate, lock), holster), along), at), shut), readiness)| {
            Situation::QcAttach(
                ExchangeSituation { work: Work::Over, lock },
                QcLiftSituation { mate, at, holster, lock, along, shut, readiness },
                QcAttachSituation { mate, along, holster, lock },
            )
        },
    )
}

fn detach() -> impl Iterator<Item = Situation> {
    pairs(&exchanges(), Held::ALL).into_iter().map(|(((((mate, lock), holster), along), at), held)| {
        Situation::QcDetach(
            ExchangeSituation { work: Work::Over, lock },
            QcLeaveSituation { mate, holster, at, along, lock },
            QcDetachSituation { mate, lock, along, holster, held },
        )
    })
}

/// The orders of a command until it ends, or until EFFECT ends it.
fn orders(verb: EmoveVerb, situation: &Situation) {
    let (mut step, mut last) = (Step::first(verb), None);
    let mut orders = Vec::new();
    loop {
        let choice = of_command(step, situation);
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
fn exchange_ends_when_every_order_is_ignored() {
    for situation in attach() {
        orders(EmoveVerb::QcAttach, &situation);
    }
    for situation in detach() {
        orders(EmoveVerb::QcDetach, &situation);
    }
}

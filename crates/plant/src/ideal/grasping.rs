//! Parts in the fingers of robot and pedestal.

use geometry::frame::{Frame, Vector as Inches};
use rcs_core::tick::TICK_S;

use super::Ideal;
use crate::{
    convert::{to_frame, to_pose},
    description::Gripper,
    grasp::{self, Grasp},
    gripper::Air,
    hand::{HANDS, Hand, ROBOT_HANDS},
    jaws::Supply,
    room::Placed,
    solid::Solid,
    squeeze::{Squeeze, squeeze},
};

/// Greatest height from which a released part comes to rest on the body below it, in; the cell's jobs have 0.15.
const DROP: f64 = 0.5;

#[derive(Clone, Debug)]
pub(super) struct Fingers {
    pub(super) air: Air,
    pub(super) hold: Option<Hold>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    pub(super) part: usize,
    pub(super) at: Frame, // in
}

impl Fingers {
    pub(super) fn new(gripper: &Gripper) -> Self {
        Self { air: Air::new(gripper), hold: None }
    }

    pub(super) const fn of([parts, v, tool, pedestal]: &[Self; 4], hand: Hand) -> &Self {
        match hand {
            Hand::Parts => parts,
            Hand::V => v,
            Hand::Tool => tool,
            Hand::Pedestal => pedestal,
        }
    }
}

impl Ideal {
    pub(super) const fn fingers(&self, hand: Hand) -> &Fingers {
        Fingers::of(&self.fingers, hand)
    }

    pub(super) const fn fingers_mut(&mut self, hand: Hand) -> &mut Fingers {
        let [parts, v, tool, pedestal] = &mut self.fingers;
        match hand {
            Hand::Parts => parts,
            Hand::V => v,
            Hand::Tool => tool,
            Hand::Pedestal => pedestal,
        }
    }

    pub(super) fn is_held_by(&self, hand: Hand, part: usize) -> bool {
        self.fingers(hand).hold.is_some_and(|hold| hold.part == part)
    }

    pub(super) fn is_held(&self, part: usize) -> bool {
        ROBOT_HANDS.into_iter().any(|hand| self.is_held_by(hand, part))
    }

    fn is_fixed(&self, part: usize) -> bool {
        self.clamped == Some(part) || self.is_in_drum(part)
    }

    fn is_held_elsewhere(&self, hand: Hand, part: usize) -> bool {
        self.is_fixed(part) || hand.others().any(|other| self.is_held_by(other, part))
    }

    /// Move the held parts with their hands. Vise and drum are stronger than a hand, the robot than the pedestal; the
    /// weaker one loses the part when its fingers no longer reach it.
    pub(super) fn carry(&mut self) {
        for hand in ROBOT_HANDS.into_iter().chain([Hand::Pedestal]) {
            let (Some(hold), Some(frame)) = (self.fingers(hand).hold, self.frame(hand)) else { continue };
            let leads = !self.is_fixed(hold.part) && (hand != Hand::Pedestal || !self.is_held(hold.part));
            let Some(part) = self.parts.get_mut(hold.part) else { continue };
            if leads {
                part.frame = frame.compose(&hold.at);
            } else {
                let at = frame.inverse().compose(&part.frame);
                self.fingers_mut(hand).hold = Some(Hold { at, ..hold });
            }
        }
    }

    /// Move the fingers of a hand for a tick, and take or release the part between them.
    pub(super) fn drive(&mut self, hand: Hand, supply: Supply) {
        if supply == Supply::default() && self.fingers(hand).air.stands(&supply) {
            return;
        }
        let hold = self.fingers(hand).hold;
        let between = match hold {
            Some(hold) => self.between(hand, hold.part).map(|squeeze| (hold.part, squeeze)),
            None => self.first_between(hand),
        };
        let stop = between.map(|(part, squeeze)| {
            grasp::stop(&squeeze, hold.is_some() || self.is_held_elsewhere(hand, part))
        });
        let fingers = self.fingers_mut(hand);
        grasp::drive(&mut fingers.air, TICK_S, supply, stop, hold.is_some());
        match (grasp::decide(hold.is_some(), stop, &fingers.air), between) {
            (Grasp::Take, Some((part, squeeze))) => self.take(hand, part, &squeeze),
            (Grasp::Release, _) => self.release(hand),
            _ => {}
        }
    }

    fn between(&self, hand: Hand, part: usize) -> Option<Squeeze> {
        let (frame, part) = (self.frame(hand)?, self.parts.get(part)?);
        let pads = grasp::pads(hand.description(self.room.cell()));
        squeeze(&to_pose(&frame.inverse().compose(&part.frame)), &Solid::of(&part.kind), &pads)
    }

    fn first_between(&self, hand: Hand) -> Option<(usize, Squeeze)> {
        let tool = to_pose(&self.frame(hand)?).translation;
        let near = self.parts.iter().enumerate().filter(|(_, part)| {
            let away = (to_pose(&part.frame).translation - tool).length();
            grasp::is_near(away, Solid::of(&part.kind).half().length())
        });
        let between = near.filter_map(|(index, _)| Some((index, self.between(hand, index)?)));
        grasp::widest(self.fingers(hand).air.opening(), between)
    }

    fn take(&mut self, hand: Hand, part: usize, squeeze: &Squeeze) {
        let (Some(frame), Some(placed)) = (self.frame(hand), self.parts.get(part)) else { return };
        let at = match self.is_held_elsewhere(hand, part) {
            true => frame.inverse().compose(&placed.frame),
            false => to_frame(&grasp::drawn(squeeze)),
        };
        self.fingers_mut(hand).hold = Some(Hold { part, at });
        self.carry();
    }

    /// Release the part of a hand. If another hand also holds the part, the part moves to the middle of that hand.
    /// Otherwise it comes to rest.
    pub(super) fn release(&mut self, hand: Hand) {
        let Some(hold) = self.fingers_mut(hand).hold.take() else { return };
        self.recover(hold.part);
    }

    /// Called when a holder has released a part. If a hand holds the part, the part moves to the middle of that hand.
    /// Otherwise it comes to rest.
    pub(super) fn recover(&mut self, part: usize) {
        if self.is_fixed(part) {
            return;
        }
        let Some(hand) = HANDS.into_iter().find(|hand| self.is_held_by(*hand, part)) else {
            return self.put_on_support(part);
        };
        if !self.is_held_elsewhere(hand, part)
            && let Some(squeeze) = self.between(hand, part)
        {
            self.fingers_mut(hand).hold = Some(Hold { part, at: to_frame(&grasp::drawn(&squeeze)) });
            self.carry();
        }
    }

    fn put_on_support(&mut self, part: usize) {
        let Some(placed) = self.parts.get(part) else { return };
        let under = || self.room.let_down(&placed.kind, &placed.frame, &-Inches::z(), DROP);
        let rests = self.room.nest_seat(placed).or_else(under);
        if let (Some(frame), Some(placed)) = (rests, self.parts.get_mut(part)) {
            *placed = Placed { frame, ..placed.clone() };
        }
    }
}

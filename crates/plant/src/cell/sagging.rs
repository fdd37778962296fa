//! The arm without pressure: what weighs on it, what it comes to lie on, and what is said of it.
//!
//! A powered arm is led on its path whatever it meets; one that sags is not. What its rigid parts run into
//! pushes back with the stiffness of the arm, and so do the springs on which fingers and held part hang:
//! those know from the simulation what they touch. The depths that are reported are those by which the arm
//! leads its outline into things: with 2000 lb/in a tenth of an inch is two hundred pounds.

use geometry::frame::Vector as Inches;
use rapier3d_f64::{parry::query, prelude::*};
use serde::{Deserialize, Serialize};

use super::{Cell, CellEvent};
use crate::{
    arm::TOOL_CENTRE,
    clearance::{Body, Clearance, Contact},
    convert::{inches, metres, to_inches},
    description::{Kind, Permits},
    linkage::{Chain, END_PLATE, FOREARM, Load, UPPER_ARM},
    t3::Cut,
};

/// Coefficient of friction of the robot's outline on what it lies on (ASSUMED: steel and paint).
const FRICTION: f64 = 0.30;
/// What is nearer than this at the beginning of a tick may be touched in it, in.
const NEAR: f64 = 0.5;
/// Contacts that have grown by less are none, in.
const LEAST_DEPTH: f64 = 0.001;

/// What has become of the arm since it lost its pressure.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Droop {
    /// Why there is no pressure.
    pub cause: Cut,
    /// Where the tool point was when the pressure went, in.
    pub position: [f64; 3],
    /// What the robot has run into since, each with its greatest depth; the deepest first.
    pub touched: Vec<Contact>,
    /// The arm has sagged as far as it will.
    pub at_rest: bool,
    /// The shoulder lies on the shot pin.
    pub on_shot_pin: bool,
    /// What was touched when the pressure went.
    before: Vec<Contact>,
}

impl Droop {
    /// How it has ended so far, behind "the arm".
    #[must_use]
    pub fn end(&self) -> String {
        let pin = if self.on_shot_pin { ", its shoulder on the shot pin" } else { "" };
        let rest = if self.at_rest { "has come to rest" } else { "still sinks" };
        let touched = self
            .touched
            .iter()
            .map(|Contact { mover, obstacle, depth, .. }| format!("{mover} {depth:.3} in into {obstacle}"));
        match touched.collect::<Vec<_>>() {
            none if none.is_empty() => format!("{rest}{pin}, and has touched nothing"),
            touched => format!("{rest}{pin}, and has run into things: {}", touched.join(", ")),
        }
    }

    /// Take in what is touched now.
    fn note(&mut self, touching: Vec<Contact>) {
        let same = |a: &Contact, b: &Contact| (&a.mover, &a.obstacle) == (&b.mover, &b.obstacle);
        for contact in touching {
            let before = self.before.iter().find(|other| same(other, &contact)).map_or(0.0, |c| c.depth);
            if contact.depth < before + LEAST_DEPTH {
                continue;
            }
            match self.touched.iter_mut().find(|other| same(other, &contact)) {
                Some(known) => known.depth = known.depth.max(contact.depth),
                None => self.touched.push(contact),
            }
        }
        self.touched.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    }
}

impl Cell {
    /// What has become of the arm since it lost its pressure; `None` while it has it.
    #[must_use]
    pub fn droop(&self) -> Option<&Droop> {
        self.droop.as_ref()
    }

    /// The hydraulics fail: the pressure is gone at once, without a switch being pressed.
    pub fn fail_hydraulics(&mut self) {
        self.t3.lose_pressure();
        self.hear_t3();
    }

    /// The hydraulics are repaired; the pressure comes back by the keys of III.6.
    pub fn repair_hydraulics(&mut self) {
        self.t3.repair_hydraulics();
    }

    /// Begin or end the account of a droop.
    pub(super) fn watch_pressure(&mut self) {
        match (self.t3.cut(), &self.droop) {
            (None, Some(_)) => self.droop = None,
            (Some(cause), None) => {
                self.droop = Some(Droop {
                    cause,
                    position: self.t3.arm().tool().position.into(),
                    touched: Vec::new(),
                    at_rest: false,
                    on_shot_pin: false,
                    before: touching(&self.movers(), &self.all_obstacles()),
                });
            }
            _ => {}
        }
    }

    /// Once a tick: what the sagging arm has met, and whether it has come to rest.
    pub(super) fn watch_droop(&mut self) {
        let Some(mut droop) = self.droop.take() else { return };
        droop.note(touching(&self.movers(), &self.all_obstacles()));
        droop.on_shot_pin = self.t3.arm().on_shot_pin();
        if self.t3.arm().has_sagged() && !droop.at_rest {
            droop.at_rest = true;
            self.events.push(CellEvent::Sagged(droop.clone()));
        }
        self.droop = Some(droop);
    }

    /// Everything that the robot can run into, where it is now.
    fn all_obstacles(&self) -> Vec<Body> {
        let mut all = self.obstacles.clone();
        all.extend(self.devices());
        all
    }

    /// What an arm without pressure may come to lie on in the coming tick; nothing under pressure.
    pub(super) fn near_arm(&self) -> Vec<Body> {
        if self.t3.arm().has_pressure() {
            return Vec::new();
        }
        let mut all = self.all_obstacles();
        let bounds: Vec<Aabb> = self
            .movers()
            .iter()
            .filter(|mover| is_rigid(mover))
            .map(|mover| mover.aabb.loosened(metres(NEAR)))
            .collect();
        all.retain(|obstacle| bounds.iter().any(|bound| bound.intersects(&obstacle.aabb)));
        all
    }

    /// The forces on an arm without pressure; `near` is what it may lie on.
    pub(super) fn loads(&self, near: &[Body]) -> Vec<Load> {
        if self.t3.arm().has_pressure() {
            return Vec::new();
        }
        let mut loads: Vec<Load> = Vec::new();
        if let Some(hand) = self.changer.carried() {
            let chain = Chain::new(&self.joints());
            let weight = self.description.gripper.weight;
            loads.push(Load::weight(END_PLATE, chain.along(END_PLATE, TOOL_CENTRE), weight));
            // In the axes of the tool: what the springs of fingers and held part carry, its weight included.
            let wrench = self.hand(hand).load(&self.world);
            let tool = self.t3.arm().tool();
            loads.push(Load {
                link: END_PLATE,
                at: tool.position,
                force: tool.rotation * wrench.force,
                moment: tool.rotation * wrench.moment,
                stiffness: self.description.robot.stiffness,
                friction: 0.0,
            });
        }
        if !near.is_empty() {
            let movers = self.movers();
            let rigid = movers.iter().filter(|mover| is_rigid(mover));
            loads.extend(
                rigid.flat_map(|mover| near.iter().filter_map(|obstacle| self.push(mover, obstacle))),
            );
        }
        loads
    }

    /// What an obstacle does to a rigid part of the robot that it meets.
    fn push(&self, mover: &Body, obstacle: &Body) -> Option<Load> {
        let contact = meet(mover, obstacle)?;
        let stiffness = self.description.robot.stiffness;
        let normal = Inches::new(contact.normal1.x, contact.normal1.y, contact.normal1.z);
        Some(Load {
            link: match &*mover.name {
                "upper_arm" => UPPER_ARM,
                "forearm" => FOREARM,
                _ => END_PLATE,
            },
            at: to_inches(contact.point2),
            force: normal * (inches(-contact.dist) * stiffness),
            moment: Inches::zeros(),
            stiffness,
            friction: FRICTION,
        })
    }
}

/// Part of the robot's own outline: fingers and held parts give way on their springs.
fn is_rigid(mover: &Body) -> bool {
    matches!(mover.kind, Kind::Arm | Kind::Gripper)
}

/// How two things penetrate, if they do.
fn meet(mover: &Body, obstacle: &Body) -> Option<query::Contact> {
    if mover.is_joined_to(obstacle) || !obstacle.aabb.intersects(&mover.aabb) {
        return None;
    }
    let contact =
        query::contact(&obstacle.pose, &*obstacle.shape, &mover.pose, &*mover.shape, 0.0).ok()??;
    (contact.dist < 0.0).then_some(contact)
}

/// All pairs that touch, each once, with their depth.
fn touching(movers: &[Body], obstacles: &[Body]) -> Vec<Contact> {
    let mut clearance = Clearance::default();
    clearance.check(&Permits::default(), movers, obstacles.iter())
}

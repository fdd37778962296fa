//! The arm without pressure: its loads, its contacts, and their report.
//!
//! A sagging arm does not follow a path through contact. Obstacles push back its rigid parts with the stiffness of the
//! arm. At 2000 lb/in a depth of a tenth of an inch is two hundred pounds.

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

const FRICTION: f64 = 0.30;
/// Bodies within this distance at the beginning of a tick can be touched during it, in.
const NEAR: f64 = 0.5;
const LEAST_DEPTH: f64 = 0.001; // least growth of a contact that is recorded, in

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct SagReport {
    pub cause: Cut,
    pub position: [f64; 3], // position of the tool point when the pressure was lost, in
    /// Contacts since then, each with its greatest depth; the deepest first.
    pub touched: Vec<Contact>,
    pub at_rest: bool,
    pub on_shot_pin: bool,
    before: Vec<Contact>, // contacts when the pressure was lost
}

impl SagReport {
    /// Its state so far, as text to follow "the arm".
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
    #[must_use]
    pub fn droop(&self) -> Option<&SagReport> {
        self.droop.as_ref()
    }

    /// Fail the hydraulics: the pressure is lost at once, without a switch.
    pub fn fail_hydraulics(&mut self) {
        self.t3.lose_pressure();
        self.read_controller();
    }

    /// Repair the hydraulics; the keys of III.6 restore the pressure.
    pub fn repair_hydraulics(&mut self) {
        self.t3.repair_hydraulics();
    }

    pub(super) fn watch_pressure(&mut self) {
        match (self.t3.cut(), &self.droop) {
            (None, Some(_)) => self.droop = None,
            (Some(cause), None) => {
                self.droop = Some(SagReport {
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

    fn all_obstacles(&self) -> Vec<Body> {
        let mut all = self.obstacles.clone();
        all.extend(self.devices());
        all
    }

    /// Bodies that an arm without pressure may touch in the next tick; none under pressure.
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

    pub(super) fn loads(&self, near: &[Body]) -> Vec<Load> {
        if self.t3.arm().has_pressure() {
            return Vec::new();
        }
        let mut loads: Vec<Load> = Vec::new();
        if let Some(hand) = self.changer.carried() {
            let chain = Chain::new(&self.joints());
            let weight = self.description.gripper.weight;
            loads.push(Load::weight(END_PLATE, chain.along(END_PLATE, TOOL_CENTRE), weight));
            // The load on the springs of fingers and held part, including their weight, in the axes of the tool.
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

/// True if a body is rigidly attached to the robot: fingers and held parts are on springs.
fn is_rigid(mover: &Body) -> bool {
    matches!(mover.kind, Kind::Arm | Kind::Gripper)
}

fn meet(mover: &Body, obstacle: &Body) -> Option<query::Contact> {
    if mover.is_joined_to(obstacle) || !obstacle.aabb.intersects(&mover.aabb) {
        return None;
    }
    let contact =
        query::contact(&obstacle.pose, &*obstacle.shape, &mover.pose, &*mover.shape, 0.0).ok()??;
    (contact.dist < 0.0).then_some(contact)
}

fn touching(movers: &[Body], obstacles: &[Body]) -> Vec<Contact> {
    let mut clearance = Clearance::default();
    clearance.check(&Permits::default(), movers, obstacles.iter())
}

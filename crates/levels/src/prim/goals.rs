use geometry::frame::Frame;
use interfaces::{Unconfirmed, prim::PrimVerb};
use rcs_core::tick::TICK_S;

use super::{
    motion::segment::FrameData,
    state::{PrimGoal, State},
    tables::{Posture, PrimLink, PrimRest, Samples, Situation},
};
use crate::{
    confirm::{Evidence, Proof},
    goal::{AT_POINT, Goal, Sensor},
};

pub static REST: Goal = Goal {
    holds: "the robot is at rest, or the link is down",
    sensors: &[Sensor::Resolvers],
    tolerance: "no motion above 0.02 in, 0.1 degree per tick for 3 ticks",
    age: 0,
    unconfirmed: &[],
};
pub static POSITIONED: Goal = Goal {
    holds: "the link runs, and the robot controller has reported the robot's position",
    sensors: &[Sensor::Link],
    tolerance: "",
    age: 1,
    unconfirmed: &[],
};
pub static PASSING: Goal = Goal {
    holds: "the robot is within the break distance of the point and of its expected lag",
    sensors: &[Sensor::Resolvers],
    tolerance: "break distance, and the expected lag and 3 ticks at the velocity of the motion",
    age: 1,
    unconfirmed: &[Unconfirmed::Position],
};
/// Goal of GOTO-PT, DELTA-MOVE and GO-WHILE.
pub static POINT: Goal = Goal {
    holds: "the robot rests at the point",
    sensors: &[Sensor::Resolvers],
    tolerance: AT_POINT,
    age: 1,
    unconfirmed: &[Unconfirmed::Position],
};
pub static CONTACT: Goal = Goal {
    holds: "the condition holds, and the robot rests",
    sensors: &[Sensor::Guard, Sensor::Resolvers],
    tolerance: "the sensor's threshold; no motion above 0.02 in, 0.1 degree per tick for 3 ticks",
    age: 1,
    unconfirmed: &[],
};
pub static CALIBRATED: Goal = Goal {
    holds: "the robot rests, and the readings for the bias are complete",
    sensors: &[Sensor::Force, Sensor::Resolvers],
    tolerance: "no motion above 0.02 in, 0.1 degree per tick",
    age: 1,
    unconfirmed: &[],
};

/// Delay of a resolver reading by T3 Interface, the line and the reading itself, without the lag of the robot.
const HOPS_S: f64 = 3.0 * TICK_S;

impl State {
    /// `lag_ms` is the expected lag of the robot, ms.
    pub(super) fn proof(
        &self,
        verb: PrimVerb,
        situation: &Situation,
        resolvers: Option<&Frame>,
        lag_ms: u16,
    ) -> Proof {
        let rests = |rest: PrimRest| Proof::when(rest == PrimRest::Arrived, Evidence::Moving);
        match verb {
            PrimVerb::None | PrimVerb::Pause => {
                let still = matches!(situation.posture, Posture::Unpositioned | Posture::Standing);
                Proof::when(still, Evidence::Moving)
            }
            PrimVerb::RobotInit => Proof::when(situation.link == PrimLink::Running, Evidence::Elsewhere),
            PrimVerb::GotoPt | PrimVerb::DeltaMove | PrimVerb::GoWhile => match resolvers {
                None => Proof::unsensed(Unconfirmed::Position),
                Some(_) => Proof::when(situation.goal == PrimRest::Arrived, Evidence::Elsewhere),
            },
            PrimVerb::GoThru => {
                self.target.goal.as_ref().map_or(Proof::HOLDS, |goal| passes(goal, resolvers, lag_ms))
            }
            PrimVerb::GoUntil => rests(situation.rest),
            PrimVerb::CalSensor => rests(situation.rest)
                .and(Proof::when(situation.samples == Samples::Complete, Evidence::Moving)),
        }
    }
}

fn passes(goal: &PrimGoal, resolvers: Option<&Frame>, lag_ms: u16) -> Proof {
    let Some(present) = resolvers else { return Proof::unsensed(Unconfirmed::Position) };
    let PrimGoal { frame, limits, through } = goal;
    let within = through.unwrap_or_default() + limits.velocity * (f64::from(lag_ms) / 1000.0 + HOPS_S);
    let distance = FrameData::frame(frame).distance(present).path();
    Proof::when(distance <= within, Evidence::Elsewhere)
}

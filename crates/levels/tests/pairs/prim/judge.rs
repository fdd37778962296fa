use geometry::frame::Frame;
use interfaces::{
    emove::{EmoveVerb, Holding},
    prim::{PrimReport, PrimVerb},
};
use levels::{emove::motion::relative::Relative, execution::Outcome};

use super::{ASIDE, LATE, Pair};
use crate::{
    data::{data, place},
    emove::is_done,
    holster,
    robot::THERE,
    search::Wrong,
};

const STEP: f64 = 0.6; // in per tick, the greatest step of the commanded pose
const BRAKES: u32 = 12; // ticks from the condition until a guarded move is at rest
/// ACQUIRE-TOOL takes a tool within this distance of its place, in.
const DEEP: f64 = 0.3;

impl Pair {
    /// Record whether the condition is met, by the inputs of Prim in this tick.
    pub(super) fn watch(&mut self, before: &Self) {
        if !before.is_guarded() {
            return;
        }
        let executes = |it: &Self| it.prim.execution.outcome == Outcome::Executing;
        if self.prim.calibration.bias.is_none() {
            self.biased_at_safe = None;
        } else if self.prim.target.verb == PrimVerb::CalSensor
            && self.prim.execution.outcome == Outcome::Done
            && executes(before)
        {
            self.biased_at_safe = Some(self.is_at_safe());
        }
        let taken = self.prim.execution.receiver.echo != before.prim.execution.receiver.echo;
        if taken || (!executes(before) && !self.is_moving()) {
            (self.contact, self.stops) = (false, false);
        }
        let executes = executes(self) || executes(before);
        let met = before.tool.is_some_and(|tool| tool.is_pressed(&self.prim))
            || before.change.is_some_and(|change| change.is_met(&before.robot, &self.prim));
        let blind = before.tool.is_some_and(|tool| tool.is_blind(&self.prim));
        self.contact |= executes && met;
        self.stops |= self.contact || (executes && blind);
        self.brakes = if self.stops && self.is_moving() { self.brakes + 1 } else { 0 };
    }

    /// The commanded pose does not jump, and each command that is done has had its effect.
    pub(super) fn judge(&self, before: &Self) -> Result<(), Wrong> {
        if let (Some(now), Some(then)) = (&self.prim.motion, &before.prim.motion)
            && now.frame().distance(&then.frame()).inches > STEP
        {
            return Err("a jump is commanded");
        }
        if self.brakes > BRAKES {
            return Err(
                "the robot continues although the sensor of its guarded move reads stop, or is faulty",
            );
        }
        if self.prim.calibration.samples > before.prim.calibration.samples && before.is_moving() {
            return Err("the force sensor is calibrated while the robot moves");
        }
        self.judge_calibration(before)?;
        if matches!(before.aside, 1..=LATE) {
            return Ok(());
        }
        let order = &self.emove_out.prim;
        if let Some(change) = before.change.filter(|change| change.is_mated(&before.robot))
            && order.number != before.emove_out.prim.number
        {
            holster::judge_order(&self.command, order, change.ring())?;
        }
        let stands = before.stands();
        self.judge_prim(before, &stands)?;
        let status = &self.emove_out.status;
        let number = self.command.number;
        if !is_done(&self.emove_out, number) || is_done(&before.emove_out, number) {
            return Ok(());
        }
        match self.command.command {
            _ if before.is_moving() => Err("done, and the robot moves"),
            _ if before.awaits_arrival() => Err("done, and the fingers move, or the ring turns"),
            EmoveVerb::Pause => Ok(()),
            EmoveVerb::MovToLoc => {
                let goal = place(self.command.site.location.as_str()).frame;
                let there = goal.distance(&stands).inches <= THERE;
                let known = status.at.is_some_and(|at| at.site.location == self.command.site.location);
                match (there, known) {
                    (false, _) => Err("done, and the robot is not there"),
                    (true, false) => Err("done, and E-move does not know that the robot is there"),
                    (true, true) => Ok(()),
                }
            }
            _ => match before.change {
                Some(change) => {
                    let state = (change.is_mated(&before.robot), change.ring());
                    holster::judge_done(&self.command, &self.emove_out, &stands, state)
                }
                None => self.judge_tool(before, &stands),
            },
        }
    }

    fn is_at_safe(&self) -> bool {
        place("TOOL-SAFE").frame.distance(&self.stands()).inches <= ASIDE
    }

    /// INSERT-TOOL takes the bias of the force sensor at TOOL-SAFE only, and approaches the drum only with that
    /// bias. If the sensor has lost power since then, Prim moves nothing.
    fn judge_calibration(&self, before: &Self) -> Result<(), Wrong> {
        let order = &self.emove_out.prim;
        let is_new = order.number != before.emove_out.prim.number;
        if !is_new || self.command.command != EmoveVerb::InsertTool {
            return Ok(());
        }
        let safe = before.is_at_safe();
        let near = Relative::InsNear.record(&self.command.site, &data()).map(|near| near.sensor);
        match order.command {
            PrimVerb::CalSensor if !safe => Err("INSERT-TOOL calibrates at a place with possible contact"),
            PrimVerb::GoWhile if order.sensor == near && before.biased_at_safe == Some(false) => {
                Err("INSERT-TOOL nears the drum with a bias that was taken at the drum")
            }
            _ => Ok(()),
        }
    }

    fn judge_prim(&self, before: &Self, stands: &Frame) -> Result<(), Wrong> {
        let done = |it: &Self| {
            let status = &it.prim_out.status;
            status.echo == it.emove_out.prim.number && status.report == PrimReport::Done
        };
        if !done(self) || done(before) {
            return Ok(());
        }
        let goal = self.prim.target.goal.map(|goal| goal.frame.frame());
        let there = goal.is_some_and(|goal| goal.distance(stands).inches <= THERE);
        match self.prim.target.verb {
            PrimVerb::GotoPt | PrimVerb::GoWhile | PrimVerb::DeltaMove if !there => {
                Err("Prim is done, and the robot is not at its goal")
            }
            PrimVerb::GoWhile if self.contact => Err("GO-WHILE is done, and its condition was met"),
            PrimVerb::GoUntil if !self.contact => Err("GO-UNTIL is done, and its condition was not met"),
            PrimVerb::GoUntil | PrimVerb::CalSensor if before.is_moving() => {
                Err("Prim is done, and the robot moves")
            }
            _ => Ok(()),
        }
    }

    fn judge_tool(&self, before: &Self, stands: &Frame) -> Result<(), Wrong> {
        let base = place(super::DRUM).frame;
        let moved = |from: &Frame, relative: Relative| {
            let record = relative.record(&self.command.site, &data()).expect("the data have the move");
            data().moved(from, record.movetable)
        };
        let seat = moved(&base, Relative::InsIn);
        // Distance of the robot out of the drum, and length of the move out of it, in.
        let out = (moved(&seat, Relative::RemOut).position - seat.position).normalize();
        let is_out = (stands.position - seat.position).dot(&out);
        let leads = |relative| (moved(&seat, relative).position - seat.position).dot(&out);
        let (status, tool) = (&self.emove_out.status, before.tool.unwrap_or_else(super::Tool::new));
        let at_drum = status.at.is_some_and(|at| at.site.location == self.command.site.location);
        let holds = tool.holds() && status.held.object() == self.command.object;
        match self.command.command {
            EmoveVerb::InsertTool | EmoveVerb::AcquireTool if is_out > DEEP + THERE => {
                Err("done, and the tool is not in the drum")
            }
            EmoveVerb::InsertTool | EmoveVerb::AcquireTool if !at_drum => {
                Err("done, and E-move does not know that the tool is in the drum")
            }
            EmoveVerb::RemoveTool if is_out < leads(Relative::RemOut) - DEEP - THERE => {
                Err("done, and the tool is not out of the drum")
            }
            EmoveVerb::InsertTool | EmoveVerb::AcquireTool | EmoveVerb::RemoveTool if !holds => {
                Err("done, and the tool is not held")
            }
            EmoveVerb::ReleaseTool if !tool.is_open() || status.held != Holding::Nothing => {
                Err("done, and the tool is not released")
            }
            EmoveVerb::ReleaseTool if is_out < leads(Relative::RelBack) - DEEP - THERE => {
                Err("done, and the robot has not left the drum")
            }
            EmoveVerb::InsertTool
            | EmoveVerb::AcquireTool
            | EmoveVerb::RemoveTool
            | EmoveVerb::ReleaseTool => Ok(()),
            _ => Err("an unknown command is done"),
        }
    }
}

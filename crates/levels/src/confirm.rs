//! CONFIRM: a command ends when its goal holds now (docs/design/tables.md "Goals").
//!
//! ```text
//!   a row reports done ----> the sensors confirm the goal, or have no part in it ----> done
//!        ^        |
//!        |        '--> they contradict --> Awaited: wait for a newer reading
//!        '------------------------------------'  |
//!                                                '--> still contradicted: the command fails
//! ```
//!
//! Preprocess compares the goal of the command with the sensors in every tick; the result is a [`Proof`].

use interfaces::{
    Reason, Unconfirmed,
    emove::{Offset, Seat},
};
use rcs_core::{Actions, Plain, Variables, decision_table, table::Choice, table::Verdict};

use crate::{
    execution::{Ending, Execution},
    goal::Goal,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Evidence {
    /// The goal holds.
    Holds,
    /// No sensor contradicts the goal, and a part of it has no sensor.
    Unsensed,
    /// The robot is not at the goal.
    Elsewhere,
    /// The robot is still moving.
    Moving,
    /// The object is not held.
    NotHeld,
    /// The object is held in another grip.
    OtherGrip,
    /// An object is still held.
    StillHeld,
    /// An unidentified object is held.
    Unknown,
    /// The sensors do not show whether something is held.
    NotKnown,
    /// The object was not released at its destination.
    NotPlaced,
    /// The gripper of the command is not on the robot.
    GripperOff,
    /// A gripper is still on the robot.
    GripperOn,
    /// The id pins do not name the gripper that was on the robot when the ring was locked.
    PinsDiffer,
    /// The locking ring is not at its commanded position.
    Ring,
    /// The robot is still in a holster.
    InHolster,
    /// The fingers are not around the tool in the drum.
    OutsideDrum,
    /// The fingers are still in the drum.
    InsideDrum,
    /// The pedestal's hand still holds the object.
    InPedestal,
    /// The pedestal's hand does not hold the object.
    HandEmpty,
    /// The pedestal's hand is not open.
    HandNarrow,
    /// The rotary table is not at its angle.
    TableElsewhere,
    /// The Data System has not answered.
    NoAnswer,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Reading {
    /// The readings may be older than the end of the command.
    Awaited,
    /// The readings are newer than the end of the command.
    Newest,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Claim {
    /// The goal of the command, compared with the sensors.
    pub evidence: Evidence,
    /// The age of the readings.
    pub reading: Reading,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Confirming {
    /// Wait for a newer reading.
    Wait,
    /// Report an error.
    Fail(Reason),
}

decision_table! {
    /// CONFIRM: a command is done only if the sensors confirm its goal in this tick. If the readings are older than
    /// the end of the command, the command waits for newer ones; then it fails.
    pub CONFIRM: fn confirm(Claim) -> Confirming or () {
        1:  evidence: Holds | Unsensed     => consult;
        2:  reading: Awaited               => Wait;
        3:  evidence: Elsewhere | Moving   => Fail(NotAtGoal);
        4:  evidence: NotHeld | NotPlaced  => Fail(ObjectLost);
        5:  evidence: OtherGrip            => Fail(RegripNeeded);
        6:  evidence: StillHeld            => Fail(ReleaseNotEnded);
        7:  evidence: Unknown              => Fail(UnknownHeld);
        8:  evidence: NotKnown             => Fail(HeldNotKnown);
        9:  evidence: GripperOff           => Fail(NotAttached);
        10: evidence: GripperOn            => Fail(NotDetached);
        11: evidence: Ring                 => Fail(RingNotLocked);
        12: evidence: InHolster            => Fail(InHolster);
        13: evidence: OutsideDrum          => Fail(NotPrepared);
        14: evidence: InsideDrum           => Fail(InDrum);
        15: evidence: InPedestal           => Fail(PartInPedestal);
        16: evidence: HandEmpty            => Fail(HandMissed);
        17: evidence: HandNarrow           => Fail(HandTimeout);
        18: evidence: TableElsewhere       => Fail(TableStuck);
        19: evidence: NoAnswer             => Fail(DataBaseSilent);
        20: evidence: PinsDiffer           => Fail(PinsFail);
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proof {
    pub evidence: Evidence,
    pub unconfirmed: Unconfirmed,
}

impl Proof {
    pub const HOLDS: Self = Self::of(Evidence::Holds);

    #[must_use]
    pub const fn of(evidence: Evidence) -> Self {
        Self { evidence, unconfirmed: Unconfirmed::None }
    }

    #[must_use]
    pub const fn unsensed(unconfirmed: Unconfirmed) -> Self {
        match unconfirmed {
            Unconfirmed::None => Self::HOLDS,
            Unconfirmed::GraspForce
            | Unconfirmed::ToolInDrum
            | Unconfirmed::Position
            | Unconfirmed::PartInFingers => Self { evidence: Evidence::Unsensed, unconfirmed },
        }
    }

    #[must_use]
    pub const fn when(holds: bool, otherwise: Evidence) -> Self {
        if holds { Self::HOLDS } else { Self::of(otherwise) }
    }

    #[must_use]
    pub const fn at(offset: Offset) -> Self {
        match offset {
            Offset::None | Offset::Slight => Self::HOLDS,
            Offset::Off => Self::of(Evidence::Elsewhere),
            Offset::NotSensed => Self::unsensed(Unconfirmed::Position),
        }
    }

    /// Both goals: the first contradiction, else the first part without a sensor.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        match (self.evidence, other.evidence) {
            (Evidence::Holds, _) | (Evidence::Unsensed, _) if !other.is_done() => other,
            (Evidence::Holds, _) => other,
            _ => self,
        }
    }

    /// The goal with another part without a sensor, which is named first.
    #[must_use]
    pub const fn and_unsensed(self, unconfirmed: Unconfirmed) -> Self {
        if self.is_done() { Self::unsensed(unconfirmed) } else { self }
    }

    /// The goal with a part in the fingers. A part with an unknown seat is named first.
    #[must_use]
    pub const fn with_part(self, seat: Seat) -> Self {
        match seat {
            Seat::Kept => self,
            Seat::NotKnown => self.and_unsensed(Unconfirmed::PartInFingers),
        }
    }

    #[must_use]
    pub const fn is_done(self) -> bool {
        matches!(self.evidence, Evidence::Holds | Evidence::Unsensed)
    }
}

impl Execution {
    /// Consult [`CONFIRM`], the table with this number, about a row that reports done. Returns that row or the row
    /// of CONFIRM. A process that waits stays in its step.
    pub fn confirm<Action: Ending, Step>(
        &mut self,
        number: u8,
        step: Step,
        choice: Choice<Action, Step>,
        (goal, proof): (&Goal, Proof),
    ) -> Choice<Action, Step> {
        if !choice.action.ends() {
            self.claimed = 0;
            return choice;
        }
        let reading = if self.claimed < goal.age { Reading::Awaited } else { Reading::Newest };
        match confirm((), &Claim { evidence: proof.evidence, reading }) {
            Verdict::Passed(()) => {
                (self.claimed, self.unconfirmed) = (0, proof.unconfirmed);
                choice
            }
            Verdict::Decided(decision) => {
                self.claimed = self.claimed.saturating_add(1);
                let (action, next) = match decision.action {
                    Confirming::Wait => (Action::WAIT, step),
                    Confirming::Fail(reason) => (Action::fail(reason), choice.next),
                };
                Choice { table: number, row: decision.row, action, next, values: decision.values }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        execution::{Course, Outcome},
        goal::{Goals, Sensor},
        ladder::Ladder,
        processes::{Emove, Prim, Subtask, Task},
        task::plan::TaskVerb,
    };
    use interfaces::{emove::EmoveVerb, prim::PrimVerb, subtask::SubtaskVerb};
    use rcs_core::{handshake::Arrival, table::Values};

    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Act {
        Wait,
        Order,
        Finish,
        Fail(Reason),
    }

    impl Ending for Act {
        const WAIT: Self = Self::Wait;

        fn fail(reason: Reason) -> Self {
            Self::Fail(reason)
        }

        fn ends(&self) -> bool {
            *self == Self::Finish
        }
    }

    static GOAL: Goal =
        Goal { holds: "it holds", sensors: &[Sensor::Resolvers], tolerance: "", age: 2, unconfirmed: &[] };

    fn ask(execution: &mut Execution, action: Act, proof: Proof) -> (u8, u8, Act, u8) {
        let row = Choice { table: 3, row: 5, action, next: 8_u8, values: Values::default() };
        let choice = execution.confirm(9, 7_u8, row, (&GOAL, proof));
        (choice.table, choice.row, choice.action, choice.next)
    }

    #[test]
    fn confirmed_command_is_done_at_once() {
        let mut execution = Execution::default();
        assert_eq!(ask(&mut execution, Act::Finish, Proof::HOLDS), (3, 5, Act::Finish, 8));
        assert_eq!(execution.unconfirmed, Unconfirmed::None);
        let proof = Proof::unsensed(Unconfirmed::GraspForce);
        assert_eq!(ask(&mut execution, Act::Finish, proof), (3, 5, Act::Finish, 8));
        execution.finish();
        assert_eq!(
            (execution.outcome, execution.report(None).unconfirmed),
            (Outcome::Done, Unconfirmed::GraspForce)
        );
        execution.execute(Arrival::New);
        assert_eq!(
            execution.report(None).unconfirmed,
            Unconfirmed::None,
            "the next command has its own goal"
        );
    }

    #[test]
    fn contradicted_command_waits_for_a_newer_reading_and_then_fails() {
        for (evidence, row, reason) in [
            (Evidence::Elsewhere, 3, Reason::NotAtGoal),
            (Evidence::Moving, 3, Reason::NotAtGoal),
            (Evidence::NotHeld, 4, Reason::ObjectLost),
            (Evidence::OtherGrip, 5, Reason::RegripNeeded),
            (Evidence::StillHeld, 6, Reason::ReleaseNotEnded),
            (Evidence::Unknown, 7, Reason::UnknownHeld),
            (Evidence::NotKnown, 8, Reason::HeldNotKnown),
            (Evidence::NotPlaced, 4, Reason::ObjectLost),
            (Evidence::GripperOff, 9, Reason::NotAttached),
            (Evidence::GripperOn, 10, Reason::NotDetached),
            (Evidence::Ring, 11, Reason::RingNotLocked),
            (Evidence::InHolster, 12, Reason::InHolster),
            (Evidence::OutsideDrum, 13, Reason::NotPrepared),
            (Evidence::InsideDrum, 14, Reason::InDrum),
            (Evidence::InPedestal, 15, Reason::PartInPedestal),
            (Evidence::HandEmpty, 16, Reason::HandMissed),
            (Evidence::HandNarrow, 17, Reason::HandTimeout),
            (Evidence::TableElsewhere, 18, Reason::TableStuck),
            (Evidence::NoAnswer, 19, Reason::DataBaseSilent),
            (Evidence::PinsDiffer, 20, Reason::PinsFail),
        ] {
            let mut execution = Execution::default();
            assert_eq!(execution.execute(Arrival::New), Course::Begin);
            let mut tick = |action| ask(&mut execution, action, Proof::of(evidence));
            assert_eq!(tick(Act::Order), (3, 5, Act::Order, 8), "no claim yet");
            assert_eq!(tick(Act::Finish), (9, 2, Act::Wait, 7), "{evidence:?}");
            assert_eq!(tick(Act::Finish), (9, 2, Act::Wait, 7));
            assert_eq!(tick(Act::Finish), (9, row, Act::Fail(reason), 8));
        }
    }

    #[test]
    fn goal_that_holds_in_time_ends_the_wait() {
        let mut execution = Execution::default();
        assert_eq!(ask(&mut execution, Act::Finish, Proof::of(Evidence::Elsewhere)).2, Act::Wait);
        assert_eq!(ask(&mut execution, Act::Finish, Proof::HOLDS).2, Act::Finish);
        assert_eq!(execution.claimed, 0);
    }

    #[test]
    fn first_contradiction_counts_before_parts_without_a_sensor() {
        let force = Proof::unsensed(Unconfirmed::GraspForce);
        let elsewhere = Proof::of(Evidence::Elsewhere);
        assert_eq!(force.and(elsewhere), elsewhere);
        assert_eq!(elsewhere.and(Proof::of(Evidence::NotHeld)), elsewhere);
        assert_eq!(Proof::HOLDS.and(force), force);
        assert_eq!(force.and(Proof::unsensed(Unconfirmed::Position)), force);
        assert_eq!(force.and_unsensed(Unconfirmed::ToolInDrum), Proof::unsensed(Unconfirmed::ToolInDrum));
        assert_eq!(elsewhere.and_unsensed(Unconfirmed::ToolInDrum), elsewhere);
    }

    #[test]
    fn every_goal_names_its_sensor_and_an_age_within_the_ladder() {
        for process in Ladder::processes() {
            assert!(!process.goals.is_empty(), "{}", process.name);
            for declared in process.goals {
                let goal = declared.goal;
                assert!(!goal.holds.is_empty() && !goal.sensors.is_empty(), "{}", process.name);
                assert!(
                    goal.age <= 4,
                    "{} {}: Task is 4 ticks from the resolvers",
                    process.name,
                    declared.command
                );
            }
        }
    }

    #[test]
    fn rows_that_end_a_command_of_a_process_with_sensors_ask_for_a_reading() {
        let ends = ["Finish", "Report", "CalibrateAndFinish"];
        let readings =
            ["ring", "stop", "size", "opening", "grasp", "readings", "place", "line", "gripper", "motion"];
        for (name, least) in
            [("Quick Change", 2), ("V-Grip", 4), ("Grip", 3), ("Rotary Table", 1), ("T3 Interface", 3)]
        {
            let process = Ladder::processes().iter().find(|process| process.name == name).unwrap();
            let mut rows = 0;
            // PAUSE sends no commands, so its goal is the process's own state.
            for table in process.tables.iter().filter(|table| !table.name.ends_with("PAUSE")) {
                for row in table.rows {
                    let finished = name == "T3 Interface" && row.argument == Some("Finished");
                    if ends.contains(&row.action) || finished {
                        let asks = row.when.iter().any(|asked| readings.contains(&asked.variable));
                        assert!(asks, "{name}, {} {row}", table.name);
                        rows += 1;
                    }
                }
            }
            assert!(rows >= least, "{name}: {rows} rows");
        }
    }

    #[test]
    fn every_process_with_statuses_below_consults_confirm() {
        for (name, tables) in Ladder::processes().iter().map(|process| (process.name, process.tables)) {
            let confirms = tables.iter().any(|table| table.name == CONFIRM.name);
            let commands = matches!(name, "Task" | "Subtask" | "E-move" | "Prim" | "Active Pedestal");
            assert_eq!(confirms, commands, "{name}");
        }
        let counts = [Task::GOALS.len(), Subtask::GOALS.len(), Emove::GOALS.len(), Prim::GOALS.len()];
        let verbs = [TaskVerb::ALL.len(), SubtaskVerb::ALL.len(), EmoveVerb::ALL.len(), PrimVerb::ALL.len()];
        assert_eq!(counts, verbs);
    }
}

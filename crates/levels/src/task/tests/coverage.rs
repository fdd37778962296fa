use interfaces::Reason;
use rcs_core::{handshake::Lower, table::Verdict};
use taskdata::files::TaskData;

use super::{confirmed, data_system, recovery};
use crate::{
    coverage::silent,
    execution::{Asked, Outcome},
    task::{
        Task,
        plan::{TaskGripper, TaskVerb},
        tables::{
            Action, Request, TABLES, Takeover, TaskOperator,
            accept::accept,
            joystick::{Control, joystick},
        },
    },
};

/// Tables about updates of the database. No header names their rows.
const UPDATES: [&str; 8] =
    ["UPDATE-DUE", "FOLLOW", "TAKE", "RELEASED", "PICK-UP", "CARRY", "QUEUE", "UPDATE"];

#[test]
fn every_row_of_every_table_fires() {
    let scenarios =
        [super::SCENARIOS, confirmed::SCENARIOS, data_system::SCENARIOS, recovery::SCENARIOS].concat();
    // The task data have the gripper numbers 1 to 3 only. The look-up of a location needs no grip. No process is
    // above Task.
    let mut missing = silent::<Task, TaskData<'_>>(&scenarios);
    missing.retain(|row| !UPDATES.iter().any(|table| row.starts_with(&format!("{table} "))));
    assert_eq!(missing, ["ACCEPT 4", "ACCEPT 9", "HALT 4"]);
}

/// No order is repeated, so Task needs no EFFECT. A repeated update always ends: the Data System accepts it, refuses it
/// or is silent.
#[test]
fn every_order_of_task_leads_to_a_later_step() {
    let others =
        [&["EXECUTE", "ACCEPT", "PRECONDITION", "HALT", "JOYSTICK", "ORDERED", "CONFIRM"][..], &UPDATES]
            .concat();
    let no_orders = ["Wait", "Finish", "Fail", "PassUp", "Connect", "SendPending"];
    let mut orders = 0;
    for table in TABLES.iter().filter(|table| !others.contains(&table.name)) {
        let steps = table.steps.expect("a command has steps").variants;
        let place = |step: &str| steps.iter().position(|variant| variant.name == step).unwrap();
        for row in table.rows.iter().filter(|row| !no_orders.contains(&row.action)) {
            let next = place(row.next.unwrap_or_else(|| panic!("{} {row}: no next step", table.name)));
            assert!(!row.steps.is_empty(), "{} {row}: in any step", table.name);
            assert!(row.steps.iter().all(|step| place(step) < next), "{} {row}", table.name);
            orders += 1;
        }
    }
    assert!(orders > 40, "{orders}");
}

#[test]
fn joystick_table_passes_while_control_is_automatic() {
    for subtask in [Lower::Pending, Lower::Executing, Lower::Done, Lower::Error, Lower::Lost] {
        for &outcome in Outcome::ALL {
            let verdict = joystick(Control::Automatic, &TaskOperator { subtask, outcome });
            assert_eq!(verdict, Verdict::Passed(Takeover::None));
        }
    }
}

#[test]
fn command_with_an_invalid_gripper_number_is_refused() {
    let request = Request {
        asked: Asked::Now,
        verb: TaskVerb::Move,
        gripper: TaskGripper::Invalid,
        ..Request::default()
    };
    let Verdict::Decided(decision) = accept((), &request) else { panic!() };
    assert_eq!((decision.row, decision.action), (4, Action::Fail(Reason::WrongGripper)));
}

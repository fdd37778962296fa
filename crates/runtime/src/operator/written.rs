//! `<=` (IV.2.6): a value for a [`Variable`] of a stopped process, checked against task data and sensors first.

use geometry::units::inches;
use interfaces::{
    CommonMemory, ProcessId,
    grip::Felt,
    operator::{Form, Variable, Write, may_be_written},
};
use levels::emove::gripper::EmoveGripper;
use rcs_core::name::Name16;
use taskdata::files::TaskData;

const NONE: &str = "NONE"; // the value of an empty variable
const GRIPS: std::ops::RangeInclusive<i32> = -99..=99; // grip numbers of the forms (VII.7.1)

/// Read `VARIABLE VALUE`, the words after `write`. Errors: a message with the expected and the found text.
pub fn read(words: &[&str]) -> Result<Write, String> {
    let Some((name, value)) = words.split_first() else {
        return Err(format!("write VARIABLE VALUE was expected, such as write {} {NONE}", Variable::Ledger));
    };
    let variable = Variable::from_text(name).ok_or_else(|| {
        let known: Vec<&str> = Variable::ALL.iter().map(|variable| variable.text()).collect();
        format!("one of {} was expected; found {name}", known.join(", "))
    })?;
    let nothing = Write { variable, object: None, grip: 0 };
    let object = |name: &str| Name16::new(name).ok();
    let grip = |number: &str| number.parse().ok().filter(|number| GRIPS.contains(number));
    let written = match (variable.form(), value) {
        (_, [NONE]) => Some(nothing),
        (Form::Object, [name]) => object(name).map(|name| Write { object: Some(name), ..nothing }),
        (Form::ObjectGrip, [name, number]) => {
            object(name).zip(grip(number)).map(|(name, grip)| Write { variable, object: Some(name), grip })
        }
        _ => None,
    };
    written.ok_or_else(|| {
        format!("write {variable} {} was expected; found {}", variable.form(), value.join(" "))
    })
}

/// Checks a write. Returns the old and the new value, for operator and log. Errors: reason and remedy.
pub fn check(write: &Write, memory: &CommonMemory, data: &TaskData<'_>) -> Result<String, String> {
    stands(write.variable.owner(), memory)?;
    check_value(write, memory, data)
}

/// [`check`] for a process that is stopped only afterwards.
pub fn check_value(write: &Write, memory: &CommonMemory, data: &TaskData<'_>) -> Result<String, String> {
    if let Some(object) = &write.object {
        is_in_data(write, object, data)?;
        check_presence(write.variable, memory)?;
        if write.variable == Variable::Held {
            check_grip_size(object, write.grip, memory, data)?;
        }
    }
    Ok(format!("{} was {}, is {}", write.variable, old_value(write.variable, memory), new_value(write)))
}

/// Checks that the process is stopped: only then can its variables be changed. Errors: the request that stops it.
pub fn stands(process: ProcessId, memory: &CommonMemory) -> Result<(), String> {
    if may_be_written(process, memory) {
        Ok(())
    } else {
        Err(format!("{process} runs: {} stops it, then it can be changed", stop_of(process)))
    }
}

fn stop_of(process: ProcessId) -> String {
    let board = format!("`board {} stop`", process.board());
    match process {
        ProcessId::Task | ProcessId::Subtask | ProcessId::Emove => {
            format!("{board} or `joystick hold {}`", process.field().to_uppercase())
        }
        _ => board,
    }
}

fn is_in_data(write: &Write, object: &Name16, data: &TaskData<'_>) -> Result<(), String> {
    let id = data.object_named(object).ok_or_else(|| {
        format!("no object form (-obj-, VII.7.1) has {object}; see the blocks of the objects")
    })?;
    if write.variable.form() == Form::ObjectGrip && data.object(object, write.grip).is_none() {
        let grips = data.end_effs.iter().filter(|grip| grip.object == id);
        let grips: Vec<String> = grips.map(|grip| format!("{:+}", grip.grip)).collect();
        return Err(format!("a grip of {object} was expected: {}; found {:+}", grips.join(", "), write.grip));
    }
    Ok(())
}

/// Check that the sensors detect an object, which is required for a name.
fn check_presence(variable: Variable, memory: &CommonMemory) -> Result<(), String> {
    let (hand, felt, process) = match variable {
        Variable::Regrip => {
            let status = &memory.pedestal.status;
            ("the pedestal's hand", if status.gripped { status.felt } else { Felt::Nothing }, ProcessId::Hand)
        }
        _ => ("the gripper", EmoveGripper::attached(memory).felt(memory), ProcessId::Grip),
    };
    let board = process.board();
    match felt {
        Felt::Something => Ok(()),
        Felt::Nothing => {
            Err(format!("{hand} holds nothing by its sensors; only an object that they sense can be named"))
        }
        Felt::NotKnown => Err(format!(
            "the sensors of {hand} show no grasp yet: run its process (board {board}), calibrated, fingers at rest"
        )),
    }
}

/// Check that the opening of the fingers is that of a grip of the object.
fn check_grip_size(
    object: &Name16,
    grip: i32,
    memory: &CommonMemory,
    data: &TaskData<'_>,
) -> Result<(), String> {
    let gripper = EmoveGripper::attached(memory);
    let size = data.object(object, grip).map_or(0, |(_, sizes)| sizes.grasp_size);
    match gripper.opening(memory) {
        Some(opening) if gripper.grips(opening, size) => Ok(()),
        opening => Err(format!(
            "fingers that hold {object} {grip} were expected (grasp size {:.2} in); they are at {:.2} in",
            inches(size),
            inches(opening.unwrap_or_default())
        )),
    }
}

fn new_value(write: &Write) -> String {
    match (write.object, write.variable.form()) {
        (None, _) => NONE.to_owned(),
        (Some(object), Form::ObjectGrip) => format!("{object} {}", write.grip),
        (Some(object), _) => object.to_string(),
    }
}

fn old_value(variable: Variable, memory: &CommonMemory) -> String {
    let (task, estimates) = (&memory.task, &memory.emove.estimates);
    let value = match variable {
        Variable::Ledger => task.ledger.map(|ledger| ledger.command.to_string()),
        Variable::Pending => {
            let pending = task.updates.pending.iter().flatten();
            let pending: Vec<String> =
                pending.map(|update| format!("{} at {}", update.item, update.position)).collect();
            (!pending.is_empty()).then(|| pending.join(", "))
        }
        Variable::Regrip => memory.subtask.regrip.map(|regrip| regrip.object.to_string()),
        Variable::Held => estimates.held.map(|held| format!("{} {}", held.object.object, held.object.grip)),
        Variable::Placed => estimates
            .placed
            .map(|placed| format!("{} {} at {}", placed.object, placed.grip, placed.site.location)),
        Variable::Located => estimates.located.map(|located| located.object.to_string()),
        Variable::Calibration => memory.grip.calibration.map(|_| "known".to_owned()),
    };
    value.unwrap_or_else(|| NONE.to_owned())
}

//! The obstacles to the robot's motion, as text for the status and for the answers to `job go` and `job skip`.

use interfaces::{
    CommonMemory, OperatorInputs, StatusReport, device::JoystickBox, emove::Holding, hws::HwsReport,
    operator::BOARDS, prim::PrimReport,
};
use neighbours::workstation::player::Workstation as _;
use plant::EStop;

use super::RequestContext;
use closed_loop::workstation::SimulatedWorkstation;

/// Requests that start up the robot after an emergency.
const START_UP: &str = "`panel fault-reset`, then start the robot up at its panel (IV.3.3)";

/// The emergency that removed the robot's pressure, and the remedy, if there is one.
pub fn emergency(workstation: &SimulatedWorkstation) -> Option<String> {
    let pressed: Vec<EStop> =
        EStop::ALL.iter().copied().filter(|site| workstation.cell.t3().is_pressed(*site)).collect();
    if pressed.is_empty() {
        return workstation.emergency().map(|why| format!("EMERGENCY: {why}: {START_UP}"));
    }
    let sites: Vec<String> = pressed.iter().map(|site| format!("the E-stop {}", site.place())).collect();
    let releases: Vec<String> = pressed.iter().map(|site| format!("`release {site}`")).collect();
    let is_are = if pressed.len() == 1 { "is" } else { "are" };
    Some(format!("EMERGENCY: {} {is_are} pressed: {}, {START_UP}", sites.join(" and "), releases.join(", ")))
}

/// Refuses to continue under an emergency, unless the job resets it. Errors: the emergency and its remedy.
pub fn check_job(around: &mut RequestContext<'_>) -> Result<(), String> {
    match emergency(around.workstation) {
        Some(why) if !around.neighbours.job_under_way()?.resets_emergency() => {
            Err(format!("nothing moves: {why}; then `job go`"))
        }
        _ => Ok(()),
    }
}

/// Why a command is refused soon after a motion by hand.
pub const STILL_SETTLING: &str = "the robot is still coming to rest after its motion by hand: ask again";

/// True while a process reports that the joystick box controls the robot. Prim reads the box, and each report
/// rises one process per tick: a command that Task receives meanwhile fails.
pub fn is_moved_by_hand(memory: &CommonMemory) -> bool {
    memory.prim.status.report == PrimReport::JoystickOn
        || [memory.emove.status.report, memory.subtask.status.report].contains(&StatusReport::JoystickOn)
        || memory.task.status.report == HwsReport::JoystickOn
}

/// Refuses to set safe outputs during a command or with a held object, because safe outputs hold no part. The error
/// text has the reason and the remedy.
pub fn check_safe(memory: &CommonMemory) -> Result<(), String> {
    if memory.task.status.report == HwsReport::Executing {
        return Err(
            "a command is executed: send `job wait` or `PAUSE`, and ask again when it has ended".to_owned()
        );
    }
    if memory.emove.status.held != Holding::Nothing {
        return Err("the gripper holds something, and safe outputs may drop it: put it down first".to_owned());
    }
    Ok(())
}

/// Empty without obstacles. `knob`, `shown` and `terminals` are the operators' knob, joystick box and entries.
pub fn of_the_robot(
    memory: &CommonMemory,
    knob: u16,
    shown: &JoystickBox,
    terminals: &OperatorInputs,
) -> String {
    let mut found = Vec::new();
    if knob == 0 {
        found.push("the velocity knob is at 0 (`go`, or `joystick velocity 1000`)".to_owned());
    }
    if shown.frame != 0 {
        found.push("a frame is on at the joystick box (`joystick frame OFF`)".to_owned());
    }
    if shown.hold != 0 {
        found.push("switches of the joystick box hold processes (`joystick free PROCESS`)".to_owned());
    }
    let stopped = BOARDS.iter().filter(|board| terminals.is_stopped(**board));
    found.extend(stopped.map(|board| format!("board {board} is stopped (`board {board} go`)")));
    if !memory.t3i.status.link_running {
        let trouble = memory.t3i.status.trouble();
        found.push(trouble.unwrap_or("the link to the robot controller does not run").to_owned());
    }
    if found.is_empty() { String::new() } else { format!("but nothing moves: {}", found.join("; ")) }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use plant::{Cell, CellDescription, Key, WorkstationAction};

    use super::*;

    #[test]
    fn emergency_text_names_buttons_and_remedy() {
        let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
        let description = CellDescription::load(&data.join("cell.toml")).unwrap();
        let mut workstation = SimulatedWorkstation::new(Cell::new(&description, 1).unwrap());
        assert_eq!(emergency(&workstation), None);
        for site in [EStop::Terminals, EStop::Pedestal] {
            workstation.cell.workstation(&WorkstationAction::T3(Key::Press(site))).unwrap();
        }
        let why = emergency(&workstation).unwrap();
        assert!(
            why.starts_with(
                "EMERGENCY: the E-stop near the terminals and the E-stop near the pedestal are pressed: \
                 `release terminals`, `release pedestal`, `panel fault-reset`"
            ),
            "{why}"
        );
        for site in [EStop::Terminals, EStop::Pedestal] {
            workstation.cell.workstation(&WorkstationAction::T3(Key::Release(site))).unwrap();
        }
        workstation.cell.step(&interfaces::DeviceOutputs::default());
        workstation.cell.workstation(&WorkstationAction::T3(Key::FaultReset)).unwrap();
        assert_eq!(emergency(&workstation), None, "the start-up is left");
    }

    #[test]
    fn safe_outputs_by_hand_are_refused_during_a_command_and_while_something_is_held() {
        let mut memory = CommonMemory::default();
        memory.emove.status.held = Holding::Nothing;
        assert_eq!(check_safe(&memory), Ok(()));
        memory.task.status.report = HwsReport::Executing;
        assert!(check_safe(&memory).unwrap_err().contains("`job wait`"));
        memory.task.status.report = HwsReport::Finished;
        memory.emove.status.held = Holding::NotKnown;
        assert!(check_safe(&memory).unwrap_err().contains("put it down first"));
    }

    #[test]
    fn every_obstacle_of_a_playing_job_is_named() {
        let mut memory = CommonMemory::default();
        memory.t3i.status.link_running = true;
        let free = (JoystickBox::default(), OperatorInputs::default());
        assert_eq!(of_the_robot(&memory, 1000, &free.0, &free.1), "");
        memory.t3i.status.link_running = false;
        let shown = JoystickBox { frame: 1, hold: 8, ..JoystickBox::default() };
        let terminals = OperatorInputs { stopped: 0xFF, ..OperatorInputs::default() };
        let said = of_the_robot(&memory, 0, &shown, &terminals);
        for part in ["the velocity knob is at 0", "a frame is on", "hold processes", "board 2 go", "the link"]
        {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
}

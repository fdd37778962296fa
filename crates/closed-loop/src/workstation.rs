//! The workstation of the simulated cell, behind the interface of the workstation controller's emulator.

use field::Failure;
use interfaces::station::{Key, ViseOpening};
use neighbours::workstation::player::Workstation;
use plant::{
    Cell, CellDescription, CellEvent, Placement, SagReport, WorkstationAction, WorkstationError, t3::Stage,
};
use rcs_core::tick::{TICK_MS, Tick};
use taskdata::load::job::{Drum, Offset, Workstation as Action};

use crate::field::Field;

/// Time limit for an arm without pressure to come to rest before the run ends, ticks: two minutes. From HOME it takes
/// 40 s; an arm that slides off an obstacle takes twice as long.
const SETTLING_LIMIT: u64 = 120_000 / TICK_MS;

/// Refuses a job that hands over to a workstation controller, in a run to which none can connect.
const NO_HAND_OVER: &str = "no workstation controller can connect to this run; \
                            --network ADDRESS --outside workstation --stand-alone lets one";

/// The emergency of an open safety circuit.
const SAFETY_OPEN: &str = "the safety circuit is open: safety.ok is 0";

#[derive(Clone, Debug)]
pub struct Emergency {
    pub tick: Tick,
    pub droop: SagReport, // cause, position, and the state of the arm
}

#[derive(Clone)]
pub struct SimulatedWorkstation {
    pub cell: Cell,
    pub field: Option<Box<Field>>,
    state: WorkstationState,
}

#[derive(Clone, Debug, Default)]
pub struct WorkstationState {
    fault: Option<String>,
    robot_elsewhere: bool, // true with an external robot, whose panel is out of reach
    hands_over: bool,      // a workstation controller can connect, so that the job can hand over to it
    emergency: Option<Emergency>,
    stopped: bool,       // the arm had no pressure after the last tick
    loads: Vec<u32>,     // reloads requested since the last call of `loads`
    delivered: Vec<u32>, // parts that an action has put into the cell since the last call of `delivered`
}

impl SimulatedWorkstation {
    pub fn new(cell: Cell) -> Self {
        Self { cell, field: None, state: WorkstationState::default() }
    }

    pub const fn state(&self) -> &WorkstationState {
        &self.state
    }

    pub const fn note_robot_elsewhere(&mut self) {
        self.state.robot_elsewhere = true;
    }

    pub const fn note_hand_over(&mut self) {
        self.state.hands_over = true;
    }

    #[must_use]
    pub const fn is_robot_elsewhere(&self) -> bool {
        self.state.robot_elsewhere
    }

    /// True if robot and devices are those of the simulated cell, so that it shows what has become of the parts.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        !self.is_robot_elsewhere() && !self.has_real_devices()
    }

    /// True if devices of the cell are behind couplers outside of the loop.
    #[must_use]
    pub fn has_real_devices(&self) -> bool {
        matches!(self.field.as_deref(), Some(Field::External(_)))
    }

    /// Events of the cell in the finished `tick`. A failed simulation or vise is a fault of the workstation.
    pub fn events(&mut self, tick: Tick) -> Vec<CellEvent> {
        let events = self.cell.events();
        if let Some(droop) = self.cell.droop().filter(|droop| droop.cause.is_emergency()) {
            let began = match &self.state.emergency {
                Some(known) if self.state.stopped => known.tick,
                _ => tick,
            };
            self.state.emergency = Some(Emergency { tick: began, droop: droop.clone() });
        }
        self.state.stopped = self.cell.droop().is_some();
        let fatal = |event: &&CellEvent| matches!(event, CellEvent::Quarantined | CellEvent::ViseStuck);
        if let Some(event) = events.iter().find(fatal) {
            self.state.fault = Some(event.to_string());
        }
        events
    }

    /// The last emergency, even after a restart of the robot.
    #[must_use]
    pub const fn last_emergency(&self) -> Option<&Emergency> {
        self.state.emergency.as_ref()
    }

    /// True if the arm has lost its pressure in an emergency and has not come to rest: it can still cause contacts.
    #[must_use]
    pub fn is_settling(&self, tick: Tick) -> bool {
        let sinks =
            |emergency: &Emergency| !emergency.droop.at_rest && tick.since(emergency.tick) < SETTLING_LIMIT;
        self.state.stopped && self.state.emergency.as_ref().is_some_and(sinks)
    }

    /// Number of the first load since the last call of [`World::loads`](crate::World::loads).
    #[must_use]
    pub fn first_load(&self) -> Option<u32> {
        self.state.loads.first().copied()
    }

    pub(crate) fn take_loads(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.state.loads)
    }

    /// Parts that an action has put into the cell since the last call.
    pub fn delivered(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.state.delivered)
    }

    /// Begin an action of an operator; `line` is its text. Errors: a message if the workstation cannot execute it.
    pub fn begin_line(&mut self, action: &Action, line: &str) -> Result<(), String> {
        self.begin(action, line)
    }

    /// False for a line that the cell executes; a person fills the trays of the simulated cell, once.
    fn begin_by_devices(&mut self, action: &Action) -> Result<bool, String> {
        let Some(field) = self.field.as_deref_mut() else { return Ok(false) };
        let is_simulated = matches!(field, Field::Simulated(_));
        let lines = field.desk_mut().lines_mut();
        if !lines.executes(action) {
            return Ok(false);
        }
        lines.begin(action)?;
        let is_to_fill = matches!(action, Action::Tray { .. }) && !self.is_filled(action);
        Ok(!(is_simulated && is_to_fill))
    }

    /// The failure of a line that devices executed, in the tick in which it fails.
    #[must_use]
    pub fn line_failure(&self) -> Option<&Failure> {
        self.field.as_deref().and_then(|field| field.desk().lines().failure())
    }

    /// True if the part of the line is in its tray, since the line was interrupted after a person had filled it.
    fn is_filled(&self, action: &Action) -> bool {
        let Action::Tray { location, object, .. } = action else { return false };
        let sector = location.sector.map_or(0, |sector| u16::try_from(sector).unwrap_or(u16::MAX));
        self.cell.parts().iter().any(|part| {
            part.name == object.as_str()
                && (part.location.as_str(), part.sector) == (location.name.as_str(), sector)
        })
    }

    fn is_executed_by_devices(&self) -> bool {
        self.field.as_deref().is_some_and(|field| field.desk().lines().is_busy())
    }

    fn translate(&self, action: &Action) -> Result<Vec<WorkstationAction>, String> {
        if is_at_robot(action) && self.state.robot_elsewhere {
            return Err(OWN_PANEL.to_owned());
        }
        orders(action, self.cell.description()).map_err(|error| error.to_string())
    }
}

/// Why an action at the robot is refused if the robot is not the simulated one.
pub const OWN_PANEL: &str = "the robot has its own panel and emergency stops: operate them by hand";

/// True for a key of the robot's panel, or one of its emergency stops.
#[must_use]
pub const fn is_at_robot(action: &Action) -> bool {
    matches!(action, Action::Press(_) | Action::Release(_) | Action::Panel(_))
}

/// Actions in order. Fails if the cell has no such vise; the cell itself checks all other names.
pub fn orders(action: &Action, cell: &CellDescription) -> Result<Vec<WorkstationAction>, WorkstationError> {
    Ok(vec![match action {
        Action::Tray { location, object, offset } => WorkstationAction::Place {
            part: object.to_string(),
            unit: location.name.to_string(),
            // The task data contain the sector, so it is not negative; one that does not fit is beyond every cell.
            sector: location.sector.map_or(0, |sector| u16::try_from(sector).unwrap_or(u16::MAX)),
            placement: offset.as_ref().map_or(Placement::Random, placement),
        },
        Action::Vise { opening, location, program } => {
            cell.has_vise_at(location.name.as_str())?;
            let opening = match opening {
                ViseOpening::Partial => WorkstationAction::VisePartial,
                ViseOpening::Close => WorkstationAction::ViseClose,
                ViseOpening::Open => WorkstationAction::ViseOpen,
            };
            let program = program.map(|name| WorkstationAction::ViseProgram { name: name.to_string() });
            return Ok(program.into_iter().chain([opening]).collect());
        }
        Action::Machine { blank, part, location } => WorkstationAction::Machine {
            from: blank.to_string(),
            to: part.to_string(),
            location: location.name.to_string(),
        },
        Action::Drum(Drum::Grip) => WorkstationAction::DrumGrip,
        Action::Drum(Drum::Release) => WorkstationAction::DrumRelease,
        Action::Drum(Drum::Tool(tool)) => WorkstationAction::DrumTool { part: tool.to_string() },
        Action::Joystick(action) => WorkstationAction::Joystick(*action),
        Action::Press(site) => WorkstationAction::T3(Key::Press(*site)),
        Action::Release(site) => WorkstationAction::T3(Key::Release(*site)),
        Action::Panel(key) => WorkstationAction::T3(*key),
        Action::Table(key) => WorkstationAction::Table(*key),
        Action::Resolvers(key) => WorkstationAction::Resolvers(*key),
        // These actions do not affect the cell.
        Action::Wait { .. } | Action::Load { .. } | Action::HandOver => return Ok(Vec::new()),
    }])
}

fn placement(offset: &Offset) -> Placement {
    let hundredths = |value: i32| f64::from(value) / 100.0;
    Placement::At { x: hundredths(offset.x), y: hundredths(offset.y), angle: hundredths(offset.angle) }
}

impl Workstation for SimulatedWorkstation {
    fn begin(&mut self, action: &Action, _: &str) -> Result<(), String> {
        match action {
            Action::Load { number } => self.state.loads.push(*number),
            Action::HandOver if !self.state.hands_over => return Err(NO_HAND_OVER.to_owned()),
            _ => {}
        }
        if self.begin_by_devices(action)? {
            return Ok(());
        }
        for action in self.translate(action)? {
            let next = self.cell.next_part_number();
            self.cell.workstation(&action).map_err(|error| error.to_string())?;
            self.state.delivered.extend(next..self.cell.next_part_number());
        }
        Ok(())
    }

    fn busy(&self) -> bool {
        self.cell.workstation_busy() || self.is_executed_by_devices()
    }

    fn has_own_time_limit(&self) -> bool {
        self.is_executed_by_devices()
    }

    fn fault(&self) -> Option<String> {
        self.state.fault.clone().or_else(|| self.line_failure().map(ToString::to_string))
    }

    fn emergency(&self) -> Option<String> {
        let faulted = self.cell.t3().stage() == Stage::Faulted;
        let droop = self.cell.droop().filter(|droop| faulted && droop.cause.is_emergency());
        let Some(droop) = droop else {
            let is_open = self.field.as_deref().is_some_and(|field| field.desk().is_safety_open());
            return is_open.then(|| SAFETY_OPEN.to_owned());
        };
        // Adding zero turns -0.0 into 0.0.
        let [x, y, z] = droop.position.map(|inches| (inches * 10.0).round() / 10.0 + 0.0);
        Some(format!("{}, with the hand at ({x:.1} {y:.1} {z:.1} in)", droop.cause))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::device::{
        DeviceInputs, DeviceOutputs, JoystickBox, KNOB_FULL, joystick_frame, single_step,
    };
    use std::path::Path;
    use taskdata::load::{Job, Source, Step, Store};

    struct Bench {
        workstation: SimulatedWorkstation,
        store: Store,
    }

    impl Bench {
        fn new() -> Self {
            let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
            let description = CellDescription::load(&data.join("cell.toml")).unwrap();
            let cell = Cell::new(&description, 1).unwrap();
            let Ok((store, _)) = Store::load(data) else { panic!("the shipped data do not load") };
            Self { workstation: SimulatedWorkstation::new(cell), store }
        }

        fn play(&mut self, line: &str) -> Result<Vec<DeviceInputs>, String> {
            let source = Source { name: "try.job".into(), text: line.into() };
            let (job, _) = Job::from_source(source, &self.store).map_err(|report| report.to_string())?;
            let [line] = &job.steps[..] else { panic!("{line} is one line") };
            let Step::Workstation(action) = line.step else { panic!("{line:?}") };
            self.workstation.begin(&action, "")?;
            let mut seen = Vec::new();
            loop {
                seen.push(self.workstation.cell.step(&DeviceOutputs::default()));
                if !self.workstation.busy() {
                    return Ok(seen);
                }
            }
        }

        fn at_box(&mut self, line: &str) -> Vec<JoystickBox> {
            let inputs = self.play(&format!("** joystick {line}")).unwrap();
            inputs.into_iter().map(|inputs| inputs.joystick).collect()
        }
    }

    #[test]
    fn tray_vise_and_machine_execute_their_lines() {
        let mut bench = Bench::new();
        bench.play("** tray UNIT_1 4 LINKBAR1_BH 50 -20 1500").unwrap();
        bench.play("** tray UNIT_2 7 SHAFT_BH").unwrap();
        bench.play("** tray UNIT_2 2 DRILL-2").unwrap();
        let parts = bench.workstation.cell.parts();
        let places: Vec<_> = parts.iter().map(|part| (part.location.as_str(), part.sector)).collect();
        assert_eq!(places, [("UNIT_1", 4), ("UNIT_2", 7), ("UNIT_2", 2)]);
        bench.play("** vise partial PFIXTURE CLEVIS").unwrap();
        assert!((bench.workstation.cell.vise_opening() - 2.64).abs() < 1e-6);
        bench.play("** vise open PFIXTURE").unwrap();
        assert!((bench.workstation.cell.vise_opening() - 2.76).abs() < 1e-6, "the program stays on");
        bench.play("** vise close PFIXTURE LINKBAR").unwrap();
        let refused = bench.play("** machine LINKBAR1_BH LINKBAR1 PFIXTURE").unwrap_err();
        assert_eq!(refused, "LINKBAR1_BH is to be machined, but nothing is clamped in the vise");
        let refused = bench.play("** machine SHAFT_BH SHAFT V-VFIXTURE").unwrap_err();
        assert_eq!(refused, "SHAFT_BH is to be machined, but nothing is at V-VFIXTURE");
        let refused = bench.play("** vise open TABLE").unwrap_err();
        assert_eq!(refused, "there is no vise at TABLE; the cell description has one at PFIXTURE");
        let refused = bench.play("** vise open PFIXTURE CLEVISS").unwrap_err();
        assert_eq!(refused, "the vise has no program CLEVISS; the cell description has LINKBAR, CLEVIS");
    }

    #[test]
    fn drum_receives_its_tool_and_moves_its_fingers() {
        let mut bench = Bench::new();
        bench.play("** drum tool ENDMILL-1").unwrap();
        assert!(bench.workstation.cell.drum_closed());
        assert_eq!(bench.workstation.cell.parts().len(), 1);
        bench.play("** drum release").unwrap();
        assert!(!bench.workstation.cell.drum_closed());
        bench.play("** drum grip").unwrap();
        assert!(bench.workstation.cell.drum_closed());
    }

    /// Keys of the panel after an emergency stop, and the stage to which each key leads.
    const RESTART: [(&str, Stage); 6] = [
        ("fault-reset", Stage::Ready),
        ("hydraulics enable", Stage::Enabled),
        ("manual on", Stage::Manual),
        ("align", Stage::Manual),
        ("auto", Stage::Auto),
        ("cycle-start", Stage::Depc),
    ];

    #[test]
    fn robot_restarts_after_an_emergency_stop() {
        let mut bench = Bench::new();
        bench.play("** estop pedestal").unwrap();
        let said = bench.workstation.emergency().unwrap();
        assert_eq!(said, "the E-stop near the pedestal was pressed, with the hand at (0.0 -71.4 -14.8 in)");
        let refused = bench.play("** panel fault-reset").unwrap_err();
        assert_eq!(refused, "the E-stop near the pedestal is still in: release it first");
        bench.play("** release pedestal").unwrap();
        assert!(bench.workstation.emergency().is_some(), "the emergency lasts until the restart");
        for (line, stage) in RESTART {
            bench.play(&format!("** panel {line}")).unwrap();
            assert_eq!(bench.workstation.cell.t3().stage(), stage, "{line}");
            assert_eq!(bench.workstation.emergency(), None);
        }
        let refused = bench.play("** panel cycle-start").unwrap_err();
        assert_eq!(refused, "the program runs: interrupt it first");
    }

    #[test]
    fn a_robot_elsewhere_has_its_own_panel() {
        let mut bench = Bench::new();
        bench.workstation.state.robot_elsewhere = true;
        for line in ["** estop pedestal", "** release pedestal", "** panel auto"] {
            let refused = bench.play(line).unwrap_err();
            assert!(refused.contains("has its own panel"), "{line}: {refused}");
        }
    }

    #[test]
    fn joystick_box_words_show_the_actions_at_it() {
        let mut bench = Bench::new();
        let frames = [
            ("WORLD", joystick_frame::WORLD),
            ("TOOL", joystick_frame::TOOL),
            ("TOOL-ORIGIN", joystick_frame::TOOL_ORIGIN),
            ("WRIST-ORIGIN", joystick_frame::WRIST_ORIGIN),
            ("OFF", 0),
        ];
        for (word, bits) in frames {
            assert_eq!(bench.at_box(&format!("frame {word}"))[0].frame, bits, "{word}");
        }
        assert_eq!(bench.at_box("stick 700 -30 3").iter().filter(|s| (s.x, s.y) == (700, -30)).count(), 3);
        type Line = fn(&JoystickBox) -> bool;
        let buttons: [(&str, Line); 8] = [
            ("up 2", |s| s.up),
            ("down 2", |s| s.down),
            ("roll+ 2", |s| s.roll_plus),
            ("roll- 2", |s| s.roll_minus),
            ("open 2", |s| s.open),
            ("close 2", |s| s.close),
            ("record", |s| s.record),
            ("resume", |s| s.resume),
        ];
        for (line, button) in buttons {
            let seen = bench.at_box(line);
            assert_eq!(seen.iter().map(button).collect::<Vec<_>>(), [true, true], "{line}");
        }
        let processes = [
            ("TASK", single_step::TASK),
            ("SUBTASK", single_step::SUBTASK),
            ("EMOVE", single_step::EMOVE),
            ("PRIM", single_step::PRIM),
        ];
        for (word, bit) in processes {
            assert_eq!(bench.at_box(&format!("hold {word}"))[0].hold, bit);
            let stepped = bench.at_box(&format!("step {word} 3"));
            let rises = stepped.iter().zip(stepped.iter().skip(1));
            let presses = rises.filter(|(a, b)| a.single_step == 0 && b.single_step == bit).count();
            assert_eq!((stepped[0].single_step, presses), (bit, 2), "three presses of {word}");
            assert_eq!(bench.at_box(&format!("free {word}"))[0].hold, 0);
        }
        assert_eq!(bench.at_box("velocity 250")[0].velocity, 250);
        assert_eq!(bench.at_box("velocity 1000")[0].velocity, KNOB_FULL);
    }
}

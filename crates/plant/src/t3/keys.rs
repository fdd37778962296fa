//! Effects of the keys of the console, and reasons to refuse them.

use depc::controller::ControllerState;
use geometry::kinematics::T3;

use super::{BY_EYE, Cut, EStop, Key, Lamps, Refusal, RobotEvent, Stage, T3Controller, off_home};

impl T3Controller {
    /// Press a key. Fails with [`Refusal`] with the missing step. The state is then unchanged.
    pub fn press(&mut self, key: Key) -> Result<(), Refusal> {
        let hardware = matches!(
            key,
            Key::Board(_) | Key::Transmitter(_) | Key::PrimBox(_) | Key::Press(_) | Key::Release(_)
        );
        if self.stage == Stage::Dark && key != Key::ControlPower(true) && !hardware {
            return Err(Refusal::NoPower);
        }
        match key {
            Key::ControlPower(on) => self.control_power(on),
            Key::FaultReset => self.fault_reset(),
            Key::Hydraulics(on) => self.hydraulics(on),
            Key::Manual(on) => self.manual(on),
            Key::Align(axis) => self.align(axis),
            Key::Jog { axis, degrees } => self.jog(axis, degrees),
            Key::Auto => self.auto(),
            Key::CycleStart => self.cycle_start(),
            Key::Interrupt => self.interrupt(),
            Key::Cancel => self.answer(true),
            Key::Enter => self.answer(false),
            Key::Hold(on) => {
                self.keys.hold = on;
                Ok(())
            }
            Key::Press(site) => {
                self.estops[usize::from(site.code())] = true;
                self.fault(Cut::EStop(site));
                Ok(())
            }
            Key::Release(site) => self.release(site),
            Key::Board(_) if self.stage != Stage::Dark => Err(Refusal::Powered),
            Key::Board(there) => {
                self.board = there;
                Ok(())
            }
            Key::Transmitter(good) => {
                self.transmitter = good;
                Ok(())
            }
            Key::PrimBox(on) => {
                self.prim_box = on;
                // The joystick box's E-stop is wired through this box: without its power the circuit is open.
                if !on {
                    self.fault(Cut::PrimBox);
                }
                Ok(())
            }
        }
    }

    /// The pump, or a line of the hydraulics, fails: the pressure is lost at once, and the controller shows a fault.
    pub fn lose_pressure(&mut self) {
        self.pump = false;
        if self.stage.is_live() {
            self.fault(Cut::PressureLost);
        }
    }

    pub fn repair_hydraulics(&mut self) {
        self.pump = true;
    }

    pub(super) fn fault(&mut self, cause: Cut) {
        if self.stage != Stage::Dark {
            self.shut_off(Stage::Faulted, cause);
            self.lamps(Lamps::Fault);
        }
    }

    /// Cut the pressure: motions end, and the axes are no longer aligned.
    fn shut_off(&mut self, stage: Stage, cause: Cut) {
        if self.stage.is_live() {
            self.robot(RobotEvent::Sinks(cause));
            self.cut = Some(cause);
        }
        self.before_jump = None;
        self.arm.set_pressure(false);
        self.aligned = [false; 6];
        self.aligning = [false; 6];
        self.end_program(stage);
    }

    fn control_power(&mut self, on: bool) -> Result<(), Refusal> {
        match (on, self.stage) {
            (true, Stage::Dark) => {
                self.enter(Stage::Faulted);
                self.lamps(Lamps::PowerOn);
                Ok(())
            }
            (true, _) => Err(Refusal::PowerIsOn),
            (false, _) => {
                self.shut_off(Stage::Dark, Cut::ControlPower);
                self.lamps(Lamps::PowerOff);
                Ok(())
            }
        }
    }

    fn fault_reset(&mut self) -> Result<(), Refusal> {
        if self.stage != Stage::Faulted {
            return Err(Refusal::NoFault);
        }
        if let Some(site) = EStop::ALL.iter().copied().find(|site| self.is_pressed(*site)) {
            return Err(Refusal::Pressed(site));
        }
        if !self.prim_box {
            return Err(Refusal::PrimBoxOff);
        }
        self.enter(Stage::Ready);
        self.lamps(Lamps::FaultReset);
        Ok(())
    }

    fn release(&mut self, site: EStop) -> Result<(), Refusal> {
        if !std::mem::replace(&mut self.estops[usize::from(site.code())], false) {
            return Err(Refusal::NotPressed(site));
        }
        Ok(())
    }

    fn hydraulics(&mut self, enable: bool) -> Result<(), Refusal> {
        match (enable, self.stage) {
            (true, Stage::Faulted) => Err(Refusal::Fault),
            (true, Stage::Ready) => {
                self.enter(Stage::Enabled);
                self.lamps(Lamps::HydraulicsEnabled);
                Ok(())
            }
            (true, _) | (false, Stage::Ready | Stage::Faulted) => Err(Refusal::KeyIsThere),
            (false, _) => {
                self.shut_off(Stage::Ready, Cut::KeySwitch);
                self.lamps(Lamps::HydraulicsDisabled);
                Ok(())
            }
        }
    }

    fn manual(&mut self, on: bool) -> Result<(), Refusal> {
        match (on, self.stage) {
            (true, Stage::Faulted) => Err(Refusal::Fault),
            (true, Stage::Ready) => Err(Refusal::NotEnabled),
            (true, Stage::Enabled) => {
                self.enter(Stage::Rising);
                self.robot(RobotEvent::WillJump);
                Ok(())
            }
            (true, _) => Err(Refusal::PressureIsOn),
            (false, stage) if stage.is_live() => {
                self.shut_off(Stage::Enabled, Cut::ManualOff);
                Ok(())
            }
            (false, _) => Err(Refusal::NoPressure),
        }
    }

    fn align(&mut self, axis: Option<u8>) -> Result<(), Refusal> {
        match self.stage {
            Stage::Manual => {}
            Stage::Rising => return Err(Refusal::Moving),
            stage if stage.is_live() => return Err(Refusal::NotManual),
            _ => return Err(Refusal::NoPressure),
        }
        if !self.arm.settled() {
            return Err(Refusal::Moving);
        }
        let arrows = off_home(&mut self.noise, BY_EYE);
        let mut goal = self.arm.command();
        for (number, (joint, arrow)) in (1..).zip(goal.iter_mut().zip(arrows)) {
            let chosen = axis.is_none_or(|axis| axis == number);
            if chosen {
                *joint = arrow;
            }
            self.aligning[usize::from(number) - 1] = chosen;
        }
        self.travel(goal);
        Ok(())
    }

    /// Teach pendant: turn one axis by some degrees.
    fn jog(&mut self, axis: u8, degrees: i8) -> Result<(), Refusal> {
        match self.stage {
            Stage::Manual | Stage::PreManual => {}
            Stage::Rising | Stage::Homing => return Err(Refusal::Moving),
            Stage::Depc | Stage::Rehearsing => return Err(Refusal::Running),
            Stage::Auto => return Err(Refusal::JogInAuto),
            _ => return Err(Refusal::NoPressure),
        }
        if !self.arm.settled() {
            return Err(Refusal::Moving);
        }
        let at = usize::from(axis).checked_sub(1).filter(|at| *at < self.aligned.len());
        let at = at.ok_or(Refusal::NoAxis(axis))?;
        let mut goal = self.arm.command();
        if let Some(joint) = goal.get_mut(at) {
            *joint += f64::from(degrees).to_radians();
        }
        if T3.margin(&goal).radians < 0.0 {
            return Err(Refusal::Limit(axis));
        }
        self.aligned[at] = false;
        self.travel(goal);
        Ok(())
    }

    fn auto(&mut self) -> Result<(), Refusal> {
        match self.stage {
            Stage::Manual if !self.arm.settled() => Err(Refusal::Moving),
            Stage::Manual if self.aligned != [true; 6] => Err(Refusal::NotAligned),
            Stage::Manual | Stage::PreManual | Stage::Auto => {
                self.go_home();
                Ok(())
            }
            Stage::Rising | Stage::Homing => Err(Refusal::Moving),
            Stage::Rehearsing => Err(Refusal::Running),
            Stage::Depc => Err(self.why_not_auto()),
            _ => Err(Refusal::NoPressure),
        }
    }

    fn why_not_auto(&self) -> Refusal {
        match self.depc.state() {
            ControllerState::Warning => Refusal::Warned,
            ControllerState::PreManual => Refusal::OnlyCancel,
            _ => Refusal::Running,
        }
    }

    fn cycle_start(&mut self) -> Result<(), Refusal> {
        match self.stage {
            Stage::Auto => {
                self.enter(Stage::Rehearsing);
                self.motions = 0;
                self.robot(RobotEvent::VerticalMotions);
                Ok(())
            }
            Stage::Homing => Err(Refusal::Moving),
            Stage::Rehearsing => Err(Refusal::Running),
            Stage::Depc => Err(self.why_not_auto()),
            _ => Err(Refusal::NotAuto),
        }
    }

    fn interrupt(&mut self) -> Result<(), Refusal> {
        match self.stage {
            Stage::Depc => {
                // In step 12 it is pressed during a warning, and then has no effect.
                self.keys.interrupt = true;
                Ok(())
            }
            Stage::Homing | Stage::Rehearsing => {
                self.arm.stop();
                self.enter(Stage::PreManual);
                self.robot(RobotEvent::Interrupted);
                Ok(())
            }
            _ => Err(Refusal::NotRunning),
        }
    }

    fn answer(&mut self, cancel: bool) -> Result<(), Refusal> {
        match (self.stage, self.depc.state()) {
            (Stage::Depc, ControllerState::PreManual) if !cancel => Err(Refusal::OnlyCancel),
            (Stage::Depc, ControllerState::Warning | ControllerState::PreManual) => {
                self.keys.cancel = cancel;
                self.keys.enter = !cancel;
                Ok(())
            }
            _ => Err(Refusal::NothingToAnswer),
        }
    }
}

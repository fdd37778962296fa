//! Lines of a job for keys and switches: joystick box (III.3.3), emergency stops (III.6), robot controller (IV.3.3),
//! rotary table's controller (IV.1 step 3), resolver electronics (IV.3.3 step 11). Words: [`interfaces::station`].

use interfaces::station::{
    BoxAction, BoxButton, BoxControl, BoxFrame, EStop, Key, Keyswitch, PanelControl, ResolverControl,
    ResolverJoint, ResolverKey, Stepped, Switch, TableControl, TableKey, TableMode,
};
use rcs_core::{
    Plain,
    plain::{Schema, from_bytes},
};

use super::{fields::Fields, read::Reader};

const STICK_FORM: &str = "** joystick stick X Y TICKS, X and Y from -1000 to 1000; stick 0 0 releases it";
const PRESS_FORM: &str = "** joystick up|down|roll+|roll-|open|close TICKS";
const VELOCITY_FORM: &str = "** joystick velocity N, from 0 to 1000";
const STEP_FORM: &str = "** joystick step PROCESS, or with a COUNT after it";
const ALIGN_FORM: &str = "** panel align, or with an AXIS from 1 to 6 after it";
const RUN_FORM: &str = "** table run+|run- TICKS";
const TABLE_STEP_FORM: &str = "** table step+|step-, or with a COUNT after it: a step is 0.01 degree";

const FULL: i32 = 1000; // deflection of the stick, and scale of the knob

impl Reader<'_, '_> {
    pub(super) fn joystick(&mut self, fields: &mut Fields<'_, '_>) -> Option<BoxAction> {
        self.forget();
        let controls = BoxControl::ALL.iter().map(|control| control.text());
        let known: Vec<&str> = controls.chain(BoxButton::ALL.iter().map(|button| button.text())).collect();
        let word = *known.get(self.choice(fields, "part of the joystick box", &known)?)?;
        if let Some(button) = BoxButton::from_text(word) {
            return Some(BoxAction::Press(button, self.ticks(fields, PRESS_FORM)?));
        }
        Some(match BoxControl::from_text(word)? {
            BoxControl::Frame => {
                BoxAction::Frame(self.word::<BoxFrame>(fields, "frame of the joystick box")?.bits())
            }
            BoxControl::Stick => {
                let x = self.within(fields, "x of the stick", -FULL, STICK_FORM)?;
                let y = self.within(fields, "y of the stick", -FULL, STICK_FORM)?;
                let ticks = match (x, y) {
                    // A released stick needs no time.
                    (0, 0) => self.number_from(fields, 0, "a number of ticks", STICK_FORM)?,
                    _ => self.ticks(fields, STICK_FORM)?,
                };
                BoxAction::Stick { x, y, ticks }
            }
            BoxControl::Velocity => {
                let knob: i16 = self.within(fields, "the velocity", 0, VELOCITY_FORM)?;
                BoxAction::Velocity(knob.unsigned_abs())
            }
            BoxControl::Record => BoxAction::Record,
            BoxControl::Resume => BoxAction::Resume,
            BoxControl::Hold => BoxAction::Hold(self.process(fields)?),
            BoxControl::Free => BoxAction::Free(self.process(fields)?),
            BoxControl::Step => {
                let process = self.process(fields)?;
                let count = if fields.more() { self.count(fields, "a count", STEP_FORM)? } else { 1 };
                BoxAction::Step(process, count)
            }
        })
    }

    fn process(&mut self, fields: &mut Fields<'_, '_>) -> Option<u8> {
        Some(self.word::<Stepped>(fields, "process that the joystick box can hold")?.bit())
    }

    pub(super) fn estop(&mut self, fields: &mut Fields<'_, '_>) -> Option<EStop> {
        self.forget();
        self.word(fields, "emergency stop")
    }

    pub(super) fn panel(&mut self, fields: &mut Fields<'_, '_>) -> Option<Key> {
        self.forget();
        Some(match self.word(fields, "key of the robot controller")? {
            PanelControl::Power => Key::ControlPower(self.switch(fields, "position of the power switch")?),
            PanelControl::FaultReset => Key::FaultReset,
            PanelControl::Hydraulics => {
                let position: Keyswitch = self.word(fields, "position of the keyswitch")?;
                Key::Hydraulics(position == Keyswitch::Enable)
            }
            PanelControl::Manual => Key::Manual(self.switch(fields, "state of MANUAL")?),
            PanelControl::Hold => Key::Hold(self.switch(fields, "state of Hold")?),
            PanelControl::Auto => Key::Auto,
            PanelControl::CycleStart => Key::CycleStart,
            PanelControl::Interrupt => Key::Interrupt,
            PanelControl::Cancel => Key::Cancel,
            PanelControl::Enter => Key::Enter,
            PanelControl::Align if !fields.more() => Key::Align(None),
            PanelControl::Align => {
                let axis = self.number(fields, "an axis", ALIGN_FORM)?;
                if !(1..=6).contains(&axis.value) {
                    let message = format!("an axis is 1 to 6, {} found", axis.value);
                    self.problems.error_help("job.range", axis.at, message, ALIGN_FORM);
                    return None;
                }
                Key::Align(u8::try_from(axis.value).ok())
            }
        })
    }

    pub(super) fn resolvers(&mut self, fields: &mut Fields<'_, '_>) -> Option<ResolverKey> {
        Some(match self.word(fields, "switch or button of the resolver electronics")? {
            ResolverControl::Manual => ResolverKey::Manual(true),
            ResolverControl::Auto => ResolverKey::Manual(false),
            ResolverControl::Joint => {
                ResolverKey::Joint(self.word::<ResolverJoint>(fields, "number of a joint")?.code())
            }
        })
    }

    pub(super) fn table(&mut self, fields: &mut Fields<'_, '_>) -> Option<TableKey> {
        let control = self.word(fields, "key of the rotary table's controller")?;
        let plus = matches!(control, TableControl::RunPlus | TableControl::StepPlus);
        Some(match control {
            TableControl::Power => TableKey::Power(self.switch(fields, "position of the power switch")?),
            TableControl::Mode => {
                let mode: TableMode = self.word(fields, "position of the mode switch")?;
                TableKey::Manual(mode == TableMode::Manual)
            }
            TableControl::RunPlus | TableControl::RunMinus => {
                TableKey::Run { plus, ticks: self.ticks(fields, RUN_FORM)? }
            }
            TableControl::StepPlus | TableControl::StepMinus => {
                let more = fields.more();
                let count = if more { self.count(fields, "a count", TABLE_STEP_FORM)? } else { 1 };
                TableKey::Step { plus, count }
            }
            TableControl::Reset => TableKey::Reset,
        })
    }

    fn switch(&mut self, fields: &mut Fields<'_, '_>, what: &str) -> Option<bool> {
        Some(self.word::<Switch>(fields, what)? == Switch::On)
    }

    pub(super) fn word<T: Plain>(&mut self, fields: &mut Fields<'_, '_>, what: &str) -> Option<T> {
        let Schema::Enum(words) = T::SCHEMA else { return None };
        let known: Vec<&str> = words.variants.iter().map(|variant| variant.text).collect();
        let code = words.variants.get(self.choice(fields, what, &known)?)?.code;
        from_bytes(&[code]).ok()
    }

    pub(super) fn choice(
        &mut self,
        fields: &mut Fields<'_, '_>,
        what: &str,
        known: &[&str],
    ) -> Option<usize> {
        let at = fields.at();
        let Some(word) = fields.take() else {
            self.missing(&known.join(", "), at);
            return None;
        };
        let found = known.iter().position(|known| *known == word.text);
        if found.is_none() {
            self.unknown(what, word.text, word.at, known);
        }
        found
    }

    fn within(&mut self, fields: &mut Fields<'_, '_>, what: &str, low: i32, form: &str) -> Option<i16> {
        let number = self.number(fields, what, form)?;
        if !(low..=FULL).contains(&number.value) {
            let message = format!("{what} is {low} to {FULL}, {} found", number.value);
            self.problems.error_help("job.range", number.at, message, form);
            return None;
        }
        i16::try_from(number.value).ok()
    }
}

//! The lines of a job that begin with `**`.

use super::{
    Step,
    action::{
        Drum, EStop, Joystick, JoystickButton, JoystickFrame, Offset, Panel, Stepped, ViseOpening,
        Workstation,
    },
    fields::Fields,
    read::{MOST, Reader},
};

/// The first word of a line after `**`, which selects how the rest is read.
#[derive(Clone, Copy)]
enum Verb {
    Tray,
    Vise,
    Machine,
    Drum,
    Joystick,
    EStop,
    Release,
    Panel,
    Table,
    Resolvers,
    Wait,
    Load,
    After,
    HandOver,
}

const VERBS: &[(&str, Verb)] = &[
    ("tray", Verb::Tray),
    ("vise", Verb::Vise),
    ("machine", Verb::Machine),
    ("drum", Verb::Drum),
    ("joystick", Verb::Joystick),
    ("estop", Verb::EStop),
    ("release", Verb::Release),
    ("panel", Verb::Panel),
    ("table", Verb::Table),
    ("resolvers", Verb::Resolvers),
    ("wait", Verb::Wait),
    ("load", Verb::Load),
    ("after", Verb::After),
    ("workstation", Verb::HandOver),
];

/// The words with which lines for the cell begin.
pub fn own_line_words() -> impl Iterator<Item = &'static str> {
    VERBS.iter().map(|(name, _)| *name)
}

#[derive(Clone, Copy)]
enum BoxVerb {
    Frame,
    Stick,
    Press(JoystickButton),
    Velocity,
    Record,
    Resume,
    Hold,
    Free,
    Step,
}

const BOX_VERBS: &[(&str, BoxVerb)] = &[
    ("frame", BoxVerb::Frame),
    ("stick", BoxVerb::Stick),
    ("up", BoxVerb::Press(JoystickButton::Up)),
    ("down", BoxVerb::Press(JoystickButton::Down)),
    ("roll+", BoxVerb::Press(JoystickButton::RollPlus)),
    ("roll-", BoxVerb::Press(JoystickButton::RollMinus)),
    ("open", BoxVerb::Press(JoystickButton::Open)),
    ("close", BoxVerb::Press(JoystickButton::Close)),
    ("velocity", BoxVerb::Velocity),
    ("record", BoxVerb::Record),
    ("resume", BoxVerb::Resume),
    ("hold", BoxVerb::Hold),
    ("free", BoxVerb::Free),
    ("step", BoxVerb::Step),
];

const OPENINGS: &[(&str, ViseOpening)] =
    &[("partial", ViseOpening::Partial), ("close", ViseOpening::Close), ("open", ViseOpening::Open)];

#[derive(Clone, Copy)]
enum DrumVerb {
    Grip,
    Release,
    Tool,
}

const DRUM_VERBS: &[(&str, DrumVerb)] =
    &[("grip", DrumVerb::Grip), ("release", DrumVerb::Release), ("tool", DrumVerb::Tool)];

const ESTOPS: &[(&str, EStop)] = &[
    ("control-panel", EStop::ControlPanel),
    ("teach-pendant", EStop::TeachPendant),
    ("terminals", EStop::Terminals),
    ("joystick-box", EStop::JoystickBox),
    ("pedestal", EStop::Pedestal),
];

#[derive(Clone, Copy)]
enum PanelVerb {
    Power,
    Hydraulics,
    Manual,
    Align,
    Hold,
    Key(Panel),
}

const PANEL_VERBS: &[(&str, PanelVerb)] = &[
    ("power", PanelVerb::Power),
    ("fault-reset", PanelVerb::Key(Panel::FaultReset)),
    ("hydraulics", PanelVerb::Hydraulics),
    ("manual", PanelVerb::Manual),
    ("align", PanelVerb::Align),
    ("auto", PanelVerb::Key(Panel::Auto)),
    ("cycle-start", PanelVerb::Key(Panel::CycleStart)),
    ("interrupt", PanelVerb::Key(Panel::Interrupt)),
    ("cancel", PanelVerb::Key(Panel::Cancel)),
    ("enter", PanelVerb::Key(Panel::Enter)),
    ("hold", PanelVerb::Hold),
];

pub(super) const SWITCH: &[(&str, bool)] = &[("on", true), ("off", false)];
const KEYSWITCH: &[(&str, bool)] = &[("enable", true), ("disable", false)];

const FRAMES: &[(&str, JoystickFrame)] = &[
    ("WORLD", JoystickFrame::World),
    ("TOOL", JoystickFrame::Tool),
    ("TOOL-ORIGIN", JoystickFrame::ToolOrigin),
    ("WRIST-ORIGIN", JoystickFrame::WristOrigin),
    ("OFF", JoystickFrame::Off),
];

const PROCESSES: &[(&str, Stepped)] = &[
    ("TASK", Stepped::Task),
    ("SUBTASK", Stepped::Subtask),
    ("EMOVE", Stepped::Emove),
    ("PRIM", Stepped::Prim),
];

const TRAY_FORM: &str = "** tray UNIT SECTOR OBJECT, or with X Y ANGLE behind it: 0.01 in and 0.01 degree from the centre of the sector";
const STICK_FORM: &str = "** joystick stick X Y TICKS, X and Y from -1000 to 1000; stick 0 0 releases it";
const PRESS_FORM: &str = "** joystick up|down|roll+|roll-|open|close TICKS";
const VELOCITY_FORM: &str = "** joystick velocity N, from 0 to 1000";
const STEP_FORM: &str = "** joystick step PROCESS, or with a COUNT behind it";
const ALIGN_FORM: &str = "** panel align, or with an AXIS from 1 to 6 behind it";
const WAIT_FORM: &str = "** wait TICKS; a tick is 40 ms";
const AFTER_FORM: &str = "** after TICKS, then another line's words behind its **";

/// Full deflection of the stick, and full scale of the knob.
const FULL: i32 = 1000;

impl Reader<'_, '_> {
    /// Read the words after `**`.
    pub(super) fn workstation(&mut self, fields: &mut Fields<'_, '_>) -> Option<Step> {
        let at = fields.at();
        match self.choice(fields, "step of the workstation", VERBS)? {
            Verb::After => {
                let ticks = self.ticks(fields, AFTER_FORM)?;
                let verb_at = fields.at();
                let verb = self.choice(fields, "step of the workstation", VERBS)?;
                if matches!(verb, Verb::After | Verb::Wait | Verb::HandOver) {
                    let message = "this takes time by itself and cannot come behind after";
                    self.problems.error_help("job.after", verb_at, message, AFTER_FORM);
                    return None;
                }
                let action = self.action(verb, fields)?;
                self.after = Some(at);
                Some(Step::After { ticks, action })
            }
            verb => self.action(verb, fields).map(Step::Workstation),
        }
    }

    /// Read a line that is not in a job. Lines that use the job's ticks, its files or its next command are not
    /// possible then.
    pub(super) fn own_line(&mut self, fields: &mut Fields<'_, '_>) -> Option<Workstation> {
        let of_job = |verb: &Verb| matches!(verb, Verb::Wait | Verb::Load | Verb::After | Verb::HandOver);
        let is_own = |(_, verb): &(&str, Verb)| !of_job(verb);
        let known: Vec<_> = VERBS.iter().copied().filter(is_own).collect();
        let verb = self.choice(fields, "line for the cell", &known)?;
        let action = self.action(verb, fields)?;
        self.end_of_line(fields)?;
        Some(action)
    }

    fn action(&mut self, verb: Verb, fields: &mut Fields<'_, '_>) -> Option<Workstation> {
        match verb {
            Verb::Tray => self.tray(fields),
            Verb::Vise => self.vise(fields),
            Verb::Machine => self.machine(fields),
            Verb::Drum => self.drum(fields).map(Workstation::Drum),
            Verb::Joystick => self.joystick(fields).map(Workstation::Joystick),
            Verb::EStop => self.estop(fields).map(Workstation::Press),
            Verb::Release => self.estop(fields).map(Workstation::Release),
            Verb::Panel => self.panel(fields).map(Workstation::Panel),
            Verb::Table => self.table(fields).map(Workstation::Table),
            Verb::Resolvers => self.resolvers(fields).map(Workstation::Resolvers),
            Verb::HandOver => Some(Workstation::HandOver),
            Verb::Load => {
                let at = fields.at();
                if fields.take().is_none() {
                    self.missing("a file of blocks", at);
                    return None;
                }
                self.reload().map(|number| Workstation::Load { number })
            }
            Verb::Wait | Verb::After => {
                self.ticks(fields, WAIT_FORM).map(|ticks| Workstation::Wait { ticks })
            }
        }
    }

    fn tray(&mut self, fields: &mut Fields<'_, '_>) -> Option<Workstation> {
        let place = self.field(fields, "a tray")?;
        let sector = self.number(fields, "a sector", TRAY_FORM)?;
        let object = self.field(fields, "an object")?;
        let offset = if fields.more() {
            let x = self.number(fields, "x in 0.01 in", TRAY_FORM)?;
            let y = self.number(fields, "y in 0.01 in", TRAY_FORM)?;
            let angle = self.number(fields, "an angle in 0.01 degree", TRAY_FORM)?;
            Some(Offset { x: x.value, y: y.value, angle: angle.value })
        } else {
            None
        };
        self.object(object).then_some(())?;
        let location = self.place(place, sector, Some(object.name))?;
        Some(Workstation::Tray { location, object: object.name, offset })
    }

    fn vise(&mut self, fields: &mut Fields<'_, '_>) -> Option<Workstation> {
        let opening = self.choice(fields, "opening of a vise", OPENINGS);
        let place = self.field(fields, "a vise")?;
        let location = self.plain_place(place);
        let program =
            if fields.more() { Some(self.field(fields, "a program of the vise")?.name) } else { None };
        Some(Workstation::Vise { opening: opening?, location: location?, program })
    }

    fn machine(&mut self, fields: &mut Fields<'_, '_>) -> Option<Workstation> {
        let blank = self.field(fields, "the blank")?;
        let part = self.field(fields, "the finished part")?;
        let place = self.field(fields, "a vise or a nest")?;
        let both = [blank, part].map(|field| self.object(field));
        let location = self.plain_place(place)?;
        both.iter().all(|known| *known).then_some(Workstation::Machine {
            blank: blank.name,
            part: part.name,
            location,
        })
    }

    fn drum(&mut self, fields: &mut Fields<'_, '_>) -> Option<Drum> {
        Some(match self.choice(fields, "step of the drum", DRUM_VERBS)? {
            DrumVerb::Grip => Drum::Grip,
            DrumVerb::Release => Drum::Release,
            DrumVerb::Tool => {
                let tool = self.field(fields, "a tool")?;
                self.object(tool).then_some(Drum::Tool(tool.name))?
            }
        })
    }

    fn joystick(&mut self, fields: &mut Fields<'_, '_>) -> Option<Joystick> {
        self.forget();
        Some(match self.choice(fields, "part of the joystick box", BOX_VERBS)? {
            BoxVerb::Frame => Joystick::Frame(self.choice(fields, "frame of the joystick box", FRAMES)?),
            BoxVerb::Stick => {
                let x = self.within(fields, "x of the stick", -FULL, STICK_FORM)?;
                let y = self.within(fields, "y of the stick", -FULL, STICK_FORM)?;
                let ticks = match (x, y) {
                    // A stick that is released needs no time.
                    (0, 0) => self.number_from(fields, 0, "a number of ticks", STICK_FORM)?,
                    _ => self.ticks(fields, STICK_FORM)?,
                };
                Joystick::Stick { x, y, ticks }
            }
            BoxVerb::Press(button) => Joystick::Press { button, ticks: self.ticks(fields, PRESS_FORM)? },
            BoxVerb::Velocity => {
                let knob: i16 = self.within(fields, "the velocity", 0, VELOCITY_FORM)?;
                Joystick::Velocity(knob.unsigned_abs())
            }
            BoxVerb::Record => Joystick::Record,
            BoxVerb::Resume => Joystick::Resume,
            BoxVerb::Hold => Joystick::Hold(self.process(fields)?),
            BoxVerb::Free => Joystick::Free(self.process(fields)?),
            BoxVerb::Step => {
                let process = self.process(fields)?;
                let count = if fields.more() { self.count(fields, "a count", STEP_FORM)? } else { 1 };
                Joystick::Step { process, count }
            }
        })
    }

    fn estop(&mut self, fields: &mut Fields<'_, '_>) -> Option<EStop> {
        self.forget();
        self.choice(fields, "emergency stop", ESTOPS)
    }

    fn panel(&mut self, fields: &mut Fields<'_, '_>) -> Option<Panel> {
        self.forget();
        Some(match self.choice(fields, "key of the robot controller", PANEL_VERBS)? {
            PanelVerb::Key(key) => key,
            PanelVerb::Power => Panel::Power(self.choice(fields, "position of the power switch", SWITCH)?),
            PanelVerb::Hydraulics => {
                Panel::Hydraulics(self.choice(fields, "position of the keyswitch", KEYSWITCH)?)
            }
            PanelVerb::Manual => Panel::Manual(self.choice(fields, "state of MANUAL", SWITCH)?),
            PanelVerb::Hold => Panel::Hold(self.choice(fields, "state of Hold", SWITCH)?),
            PanelVerb::Align if !fields.more() => Panel::Align(None),
            PanelVerb::Align => {
                let axis = self.number(fields, "an axis", ALIGN_FORM)?;
                if !(1..=6).contains(&axis.value) {
                    let message = format!("an axis is 1 to 6, {} found", axis.value);
                    self.problems.error_help("job.range", axis.at, message, ALIGN_FORM);
                    return None;
                }
                Panel::Align(u8::try_from(axis.value).ok())
            }
        })
    }

    fn process(&mut self, fields: &mut Fields<'_, '_>) -> Option<Stepped> {
        self.choice(fields, "process that the joystick box can hold", PROCESSES)
    }

    /// Read one of several words.
    pub(super) fn choice<T: Copy>(
        &mut self,
        fields: &mut Fields<'_, '_>,
        what: &str,
        choices: &[(&str, T)],
    ) -> Option<T> {
        let known: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
        let at = fields.at();
        let Some(word) = fields.take() else {
            self.missing(&known.join(", "), at);
            return None;
        };
        let found = choices.iter().find(|(known, _)| *known == word.text);
        if found.is_none() {
            self.unknown(what, word.text, word.at, &known);
        }
        found.map(|(_, choice)| *choice)
    }

    pub(super) fn ticks(&mut self, fields: &mut Fields<'_, '_>, form: &str) -> Option<u32> {
        self.count(fields, "a number of ticks", form)
    }

    pub(super) fn count(&mut self, fields: &mut Fields<'_, '_>, what: &str, form: &str) -> Option<u32> {
        self.number_from(fields, 1, what, form)
    }

    /// Read a number of at least `low`.
    fn number_from(&mut self, fields: &mut Fields<'_, '_>, low: i32, what: &str, form: &str) -> Option<u32> {
        let number = self.number(fields, what, form)?;
        if number.value < low {
            let message = format!("{what} is {low} to {MOST}, {} found", number.value);
            self.problems.error_help("job.range", number.at, message, form);
            return None;
        }
        u32::try_from(number.value).ok()
    }

    /// Read a number from `low` to 1000.
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

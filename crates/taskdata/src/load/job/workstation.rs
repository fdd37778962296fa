//! The lines of a job that begin with `**`.

use interfaces::station::{DrumVerb, LineVerb as Verb};

use super::{
    Step,
    action::{Drum, Offset, Workstation},
    fields::Fields,
    read::{MOST, Reader},
};

const TRAY_FORM: &str = "** tray UNIT SECTOR OBJECT, or with X Y ANGLE after it: 0.01 in and 0.01 degree from the centre of the sector";
const WAIT_FORM: &str = "** wait TICKS; a tick is 40 ms";
const AFTER_FORM: &str = "** after TICKS, then another line's words behind its **";

impl Reader<'_, '_> {
    pub(super) fn workstation(&mut self, fields: &mut Fields<'_, '_>) -> Option<Step> {
        let at = fields.at();
        match self.word(fields, "step of the workstation")? {
            Verb::After => {
                let ticks = self.ticks(fields, AFTER_FORM)?;
                let verb_at = fields.at();
                let verb = self.word(fields, "step of the workstation")?;
                if matches!(verb, Verb::After | Verb::Wait | Verb::HandOver) {
                    let message = "this action has its own duration and cannot follow after";
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

    /// A line that is not in a job cannot use the job's ticks, files or next command.
    pub(super) fn own_line(&mut self, fields: &mut Fields<'_, '_>) -> Option<Workstation> {
        let known: Vec<Verb> = Verb::ALL.iter().copied().filter(|verb| !verb.is_of_job()).collect();
        let texts: Vec<&str> = known.iter().map(|verb| verb.text()).collect();
        let at = self.choice(fields, "line for the cell", &texts)?;
        let verb = *known.get(at)?;
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
        let opening = self.word(fields, "opening of a vise");
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
        Some(match self.word(fields, "step of the drum")? {
            DrumVerb::Grip => Drum::Grip,
            DrumVerb::Release => Drum::Release,
            DrumVerb::Tool => {
                let tool = self.field(fields, "a tool")?;
                self.object(tool).then_some(Drum::Tool(tool.name))?
            }
        })
    }

    pub(super) fn ticks(&mut self, fields: &mut Fields<'_, '_>, form: &str) -> Option<u32> {
        self.count(fields, "a number of ticks", form)
    }

    pub(super) fn count(&mut self, fields: &mut Fields<'_, '_>, what: &str, form: &str) -> Option<u32> {
        self.number_from(fields, 1, what, form)
    }

    pub(super) fn number_from(
        &mut self,
        fields: &mut Fields<'_, '_>,
        low: i32,
        what: &str,
        form: &str,
    ) -> Option<u32> {
        let number = self.number(fields, what, form)?;
        if number.value < low {
            let message = format!("{what} is {low} to {MOST}, {} found", number.value);
            self.problems.error_help("job.range", number.at, message, form);
            return None;
        }
        u32::try_from(number.value).ok()
    }
}

//! Events of the cell, found by comparing two of its published views. Logs contain events as lines; shared
//! memory contains only states.

use executive::memory::cell::{CellView, PartView};
use plant::{CellEvent, Cut, EStop, t3::RobotEvent};
use rcs_core::tick::Tick;
use record::{Level, reader::LogLine};
use runtime::event::Event;

/// Location of a part that lies on the floor.
const FLOOR: &str = "floor";
/// Code of a warning of the robot controller, as in a log.
const WARNING: &str = "cell.warning";

/// The events between two views, as the lines of a log, in the tick after the second view.
pub fn lines(before: &CellView, now: &CellView, tick: Tick) -> Vec<LogLine> {
    let (was, is) = (&before.controller, &now.controller);
    let mut lines = Vec::new();
    if was.cut != is.cut
        && let Some(cut) = cut(is.cut.as_str())
    {
        // A button is pressed between two ticks, so the pressure is lost in the second.
        let tick = if matches!(cut, Cut::EStop(_)) { tick.next() } else { tick };
        lines.push(line(tick, CellEvent::Robot(RobotEvent::Sinks(cut))));
    }
    if !is.screen.as_str().is_empty() && (was.screen, was.screen_tick) != (is.screen, is.screen_tick) {
        let (level, source, text) = (Level::Error, "cell".to_owned(), is.screen.to_string());
        lines.push(LogLine { tick, level, source, text, code: WARNING.to_owned() });
    }
    let lies = |part: &PartView| part.id > 0 && part.location.as_str() == FLOOR;
    let fell = before.parts.iter().zip(&now.parts).filter(|(was, is)| lies(is) && !lies(was));
    lines.extend(fell.map(|(_, part)| line(tick, CellEvent::Fell { part: part.name.to_string() })));
    lines
}

/// The loss of pressure that this text reports.
fn cut(text: &str) -> Option<Cut> {
    let others = [Cut::PressureLost, Cut::ManualOff, Cut::KeySwitch, Cut::ControlPower, Cut::PrimBox];
    EStop::ALL.iter().copied().map(Cut::EStop).chain(others).find(|cut| cut.to_string() == text)
}

fn line(tick: Tick, event: CellEvent) -> LogLine {
    let event = Event::Cell(event);
    LogLine {
        tick,
        level: event.level(),
        source: event.source().to_owned(),
        text: event.to_string(),
        code: event.code().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use executive::memory::Text;
    use rcs_core::name::Name16;

    #[test]
    fn losses_of_pressure_and_parts_become_lines_once() {
        let before = CellView::default();
        let mut now = before;
        now.controller.cut = Text::clipped(&Cut::EStop(EStop::JoystickBox).to_string());
        now.controller.screen = Text::clipped("the T3 controller shows WD1");
        let (id, name) = (1, Name16::clipped("LINKBAR1"));
        now.parts[0] = PartView { id, name, location: Name16::clipped(FLOOR), ..PartView::default() };
        let said = lines(&before, &now, Tick(8));
        let codes: Vec<_> = said.iter().map(|line| line.code.as_str()).collect();
        assert_eq!(codes, ["cell.emergency", WARNING, "cell.fell"]);
        let ticks: Vec<_> = said.iter().map(|line| line.tick).collect();
        assert_eq!(ticks, [Tick(9), Tick(8), Tick(8)], "as in the log of the run");
        assert!(said[0].text.contains("the E-stop on the joystick box was pressed"), "{said:?}");
        assert_eq!(lines(&now, &now, Tick(9)), []);
        assert_eq!(lines(&now, &before, Tick(9)), [], "a repair is not an event");
    }

    /// The views must contain the texts in full; otherwise the cause of a loss is not found.
    #[test]
    fn every_loss_of_pressure_is_found_by_its_text() {
        for site in EStop::ALL.iter().copied() {
            let cause = Cut::EStop(site);
            assert_eq!(cut(Text::<48>::clipped(&cause.to_string()).as_str()), Some(cause));
        }
    }
}

//! Compares two published views of the cell: logs contain events as lines, shared memory only states.

use executive::memory::cell::{CellView, PartView};
use plant::{CellEvent, Cut, EStop, t3::RobotEvent};
use rcs_core::tick::Tick;
use record::{Level, reader::LogLine};
use runtime::event::Event;

const FLOOR: &str = "floor";
const WARNING: &str = "cell.warning";

/// The events between two views, as the lines of a log. A line has the tick after that of its event. Without an earlier
/// view, only a present loss of pressure is an event.
pub fn lines(before: Option<&CellView>, now: &CellView) -> Vec<LogLine> {
    let cut_before = before.map_or(Tick::BEFORE_START, |before| before.controller.cut_tick);
    let is = &now.controller;
    let mut lines = Vec::new();
    if is.cut_tick > cut_before
        && let Some(cut) = cut(is.cut.as_str())
    {
        lines.push(line(is.cut_tick.next(), CellEvent::Robot(RobotEvent::Sinks(cut))));
    }
    let Some(before) = before else { return lines };
    // While FAULT RESET is lit, the screen shows the error of the lamp, which is not an event.
    if !is.lamps.fault_reset && is.screen_tick > before.controller.screen_tick {
        let (level, source, text) = (Level::Error, "cell".to_owned(), is.screen.to_string());
        lines.push(LogLine { tick: is.screen_tick.next(), level, source, text, code: WARNING.to_owned() });
    }
    let lies = |part: &PartView| part.id > 0 && part.location.as_str() == FLOOR;
    let fell = before.parts.iter().zip(&now.parts).filter(|(was, is)| lies(is) && !lies(was));
    let fell = fell.map(|(_, part)| CellEvent::Fell { part: part.name.to_string() });
    lines.extend(fell.map(|event| line(now.tick.next(), event)));
    lines
}

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

    fn view(tick: u64, (screen, screen_tick): (&str, u64), cut: Option<(Cut, u64)>) -> CellView {
        let mut view = CellView { tick: Tick(tick), ..CellView::default() };
        view.controller.screen = Text::clipped(screen);
        view.controller.screen_tick = Tick(screen_tick);
        if let Some((cut, tick)) = cut {
            view.controller.cut = Text::clipped(&cut.to_string());
            view.controller.cut_tick = Tick(tick);
            view.controller.lamps.fault_reset = true;
        }
        view
    }

    fn codes_and_ticks(lines: &[LogLine]) -> Vec<(&str, u64)> {
        lines.iter().map(|line| (line.code.as_str(), line.tick.0)).collect()
    }

    #[test]
    fn warnings_and_fallen_parts_become_lines_once() {
        let before = view(6, ("", 0), None);
        let mut now = view(7, ("the T3 controller shows WD1", 5), None);
        let (id, name) = (1, Name16::clipped("LINKBAR1"));
        now.parts[0] = PartView { id, name, location: Name16::clipped(FLOOR), ..PartView::default() };
        let said = lines(Some(&before), &now);
        assert_eq!(codes_and_ticks(&said), [(WARNING, 6), ("cell.fell", 8)], "as in the log of the run");
        assert_eq!(lines(Some(&now), &now), []);
        assert_eq!(lines(Some(&now), &before), [], "a repair is not an event");
    }

    /// The lamp lights up in the tick in which the button is pressed, one tick before the arm loses its pressure.
    #[test]
    fn emergency_stop_is_one_line_in_the_tick_of_the_log() {
        let cause = Some((Cut::EStop(EStop::JoystickBox), 8));
        let before = view(6, ("the T3 controller shows WD1", 3), None);
        let pressed = view(7, ("ERROR-E22", 7), cause);
        let said = lines(Some(&before), &pressed);
        assert_eq!(codes_and_ticks(&said), [("cell.emergency", 9)]);
        assert!(said[0].text.contains("the E-stop on the joystick box was pressed"), "{said:?}");
        assert_eq!(
            lines(Some(&before), &view(12, ("ERROR-E22", 7), cause)),
            said,
            "also if views were missed"
        );
        assert_eq!(lines(None, &pressed), said, "also for a console that starts later");
        let reset = view(20, ("the T3 controller shows WD1", 3), None);
        assert_eq!(lines(Some(&pressed), &reset), [], "the warning is an old one");
    }

    /// The views must contain the full texts. Otherwise the cause of a loss is not found.
    #[test]
    fn every_loss_of_pressure_is_found_by_its_text() {
        for site in EStop::ALL.iter().copied() {
            let cause = Cut::EStop(site);
            assert_eq!(cut(Text::<48>::clipped(&cause.to_string()).as_str()), Some(cause));
        }
    }
}

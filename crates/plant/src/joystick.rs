//! The joystick box (III.3.3) and the actions of its operator.
//!
//! Switches and knob keep their setting; stick and buttons return after their time. An action replaces the previous one
//! of the same control.

use interfaces::{
    device::{JoystickBox, KNOB_FULL},
    station::{BoxAction, BoxButton},
};
use serde::{Deserialize, Serialize};

const PRESS: u32 = 2; // duration of a short press, ticks: long enough for every process to read it
const PAUSE: u32 = 2; // ticks between two short presses of the same button

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
enum Held {
    Stick([i16; 2]),
    Button(#[serde(with = "crate::image::word")] BoxButton),
    Record,
    Resume,
    Step(u8),
}

#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub struct Joystick {
    velocity: u16,
    frame: u8,
    hold: u8,
    held: Vec<(Held, u32)>,
    steps: Vec<(u8, u32, u32)>, // step buttons: bits, remaining presses, and ticks until the next press
}

impl Default for Joystick {
    fn default() -> Self {
        Self { velocity: KNOB_FULL, frame: 0, hold: 0, held: Vec::new(), steps: Vec::new() }
    }
}

impl Joystick {
    pub fn act(&mut self, action: BoxAction) {
        match action {
            BoxAction::Frame(frame) => {
                self.frame = frame;
                if frame == 0 {
                    self.held.retain(|(held, _)| !held.moves());
                }
            }
            BoxAction::Velocity(velocity) => self.velocity = velocity.min(KNOB_FULL),
            BoxAction::Hold(processes) => self.hold |= processes,
            BoxAction::Free(processes) => self.hold &= !processes,
            BoxAction::Stick { x: 0, y: 0, .. } => self.hold_down(Held::Stick([0, 0]), 0),
            BoxAction::Stick { x, y, ticks } => self.hold_down(Held::Stick([x, y]), ticks),
            BoxAction::Press(button, ticks) => self.hold_down(Held::Button(button), ticks),
            BoxAction::Record => self.hold_down(Held::Record, PRESS),
            BoxAction::Resume => self.hold_down(Held::Resume, PRESS),
            BoxAction::Step(process, count) => self.steps.push((process, count, 0)),
        }
    }

    fn hold_down(&mut self, what: Held, ticks: u32) {
        self.held.retain(|(held, _)| !held.is_same_control(what));
        if ticks > 0 {
            self.held.push((what, ticks));
        }
    }

    /// True while a control is held down or presses remain.
    #[must_use]
    pub fn busy(&self) -> bool {
        !self.held.is_empty() || !self.steps.is_empty()
    }

    /// True while a control is held down, presses remain, or a frame is on: the box can move the robot.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.frame != 0 || self.busy()
    }

    /// Release stick and buttons, and switch the frame off; knob and switches keep their setting, so no motion
    /// accelerates.
    pub fn release(&mut self) {
        self.frame = 0;
        self.held.clear();
        self.steps.clear();
    }

    /// The box as the controller reads it in the next tick. Call it once per tick.
    pub fn read(&mut self) -> JoystickBox {
        for (process, count, wait) in &mut self.steps {
            if *wait == 0 {
                self.held.push((Held::Step(*process), PRESS));
                *count -= 1;
                *wait = PRESS + PAUSE;
            }
            *wait -= 1;
        }
        self.steps.retain(|(_, count, _)| *count > 0);
        let mut shown = JoystickBox {
            velocity: self.velocity,
            frame: self.frame,
            hold: self.hold,
            ..JoystickBox::default()
        };
        for (what, ticks) in &mut self.held {
            *ticks -= 1;
            what.show(&mut shown);
        }
        self.held.retain(|(_, ticks)| *ticks > 0);
        shown
    }
}

impl Held {
    const fn moves(self) -> bool {
        matches!(self, Self::Stick(_) | Self::Button(_))
    }

    fn is_same_control(self, other: Self) -> bool {
        self == other || matches!((self, other), (Self::Stick(_), Self::Stick(_)))
    }

    fn show(self, shown: &mut JoystickBox) {
        match self {
            Self::Stick([x, y]) => (shown.x, shown.y) = (x, y),
            Self::Button(BoxButton::Up) => shown.up = true,
            Self::Button(BoxButton::Down) => shown.down = true,
            Self::Button(BoxButton::RollPlus) => shown.roll_plus = true,
            Self::Button(BoxButton::RollMinus) => shown.roll_minus = true,
            Self::Button(BoxButton::Open) => shown.open = true,
            Self::Button(BoxButton::Close) => shown.close = true,
            Self::Record => shown.record = true,
            Self::Resume => shown.resume = true,
            Self::Step(process) => shown.single_step |= process,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::device::{joystick_frame, single_step};

    #[test]
    fn starting_box_is_off_with_full_knob() {
        let shown = Joystick::default().read();
        assert_eq!(shown, JoystickBox { velocity: KNOB_FULL, ..JoystickBox::default() });
    }

    #[test]
    fn switches_stay_and_the_stick_returns() {
        let mut joystick = Joystick::default();
        joystick.act(BoxAction::Frame(joystick_frame::WORLD));
        joystick.act(BoxAction::Velocity(5000));
        joystick.act(BoxAction::Stick { x: 700, y: -20, ticks: 3 });
        joystick.act(BoxAction::Press(BoxButton::Up, 1));
        let shown: Vec<_> = (0..5).map(|_| joystick.read()).collect();
        assert_eq!(
            shown.iter().map(|s| (s.x, s.y)).collect::<Vec<_>>(),
            [(700, -20), (700, -20), (700, -20), (0, 0), (0, 0)]
        );
        assert_eq!(shown.iter().map(|s| s.up).collect::<Vec<_>>(), [true, false, false, false, false]);
        assert!(shown.iter().all(|s| s.frame == joystick_frame::WORLD && s.velocity == KNOB_FULL));
        assert!(!joystick.busy());
    }

    /// Deflections of the stick in the next `N` ticks.
    fn deflections<const N: usize>(joystick: &mut Joystick) -> [(i16, i16); N] {
        std::array::from_fn(|_| {
            let shown = joystick.read();
            (shown.x, shown.y)
        })
    }

    #[test]
    fn new_deflection_replaces_the_old_one() {
        let mut joystick = Joystick::default();
        joystick.act(BoxAction::Stick { x: 0, y: 300, ticks: 250 });
        assert_eq!(deflections(&mut joystick), [(0, 300)]);
        joystick.act(BoxAction::Stick { x: 0, y: -300, ticks: 2 });
        assert_eq!(deflections(&mut joystick), [(0, -300), (0, -300), (0, 0), (0, 0)]);
        joystick.act(BoxAction::Press(BoxButton::Up, 9));
        joystick.act(BoxAction::Press(BoxButton::Up, 1));
        assert_eq!([joystick.read().up, joystick.read().up], [true, false]);
    }

    #[test]
    fn stick_at_the_centre_stops_at_once() {
        for ticks in [0, 1, 500] {
            let mut joystick = Joystick::default();
            joystick.act(BoxAction::Stick { x: 0, y: 300, ticks: 250 });
            joystick.act(BoxAction::Stick { x: 0, y: 0, ticks });
            assert!(!joystick.busy(), "{ticks}");
            assert_eq!(deflections(&mut joystick), [(0, 0), (0, 0)], "{ticks}");
        }
    }

    #[test]
    fn frame_switch_off_releases_stick_and_buttons() {
        let mut joystick = Joystick::default();
        joystick.act(BoxAction::Frame(joystick_frame::WORLD));
        joystick.act(BoxAction::Stick { x: 0, y: 300, ticks: 250 });
        joystick.act(BoxAction::Press(BoxButton::Down, 250));
        joystick.act(BoxAction::Record);
        joystick.act(BoxAction::Frame(joystick_frame::TOOL));
        assert_eq!(deflections(&mut joystick), [(0, 300)], "another frame changes the direction only");
        joystick.act(BoxAction::Frame(0));
        joystick.act(BoxAction::Frame(joystick_frame::WORLD));
        let shown = joystick.read();
        assert_eq!((shown.x, shown.y, shown.down), (0, 0, false));
        assert!(shown.record, "the record key moves nothing");
    }

    #[test]
    fn release_keeps_knob_and_hold_switches() {
        let mut joystick = Joystick::default();
        for action in [
            BoxAction::Frame(joystick_frame::WORLD),
            BoxAction::Velocity(300),
            BoxAction::Hold(single_step::PRIM),
            BoxAction::Step(single_step::PRIM, 5),
            BoxAction::Stick { x: 10, y: 0, ticks: 9 },
        ] {
            joystick.act(action);
        }
        assert!(joystick.is_held());
        joystick.release();
        assert!(!joystick.is_held());
        let kept = JoystickBox { velocity: 300, hold: single_step::PRIM, ..JoystickBox::default() };
        assert_eq!(joystick.read(), kept);
    }

    #[test]
    fn single_steps_have_pauses_between_them() {
        let mut joystick = Joystick::default();
        joystick.act(BoxAction::Hold(single_step::PRIM | single_step::TASK));
        joystick.act(BoxAction::Free(single_step::TASK));
        joystick.act(BoxAction::Step(single_step::PRIM, 3));
        assert!(joystick.busy());
        let shown: Vec<_> = (0..12).map(|_| joystick.read()).collect();
        assert!(shown.iter().all(|s| s.hold == single_step::PRIM));
        let rises = shown.windows(2).filter(|w| w[0].single_step == 0 && w[1].single_step != 0).count();
        assert_eq!((shown[0].single_step, rises), (single_step::PRIM, 2), "three presses");
        assert!(!joystick.busy());
    }

    #[test]
    fn every_button_shows_on_its_own_line() {
        let buttons = [
            BoxAction::Press(BoxButton::Up, 1),
            BoxAction::Press(BoxButton::Down, 1),
            BoxAction::Press(BoxButton::RollPlus, 1),
            BoxAction::Press(BoxButton::RollMinus, 1),
            BoxAction::Press(BoxButton::Open, 1),
            BoxAction::Press(BoxButton::Close, 1),
            BoxAction::Record,
            BoxAction::Resume,
        ];
        for (index, action) in buttons.into_iter().enumerate() {
            let mut joystick = Joystick::default();
            joystick.act(action);
            let s = joystick.read();
            let lines = [s.up, s.down, s.roll_plus, s.roll_minus, s.open, s.close, s.record, s.resume];
            let on: Vec<usize> = (0..lines.len()).filter(|line| lines[*line]).collect();
            assert_eq!(on, [index]);
        }
    }
}

use interfaces::{
    device::KNOB_FULL,
    station::{BoxFrame, Stepped},
};

use super::condition::{HOME, Sight, TOLERANCE, largest, rows};
use crate::rcs_console::model::{Text, Tone, cell};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    Nothing,
    /// The screen of the robot controller.
    Screen,
    /// Its line of aligned axes.
    Aligned,
    /// `frame-feedback` next to HOME.
    Frame,
    /// `tp-xyz`, `wr->tp` and `tp->fp`, input and output.
    Frames,
    /// Position of the hand, and the distance it has moved since the step began.
    Hand,
    Holsters,
    Box,
    /// Table and hand of the pedestal.
    Pedestal,
    /// The last request to vision and its answer.
    Vision,
}

impl Show {
    #[must_use]
    pub fn lines(self, sight: &Sight<'_>) -> Vec<Text> {
        match self {
            Self::Nothing => Vec::new(),
            Self::Screen => screen(sight),
            Self::Aligned => aligned(sight),
            Self::Frame => frame(sight),
            Self::Frames => frames(sight),
            Self::Hand => vec![hand(sight)],
            Self::Holsters => vec![holsters(sight)],
            Self::Box => vec![joystick_box(sight)],
            Self::Pedestal => vec![pedestal(sight)],
            Self::Vision => vec![vision(sight)],
        }
    }
}

fn screen(sight: &Sight<'_>) -> Vec<Text> {
    let Some(controller) = sight.shown() else { return Vec::new() };
    let mut lines = vec![Text::plain(format!("the robot controller: {}", controller.stage))];
    if !controller.screen.as_str().is_empty() {
        lines.push(Text::plain(format!(
            "its screen since tick {}: {}",
            controller.screen_tick, controller.screen
        )));
    }
    if !controller.cut.as_str().is_empty() {
        lines.push(Text::plain(format!("no pressure: {}", controller.cut)));
    }
    lines
}

fn aligned(sight: &Sight<'_>) -> Vec<Text> {
    let Some(controller) = sight.shown() else { return Vec::new() };
    let stars: Vec<_> = controller.aligned.iter().map(|axis| if *axis { "*" } else { " " }).collect();
    vec![
        Text::plain("* = ALIGNED   1 2 3 4 5 6"),
        Text::plain(format!("              {}", stars.join(" ").trim_end())),
    ]
}

fn frame(sight: &Sight<'_>) -> Vec<Text> {
    let is = sight.frame_feedback();
    let mut lines = vec![Text::plain("       is               should be        off by")];
    for (is, should) in rows(&is).into_iter().zip(rows(&HOME)) {
        let three = |values: [i32; 3], width: usize| -> String {
            values.iter().map(|value| format!("{value:>width$}")).collect()
        };
        let off: [i32; 3] = std::array::from_fn(|at| (is[at] - should[at]).abs());
        lines.push(Text::plain(format!("{} {} {}", three(is, 6), three(should, 6), three(off, 5))));
    }
    let off = largest(&is, &HOME);
    lines.push(match off <= TOLERANCE {
        true => Text::plain(format!("the largest is {off}, at most {TOLERANCE} is right")),
        false => Text::new(Tone::Trouble, format!("the largest is {off}; at most {TOLERANCE} is right")),
    });
    lines
}

fn frames(sight: &Sight<'_>) -> Vec<Text> {
    let (got, given) = sight.prim_frames();
    let names = ["tp-xyz-input, -output", "wr->tp-in, -out", "tp->fp-in, -out"];
    let line = |((name, [a, b, c]), [d, e, f]): ((&str, [i32; 3]), [i32; 3])| {
        Text::plain(format!("{name:<22}{a:>6}{b:>6}{c:>6}  {d:>6}{e:>6}{f:>6}"))
    };
    let mut lines: Vec<_> = names.into_iter().zip(rows(&got)).zip(rows(&given)).map(line).collect();
    lines.push(Text::plain(format!(
        "the largest difference is {}, at most {TOLERANCE} is right",
        largest(&got, &given)
    )));
    lines
}

fn hand(sight: &Sight<'_>) -> Text {
    let Some(tool) = sight.tool() else { return Text::plain("the resolvers have no power") };
    let [x, y, z] = tool.map(inches);
    let way = sight
        .way()
        .map_or_else(String::new, |way| format!("; {:.2} in from where the step began", inches(way)));
    let rest = match sight.shown() {
        Some(controller) if controller.at_rest => "; it stands",
        Some(_) => "; it moves",
        None => "",
    };
    Text::plain(format!("hand at {x:.2} {y:.2} {z:.2} in{way}{rest}"))
}

fn inches(hundredths: i32) -> f64 {
    f64::from(hundredths) / 100.0
}

fn holsters(sight: &Sight<'_>) -> Text {
    let sensors = &sight.picture.external.devices.holsters;
    let [right, left, centre] = [sensors.right, sensors.left, sensors.centre].map(cell::holster);
    Text::plain(format!("holsters: right {right}, left {left}, centre {centre}"))
}

fn joystick_box(sight: &Sight<'_>) -> Text {
    let joystick = sight.joystick();
    let knob = u32::from(joystick.velocity) * 100 / u32::from(KNOB_FULL);
    let frames = BoxFrame::ALL.iter().filter(|frame| joystick.frame & frame.bits() != 0);
    let holds = Stepped::ALL.iter().filter(|process| joystick.hold & process.bit() != 0);
    let listed = |names: Vec<&str>| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let frame = listed(frames.map(|frame| frame.text()).collect());
    let hold = listed(holds.map(|process| process.process().text()).collect());
    Text::plain(format!("joystick box: knob {knob} %, frame {frame}, held {hold}"))
}

fn pedestal(sight: &Sight<'_>) -> Text {
    let memory = &sight.picture.memory;
    let table = &memory.table.status;
    let angle = table.position.map_or_else(
        || "its angle is not known".to_owned(),
        |tenths| format!("{:.1} degrees", f64::from(tenths) / 10.0),
    );
    let hand = if memory.hand.status.initialized { "calibrated" } else { "not calibrated" };
    Text::plain(format!("rotary table: {angle}, {}; hand: {hand}", table.report))
}

fn vision(sight: &Sight<'_>) -> Text {
    let (asked, answer) = (&sight.picture.memory.emove.vision, &sight.picture.external.devices.vision);
    Text::plain(format!(
        "request {} {}, object {}; answer to {}: {}",
        asked.number, asked.picture, asked.object_id, answer.echo, answer.status
    ))
}

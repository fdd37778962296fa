//! Drawings of the page: lanes, curves and paths as SVG. Coordinates are pixels of a drawing [`WIDTH`] wide.

use std::fmt::Write as _;

use rcs_core::tick::TICK_S;

use super::gather::Stretch;

/// Width of a drawing.
pub const WIDTH: f64 = 1200.0;
/// Room for names on the left.
const LEFT: f64 = 118.0;
/// Height of a lane.
const LANE: f64 = 26.0;
/// Points of a curve at most: more are not seen.
const POINTS: usize = 1200;
/// Divisions of an axis, about.
const DIVISIONS: f64 = 10.0;

/// Text that is safe in HTML.
#[must_use]
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Where a tick stands in a drawing over the whole run.
#[derive(Clone, Copy)]
pub struct TimeAxis {
    first: f64,
    last: f64,
}

impl TimeAxis {
    /// The axis of a run from its first to its last tick.
    #[must_use]
    pub const fn new(first: u64, last: u64) -> Self {
        Self { first: first as f64, last: last as f64 }
    }

    fn x(self, tick: f64) -> f64 {
        let share = (tick - self.first) / (self.last - self.first).max(1.0);
        LEFT + share * (WIDTH - LEFT)
    }

    /// Seconds that are worth a line.
    fn seconds(self) -> Vec<f64> {
        let step = division((self.last - self.first) * TICK_S);
        let first = (self.first * TICK_S / step).ceil();
        let at = |index: i32| (first + f64::from(index)) * step;
        (0..40).map(at).take_while(|seconds| *seconds <= self.last * TICK_S).collect()
    }
}

/// A round number that divides a range into about [`DIVISIONS`].
fn division(range: f64) -> f64 {
    let rough = (range / DIVISIONS).max(1e-3);
    let power = 10f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|step| *step >= rough)
        .unwrap_or(power)
}

/// The seconds below drawings over the whole run.
#[must_use]
pub fn scale(axis: TimeAxis) -> String {
    let mut out = format!("<svg viewBox=\"0 0 {WIDTH} 18\" aria-hidden=\"true\">");
    for seconds in axis.seconds() {
        let x = axis.x(seconds / TICK_S);
        let anchor = if x > WIDTH - 30.0 { "end" } else { "middle" };
        let _ = write!(
            out,
            "<text class=\"scale\" text-anchor=\"{anchor}\" x=\"{x:.1}\" y=\"12\">{seconds} s</text>"
        );
    }
    out + "</svg>\n"
}

fn grid(axis: TimeAxis, height: f64) -> String {
    axis.seconds().into_iter().fold(String::new(), |mut out, seconds| {
        let x = axis.x(seconds / TICK_S);
        let _ = write!(out, "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"0\" y2=\"{height:.1}\"/>");
        out
    })
}

/// Something that happened in a tick.
pub struct Mark<'a> {
    /// The tick.
    pub tick: u64,
    /// An error, or only a warning.
    pub error: bool,
    /// What it was.
    pub text: &'a str,
}

/// Lanes under one another, a box a stretch; a command in words where it fits, and as a tool tip everywhere. Marks go through
/// all lanes.
#[must_use]
pub fn lanes(lanes: &[(&str, Vec<Stretch>)], marks: &[Mark<'_>], axis: TimeAxis) -> String {
    let height = LANE * lanes.len() as f64;
    let mut out = format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">{}\n", grid(axis, height));
    for (index, (name, stretches)) in lanes.iter().enumerate() {
        let top = index as f64 * LANE;
        let _ = writeln!(out, "<text x=\"0\" y=\"{:.1}\">{}</text>", top + 17.0, escape(name));
        for stretch in stretches.iter().filter(|stretch| !stretch.text.is_empty()) {
            put_stretch(stretch, top, axis, &mut out);
        }
    }
    for Mark { tick, error, text } in marks {
        let (x, class) = (axis.x(*tick as f64), if *error { "mark" } else { "mark warn" });
        let _ = writeln!(
            out,
            "<g><title>tick {tick}: {}</title><line class=\"{class}\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"0\" y2=\"{height}\"/></g>",
            escape(text)
        );
    }
    out + "</svg>\n"
}

fn put_stretch(stretch: &Stretch, top: f64, axis: TimeAxis, out: &mut String) {
    let (from, to) = (axis.x(stretch.from as f64), axis.x(stretch.to as f64 + 1.0));
    let (width, text) = ((to - from).max(0.5), escape(&stretch.text));
    let steps: String =
        stretch.steps.iter().map(|(tick, step)| format!("\ntick {tick}: {}", escape(step))).collect();
    let _ = write!(
        out,
        "<g><title>{text}, ticks {} to {}{steps}</title><rect class=\"box c{}\" x=\"{from:.1}\" y=\"{:.1}\" width=\"{width:.1}\" \
         height=\"{:.1}\" rx=\"2\"/>",
        stretch.from,
        stretch.to,
        color(&stretch.text),
        top + 3.0,
        LANE - 6.0
    );
    // About six pixels a letter.
    let letters = (width / 6.5) as usize;
    if letters > 3 {
        let short: String = stretch.text.chars().take(letters).collect();
        let _ = write!(
            out,
            "<text class=\"in\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            from + 4.0,
            top + 17.0,
            escape(&short)
        );
    }
    out.push_str("</g>\n");
}

/// The same word has the same colour wherever it stands.
fn color(text: &str) -> usize {
    let word = text.split(' ').next().unwrap_or_default();
    word.bytes().fold(7_usize, |sum, byte| (sum * 31 + usize::from(byte)) % 1009) % 8
}

/// A curve over the run.
pub struct Curve<'a> {
    /// What is drawn.
    pub name: &'a str,
    /// Its unit.
    pub unit: &'a str,
    /// One value a tick.
    pub values: &'a [f64],
    /// Limit that is drawn as a line.
    pub limit: Option<f64>,
}

/// A curve with its scale on the left, and its limit.
#[must_use]
pub fn curve(curve: &Curve<'_>, ticks: &[u64], axis: TimeAxis) -> String {
    const HEIGHT: f64 = 92.0;
    const BASE: f64 = HEIGHT - 6.0;
    let most = curve.values.iter().copied().fold(curve.limit.unwrap_or(0.0), f64::max).max(1e-9);
    let y = |value: f64| BASE - value.max(0.0) / most * (HEIGHT - 22.0);
    let mut out = format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\">{}", grid(axis, HEIGHT));
    let _ = writeln!(
        out,
        "<text x=\"0\" y=\"18\">{}</text><text class=\"scale\" x=\"0\" y=\"34\">{}, to {most:.2}</text>\
         <line class=\"axis\" x1=\"{LEFT}\" x2=\"{WIDTH}\" y1=\"{BASE}\" y2=\"{BASE}\"/>",
        escape(curve.name),
        escape(curve.unit)
    );
    let points: Vec<(f64, f64)> = thinned(ticks, curve.values)
        .into_iter()
        .map(|(tick, value)| (axis.x(tick as f64), y(value)))
        .collect();
    let _ =
        writeln!(out, "<polygon class=\"area\" points=\"{LEFT},{BASE} {}{WIDTH},{BASE}\"/>", list(&points));
    let _ = writeln!(out, "<polyline class=\"curve\" points=\"{}\"/>", list(&points));
    if let Some(limit) = curve.limit {
        let _ = writeln!(
            out,
            "<line class=\"limit\" x1=\"{LEFT}\" x2=\"{WIDTH}\" y1=\"{0:.1}\" y2=\"{0:.1}\"/>\
             <text class=\"limit-text\" x=\"0\" y=\"50\">limit {limit}</text>",
            y(limit)
        );
    }
    out + "</svg>\n"
}

/// At most [`POINTS`] of a series, the greatest of each group: peaks must not be lost.
fn thinned(ticks: &[u64], values: &[f64]) -> Vec<(u64, f64)> {
    let step = values.len().div_ceil(POINTS).max(1);
    let greatest = |(ticks, values): (&[u64], &[f64])| {
        let most = values.iter().copied().fold(f64::MIN, f64::max);
        (ticks.first().copied().unwrap_or_default(), most)
    };
    ticks.chunks(step).zip(values.chunks(step)).map(greatest).collect()
}

fn list(points: &[(f64, f64)]) -> String {
    points.iter().fold(String::new(), |mut out, (x, y)| {
        let _ = write!(out, "{x:.1},{y:.1} ");
        out
    })
}

/// A path seen along an axis: `seen` takes the coordinates that are drawn, across and up, from a point. `stops` are places worth
/// a dot.
#[must_use]
pub fn path(
    title: &str,
    points: &[[f64; 3]],
    stops: &[[f64; 3]],
    seen: impl Fn(&[f64; 3]) -> [f64; 2],
) -> String {
    const SIZE: f64 = 560.0;
    const MARGIN: f64 = 26.0;
    // Before the link runs no frame has been commanded.
    let known: Vec<[f64; 2]> = points.iter().filter(|point| **point != [0.0; 3]).map(&seen).collect();
    let (mut least, mut most) = ([f64::MAX; 2], [f64::MIN; 2]);
    for axis in 0..2 {
        for point in &known {
            (least[axis], most[axis]) = (least[axis].min(point[axis]), most[axis].max(point[axis]));
        }
    }
    let mut out = format!("<figure><svg viewBox=\"0 0 {SIZE} {SIZE}\" role=\"img\">");
    if let (Some(first), Some(_)) = (known.first(), known.get(1)) {
        let range = (most[0] - least[0]).max(most[1] - least[1]).max(1.0);
        let middle = [0, 1].map(|axis| f64::midpoint(least[axis], most[axis]));
        let place = |point: [f64; 2]| {
            let share = [(point[0] - middle[0]) / range, (middle[1] - point[1]) / range];
            (
                share[0].mul_add(SIZE - 2.0 * MARGIN, SIZE / 2.0),
                share[1].mul_add(SIZE - 2.0 * MARGIN, SIZE / 2.0),
            )
        };
        put_net(middle, range, place, SIZE, &mut out);
        let step = known.len().div_ceil(4 * POINTS).max(1);
        let line: Vec<(f64, f64)> = known.iter().step_by(step).map(|point| place(*point)).collect();
        let _ = write!(out, "<polyline class=\"path\" points=\"{}\"/>", list(&line));
        for (x, y) in stops.iter().filter(|stop| **stop != [0.0; 3]).map(|stop| place(seen(stop))) {
            let _ = write!(out, "<circle class=\"dot\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\"/>");
        }
        let (x, y) = place(*first);
        let _ = write!(
            out,
            "<circle class=\"start\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"><title>start</title></circle>"
        );
    }
    format!("{out}</svg><figcaption>{}</figcaption></figure>\n", escape(title))
}

/// Lines at round numbers, with the numbers.
fn put_net(
    middle: [f64; 2],
    range: f64,
    place: impl Fn([f64; 2]) -> (f64, f64),
    size: f64,
    out: &mut String,
) {
    let step = division(range);
    for index in -12_i32..=12 {
        let x = ((middle[0] / step).round() + f64::from(index)) * step;
        let y = ((middle[1] / step).round() + f64::from(index)) * step;
        let (across, down) = (place([x, middle[1]]).0, place([middle[0], y]).1);
        if (0.0..=size).contains(&across) {
            let _ = write!(
                out,
                "<line class=\"grid\" x1=\"{across:.1}\" x2=\"{across:.1}\" y1=\"0\" y2=\"{size}\"/>\
                 <text class=\"scale\" text-anchor=\"middle\" x=\"{across:.1}\" y=\"{:.1}\">{x}</text>",
                size - 4.0
            );
        }
        if (0.0..=size).contains(&down) {
            let _ = write!(
                out,
                "<line class=\"grid\" x1=\"0\" x2=\"{size}\" y1=\"{down:.1}\" y2=\"{down:.1}\"/>\
                 <text class=\"scale\" x=\"3\" y=\"{:.1}\">{y}</text>",
                down - 3.0
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_a_log_cannot_become_markup() {
        assert_eq!(escape("<b a=\"1\">&"), "&lt;b a=&quot;1&quot;&gt;&amp;");
        let stretches =
            vec![Stretch { from: 1, to: 100, text: "<script>".into(), steps: vec![(2, "a<b".into())] }];
        let marks = [Mark { tick: 5, error: true, text: "<script>" }];
        let drawn = lanes(&[("Task", stretches)], &marks, TimeAxis::new(1, 100));
        assert!(!drawn.contains("<script>") && drawn.contains("\ntick 2: a&lt;b</title>"), "{drawn}");
    }

    #[test]
    fn peaks_survive_thinning() {
        let ticks: Vec<u64> = (1..=50_000).collect();
        let mut values = vec![0.0; 50_000];
        values[31_234] = 13.9;
        let thin = thinned(&ticks, &values);
        assert!(thin.len() <= POINTS);
        assert!(thin.iter().any(|(_, value)| (*value - 13.9).abs() < 1e-12));
    }

    #[test]
    fn the_axis_ends_at_the_edges_and_has_round_numbers() {
        let axis = TimeAxis::new(10, 20);
        assert!((axis.x(10.0) - LEFT).abs() < 1e-9 && (axis.x(20.0) - WIDTH).abs() < 1e-9);
        assert_eq!(TimeAxis::new(1, 33_000).seconds()[..3], [200.0, 400.0, 600.0]);
    }

    #[test]
    fn a_path_without_points_is_an_empty_picture() {
        assert!(!path("nowhere", &[[0.0; 3]], &[], |p| [p[0], p[1]]).contains("polyline"));
        let corner = [[1.0, 0.0, 0.0], [2.0, 5.0, 0.0]];
        assert!(path("somewhere", &corner, &corner, |p| [p[0], p[1]]).contains("polyline"));
    }
}

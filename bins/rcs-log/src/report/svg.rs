//! Lanes, curves and paths of the page as SVG. Coordinates are pixels of a drawing [`WIDTH`] wide.

use maud::{Markup, html};
use rcs_core::tick::TICK_S;

use super::gather::Stretch;

/// Width of a drawing.
pub const WIDTH: f64 = 1200.0;
/// Width of the column for names on the left.
const LEFT: f64 = 118.0;
/// Height of a lane.
const LANE: f64 = 26.0;
/// Greatest number of points of a curve; more would not be visible.
const POINTS: usize = 1200;
/// Approximate number of divisions of an axis.
const DIVISIONS: f64 = 10.0;

/// Horizontal axis of a drawing of the whole run: position of a tick.
#[derive(Clone, Copy)]
pub struct TimeAxis {
    first: f64,
    last: f64,
}

impl TimeAxis {
    /// The axis from the first to the last tick of a run.
    #[must_use]
    pub const fn new(first: u64, last: u64) -> Self {
        Self { first: first as f64, last: last as f64 }
    }

    fn x(self, tick: f64) -> f64 {
        let share = (tick - self.first) / (self.last - self.first).max(1.0);
        LEFT + share * (WIDTH - LEFT)
    }

    /// Times of the grid lines, s.
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

/// A coordinate with one decimal.
fn px(value: f64) -> String {
    format!("{value:.1}")
}

/// Time labels in seconds below the drawings.
#[must_use]
pub fn scale(axis: TimeAxis) -> Markup {
    html! {
        svg viewBox=(format_args!("0 0 {WIDTH} 18")) aria-hidden="true" {
            @for seconds in axis.seconds() {
                @let x = axis.x(seconds / TICK_S);
                @let anchor = if x > WIDTH - 30.0 { "end" } else { "middle" };
                text.scale text-anchor=(anchor) x=(px(x)) y="12" { (format_args!("{seconds} s")) }
            }
        }
    }
}

fn grid(axis: TimeAxis, height: f64) -> Markup {
    html! {
        @for seconds in axis.seconds() {
            @let x = px(axis.x(seconds / TICK_S));
            line.grid x1=(x) x2=(x) y1="0" y2=(px(height)) {}
        }
    }
}

/// An event in a tick.
pub struct Mark<'a> {
    /// The tick.
    pub tick: u64,
    /// True for an error, false for a warning.
    pub error: bool,
    /// Description of the event.
    pub text: &'a str,
}

/// Lanes one above the other, with a box for each stretch. The command is written in the box if it fits, and is always
/// its tool tip. Marks cross all lanes.
#[must_use]
pub fn lanes(lanes: &[(&str, Vec<Stretch>)], marks: &[Mark<'_>], axis: TimeAxis) -> Markup {
    let height = LANE * lanes.len() as f64;
    html! {
        svg viewBox=(format_args!("0 0 {WIDTH} {height}")) role="img" {
            (grid(axis, height))
            @for (index, (name, stretches)) in lanes.iter().enumerate() {
                @let top = index as f64 * LANE;
                text x="0" y=(px(top + 17.0)) { (name) }
                @for stretch in stretches.iter().filter(|stretch| !stretch.text.is_empty()) {
                    (boxed(stretch, top, axis))
                }
            }
            @for Mark { tick, error, text } in marks {
                @let x = px(axis.x(*tick as f64));
                g {
                    title { "tick " (tick) ": " (text) }
                    line class=(if *error { "mark" } else { "mark warn" }) x1=(x) x2=(x) y1="0" y2=(height) {}
                }
            }
        }
    }
}

fn boxed(stretch: &Stretch, top: f64, axis: TimeAxis) -> Markup {
    let (from, to) = (axis.x(stretch.from as f64), axis.x(stretch.to as f64 + 1.0));
    let width = (to - from).max(0.5);
    // A letter is about six pixels wide.
    let letters = (width / 6.5) as usize;
    html! {
        g {
            title {
                (stretch.text) ", ticks " (stretch.from) " to " (stretch.to)
                @for (tick, step) in &stretch.steps { "\ntick " (tick) ": " (step) }
            }
            rect class=(format_args!("box c{}", color(&stretch.text))) x=(px(from)) y=(px(top + 3.0))
                width=(px(width)) height=(px(LANE - 6.0)) rx="2" {}
            @if letters > 3 {
                text.in x=(px(from + 4.0)) y=(px(top + 17.0)) {
                    (stretch.text.chars().take(letters).collect::<String>())
                }
            }
        }
    }
}

/// Chooses a colour by the first word, so that a command has the same colour everywhere.
fn color(text: &str) -> usize {
    let word = text.split(' ').next().unwrap_or_default();
    word.bytes().fold(7_usize, |sum, byte| (sum * 31 + usize::from(byte)) % 1009) % 8
}

/// A curve over the run.
pub struct Curve<'a> {
    /// Name of the quantity.
    pub name: &'a str,
    /// Unit of the values.
    pub unit: &'a str,
    /// One value per tick.
    pub values: &'a [f64],
    /// Limit, drawn as a line.
    pub limit: Option<f64>,
}

/// Draws a curve with its scale on the left, and its limit.
#[must_use]
pub fn curve(curve: &Curve<'_>, ticks: &[u64], axis: TimeAxis) -> Markup {
    const HEIGHT: f64 = 92.0;
    const BASE: f64 = HEIGHT - 6.0;
    let most = curve.values.iter().copied().fold(curve.limit.unwrap_or(0.0), f64::max).max(1e-9);
    let y = |value: f64| BASE - value.max(0.0) / most * (HEIGHT - 22.0);
    let points: Vec<(f64, f64)> = thinned(ticks, curve.values)
        .into_iter()
        .map(|(tick, value)| (axis.x(tick as f64), y(value)))
        .collect();
    let line = list(&points);
    html! {
        svg viewBox=(format_args!("0 0 {WIDTH} {HEIGHT}")) role="img" {
            (grid(axis, HEIGHT))
            text x="0" y="18" { (curve.name) }
            text.scale x="0" y="34" { "to " (format_args!("{most:.2} {}", curve.unit)) }
            line.axis x1=(LEFT) x2=(WIDTH) y1=(BASE) y2=(BASE) {}
            polygon.area points=(format_args!("{LEFT},{BASE} {line}{WIDTH},{BASE}")) {}
            polyline.curve points=(line) {}
            @if let Some(limit) = curve.limit {
                line.limit x1=(LEFT) x2=(WIDTH) y1=(px(y(limit))) y2=(px(y(limit))) {}
                text.limit-text x="0" y="50" { "limit " (limit) " " (curve.unit) }
            }
        }
    }
}

/// At most [`POINTS`] of a series: the greatest value of each group, so that peaks remain visible.
fn thinned(ticks: &[u64], values: &[f64]) -> Vec<(u64, f64)> {
    let step = values.len().div_ceil(POINTS).max(1);
    let greatest = |(ticks, values): (&[u64], &[f64])| {
        let most = values.iter().copied().fold(f64::MIN, f64::max);
        (ticks.first().copied().unwrap_or_default(), most)
    };
    ticks.chunks(step).zip(values.chunks(step)).map(greatest).collect()
}

fn list(points: &[(f64, f64)]) -> String {
    points.iter().map(|(x, y)| format!("{x:.1},{y:.1} ")).collect()
}

/// Maps points of a path to a square drawing.
struct Square {
    middle: [f64; 2],
    range: f64,
}

impl Square {
    /// Width and height, pixels.
    const SIZE: f64 = 560.0;
    const MARGIN: f64 = 26.0;

    /// A square that shows all points; `None` without points.
    fn around(points: &[[f64; 2]]) -> Option<Self> {
        let (mut least, mut most) = ([f64::MAX; 2], [f64::MIN; 2]);
        for axis in 0..2 {
            for point in points {
                (least[axis], most[axis]) = (least[axis].min(point[axis]), most[axis].max(point[axis]));
            }
        }
        let range = (most[0] - least[0]).max(most[1] - least[1]).max(1.0);
        let middle = [0, 1].map(|axis| f64::midpoint(least[axis], most[axis]));
        (points.len() > 1).then_some(Self { middle, range })
    }

    fn place(&self, point: [f64; 2]) -> (f64, f64) {
        let at = |share: f64| (share / self.range).mul_add(Self::SIZE - 2.0 * Self::MARGIN, Self::SIZE / 2.0);
        (at(point[0] - self.middle[0]), at(self.middle[1] - point[1]))
    }

    /// Round numbers along an axis of the drawing (0 horizontal, 1 vertical), each with its position.
    fn divisions(&self, axis: usize) -> Vec<(f64, f64)> {
        let step = division(self.range);
        let value = |index: i32| ((self.middle[axis] / step).round() + f64::from(index)) * step;
        let placed = |value: f64| {
            let place = self.place([value; 2]);
            (value, if axis == 0 { place.0 } else { place.1 })
        };
        let inside = |(_, at): &(f64, f64)| (0.0..=Self::SIZE).contains(at);
        (-12..=12).map(|index| placed(value(index))).filter(inside).collect()
    }
}

/// Draws a path along an axis: `seen` converts a point to its horizontal and vertical coordinate. Each point of `stops`
/// gets a dot, and `ring` gets a ring with a text.
#[must_use]
pub fn path(
    title: &str,
    points: &[[f64; 3]],
    stops: &[[f64; 3]],
    ring: Option<([f64; 3], &str)>,
    seen: impl Fn(&[f64; 3]) -> [f64; 2],
) -> Markup {
    const SIZE: f64 = Square::SIZE;
    // No frame is commanded before the link runs.
    let known = |points: &[[f64; 3]]| -> Vec<[f64; 2]> {
        points.iter().filter(|point| **point != [0.0; 3]).map(&seen).collect()
    };
    let (points, stops) = (known(points), known(stops));
    let step = points.len().div_ceil(4 * POINTS).max(1);
    html! {
        figure {
            svg viewBox=(format_args!("0 0 {SIZE} {SIZE}")) role="img" {
                @if let Some(square) = Square::around(&points) {
                    @for (value, x) in square.divisions(0) {
                        line.grid x1=(px(x)) x2=(px(x)) y1="0" y2=(SIZE) {}
                        text.scale text-anchor="middle" x=(px(x)) y=(px(SIZE - 4.0)) { (value) }
                    }
                    @for (value, y) in square.divisions(1) {
                        line.grid x1="0" x2=(SIZE) y1=(px(y)) y2=(px(y)) {}
                        text.scale x="3" y=(px(y - 3.0)) { (value) }
                    }
                    @let line: Vec<_> = points.iter().step_by(step).map(|point| square.place(*point)).collect();
                    polyline.path points=(list(&line)) {}
                    @for (x, y) in stops.iter().map(|stop| square.place(*stop)) {
                        circle.dot cx=(px(x)) cy=(px(y)) r="2.6" {}
                    }
                    @if let Some((point, text)) = ring {
                        @let (x, y) = square.place(seen(&point));
                        g {
                            title { (text) }
                            circle.ring cx=(px(x)) cy=(px(y)) r="8" {}
                        }
                    }
                    @for (x, y) in points.iter().take(1).map(|start| square.place(*start)) {
                        circle.start cx=(px(x)) cy=(px(y)) r="4" { title { "start" } }
                    }
                }
            }
            figcaption { (title) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_a_log_cannot_become_markup() {
        let stretches =
            vec![Stretch { from: 1, to: 100, text: "<script>".into(), steps: vec![(2, "a<b".into())] }];
        let marks = [Mark { tick: 5, error: true, text: "<script>" }];
        let drawn = lanes(&[("Task", stretches)], &marks, TimeAxis::new(1, 100)).into_string();
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
        assert!(
            !path("nowhere", &[[0.0; 3]], &[], None, |p| [p[0], p[1]]).into_string().contains("polyline")
        );
        let corner = [[1.0, 0.0, 0.0], [2.0, 5.0, 0.0]];
        let drawn =
            path("somewhere", &corner, &corner, Some((corner[1], "a<b")), |p| [p[0], p[1]]).into_string();
        assert!(drawn.contains("polyline") && drawn.contains("<title>a&lt;b</title>"), "{drawn}");
    }
}

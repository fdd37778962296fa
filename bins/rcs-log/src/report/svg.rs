//! Drawings of the page: lanes, curves and paths as SVG. Coordinates are pixels of a drawing [`WIDTH`] wide.

use std::fmt::Write as _;

use super::gather::Stretch;

/// Width of a drawing.
pub const WIDTH: f64 = 1200.0;
/// Room for names on the left.
const LEFT: f64 = 110.0;
/// Height of a lane.
const LANE: f64 = 26.0;
/// Points of a curve at most: more are not seen.
const POINTS: usize = 1200;

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

    fn x(self, tick: u64) -> f64 {
        let share = (tick as f64 - self.first) / (self.last - self.first).max(1.0);
        LEFT + share * (WIDTH - LEFT)
    }
}

/// Lanes under one another, a box a stretch; a command in words where it fits, and as a tool tip everywhere.
#[must_use]
pub fn lanes(lanes: &[(&str, Vec<Stretch>)], axis: TimeAxis) -> String {
    let height = LANE * lanes.len() as f64;
    let mut out = format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\">\n");
    for (index, (name, stretches)) in lanes.iter().enumerate() {
        let top = index as f64 * LANE;
        let _ = writeln!(out, "<text x=\"0\" y=\"{:.1}\">{}</text>", top + 17.0, escape(name));
        for stretch in stretches.iter().filter(|stretch| !stretch.text.is_empty()) {
            let (from, to) = (axis.x(stretch.from), axis.x(stretch.to + 1));
            let (width, text) = ((to - from).max(0.5), escape(&stretch.text));
            let _ = write!(
                out,
                "<g><title>{text}, ticks {} to {}</title><rect class=\"c{}\" x=\"{from:.1}\" y=\"{:.1}\" width=\"{width:.1}\" \
                 height=\"{:.1}\"/>",
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
                    from + 3.0,
                    top + 17.0,
                    escape(&short)
                );
            }
            out.push_str("</g>\n");
        }
    }
    out + "</svg>\n"
}

/// The same word has the same colour wherever it stands.
fn color(text: &str) -> usize {
    let word = text.split(' ').next().unwrap_or_default();
    word.bytes().fold(7_usize, |sum, byte| (sum * 31 + usize::from(byte)) % 1009) % 8
}

/// A curve over the run.
pub struct Curve<'a> {
    /// What is drawn, with its unit.
    pub name: &'a str,
    /// One value a tick.
    pub values: &'a [f64],
    /// Limit that is drawn as a line.
    pub limit: Option<f64>,
}

/// A curve with its scale on the left, and its limit.
#[must_use]
pub fn curve(curve: &Curve<'_>, ticks: &[u64], axis: TimeAxis) -> String {
    const HEIGHT: f64 = 110.0;
    let most = curve.values.iter().copied().fold(curve.limit.unwrap_or(0.0), f64::max).max(1e-9);
    let y = |value: f64| HEIGHT - 8.0 - value / most * (HEIGHT - 24.0);
    let mut out = format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\">\n");
    let _ = writeln!(out, "<text x=\"0\" y=\"14\">{}</text>", escape(curve.name));
    let _ = writeln!(out, "<text class=\"scale\" x=\"0\" y=\"30\">up to {most:.2}</text>");
    if let Some(limit) = curve.limit {
        let _ = writeln!(
            out,
            "<line class=\"limit\" x1=\"{LEFT}\" x2=\"{WIDTH}\" y1=\"{0:.1}\" y2=\"{0:.1}\"/>",
            y(limit)
        );
    }
    let points = thinned(ticks, curve.values).into_iter().map(|(tick, value)| (axis.x(tick), y(value)));
    out + &polyline("curve", points) + "</svg>\n"
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

fn polyline(class: &str, points: impl Iterator<Item = (f64, f64)>) -> String {
    let mut out = format!("<polyline class=\"{class}\" points=\"");
    for (x, y) in points {
        let _ = write!(out, "{x:.1},{y:.1} ");
    }
    out + "\"/>\n"
}

/// A path seen along an axis: `across` and `up` take the coordinates that are drawn from a point.
#[must_use]
pub fn path(
    title: &str,
    points: &[[f64; 3]],
    across: impl Fn(&[f64; 3]) -> f64,
    up: impl Fn(&[f64; 3]) -> f64,
) -> String {
    const SIZE: f64 = 560.0;
    const HALF_RANGE: f64 = 110.0;
    let place = |value: f64| SIZE / 2.0 + value / HALF_RANGE * (SIZE / 2.0);
    let step = points.len().div_ceil(4 * POINTS).max(1);
    // Before the link runs no frame has been commanded.
    let known = points.iter().filter(|point| **point != [0.0; 3]).step_by(step);
    let line = polyline("path", known.map(|point| (place(across(point)), place(-up(point)))));
    let axes = format!(
        "<line class=\"axis\" x1=\"0\" x2=\"{SIZE}\" y1=\"{0}\" y2=\"{0}\"/><line class=\"axis\" y1=\"0\" y2=\"{SIZE}\" x1=\"{0}\" x2=\"{0}\"/>",
        SIZE / 2.0
    );
    format!(
        "<figure><svg viewBox=\"0 0 {SIZE} {SIZE}\" role=\"img\">{axes}{line}</svg><figcaption>{}</figcaption></figure>\n",
        escape(title)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_a_log_cannot_become_markup() {
        assert_eq!(escape("<b a=\"1\">&"), "&lt;b a=&quot;1&quot;&gt;&amp;");
        let stretches = vec![Stretch { from: 1, to: 100, text: "<script>".into() }];
        assert!(!lanes(&[("Task", stretches)], TimeAxis::new(1, 100)).contains("<script>"));
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
    fn the_axis_ends_at_the_edges() {
        let axis = TimeAxis::new(10, 20);
        assert!((axis.x(10) - LEFT).abs() < 1e-9 && (axis.x(20) - WIDTH).abs() < 1e-9);
    }
}

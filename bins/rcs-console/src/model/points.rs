//! The points screen: couplers, inputs with raw word and value, outputs as commanded and as acknowledged.

use executive::memory::field::{CouplerView, FieldView, PointView};
use interfaces::point::{Kind, Point};
use os_io::text::amount;

use super::{Section, Text, Tone};

const SIDE_BY_SIDE: usize = 160; // least width for inputs and outputs in two columns
const WITH_AGE: usize = 80; // width of a line from which on it has room for the age of an input
const RUNNING: &str = "running";

/// The couplers, inputs and outputs whose names contain `filter`.
#[must_use]
pub fn sections(view: Option<&FieldView>, filter: &str, width: usize) -> Vec<Section> {
    let Some(view) = view else {
        let text = " This run has no field I/O: all devices are simulated without couplers.";
        return vec![Section::new("field I/O", vec![Text::new(Tone::Faint, text)])];
    };
    let couplers = count(view.device_count, view.devices.len());
    let couplers = view.devices.iter().take(couplers).map(coupler).collect();
    let points = view.points.get(..count(view.point_count, view.points.len())).unwrap_or_default();
    let filter = filter.to_lowercase();
    let shown = points.iter().filter(|point| point.name.as_str().to_lowercase().contains(&filter));
    let (outputs, inputs): (Vec<&PointView>, Vec<&PointView>) = shown.partition(|point| point.is_output);
    let column = if width < SIDE_BY_SIDE { width } else { width / 2 };
    let has_age = column > WITH_AGE;
    let mut inputs: Vec<Text> = inputs.into_iter().map(|point| input(point, view, has_age)).collect();
    let mut outputs: Vec<Text> = outputs.into_iter().map(|point| output(point, view)).collect();
    let named = if filter.is_empty() { String::new() } else { format!(" with {filter:?}") };
    let titles = [(inputs.len(), "input"), (outputs.len(), "output")]
        .map(|(count, what)| format!("{}{named}", amount(u64::try_from(count).unwrap_or(u64::MAX), what)));
    let couplers = Section::new("couplers", couplers);
    inputs.insert(0, head(["raw", "value"], if has_age { "             age" } else { "" }));
    outputs.insert(0, head(["commanded", "acknowledged"], ""));
    let [of_inputs, of_outputs] = titles;
    if width < SIDE_BY_SIDE {
        return vec![couplers, Section::new(of_inputs, inputs), Section::new(of_outputs, outputs)];
    }
    let lines = beside(inputs, outputs, column);
    vec![couplers, Section::new(format!("{of_inputs}, {of_outputs}"), lines)]
}

fn count(number: u32, most: usize) -> usize {
    usize::try_from(number).unwrap_or(most).min(most)
}

fn coupler(coupler: &CouplerView) -> Text {
    let CouplerView { name, state, age_ms, failures, trips } = coupler;
    let (mark, tone) = if state.as_str() == RUNNING { ("  ", Tone::Plain) } else { ("!!", Tone::Trouble) };
    let age = age(*age_ms);
    let state = state_word(state.as_str());
    let failures = amount(*failures, "failed exchange");
    Text::new(
        tone,
        format!("{mark}{name:<12} {state:<9} inputs {age} old, {failures}, {}", amount(*trips, "trip")),
    )
}

fn age(ms: u32) -> String {
    match ms {
        ms @ 0..=9999 => format!("{ms} ms"),
        ms => format!("{} s", ms / 1000),
    }
}

/// A state in capitals, unless it is the normal one.
fn state_word(state: &str) -> String {
    if state == RUNNING { state.to_owned() } else { state.to_uppercase() }
}

fn head([first, second]: [&str; 2], rest: &str) -> Text {
    let text = format!("  {:<27} {:<9}{first:>12} {second:>12}{rest}", "name", "coupler");
    Text::new(Tone::Faint, text)
}

fn coupler_of<'v>(point: &PointView, view: &'v FieldView) -> Option<&'v CouplerView> {
    view.devices.get(usize::from(point.device?))
}

fn input(point: &PointView, view: &FieldView, has_age: bool) -> Text {
    let mut rest = unit(point).to_owned();
    if let Some(coupler) = coupler_of(point, view).filter(|_| has_age) {
        rest = format!("{rest:<7}{:>8}", age(coupler.age_ms));
    }
    let raw = if point.device.is_some() { format!("{}", point.raw) } else { "fixed".to_owned() };
    line(point, view, [raw, value(point, point.value)], rest, None)
}

fn output(point: &PointView, view: &FieldView) -> Text {
    let differs = (point.raw != point.value).then_some("DIFFERS");
    line(point, view, [point.raw, point.value].map(|number| value(point, number)), String::new(), differs)
}

fn line(
    point: &PointView,
    view: &FieldView,
    [first, second]: [String; 2],
    mut rest: String,
    remark: Option<&str>,
) -> Text {
    let coupler = coupler_of(point, view);
    let name = coupler.map_or("", |coupler| coupler.name.as_str());
    let late =
        coupler.map(|coupler| coupler.state.as_str()).filter(|state| *state != RUNNING).map(state_word);
    let remark = late.as_deref().or(remark);
    let (mark, tone) = if remark.is_some() { ("!!", Tone::Trouble) } else { ("  ", Tone::Plain) };
    if let Some(remark) = remark {
        rest = if rest.is_empty() { remark.to_owned() } else { format!("{rest} {remark}") };
    }
    Text::new(tone, format!("{mark}{:<27} {name:<9}{first:>12} {second:>12} {rest}", point.name))
}

/// A value of a point: a word for one that is on or off.
fn value(point: &PointView, number: f64) -> String {
    if is_switch(point) {
        return if number == 0.0 { "off" } else { "on" }.to_owned();
    }
    format!("{number}")
}

fn known(point: &PointView) -> Option<Point<'_>> {
    let name = point.name.as_str();
    if point.is_output { Point::written(name) } else { Point::read(name) }
}

fn is_switch(point: &PointView) -> bool {
    known(point).is_some_and(|point| point.range() == (0..=1))
}

fn unit(point: &PointView) -> &'static str {
    match known(point) {
        Some(Point::Input(input)) => match input.kind() {
            Kind::Converter | Kind::Force | Kind::Resolver => "counts",
            Kind::Knob => "of 1000",
            _ => "",
        },
        _ => "",
    }
}

/// Two lists as columns. A line has the tone of its more important half.
fn beside(left: Vec<Text>, right: Vec<Text>, width: usize) -> Vec<Text> {
    let count = left.len().max(right.len());
    let rows = left.into_iter().map(Some).chain(std::iter::repeat(None));
    let rows = rows.zip(right.into_iter().map(Some).chain(std::iter::repeat(None))).take(count);
    rows.map(|(left, right)| {
        let (left, right) = (left.unwrap_or_default(), right.unwrap_or_default());
        let is_trouble = [left.tone, right.tone].contains(&Tone::Trouble);
        let tone = if is_trouble { Tone::Trouble } else { left.tone };
        Text { tone, text: format!("{:<width$}{}", left.text, right.text).trim_end().to_owned() }
    })
    .collect()
}

//! The view of the couplers and their points for screens, of a run or of a log.

use closed_loop::field::FieldController;
use couplers::{InWords, OutWords};
use executive::memory::{
    Text,
    field::{CouplerView, DEVICES, FieldView, PointView},
};
use field::{InPoint, Mapping, OutPoint, Target};
use interfaces::DeviceInputs;
use rcs_core::{Plain, name::Name16, tick::Tick};
use record::views::Couplers;

/// State and words of a coupler.
#[derive(Clone, Copy)]
struct Coupler<'a> {
    state: &'a str,
    age_ms: u64,
    failures: u32,
    trips: u32,
    inputs: InWords,
    commanded: OutWords,
    acknowledged: OutWords,
}

/// The view of a run after a tick. `inputs` are those of the controller. Does not allocate.
#[must_use]
pub fn view_of_run(tick: Tick, desk: &FieldController, inputs: &DeviceInputs) -> FieldView {
    let couplers = desk.devices().map(|(_, orders, report, age_ms)| Coupler {
        state: report.state.word(),
        age_ms,
        failures: report.counters.failures,
        trips: report.counters.trips,
        inputs: report.inputs,
        commanded: orders.words,
        acknowledged: report.acknowledged,
    });
    view(tick, desk.mapping(), couplers, inputs)
}

/// The view of a tick of a log, from the words on `/field` and the mapping of the run.
#[must_use]
pub fn view_of_log(tick: Tick, mapping: &Mapping, logged: &Couplers, inputs: &DeviceInputs) -> FieldView {
    fn fill(words: &mut [u16], logged: &[u32]) {
        for (word, logged) in words.iter_mut().zip(logged) {
            *word = u16::try_from(*logged).unwrap_or_default();
        }
    }
    let couplers = logged.couplers.iter().map(|coupler| {
        let mut words = Coupler {
            state: &coupler.state,
            age_ms: coupler.age_ms,
            failures: coupler.failures,
            trips: coupler.trips,
            inputs: InWords::ZERO,
            commanded: OutWords::ZERO,
            acknowledged: OutWords::ZERO,
        };
        fill(&mut words.inputs.words, &coupler.inputs);
        fill(&mut words.commanded.words, &coupler.commanded);
        fill(&mut words.acknowledged.words, &coupler.acknowledged);
        words
    });
    view(tick, mapping, couplers, inputs)
}

fn view<'a>(
    tick: Tick,
    mapping: &Mapping,
    couplers: impl Iterator<Item = Coupler<'a>>,
    inputs: &DeviceInputs,
) -> FieldView {
    let mut view = FieldView {
        tick,
        device_count: count(mapping.devices.len()),
        point_count: count(mapping.inputs.len() + mapping.outputs.len()),
        ..FieldView::default()
    };
    let mut known = [None; DEVICES];
    let places = view.devices.iter_mut().zip(&mut known);
    for ((place, known), (device, coupler)) in places.zip(mapping.devices.iter().zip(couplers)) {
        *place = CouplerView {
            name: Name16::clipped(&device.name),
            state: Name16::clipped(coupler.state),
            age_ms: u32::try_from(coupler.age_ms).unwrap_or(u32::MAX),
            failures: coupler.failures,
            trips: coupler.trips,
        };
        *known = Some(coupler);
    }
    let of = |device: usize| known.get(device).copied().flatten();
    let points =
        mapping.inputs.iter().map(|point| input(point, point.device().and_then(of).as_ref(), inputs));
    let outputs = mapping.outputs.iter().map(|point| output(point, of(point.device()).as_ref()));
    view.points.iter_mut().zip(points.chain(outputs)).for_each(|(place, point)| *place = point);
    view
}

fn input(point: &InPoint, coupler: Option<&Coupler<'_>>, inputs: &DeviceInputs) -> PointView {
    let raw = coupler.and_then(|coupler| point.raw(&coupler.inputs));
    let value = match point.target {
        Target::Word(word) => Some(word.read(inputs)),
        Target::Station => raw.or(point.fixed()),
    };
    PointView {
        name: Text::clipped(&point.name),
        device: point.device().and_then(|device| u8::try_from(device).ok()),
        is_output: false,
        raw: raw.unwrap_or_default() as f64,
        value: value.unwrap_or_default() as f64,
    }
}

fn output(point: &OutPoint, coupler: Option<&Coupler<'_>>) -> PointView {
    let value = |words: &OutWords| point.get(words) as f64;
    PointView {
        name: Text::clipped(&point.name),
        device: u8::try_from(point.device()).ok(),
        is_output: true,
        raw: coupler.map_or(0.0, |coupler| value(&coupler.commanded)),
        value: coupler.map_or(0.0, |coupler| value(&coupler.acknowledged)),
    }
}

fn count(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

//! The row channels: one per process, `/process/row`, with the row of a decision table that fired.
//!
//! A message has the row as text, its step, the state variables, its tick, and the rows of other tables that fired. It
//! is written when anything except the tick changes. A process at rest repeats its last row, with `resting` set.

use std::io::{Seek, Write};

use interfaces::{Basis, Consulted, Decided, Header};
use levels::ladder::ProcessInfo;
use mcap::McapResult;
use prost_types::field_descriptor_proto::Type;
use rcs_core::{
    table::{Fired, Table, Values},
    tick::Tick,
};

use crate::{
    channels::{HeaderPlace, Output, headers},
    proto::{
        descriptor::{self, encode_set, field, file},
        wire,
    },
};

pub struct Rows(Vec<Channel>);

struct Channel {
    id: u16,
    place: HeaderPlace,
    last: Option<(Header, Vec<u8>)>, // the last message, without its tick
}

const ROW: &str = "Row";

/// The state variables of a table as text: `work Busy, clock Running`.
#[must_use]
pub fn values_text(table: &'static Table, values: Values) -> String {
    let asked: Vec<&str> = table.asked().map(|variable| variable.name).collect();
    let known = table.values(values).filter(|(variable, _)| asked.contains(&variable.name));
    let texts: Vec<String> =
        known.map(|(variable, value)| format!("{} {}", variable.name, value.name)).collect();
    texts.join(", ")
}

impl Rows {
    pub fn open<W: Write + Seek>(output: &mut Output<W>) -> McapResult<Self> {
        let fields = vec![
            field("process", 1, Type::String),
            field("table_number", 2, Type::Uint32),
            field("table", 3, Type::String),
            field("row", 4, Type::Uint32),
            field("conditions", 5, Type::String),
            field("action", 6, Type::String),
            field("next", 7, Type::String),
            field("republished", 8, Type::Bool),
            field("step", 9, Type::String),
            field("resting", 10, Type::Bool),
            field("values", 11, Type::String),
            field("beside", 12, Type::String),
            field("fired_tick", 13, Type::Uint64),
            field("step_before", 14, Type::String),
        ];
        let message = descriptor::message(ROW, fields);
        let set = encode_set(vec![file("rcs.proto", descriptor::PACKAGE, &[], vec![message])]);
        let name = format!("{}.{ROW}", descriptor::PACKAGE);
        let open = |place: HeaderPlace| {
            let id = output.protobuf(&format!("/{}/row", place.field), &name, &set)?;
            Ok(Channel { id, place, last: None })
        };
        headers().into_iter().map(open).collect::<McapResult<_>>().map(Self)
    }

    pub fn write<W: Write + Seek>(
        &mut self,
        output: &mut Output<W>,
        tick: Tick,
        image: &[u8],
        all: bool,
    ) -> McapResult<()> {
        for Channel { id, place, last } in &mut self.0 {
            let header = place.read(image);
            let timeless = timeless(&header);
            if !all && last.as_ref().is_some_and(|(last, _)| *last == timeless) {
                continue;
            }
            let mut data = row_message(place, &header);
            if all || last.as_ref().is_none_or(|(_, last)| *last != data) {
                let message = data.len();
                if let Some(Basis { tick, .. }) = header.basis {
                    wire::unsigned(13, tick.0, &mut data);
                }
                output.put(*id, tick, &data)?;
                data.truncate(message);
            }
            *last = Some((timeless, data));
        }
        Ok(())
    }
}

/// The header without the fields that change in every tick: the stamp, and the tick of a row that fires again.
fn timeless(header: &Header) -> Header {
    let resting = header.age().is_some_and(|age| age > 0);
    let tick = if resting { Tick(1) } else { Tick::BEFORE_START };
    let basis = header.basis.map(|basis| Basis { tick, ..basis });
    Header { stamp: Tick::BEFORE_START, basis, ..*header }
}

fn row_message(place: &HeaderPlace, header: &Header) -> Vec<u8> {
    let (table, conditions, action, next) = match place.fired(header) {
        Some(Fired { table, row, .. }) => {
            (table.name, row.conditions().to_string(), row.call().to_string(), row.next.unwrap_or_default())
        }
        None => Default::default(),
    };
    let consulted = header
        .consulted()
        .and_then(|consulted| Some((place.process.table(consulted.decided.table)?, consulted.values)));
    let values = consulted.map(|(table, values)| values_text(table, values));
    let step_before = consulted.and_then(|(table, values)| Some(table.step(values)?.name));
    let beside: Vec<String> = beside(place.process, header).collect();
    let (table_number, row_number) = header.decided.map_or((0, 0), |Decided { table, row }| (table, row));
    let mut data = Vec::new();
    wire::bytes(1, place.process.name.as_bytes(), &mut data);
    wire::unsigned(2, table_number.into(), &mut data);
    wire::bytes(3, table.as_bytes(), &mut data);
    wire::unsigned(4, row_number.into(), &mut data);
    wire::bytes(5, conditions.as_bytes(), &mut data);
    wire::bytes(6, action.as_bytes(), &mut data);
    wire::bytes(7, next.as_bytes(), &mut data);
    wire::unsigned(8, header.republished.into(), &mut data);
    wire::bytes(9, header.step.unwrap_or_default().as_str().as_bytes(), &mut data);
    wire::unsigned(10, header.age().is_some_and(|age| age > 0).into(), &mut data);
    wire::bytes(11, values.unwrap_or_default().as_bytes(), &mut data);
    wire::bytes(12, beside.join("; ").as_bytes(), &mut data);
    wire::bytes(14, step_before.unwrap_or_default().as_bytes(), &mut data);
    data
}

/// The rows of other tables in a header: `ATTEND row 4 (course Continue, kind Motion, operator Idle)`.
pub fn beside(process: &'static ProcessInfo, header: &Header) -> impl Iterator<Item = String> {
    header.beside.into_iter().flatten().filter_map(|Consulted { decided, values }| {
        let (table, row) = process.row(decided)?;
        Some(format!("{} row {} ({})", table.name, row.number, values_text(table, values)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proto::wire::{Fields, Value};
    use levels::execution::Course;
    use levels::prim::tables::{Attendance, CommandKind, PrimOperator, TABLES, number};
    use rcs_core::table::Variables as _;

    fn prim() -> HeaderPlace {
        headers().into_iter().find(|place| place.field == "prim").unwrap()
    }

    fn attended(operator: PrimOperator) -> Header {
        let attendance = Attendance { course: Course::Continue, kind: CommandKind::Motion, operator };
        let values = Values { step: 1, variables: attendance.code() };
        let decided = Decided { table: number::ATTEND, row: 2 };
        Header {
            stamp: Tick(7),
            decided: Some(decided),
            basis: Some(Basis { tick: Tick(7), values }),
            beside: [None, Some(Consulted { decided, values }), None],
            ..Header::default()
        }
    }

    #[test]
    fn values_text_has_their_names() {
        let attend = TABLES[usize::from(number::ATTEND) - 1];
        let basis = attended(PrimOperator::Moves).basis.unwrap();
        assert_eq!(values_text(attend, basis.values), "course Continue, kind Motion, operator Moves");
        let told: Vec<_> = beside(prim().process, &attended(PrimOperator::Idle)).collect();
        assert_eq!(told, ["ATTEND row 2 (course Continue, kind Motion, operator Idle)"]);
    }

    #[test]
    fn message_has_the_step_in_which_the_row_was_looked_up() {
        let place = prim();
        let (number, table) = (1_u8..)
            .zip(TABLES)
            .find(|(_, table)| table.steps.is_some_and(|of| of.variants.len() > 1))
            .unwrap();
        let step = &table.steps.unwrap().variants[1];
        let values = Values { step: step.code, variables: 0 };
        let header = Header {
            stamp: Tick(7),
            decided: Some(Decided { table: number, row: 1 }),
            basis: Some(Basis { tick: Tick(7), values }),
            ..Header::default()
        };
        let message = row_message(&place, &header);
        let found = Fields(&message).find_map(|field| match field {
            (14, Value::Bytes(bytes)) => Some(bytes),
            _ => None,
        });
        assert_eq!(found, Some(step.name.as_bytes()));
    }

    #[test]
    fn row_message_is_independent_of_the_tick() {
        let place = prim();
        let (fired, other) = (attended(PrimOperator::Idle), attended(PrimOperator::Moves));
        let later =
            Header { stamp: Tick(8), basis: fired.basis.map(|b| Basis { tick: Tick(8), ..b }), ..fired };
        let resting = Header { stamp: Tick(9), ..fired };
        assert_eq!(
            (timeless(&fired), row_message(&place, &fired)),
            (timeless(&later), row_message(&place, &later))
        );
        for different in [other, resting] {
            assert_ne!(timeless(&fired), timeless(&different));
            assert_ne!(row_message(&place, &fired), row_message(&place, &different));
        }
        assert_eq!(timeless(&resting), timeless(&Header { stamp: Tick(80), ..resting }));
    }
}

//! Requests of operators, on a separate channel, so that they can be replayed in another run.

use std::io::{Seek, Write};

use mcap::McapResult;
use prost_types::field_descriptor_proto::Type;
use rcs_core::tick::Tick;

use crate::{
    channels::Output,
    proto::{
        descriptor::{self, encode_set, field, file},
        wire::{self, Fields, Value},
    },
};

/// The topic. A run without operators has no such channel.
pub const OPERATOR: &str = "/operator";

const SOURCE: u32 = 1;
const LINE: u32 = 2;
const ANSWER: u32 = 3;
const REFUSED: u32 = 4;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OperatorLine {
    pub tick: Tick, // the first one that reads the request
    pub source: String,
    pub line: String,
    pub answer: String,          // may be empty
    pub refused: Option<String>, // `None` if it was accepted
}

impl OperatorLine {
    fn encode(&self) -> Vec<u8> {
        let mut data = Vec::new();
        wire::bytes(SOURCE, self.source.as_bytes(), &mut data);
        wire::bytes(LINE, self.line.as_bytes(), &mut data);
        wire::bytes(ANSWER, self.answer.as_bytes(), &mut data);
        if let Some(why) = &self.refused {
            wire::bytes(REFUSED, why.as_bytes(), &mut data);
        }
        data
    }

    pub(crate) fn decode(tick: Tick, data: &[u8]) -> Self {
        let mut read =
            Self { tick, source: String::new(), line: String::new(), answer: String::new(), refused: None };
        for (number, value) in Fields(data) {
            let Value::Bytes(bytes) = value else { continue };
            let text = String::from_utf8_lossy(bytes).into_owned();
            match u32::try_from(number) {
                Ok(SOURCE) => read.source = text,
                Ok(LINE) => read.line = text,
                Ok(ANSWER) => read.answer = text,
                Ok(REFUSED) => read.refused = Some(text),
                _ => {}
            }
        }
        read
    }
}

/// The channel, which exists from the first line on.
#[derive(Default)]
pub(crate) struct OperatorChannel(Option<u16>);

impl OperatorChannel {
    pub fn put<W: Write + Seek>(&mut self, output: &mut Output<W>, line: &OperatorLine) -> McapResult<()> {
        let channel = match self.0 {
            Some(channel) => channel,
            None => output.protobuf(OPERATOR, "rcs.OperatorLine", &operator_descriptor())?,
        };
        self.0 = Some(channel);
        output.put(channel, line.tick, &line.encode())
    }
}

fn operator_descriptor() -> Vec<u8> {
    let number = |field: u32| i32::try_from(field).unwrap_or(i32::MAX);
    let fields = vec![
        field("source", number(SOURCE), Type::String),
        field("line", number(LINE), Type::String),
        field("answer", number(ANSWER), Type::String),
        descriptor::optional(field("refused", number(REFUSED), Type::String)),
    ];
    let message = descriptor::message("OperatorLine", fields);
    encode_set(vec![file("rcs.proto", descriptor::PACKAGE, &[], vec![message])])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operator_line_round_trips() {
        for refused in [None, Some(String::new()), Some("no".to_owned())] {
            let line = OperatorLine {
                tick: Tick(7),
                source: "console".into(),
                line: "joystick velocity 0".into(),
                answer: "tick 7".into(),
                refused,
            };
            assert_eq!(OperatorLine::decode(line.tick, &line.encode()), line);
        }
    }
}

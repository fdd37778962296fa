//! All processes in one message: `/ladder`, with the command, the status and the row of each.
//!
//! A viewer shows it as a table. It is written when the command, the report or the deciding row of a process
//! changes, and repeated with the buffers.

use std::{
    borrow::Cow,
    io::{Seek, Write},
};

use interfaces::{CommonMemory, Decided, Fault, HwsCommand, ProcessId};
use levels::ladder::{Ladder, ProcessInfo};
use mcap::McapResult;
use rcs_core::{handshake::Lower, name::Name16, tick::Tick};

use crate::{
    channels::Output,
    proto::typed::{self, messages},
};

pub const LADDER: &str = "/ladder";

messages! {
    /// A process of the ladder.
    LadderLevel {
        /// Its name, as the manual writes it.
        process: Cow<'static, str>,
        /// Its command, with objects and places. A point of T3 Interface has no coordinates: it changes every tick.
        command: String,
        /// The word of its report.
        status: Cow<'static, str>,
        /// Why it failed; empty if it did not.
        reason: Cow<'static, str>,
        /// The table of the row that fired last; empty before the first.
        table: Cow<'static, str>,
        /// The row.
        row: u32,
        /// Its action.
        action: String,
        /// Step of the command after the row.
        step: String,
    }

    /// All processes, from Task down.
    LadderState {
        /// The processes, in the order of common memory.
        processes: Vec<LadderLevel>,
    }
}

#[derive(Clone, Copy, PartialEq)]
struct Key {
    command: Option<u32>,
    status: (&'static str, Lower),
    fault: Fault,
    decided: Option<Decided>,
    step: Option<Name16>,
}

impl Key {
    fn of(process: ProcessId, hws: &HwsCommand, memory: &CommonMemory) -> Self {
        let (said, header) = (memory.said(process), memory.header(process));
        let command = match process {
            ProcessId::Task => Some(hws.number),
            ProcessId::T3i => None,
            process => memory.command_number(process),
        };
        let status = (said.report, said.lower);
        Self { command, status, fault: said.fault, decided: header.decided, step: header.step }
    }
}

pub(crate) struct LadderChannel {
    id: u16,
    last: Vec<Key>,
}

impl LadderChannel {
    pub fn open<W: Write + Seek>(output: &mut Output<W>) -> McapResult<Self> {
        let (name, descriptors) = (typed::name::<LadderState>(), typed::descriptor_set::<LadderState>());
        Ok(Self { id: output.protobuf(LADDER, &name, &descriptors)?, last: Vec::new() })
    }

    /// Write the state after a tick if it has changed or is `due`.
    pub fn write<W: Write + Seek>(
        &mut self,
        output: &mut Output<W>,
        tick: Tick,
        (hws, memory): (&HwsCommand, &CommonMemory),
        due: bool,
    ) -> McapResult<()> {
        let keys = || ProcessId::ALL.iter().map(|process| Key::of(*process, hws, memory));
        if !due && keys().eq(self.last.iter().copied()) {
            return Ok(());
        }
        self.last.clear();
        self.last.extend(keys());
        output.put(self.id, tick, &typed::encode(&state(hws, memory)))
    }
}

fn state(hws: &HwsCommand, memory: &CommonMemory) -> LadderState {
    let processes = ProcessId::ALL.iter().zip(Ladder::processes());
    LadderState { processes: processes.map(|(id, process)| level(*id, process, hws, memory)).collect() }
}

fn level(id: ProcessId, process: &ProcessInfo, hws: &HwsCommand, memory: &CommonMemory) -> LadderLevel {
    let (said, header) = (memory.said(id), memory.header(id));
    let command = match id {
        ProcessId::T3i => memory.prim.t3i.command.to_string(),
        id => memory.show_command(id, |command| command.to_string()).unwrap_or_else(|| hws.to_string()),
    };
    let row = header.decided.and_then(|decided| process.row(decided));
    LadderLevel {
        process: process.name.into(),
        command,
        status: said.report.into(),
        reason: if said.fault.is_none() { "" } else { said.fault.text() }.into(),
        table: row.map_or("", |(table, _)| table.name).into(),
        row: row.map_or(0, |(_, row)| row.number.into()),
        action: row.map_or_else(String::new, |(_, row)| row.call().to_string()),
        step: header.step.unwrap_or_default().as_str().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Reason, emove::EmoveVerb, t3i::T3iVerb};

    #[test]
    fn every_process_has_its_command_status_and_row() {
        let mut memory = CommonMemory::default();
        memory.subtask.emove.command = EmoveVerb::MovToLoc;
        memory.emove.status.reason = Reason::NoTrajectory;
        memory.emove.header.decided = Some(Decided { table: 1, row: 1 });
        let state = state(&HwsCommand::default(), &memory);
        assert_eq!(state.processes.len(), ProcessId::ALL.len());
        let emove = &state.processes[2];
        assert_eq!((&*emove.process, emove.row, &*emove.reason), ("E-move", 1, Reason::NoTrajectory.text()));
        assert!(state.processes.iter().all(|level| level.process == "E-move" || level.reason.is_empty()));
        assert!(emove.command.starts_with("MOV-TO-LOC") && !emove.table.is_empty(), "{emove:?}");
    }

    #[test]
    fn points_alone_cause_no_message() {
        let key = |memory: &CommonMemory| Key::of(ProcessId::T3i, &HwsCommand::default(), memory);
        let before = CommonMemory::default();
        let mut after = before;
        (after.prim.t3i.command, after.prim.t3i.number) = (T3iVerb::Restart, 7);
        assert!(key(&before) == key(&after));
        after.t3i.status.fault = interfaces::t3i::LinkFault::NotResponding;
        assert!(key(&before) != key(&after));
    }
}

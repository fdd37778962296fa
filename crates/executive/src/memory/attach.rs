//! The side of the others: look into a run without disturbing it.

use iceoryx2::{node::Node, prelude::ipc};
use rcs_core::{
    interface::{CommonMemory, ExternalInputs},
    plain::DecodeError,
};

use super::{
    buffers::{
        DataBaseReader, DevicesReader, EmoveReader, ExecutiveReader, GripReader, HandReader, HwscReader,
        OutsidePedestalReader, PedestalReader, PrimReader, Pulse, QuickChangeReader, SubtaskReader,
        T3iReader, TableReader, TaskReader, ToolGripReader, VGripReader,
    },
    publish::FIRST_EPOCH,
    runs::{self, RunName, SharedMemoryError},
};

/// How often a reader looks again when it meets the writer at work. Writing takes microseconds of a tick.
const ATTEMPTS: usize = 1000;

/// Why nothing was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// The bytes are not legal records.
    #[error("shared memory holds something that no process writes: {0}")]
    Decode(#[from] DecodeError),
    /// The writer was in the middle of a tick at every attempt; the next call may succeed.
    #[error("the buffers were being written at every attempt")]
    Busy,
}

/// A reader that is attached to a run. Dropping it detaches.
pub struct Attached {
    name: RunName,
    // Taken out before the files are removed, if this is the last one out.
    ports: Option<Ports>,
}

struct Ports {
    task: TaskReader,
    subtask: SubtaskReader,
    emove: EmoveReader,
    prim: PrimReader,
    t3i: T3iReader,
    quick_change: QuickChangeReader,
    grip: GripReader,
    v_grip: VGripReader,
    tool_grip: ToolGripReader,
    pedestal: PedestalReader,
    hand: HandReader,
    table: TableReader,
    hwsc: HwscReader,
    data_base: DataBaseReader,
    outside_pedestal: OutsidePedestalReader,
    devices: DevicesReader,
    executive: ExecutiveReader,
    _node: Node<ipc::Service>,
}

impl Attached {
    /// Attach to a run by its name.
    ///
    /// # Errors
    /// [`SharedMemoryError::NoSuchRun`] if no living run has the name, [`SharedMemoryError::OtherLayout`] if
    /// it comes from other sources, else what iceoryx2 says.
    pub fn open(name: &RunName) -> Result<Self, SharedMemoryError> {
        runs::find_living(name)?;
        let node = runs::node(name, "reader")?;
        let epoch = FIRST_EPOCH;
        let ports = Ports {
            task: TaskReader::open(&node, epoch)?,
            subtask: SubtaskReader::open(&node, epoch)?,
            emove: EmoveReader::open(&node, epoch)?,
            prim: PrimReader::open(&node, epoch)?,
            t3i: T3iReader::open(&node, epoch)?,
            quick_change: QuickChangeReader::open(&node, epoch)?,
            grip: GripReader::open(&node, epoch)?,
            v_grip: VGripReader::open(&node, epoch)?,
            tool_grip: ToolGripReader::open(&node, epoch)?,
            pedestal: PedestalReader::open(&node, epoch)?,
            hand: HandReader::open(&node, epoch)?,
            table: TableReader::open(&node, epoch)?,
            hwsc: HwscReader::open(&node, epoch)?,
            data_base: DataBaseReader::open(&node, epoch)?,
            outside_pedestal: OutsidePedestalReader::open(&node, epoch)?,
            devices: DevicesReader::open(&node, epoch)?,
            executive: ExecutiveReader::open(&node, epoch)?,
            _node: node,
        };
        Ok(Self { name: name.clone(), ports: Some(ports) })
    }

    /// The run.
    #[must_use]
    pub const fn name(&self) -> &RunName {
        &self.name
    }

    /// Common memory as one tick left it: all processes bear its stamp, but for those of a pedestal in another system that does
    /// not answer, which bear an older one.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn memory(&self) -> Result<CommonMemory, ReadError> {
        self.settled(|ports| {
            // What is written last is read first, and what is written first is read last: if both are of one tick, so is all
            // between them, whatever stamps it bears.
            let tick = unfinished(ports.executive.read()?)?.header.stamp;
            let memory = CommonMemory {
                table: unfinished(ports.table.read()?)?,
                hand: unfinished(ports.hand.read()?)?,
                pedestal: unfinished(ports.pedestal.read()?)?,
                tool_grip: unfinished(ports.tool_grip.read()?)?,
                v_grip: unfinished(ports.v_grip.read()?)?,
                grip: unfinished(ports.grip.read()?)?,
                quick_change: unfinished(ports.quick_change.read()?)?,
                t3i: unfinished(ports.t3i.read()?)?,
                prim: unfinished(ports.prim.read()?)?,
                emove: unfinished(ports.emove.read()?)?,
                subtask: unfinished(ports.subtask.read()?)?,
                task: unfinished(ports.task.read()?)?,
            };
            let own = [
                &memory.task.header,
                &memory.subtask.header,
                &memory.emove.header,
                &memory.prim.header,
                &memory.t3i.header,
                &memory.quick_change.header,
                &memory.grip.header,
                &memory.v_grip.header,
                &memory.tool_grip.header,
            ];
            let of_pedestal = [&memory.pedestal.header, &memory.hand.header, &memory.table.header];
            let settled = own.iter().all(|header| header.stamp == tick)
                && of_pedestal.iter().all(|header| header.stamp <= tick);
            if settled { Ok(memory) } else { Err(ReadError::Busy) }
        })
    }

    /// What came from outside for the last tick.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn external(&self) -> Result<ExternalInputs, ReadError> {
        self.settled(|ports| {
            let (hwsc, devices) = (unfinished(ports.hwsc.read()?)?, unfinished(ports.devices.read()?)?);
            let data_base = unfinished(ports.data_base.read()?)?;
            let pedestal = unfinished(ports.outside_pedestal.read()?)?;
            let executive = unfinished(ports.executive.read()?)?;
            let stamp = hwsc.header.stamp;
            let others = [&devices.header, &data_base.header, &pedestal.header, &executive.header];
            if others.iter().all(|header| header.stamp == stamp) {
                Ok(ExternalInputs {
                    hws: hwsc.command,
                    devices: devices.inputs,
                    data_base: data_base.status,
                    generation: executive.pulse.generation,
                    pedestal: pedestal.sent,
                })
            } else {
                Err(ReadError::Busy)
            }
        })
    }

    /// What the executive says of the run.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn pulse(&self) -> Result<Pulse, ReadError> {
        self.settled(|ports| Ok(unfinished(ports.executive.read()?)?.pulse))
    }

    /// Reads until nobody writes in between.
    fn settled<T>(&self, read: impl Fn(&Ports) -> Result<T, ReadError>) -> Result<T, ReadError> {
        let Some(ports) = &self.ports else { return Err(ReadError::Busy) };
        for _ in 0..ATTEMPTS {
            match read(ports) {
                Err(ReadError::Busy) => std::thread::yield_now(),
                other => return other,
            }
        }
        Err(ReadError::Busy)
    }
}

fn unfinished<T>(outputs: Option<T>) -> Result<T, ReadError> {
    outputs.ok_or(ReadError::Busy)
}

impl Drop for Attached {
    fn drop(&mut self) {
        drop(self.ports.take());
        // A living run or another reader keeps the files; a failure is left to `rcs-run clean`.
        let _ = runs::remove_if_deserted(&self.name, &runs::layout());
    }
}

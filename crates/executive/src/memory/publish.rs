//! The side of the run: creates all services before the first tick and writes them once a tick, without
//! allocating.

use std::sync::{Arc, Mutex, TryLockError};

use iceoryx2::{node::Node, prelude::ipc};
use rcs_core::{
    Plain as _,
    interface::{CommonMemory, ExternalInputs, Header},
    tick::Tick,
};

use super::{
    buffers::{
        DataBaseOutputs, DataBaseWriter, DevicesOutputs, DevicesWriter, EmoveWriter, Epoch, ExecutiveOutputs,
        ExecutiveWriter, GripWriter, HandWriter, HwscOutputs, HwscWriter, OutsidePedestalOutputs,
        OutsidePedestalWriter, PedestalWriter, PrimWriter, Pulse, QuickChangeWriter, SubtaskWriter,
        T3iWriter, TableWriter, TaskWriter, ToolGripWriter, VGripWriter,
    },
    runs::{self, RunName, SharedMemoryError},
};

/// Epoch of a run whose writers were never restarted.
pub const FIRST_EPOCH: Epoch = 1;

/// What was published last.
#[derive(Clone, Copy, Default)]
pub(super) struct Published {
    pub external: ExternalInputs,
    pub memory: CommonMemory,
    pub pulse: Pulse,
}

/// What was published last, for other threads of this program: nothing that somebody else writes into shared memory gets in
/// here. Neither side ever waits for the other, so that no tick is late because of a thread that looks.
#[derive(Default)]
pub(super) struct Window(Mutex<Published>);

impl Window {
    /// Do something with what stands here; `None` while the other side is at it.
    pub(super) fn with<T>(&self, work: impl FnOnce(&mut Published) -> T) -> Option<T> {
        match self.0.try_lock() {
            Ok(mut published) => Some(work(&mut published)),
            // Every value in it is whole whatever its owner was doing when it panicked.
            Err(TryLockError::Poisoned(published)) => Some(work(&mut published.into_inner())),
            Err(TryLockError::WouldBlock) => None,
        }
    }
}

/// The writers of all buffers of a run. Dropping it ends the run in shared memory: readers that are still
/// attached see [`Pulse::over`], and whoever leaves last removes the files.
pub struct Publisher {
    name: RunName,
    // Taken out before the files are removed: iceoryx2 must have let go of them by then.
    ports: Option<Ports>,
    pulse: Pulse,
    window: Arc<Window>,
}

struct Ports {
    task: TaskWriter,
    subtask: SubtaskWriter,
    emove: EmoveWriter,
    prim: PrimWriter,
    t3i: T3iWriter,
    quick_change: QuickChangeWriter,
    grip: GripWriter,
    v_grip: VGripWriter,
    tool_grip: ToolGripWriter,
    pedestal: PedestalWriter,
    hand: HandWriter,
    table: TableWriter,
    hwsc: HwscWriter,
    data_base: DataBaseWriter,
    outside_pedestal: OutsidePedestalWriter,
    devices: DevicesWriter,
    executive: ExecutiveWriter,
    // Last: the services are closed before their node.
    _node: Node<ipc::Service>,
}

impl Publisher {
    /// Set up all services of a run. What killed runs left behind is removed first.
    ///
    /// # Errors
    /// [`SharedMemoryError`] with what iceoryx2 says, if this machine does not give the memory or the name is
    /// taken.
    pub fn create(name: &RunName) -> Result<Self, SharedMemoryError> {
        // Half a run is none: what was set up before something failed goes again.
        Self::set_up(name).inspect_err(|_| {
            let _ = runs::remove_if_deserted(name, &runs::layout());
        })
    }

    fn set_up(name: &RunName) -> Result<Self, SharedMemoryError> {
        runs::own_root()?;
        runs::clean()?;
        runs::have_room()?;
        let node = runs::node(name, "rcs-run")?;
        let epoch = FIRST_EPOCH;
        let ports = Ports {
            task: TaskWriter::create(&node, epoch)?,
            subtask: SubtaskWriter::create(&node, epoch)?,
            emove: EmoveWriter::create(&node, epoch)?,
            prim: PrimWriter::create(&node, epoch)?,
            t3i: T3iWriter::create(&node, epoch)?,
            quick_change: QuickChangeWriter::create(&node, epoch)?,
            grip: GripWriter::create(&node, epoch)?,
            v_grip: VGripWriter::create(&node, epoch)?,
            tool_grip: ToolGripWriter::create(&node, epoch)?,
            pedestal: PedestalWriter::create(&node, epoch)?,
            hand: HandWriter::create(&node, epoch)?,
            table: TableWriter::create(&node, epoch)?,
            hwsc: HwscWriter::create(&node, epoch)?,
            data_base: DataBaseWriter::create(&node, epoch)?,
            outside_pedestal: OutsidePedestalWriter::create(&node, epoch)?,
            devices: DevicesWriter::create(&node, epoch)?,
            executive: ExecutiveWriter::create(&node, epoch)?,
            _node: node,
        };
        runs::reserve(name)?;
        Ok(Self { name: name.clone(), ports: Some(ports), pulse: Pulse::default(), window: Arc::default() })
    }

    pub(super) fn window(&self) -> Arc<Window> {
        Arc::clone(&self.window)
    }

    /// The name under which readers find the run.
    #[must_use]
    pub const fn name(&self) -> &RunName {
        &self.name
    }

    /// Write the buffers of a tick: what came in, what the processes wrote, and the pulse, in this order.
    /// Does not allocate.
    pub fn publish(&mut self, external: &ExternalInputs, memory: &CommonMemory, pulse: Pulse) {
        let Some(ports) = &self.ports else { return };
        let header = stamp(pulse.tick);
        ports.hwsc.write(&HwscOutputs { header, command: external.hws });
        ports.data_base.write(&DataBaseOutputs { header, status: external.data_base });
        ports.outside_pedestal.write(&OutsidePedestalOutputs { header, sent: external.pedestal });
        ports.devices.write(&DevicesOutputs { header, inputs: external.devices });
        ports.task.write(&memory.task);
        ports.subtask.write(&memory.subtask);
        ports.emove.write(&memory.emove);
        ports.prim.write(&memory.prim);
        ports.t3i.write(&memory.t3i);
        ports.quick_change.write(&memory.quick_change);
        ports.grip.write(&memory.grip);
        ports.v_grip.write(&memory.v_grip);
        ports.tool_grip.write(&memory.tool_grip);
        ports.pedestal.write(&memory.pedestal);
        ports.hand.write(&memory.hand);
        ports.table.write(&memory.table);
        ports.executive.write(&ExecutiveOutputs { header, pulse });
        self.pulse = pulse;
        // If it is being looked at, the next tick comes soon.
        let _ = self.window.with(|seen| *seen = Published { external: *external, memory: *memory, pulse });
    }
}

const fn stamp(tick: Tick) -> Header {
    Header { stamp: tick, ..Header::ZERO }
}

impl Drop for Publisher {
    fn drop(&mut self) {
        if let Some(ports) = self.ports.take() {
            let pulse = Pulse { over: true, ..self.pulse };
            ports.executive.write(&ExecutiveOutputs { header: stamp(pulse.tick), pulse });
            drop(ports);
        }
        // Nothing can be done about a failure here; `rcs-run clean` tries again and reports.
        let _ = runs::remove_if_deserted(&self.name, &runs::layout());
    }
}

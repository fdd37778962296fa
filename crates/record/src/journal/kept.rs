//! The buffers that a controller keeps over a loss of power (docs/design/resume.md "Kept"). A restarted process adopts
//! the estimates in its output buffers, so common memory has all that is needed. Readings, rows and the state of the
//! link are measured again, and the bias of the force sensor is valid only as long as the sensor has power.

use interfaces::{
    CommonMemory, EmoveOutputs, GripOutputs, Header, JawsOutputs, PedestalOutputs, PrimOutputs, ProcessId,
    QuickChangeOutputs, SubtaskOutputs, T3iOutputs, TableOutputs,
    emove::{CalibratedAt, EmoveStatus},
    grip::GripStatus,
    pedestal::{PedestalStatus, TableStatus},
    subtask::SubtaskStatus,
    t3i::T3iCommand,
    track::Course,
    vision::VisionRequest,
};
use rcs_core::{Plain as _, tick::Tick};

/// The buffers for the journal: without rows, without the state of the link, and without the bias of the force sensor.
#[must_use]
pub fn kept(memory: &CommonMemory) -> CommonMemory {
    let mut kept = *memory;
    for process in ProcessId::ALL {
        *kept.header_mut(*process) = Header::ZERO;
    }
    kept.t3i = T3iOutputs::ZERO;
    (kept.prim.t3i, kept.prim.bias, kept.prim.joystick_leds) = (T3iCommand::ZERO, None, 0);
    kept.emove.estimates.calibrated = CalibratedAt::Drum;
    kept.emove.vision = VisionRequest::ZERO;
    kept
}

/// Kept buffers without values that sensors measure again. Two ticks with equal results need only one entry.
#[must_use]
pub fn knowledge(kept: &CommonMemory) -> CommonMemory {
    let mut known = *kept;
    known.subtask = SubtaskOutputs { status: SubtaskStatus::ZERO, ..kept.subtask };
    known.subtask.pedestal.cycle = Tick::BEFORE_START;
    known.emove = EmoveOutputs {
        status: EmoveStatus::ZERO,
        nearest: [None; 2],
        poses: EmoveOutputs::ZERO.poses,
        ..kept.emove
    };
    let track = &mut known.emove.estimates.track;
    if track.course == Course::Known {
        // While the place is known, the end of the track follows the noise of the resolvers.
        track.end = EmoveOutputs::ZERO.estimates.track.end;
    }
    known.prim = PrimOutputs::ZERO;
    (known.grip, known.hand) = (of_gripper(&kept.grip), of_gripper(&kept.hand));
    (known.v_grip, known.tool_grip) = (JawsOutputs::ZERO, JawsOutputs::ZERO);
    known.quick_change = QuickChangeOutputs::ZERO;
    let gripped = PedestalStatus { gripped: kept.pedestal.status.gripped, ..PedestalStatus::ZERO };
    known.pedestal = PedestalOutputs { status: gripped, ..kept.pedestal };
    known.table = TableOutputs { status: TableStatus::ZERO, ..kept.table };
    known
}

fn of_gripper(kept: &GripOutputs) -> GripOutputs {
    let status = GripStatus { initialized: kept.status.initialized, ..GripStatus::ZERO };
    GripOutputs { status, calibration: kept.calibration, ..GripOutputs::ZERO }
}

/// Kept buffers for a controller that starts after tick `tick`. Every process finds a command that it has not executed,
/// so it adopts its estimates and starts nothing by itself (docs/design/handshake.md "Restart").
#[must_use]
pub fn resumed(kept: &CommonMemory, tick: Tick) -> CommonMemory {
    let mut memory = *kept;
    for process in ProcessId::ALL {
        memory.header_mut(*process).stamp = tick;
    }
    let (emove, pedestal) = (&mut memory.emove, &mut memory.pedestal);
    for number in [
        &mut memory.task.subtask.number,
        &mut memory.subtask.emove.number,
        &mut memory.subtask.pedestal.number,
        &mut emove.prim.number,
        &mut emove.quick_change.number,
        &mut emove.grip.number,
        &mut emove.v_grip.number,
        &mut emove.tool_grip.number,
        &mut memory.prim.t3i.number,
        &mut pedestal.hand.number,
        &mut pedestal.table.number,
    ] {
        *number = (*number).max(1);
    }
    memory
}

#[cfg(test)]
mod tests {
    use interfaces::Decided;

    use super::*;

    #[test]
    fn readings_are_no_knowledge_and_estimates_are() {
        let memory = CommonMemory::default();
        let known = |memory: &CommonMemory| knowledge(&kept(memory));
        let mut reading = memory;
        reading.prim.status.sensed = 7;
        reading.grip.status.position = 120;
        reading.task.header.decided = Some(Decided { table: 1, row: 2 });
        reading.t3i.status.counters.naks = 3;
        reading.subtask.pedestal.cycle = Tick(9);
        assert_eq!(known(&reading), known(&memory));
        let mut estimate = memory;
        estimate.emove.estimates.empty = true;
        assert_ne!(known(&estimate), known(&memory));
    }

    #[test]
    fn bias_of_the_force_sensor_is_not_kept() {
        let mut memory = CommonMemory::default();
        memory.prim.bias = Some([1.0; 4]);
        memory.emove.estimates.calibrated = CalibratedAt::Safe;
        let kept = kept(&memory);
        assert_eq!((kept.prim.bias, kept.emove.estimates.calibrated), (None, CalibratedAt::Drum));
    }

    #[test]
    fn every_command_of_a_resumed_controller_has_a_number() {
        let memory = resumed(&CommonMemory::default(), Tick(40));
        for process in ProcessId::ALL {
            assert_eq!(memory.header(*process).stamp, Tick(40));
            assert_ne!(memory.command_number(*process), Some(0), "{process}");
        }
    }
}

//! Effects of the air supply and of a stuck ring on the outputs.

use interfaces::device::{DeviceOutputs, valve};

/// Remove the air supply: nothing flows in; closed valves and check valves keep their air (ASSUMED). Venting still
/// works.
pub const fn cut_air(outputs: &mut DeviceOutputs) {
    outputs.grip.bits &= valve::VENT;
    outputs.pedestal_hand.bits &= valve::VENT;
    (outputs.v_grip.open, outputs.v_grip.close) = (false, false);
    (outputs.tool_grip.open, outputs.tool_grip.close) = (false, false);
    (outputs.quick_change.lock, outputs.quick_change.unlock) = (false, false);
}

/// Hold the locking ring against the air.
pub const fn hold_ring(outputs: &mut DeviceOutputs) {
    outputs.quick_change.port = false;
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::point::Output;

    #[test]
    fn fingers_without_air_can_only_vent() {
        let mut outputs = DeviceOutputs::default();
        Output::valves().for_each(|valve| valve.write(&mut outputs, 1));
        cut_air(&mut outputs);
        assert_eq!((outputs.grip.bits, outputs.pedestal_hand.bits), (valve::VENT, valve::VENT));
        assert!(!outputs.v_grip.close && !outputs.tool_grip.close && !outputs.quick_change.unlock);
    }
}

//! Estimates of a resumed controller that its sensors contradict, in words for the person who decides on `job go`.

use interfaces::{
    CommonMemory,
    emove::{Estimates, ObjectGrip},
};

/// Ticks after which every process has read its sensors.
const READ: u32 = 25;

/// The adopted estimates, until they are contradicted or the job continues.
pub struct Contradictions {
    kept: Estimates,
    gripper: Option<u8>,
    ticks: u32,
}

impl Contradictions {
    pub const fn of(kept: &CommonMemory) -> Self {
        let emove = &kept.emove;
        Self { kept: emove.estimates, gripper: emove.status.end_effector_id, ticks: 0 }
    }

    /// The contradictions that are new in this tick.
    pub fn look(&mut self, memory: &CommonMemory) -> Vec<String> {
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks < READ {
            return Vec::new();
        }
        let (kept, now) = (&mut self.kept, &memory.emove.estimates);
        let mut found = Vec::new();
        let pins = memory.quick_change.status.end_effector_id;
        if let Some(gripper) = self.gripper.filter(|gripper| pins != Some(*gripper)) {
            let pins = pins.map_or_else(|| "no gripper".to_owned(), |id| format!("gripper {id}"));
            found.push(format!("the record has gripper {gripper} on the arm, the id pins name {pins}"));
            self.gripper = None;
        }
        let is_lost = now.place.is_none() && now.way.is_none();
        let was = kept.place.map(|place| place.site).or_else(|| kept.way.map(|way| way.to.site));
        if let Some(site) = was.filter(|_| is_lost) {
            found.push(format!(
                "the record has the robot at or near {}, the resolvers show it elsewhere: its place is not known",
                site.location
            ));
            (kept.place, kept.way) = (None, None);
        }
        if let Some(held) = kept.held.filter(|_| now.held.is_none()) {
            let ObjectGrip { object, grip } = held.object;
            found.push(format!(
                "the record has {object} with grip {grip:+} in the gripper, and its sensors contradict that"
            ));
            kept.held = None;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use interfaces::emove::{Grasped, RobotPlace};

    use super::*;

    #[test]
    fn each_contradiction_is_reported_once() {
        let mut memory = CommonMemory::default();
        memory.emove.estimates.place = Some(RobotPlace::default());
        memory.emove.estimates.held = Some(Grasped::default());
        memory.emove.status.end_effector_id = Some(1);
        memory.quick_change.status.end_effector_id = Some(1);
        let mut contradictions = Contradictions::of(&memory);
        for _ in 0..2 * READ {
            assert_eq!(contradictions.look(&memory), [""; 0]);
        }
        memory.quick_change.status.end_effector_id = Some(2);
        memory.emove.estimates = Estimates::default();
        let found = contradictions.look(&memory);
        assert_eq!(found.len(), 3, "{found:?}");
        assert_eq!(found[0], "the record has gripper 1 on the arm, the id pins name gripper 2");
        assert!(found[1].ends_with("its place is not known"), "{found:?}");
        assert_eq!(contradictions.look(&memory), [""; 0]);
    }
}

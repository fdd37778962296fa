//! Units of the numbers in the buffers, which are integers as in the manual (docs/design/units.md).

/// Ends of field names, from specific to general, with their units.
const UNITS: [(&str, &str); 44] = [
    ("range_mm", "mm"),
    ("nearest.inches", "in"),
    ("nearest.degrees", "deg"),
    ("status.sensed", "lb, in lb, 0/1"),
    ("status.distance", "0.01 in"),
    ("joystick.velocity", "0.1 %"),
    ("joystick.x", "0.1 %"),
    ("joystick.y", "0.1 %"),
    ("table_potentiometer", "counts"),
    ("potentiometer", "counts"),
    ("strain_left", "counts"),
    ("strain_right", "counts"),
    ("force.x", "counts"),
    ("force.y", "counts"),
    ("force.z", "counts"),
    ("force.moment", "counts"),
    ("resolvers.counts", "counts"),
    ("deviation", "0.01 in"),
    ("robot_lag", "ms"),
    ("motor_counter", "0.01 deg"),
    ("motor.steps", "0.01 deg"),
    ("left_force", "lb"),
    ("right_force", "lb"),
    ("grasp_force", "lb"),
    ("grip_force", "lb"),
    ("force", "lb"),
    ("grasp_size", "0.01 in"),
    ("grip_size", "0.01 in"),
    ("opening", "0.01 in"),
    ("size", "0.01 in"),
    ("velocity", "0.01 in/s"),
    ("table_angle", "0.1 deg"),
    ("table_position", "0.1 deg"),
    ("table.status.position", "0.1 deg"),
    ("table.angle", "0.1 deg"),
    ("grip.position", "0.01 in"),
    ("hand.position", "0.01 in"),
    ("status.position", "0.01 in"),
    ("vision.y", "0.01 in"),
    ("vision.z", "0.01 in"),
    ("vision.angle", "0.01 deg"),
    ("tool", "0.01 in"),
    ("wrist", "0.01 in"),
    ("finger", "0.01 in"),
];

/// The unit of a field, from its path; empty for none.
#[must_use]
pub fn unit(path: &str) -> &'static str {
    let plain: String = strip_indices(path);
    let fits = |end: &str| plain == end || plain.strip_suffix(end).is_some_and(|front| front.ends_with('.'));
    UNITS.iter().find(|(end, _)| fits(end)).map_or("", |(_, unit)| unit)
}

/// A path without array indices: `poses[2].tool[0]` becomes `poses.tool`.
fn strip_indices(path: &str) -> String {
    let mut depth = 0_u32;
    let keep = |letter: &char| {
        match letter {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && *letter != ']'
    };
    path.chars().filter(keep).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, ExternalInputs};
    use record::layout;

    #[test]
    fn every_unit_matches_a_field() {
        let paths: Vec<String> = [CommonMemory::STRUCT, ExternalInputs::STRUCT]
            .into_iter()
            .flat_map(layout::leaves)
            .map(|leaf| strip_indices(&leaf.path))
            .collect();
        let is_there = |end: &str| paths.iter().any(|path| path == end || path.ends_with(&format!(".{end}")));
        let unknown: Vec<_> = UNITS.iter().map(|(end, _)| *end).filter(|end| !is_there(end)).collect();
        assert_eq!(unknown, Vec::<&str>::new());
    }

    #[test]
    fn more_specific_name_decides() {
        assert_eq!(unit("table.status.position"), "0.1 deg");
        assert_eq!(unit("grip.status.position"), "0.01 in");
        assert_eq!(unit("devices.force.x"), "counts");
        assert_eq!(unit("emove.grip.force"), "lb");
        assert_eq!(unit("prim.poses[2].pose.tool[0]"), "0.01 in");
        assert_eq!(unit("task.status.echo"), "");
        assert_eq!(unit("devices.joystick.velocity"), "0.1 %");
    }
}

//! Two ROS 2 messages in CDR: `sensor_msgs/msg/JointState` and `std_msgs/msg/String` with the robot description. CDR
//! here is little-endian with the four-byte header of XCDR1; every number is aligned to its size.

pub const JOINT_STATE: &str = "sensor_msgs/msg/JointState";
pub const STRING: &str = "std_msgs/msg/String";

/// Definition of [`JOINT_STATE`], including the messages to which it refers.
pub const JOINT_STATE_DEFINITION: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

pub const STRING_DEFINITION: &str = "string data\n";

struct Cdr<'a> {
    out: &'a mut Vec<u8>,
    start: usize,
}

impl<'a> Cdr<'a> {
    fn new(out: &'a mut Vec<u8>) -> Self {
        out.extend_from_slice(&[0, 1, 0, 0]);
        let start = out.len();
        Self { out, start }
    }

    fn align(&mut self, to: usize) {
        let length = self.out.len() - self.start;
        self.out.resize(self.start + length.next_multiple_of(to), 0);
    }

    fn number(&mut self, value: u32) {
        self.align(4);
        self.out.extend_from_slice(&value.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.number(text.len() as u32 + 1);
        self.out.extend_from_slice(text.as_bytes());
        self.out.push(0);
    }

    fn doubles(&mut self, values: &[f64]) {
        self.number(values.len() as u32);
        for value in values {
            self.align(8);
            self.out.extend_from_slice(&value.to_le_bytes());
        }
    }
}

/// Append a `JointState`: `time` in ns since 1970, positions in radians or metres; velocities and efforts stay empty.
pub fn joint_state(time: u64, names: &[String], positions: &[f64], out: &mut Vec<u8>) {
    let mut cdr = Cdr::new(out);
    cdr.number((time / 1_000_000_000) as u32);
    cdr.number((time % 1_000_000_000) as u32);
    cdr.text("");
    cdr.number(names.len() as u32);
    names.iter().for_each(|name| cdr.text(name));
    cdr.doubles(positions);
    cdr.doubles(&[]);
    cdr.doubles(&[]);
}

pub fn string(text: &str, out: &mut Vec<u8>) {
    Cdr::new(out).text(text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn string_has_the_expected_bytes() {
        let mut out = Vec::new();
        string("<r/>", &mut out);
        assert_eq!(out, b"\x00\x01\x00\x00\x05\x00\x00\x00<r/>\x00");
    }

    #[test]
    fn joint_state_has_the_expected_bytes() {
        let mut out = Vec::new();
        joint_state(2_000_000_003, &["base".into()], &[0.5], &mut out);
        let expected: &[&[u8]] = &[
            &[0, 1, 0, 0],
            &[2, 0, 0, 0, 3, 0, 0, 0],
            &[1, 0, 0, 0, 0, 0, 0, 0], // frame_id "", padded to 4
            &[1, 0, 0, 0],             // one name
            b"\x05\0\0\0base\0\0\0\0", // padded to 4
            &[1, 0, 0, 0, 0, 0, 0, 0], // one position, padded to 8
            &[0, 0, 0, 0, 0, 0, 0xE0, 0x3F],
            &[0, 0, 0, 0],
            &[0, 0, 0, 0],
        ];
        assert_eq!(out, expected.concat());
    }
}

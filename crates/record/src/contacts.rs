//! Marks of the contacts: `/contacts`. A message has all valid marks, so that a reader needs only the last one.

use crate::{
    input::Touch,
    proto::scene::{self, Colour, Entity, Primitive},
};

pub const CONTACTS: &str = "/contacts";

pub(crate) const INCH: f64 = 0.0254;
/// The mark of a permitted contact: its diameter, m, and its colour.
const PERMITTED: (f64, Colour) = (0.03, [0.15, 0.75, 0.30, 0.9]);
const COLLISION: (f64, Colour) = (0.06, [0.90, 0.10, 0.10, 0.85]);
const LETTERS: f64 = 0.05; // height of the letters at a collision, m
/// Height of a text above the middle of its mark, and distance between the texts of further collisions, m.
const ABOVE: (f64, f64) = (0.14, 0.07);

/// Append the marks to a `foxglove.SceneUpdate`. `time` in nanoseconds since 1970.
pub fn put_marks(time: u64, touches: &[Touch], out: &mut Vec<u8>) {
    scene::put_clear(time, out);
    let (mut above, line) = ABOVE;
    for Touch { mover, obstacle, point, depth, collides } in touches {
        let (diameter, colour) = if *collides { COLLISION } else { PERMITTED };
        let [x, y, z] = point.map(|inches| inches * INCH);
        let [east, north, up] = point;
        let facts = [
            ("mover", mover.clone()),
            ("obstacle", obstacle.clone()),
            ("point_in", format!("{east:.2} {north:.2} {up:.2}")),
            ("depth_in", format!("{depth:.3}")),
            ("permitted", (!collides).to_string()),
        ];
        let id = format!("{mover}, {obstacle}");
        let primitive = Primitive::Ball([x, y, z], diameter, colour);
        scene::put_entity(time, &Entity { facts: &facts, ..Entity::new(&id, "world", primitive) }, out);
        if *collides {
            let text = format!("{mover} in {obstacle}");
            let primitive = Primitive::Text(&text, [x, y, z + above], LETTERS, colour);
            scene::put_entity(time, &Entity::new(&text, "world", primitive), out);
            above += line;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proto::wire::{Fields, Value};

    fn touch(collides: bool) -> Touch {
        let (mover, obstacle) = ("forearm".into(), "vise".into());
        Touch { mover, obstacle, point: [10.0, -20.0, 5.0], depth: 0.25, collides }
    }

    fn count(data: &[u8], number: u64) -> usize {
        Fields(data).filter(|field| matches!(field, (n, Value::Bytes(_)) if *n == number)).count()
    }

    fn marks(touches: &[Touch]) -> Vec<u8> {
        let mut data = Vec::new();
        put_marks(1, touches, &mut data);
        data
    }

    #[test]
    fn ended_contact_is_deleted() {
        let none = marks(&[]);
        assert_eq!((count(&none, 1), count(&none, 2)), (1, 0));
    }

    #[test]
    fn only_collisions_are_named() {
        assert_eq!(count(&marks(&[touch(false)]), 2), 1);
        assert_eq!(count(&marks(&[touch(true)]), 2), 2);
    }

    #[test]
    fn contact_mark_has_both_bodies_and_the_place() {
        let data = marks(&[touch(false)]);
        let text = String::from_utf8_lossy(&data);
        for fact in ["forearm", "vise", "10.00 -20.00 5.00", "0.250", "true"] {
            assert!(text.contains(fact), "{fact} is not in {text}");
        }
        assert!(data.windows(8).any(|bytes| bytes == 0.254_f64.to_le_bytes()), "metres for the viewer");
    }
}

//! Keeps the newest pose of each link, from messages that contain only the moved links.
//!
//! `foxglove.FrameTransforms` has transforms as field 1; their field 3, `child_frame_id`, names the link. A viewer that
//! connects during the run needs all links.

use std::collections::BTreeMap;

use record::proto::wire::{self, Fields, Value};

pub const SCHEMA: &str = "foxglove.FrameTransforms";
const LONGEST: usize = 4096; // greatest length of a transform, bytes; a longer field is not a transform
const LINKS: usize = 4096;

/// Encoded transforms of the links, in the order in which the links first appeared.
#[derive(Clone, Debug, Default)]
pub struct Frames {
    transforms: Vec<Vec<u8>>,
    places: BTreeMap<Vec<u8>, usize>,
}

impl Frames {
    pub fn add(&mut self, message: &[u8]) {
        for field in Fields(message) {
            let (1, Value::Bytes(transform)) = field else { continue };
            let Some(link) = link(transform).filter(|_| transform.len() <= LONGEST) else { continue };
            let known = self.places.get(link).and_then(|place| self.transforms.get_mut(*place));
            if let Some(known) = known {
                transform.clone_into(known);
            } else if self.transforms.len() < LINKS {
                self.places.insert(link.to_owned(), self.transforms.len());
                self.transforms.push(transform.to_owned());
            }
        }
    }

    pub fn message(&self) -> Vec<u8> {
        let mut message = Vec::new();
        self.transforms.iter().for_each(|transform| wire::bytes(1, transform, &mut message));
        message
    }
}

fn link(transform: &[u8]) -> Option<&[u8]> {
    Fields(transform).find_map(|field| match field {
        (3, Value::Bytes(link)) => Some(link),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use record::{Transform, proto::foxglove};

    #[test]
    fn newest_pose_of_each_link_is_kept() {
        let place = |x: f64| Transform { position: [x, 0.0, 0.0], ..Transform::IDENTITY };
        let mut frames = Frames::default();
        let message = |links: &[(&str, f64)]| {
            let mut data = Vec::new();
            links.iter().for_each(|(name, x)| {
                foxglove::put_transform(7, "world", name, &place(*x), &mut data);
            });
            data
        };
        frames.add(&message(&[("b", 1.0), ("a", 2.0)]));
        frames.add(&message(&[("a", 3.0)]));
        assert_eq!(frames.message(), message(&[("b", 1.0), ("a", 3.0)]));
    }

    proptest::proptest! {
        #[test]
        fn no_bytes_panic(bytes: Vec<u8>) {
            let mut frames = Frames::default();
            frames.add(&bytes);
            frames.message();
        }
    }
}

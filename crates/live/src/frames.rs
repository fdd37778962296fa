//! The newest place of each link, from messages that contain only links that have moved.
//!
//! `foxglove.FrameTransforms` has transforms as field 1, each with its link, `child_frame_id`, as field 3. A
//! viewer that begins in the middle needs all of them.

use std::collections::BTreeMap;

use record::proto::wire::{self, Fields, Value};

/// Schema of the messages that are assembled here.
pub const SCHEMA: &str = "foxglove.FrameTransforms";
/// Most bytes of one transform; a longer field is not a transform.
const LONGEST: usize = 4096;
/// Links at most.
const LINKS: usize = 4096;

/// The bytes of the transforms, in the order in which their links first came.
#[derive(Debug, Default)]
pub struct Frames {
    transforms: Vec<Vec<u8>>,
    /// Where the transform of a link is.
    places: BTreeMap<Vec<u8>, usize>,
}

impl Frames {
    /// Add the transforms of a message.
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

    /// A message with all of them.
    pub fn message(&self) -> Vec<u8> {
        let mut message = Vec::new();
        self.transforms.iter().for_each(|transform| wire::bytes(1, transform, &mut message));
        message
    }
}

/// The link of a transform.
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
    fn the_newest_place_of_each_link_stays() {
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

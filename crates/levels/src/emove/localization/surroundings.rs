//! The known places nearest to a robot that is at no known place.

use geometry::frame::Frame;
use interfaces::{emove::NearPlace, location::Site};
use rcs_core::Plain;
use taskdata::files::{LocptId, TaskData};

use crate::{emove::motion::relative::Relative, places::named};

const NEAREST_PER_TICK: u32 = 16; // location points

/// The nearest known places of a robot at an unknown place. The search repeats without end.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Surroundings {
    looked: u32,                         // location points searched in this round
    found: [Option<NearPlace>; 2],       // the nearest of this round, sorted by distance
    pub nearest: [Option<NearPlace>; 2], // the nearest of the last complete round
}

impl Surroundings {
    pub(super) fn look(&mut self, present: &Frame, data: &TaskData<'_>) {
        for _ in 0..NEAREST_PER_TICK {
            let next = LocptId::new(self.looked.saturating_add(1));
            let Some(locpt) = data.locpt(next) else {
                *self = Self { nearest: self.found, ..Self::default() };
                return;
            };
            self.looked = next.number();
            if is_plain(&Site::point(locpt.name, next), data) {
                self.insert(NearPlace::seen(locpt.name, &locpt.frame, present));
            }
        }
    }

    fn insert(&mut self, place: NearPlace) {
        let nearer = |than: Option<NearPlace>| than.is_none_or(|than| place.inches < than.inches);
        let [first, second] = self.found;
        if nearer(first) {
            self.found = [Some(place), first];
        } else if nearer(second) {
            self.found = [first, Some(place)];
        }
    }
}

/// False in a holster, at the tool drum and at the pedestal, where the departure depends on gripper, tool and part.
pub(super) fn is_plain(site: &Site, data: &TaskData<'_>) -> bool {
    let has = |relative: Relative| relative.record(site, data).is_some();
    !has(Relative::QcaBack) && !has(Relative::InsIn) && site.location.as_str() != named::PEDESTAL
}

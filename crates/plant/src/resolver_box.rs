//! The resolver electronics (III.3.2). A button per joint sets its reading to that of HOME while the switch is at
//! MANUAL (IV.3.3 step 11). The electronics cannot detect HOME: elsewhere the reset makes the readings wrong (CHOSEN).

use geometry::kinematics::HOME_JOINTS;
use interfaces::{
    device::{RESOLVER_COUNTS, Resolvers},
    station::ResolverKey,
};
use serde::{Deserialize, Serialize};

use crate::{
    noise::{Noise, Stream},
    sensor::resolver,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ResolverRefusal {
    #[error("the resolver electronics is at AUTO: `resolvers manual` comes first")]
    Auto,
    #[error("the resolver electronics has joints 0 to 5, and no joint {0}")]
    NoJoint(u8),
}

#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct ResolverBox {
    manual: bool,
    zero: [u32; 6],
    shown: [u32; 6], // the last readings, with `zero`
}

impl ResolverBox {
    /// Add the zeros to the words of a tick.
    pub fn show(&mut self, resolvers: &mut Resolvers) {
        for (word, zero) in resolvers.counts.iter_mut().zip(self.zero) {
            *word = (*word + zero) % RESOLVER_COUNTS;
        }
        self.shown = resolvers.counts;
    }

    /// Turn the switch or press a button. On error, the state is unchanged.
    pub fn press(&mut self, key: ResolverKey) -> Result<(), ResolverRefusal> {
        match key {
            ResolverKey::Manual(on) => self.manual = on,
            ResolverKey::Joint(joint) => {
                let at = usize::from(joint);
                if !self.manual {
                    return Err(ResolverRefusal::Auto);
                }
                let (Some(zero), Some(shown)) = (self.zero.get_mut(at), self.shown.get_mut(at)) else {
                    return Err(ResolverRefusal::NoJoint(joint));
                };
                let home = resolver::counts(HOME_JOINTS[at], 0.0, &mut Noise::new(0, Stream::Resolvers));
                *zero = (*zero + RESOLVER_COUNTS + home - *shown) % RESOLVER_COUNTS;
                *shown = home;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_home(offset: u32) -> Resolvers {
        let mut noise = Noise::new(0, Stream::Resolvers);
        let counts =
            HOME_JOINTS.map(|angle| (resolver::counts(angle, 0.0, &mut noise) + offset) % RESOLVER_COUNTS);
        Resolvers { counts, valid: true }
    }

    /// The readings of a robot at HOME whose resolvers are off by an offset.
    fn shown(electronics: &mut ResolverBox, offset: u32) -> [u32; 6] {
        let mut words = at_home(offset);
        electronics.show(&mut words);
        words.counts
    }

    #[test]
    fn button_sets_its_joint_reading_to_that_of_home() {
        for offset in [200, RESOLVER_COUNTS - 200] {
            let mut electronics = ResolverBox::default();
            let home = at_home(0).counts;
            assert_ne!(shown(&mut electronics, offset), home);
            assert_eq!(electronics.press(ResolverKey::Joint(2)), Err(ResolverRefusal::Auto));
            electronics.press(ResolverKey::Manual(true)).unwrap();
            electronics.press(ResolverKey::Joint(2)).unwrap();
            let now = shown(&mut electronics, offset);
            assert_eq!((now[2], now[1] == home[1]), (home[2], false), "the other joints stay as they are");
            for joint in 0..6 {
                electronics.press(ResolverKey::Joint(joint)).unwrap();
            }
            assert_eq!(shown(&mut electronics, offset), home);
            electronics.press(ResolverKey::Joint(2)).unwrap();
            assert_eq!(shown(&mut electronics, offset), home);
            assert_eq!(electronics.press(ResolverKey::Joint(6)), Err(ResolverRefusal::NoJoint(6)));
            electronics.press(ResolverKey::Manual(false)).unwrap();
            assert_eq!(electronics.press(ResolverKey::Joint(0)), Err(ResolverRefusal::Auto));
        }
    }
}

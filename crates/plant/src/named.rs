//! Points of the devices are saved by their names.

use interfaces::point::{Input, Output};
use serde::{Deserialize, Deserializer, Serializer, de};

pub trait Named: Sized + Copy {
    fn name(self) -> &'static str;
    fn named(name: &str) -> Option<Self>;
}

impl Named for Input {
    fn name(self) -> &'static str {
        self.name()
    }

    fn named(name: &str) -> Option<Self> {
        Self::named(name)
    }
}

impl Named for Output {
    fn name(self) -> &'static str {
        self.name()
    }

    fn named(name: &str) -> Option<Self> {
        Self::named(name)
    }
}

pub fn serialize<T: Named, S: Serializer>(point: &T, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(point.name())
}

pub fn deserialize<'de, T: Named, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    let name = String::deserialize(deserializer)?;
    T::named(&name).ok_or_else(|| de::Error::custom(format_args!("there is no point {name:?}")))
}

//! Serde support for field types from other crates, with `#[serde(with = "crate::image::record")]`. It preserves every
//! bit.

/// Records and coded enums of the controller, as their byte image.
pub mod record {
    use rcs_core::{
        Plain,
        plain::{Writer, from_bytes},
    };
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    pub fn serialize<T: Plain, S: Serializer>(record: &T, serializer: S) -> Result<S::Ok, S::Error> {
        let mut image = vec![0_u8; T::SIZE];
        record.encode(&mut Writer::new(&mut image));
        image.serialize(serializer)
    }

    pub fn deserialize<'de, T: Plain, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
        from_bytes(&Vec::<u8>::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

/// Enums of the controller without data, as the number of their variant: the bytes of an enum with serde's own traits.
pub mod word {
    use rcs_core::{
        Plain,
        plain::{from_bytes, to_bytes},
    };
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub fn serialize<T: Plain, S: Serializer>(word: &T, serializer: S) -> Result<S::Ok, S::Error> {
        let [code] = to_bytes::<1, _>(word);
        serializer.serialize_u32(u32::from(code))
    }

    pub fn deserialize<'de, T: Plain, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
        let code = u8::try_from(u32::deserialize(deserializer)?).map_err(D::Error::custom)?;
        from_bytes(&[code]).map_err(D::Error::custom)
    }
}

/// Frames, as position and the columns of the rotation.
pub mod frame {
    use geometry::frame::{Frame, Rotation, Vector};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(frame: &Frame, serializer: S) -> Result<S::Ok, S::Error> {
        let axes: [[f64; 3]; 4] =
            [frame.position.into(), frame.x().into(), frame.y().into(), frame.z().into()];
        axes.serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Frame, D::Error> {
        let [position, x, y, z] = <[[f64; 3]; 4]>::deserialize(deserializer)?.map(Vector::from);
        let rotation = Rotation::from_basis_unchecked(&[x, y, z]);
        Ok(Frame { position, rotation })
    }
}

//! Materials: a few colours that are easy to distinguish.

use crate::{description::PartType, solid::Family};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Material {
    Orange,
    Cream,
    Charcoal,
    Rubber,
    Steel,
    Bright,
    White,
    Petrol,
    Blue,
    PaleBlue,
    Slate,
    Maple,
    Yellow,
    Concrete,
    Pad,
    Green,
    Red,
    Violet,
    Brass,
    Gold,
    Light,
}

/// sRGB colour, metallic factor, roughness factor, emission.
struct Look {
    colour: u32,
    metal: f64,
    rough: f64,
    light: f64,
}

impl Material {
    const fn look(self) -> Look {
        let (colour, metal, rough, light) = match self {
            Self::Orange => (0x00E8_6A1C, 0.0, 0.42, 0.0),
            Self::Cream => (0x00EF_E6D2, 0.0, 0.45, 0.0),
            Self::Charcoal => (0x0034_393F, 0.15, 0.50, 0.0),
            Self::Rubber => (0x0017_191C, 0.0, 0.65, 0.0),
            Self::Steel => (0x00A3_ABB3, 0.35, 0.38, 0.0),
            Self::Bright => (0x00D2_D8DD, 0.40, 0.25, 0.0),
            Self::White => (0x00E9_ECEE, 0.0, 0.40, 0.0),
            Self::Petrol => (0x001F_5A6B, 0.0, 0.45, 0.0),
            Self::Blue => (0x0037_6FB3, 0.0, 0.50, 0.0),
            Self::PaleBlue => (0x00A9_C8E8, 0.0, 0.50, 0.0),
            Self::Slate => (0x0063_707C, 0.0, 0.55, 0.0),
            Self::Maple => (0x00C9_A06A, 0.0, 0.60, 0.0),
            Self::Yellow => (0x00F5_C518, 0.0, 0.45, 0.0),
            Self::Concrete => (0x00B9_BBB8, 0.0, 0.80, 0.0),
            Self::Pad => (0x002B_2F33, 0.0, 0.80, 0.0),
            Self::Green => (0x002F_9E57, 0.0, 0.45, 0.0),
            Self::Red => (0x00D2_3B32, 0.0, 0.45, 0.0),
            Self::Violet => (0x0079_51B8, 0.0, 0.45, 0.0),
            Self::Brass => (0x00D9_A928, 0.30, 0.30, 0.0),
            Self::Gold => (0x00F2_C84B, 0.40, 0.30, 0.0),
            Self::Light => (0x00FF_F4D6, 0.0, 0.50, 0.6),
        };
        Look { colour, metal, rough, light }
    }

    /// The colour of a kind of part, which its family determines.
    #[must_use]
    pub fn of_part(kind: &PartType) -> Self {
        match Family::of(kind) {
            Family::Tool => Self::Red,
            Family::Round => Self::Brass,
            Family::Block => Self::Violet,
            Family::Bar => Self::Green,
        }
    }

    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Orange => "orange",
            Self::Cream => "cream",
            Self::Charcoal => "charcoal",
            Self::Rubber => "rubber",
            Self::Steel => "steel",
            Self::Bright => "bright",
            Self::White => "white",
            Self::Petrol => "petrol",
            Self::Blue => "blue",
            Self::PaleBlue => "pale-blue",
            Self::Slate => "slate",
            Self::Maple => "maple",
            Self::Yellow => "yellow",
            Self::Concrete => "concrete",
            Self::Pad => "pad",
            Self::Green => "green",
            Self::Red => "red",
            Self::Violet => "violet",
            Self::Brass => "brass",
            Self::Gold => "gold",
            Self::Light => "light",
        }
    }

    /// sRGB colour: red, green, blue from 0 to 1.
    #[must_use]
    pub fn colour(self) -> [f64; 3] {
        let Look { colour, .. } = self.look();
        [16, 8, 0].map(|shift| f64::from(colour >> shift & 0xFF) / 255.0)
    }

    #[must_use]
    pub fn gltf(self) -> String {
        let Look { metal, rough, light, .. } = self.look();
        // From sRGB values to linear light, which glTF uses.
        let linear = |value: f64| {
            let light =
                if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) };
            (light * 1e4).round() / 1e4
        };
        let [r, g, b] = self.colour().map(linear);
        format!(
            r#"{{"name":"{}","pbrMetallicRoughness":{{"baseColorFactor":[{r},{g},{b},1],"metallicFactor":{metal},"roughnessFactor":{rough}}},"emissiveFactor":[{},{},{}]}}"#,
            self.name(),
            r * light,
            g * light,
            b * light
        )
    }
}

//! Places of points: `arm holding 0x800.5`.

use couplers::Area;

const AREAS: [Area; 4] = [Area::Coil, Area::Discrete, Area::Input, Area::Holding];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place<'t> {
    pub device: &'t str,
    pub area: Area,
    pub address: u16,
    pub bit: Option<u8>,
}

/// Expected form of a place, for messages.
pub(super) const EXPECTED: &str = "\"DEVICE coil|discrete|input|holding ADDRESS[.BIT]\"";

impl<'t> Place<'t> {
    /// Reads a place.
    ///
    /// # Errors
    /// What was expected.
    pub(super) fn parse(text: &'t str) -> Result<Self, String> {
        let words: Vec<&str> = text.split(' ').collect();
        let [device, area, address] = words[..] else { return Err(EXPECTED.to_owned()) };
        let area = AREAS.into_iter().find(|one| one.text() == area);
        let area = area.ok_or("one of coil, discrete, input and holding after the device")?;
        let (register, bit) = match address.split_once('.') {
            Some((register, bit)) => (register, Some(bit)),
            None => (address, None),
        };
        let address = number(register).ok_or("an address from 0 to 65535 (0xFFFF)")?;
        let bit = match bit {
            None => None,
            Some(_) if area.has_bits() => {
                return Err(format!("no bit after the address of a {}", area.text()));
            }
            Some(bit) => Some(bit.parse().ok().filter(|bit| *bit < 16).ok_or("a bit from 0 to 15")?),
        };
        Ok(Self { device, area, address, bit })
    }
}

/// A decimal number, or a hexadecimal one after `0x`.
fn number(text: &str) -> Option<u16> {
    if text.starts_with('+') {
        return None;
    }
    match text.strip_prefix("0x") {
        Some(digits) if !digits.starts_with('+') => u16::from_str_radix(digits, 16).ok(),
        Some(_) => None,
        None => text.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_in_both_notations() {
        let place = Place::parse("arm holding 0x800.5").unwrap();
        assert_eq!(place, Place { device: "arm", area: Area::Holding, address: 0x800, bit: Some(5) });
        assert_eq!(Place::parse("a coil 12").unwrap().address, 12);
        for (wrong, expected) in [
            ("arm holding", EXPECTED),
            ("arm  holding 1", EXPECTED),
            ("arm register 1", "one of coil"),
            ("arm input 65536", "an address"),
            ("arm input 0x", "an address"),
            ("arm input +1", "an address"),
            ("arm input 1.16", "a bit from 0 to 15"),
            ("arm coil 1.0", "no bit"),
        ] {
            let said = Place::parse(wrong).unwrap_err();
            assert!(said.starts_with(expected), "{wrong}: {said}");
        }
    }
}

//! Writes small pictures as PNG: with a palette, and deflate with fixed codes and matches at two distances only: the
//! previous byte and the row above. This is enough for drawn pictures.

/// Longest match that deflate can encode.
const LONGEST: usize = 258;
/// Longest match whose code has no extra bits, except [`LONGEST`].
const PLAIN: usize = 10;

/// A picture of at most 144 colours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width, pixels.
    pub width: usize,
    /// Palette indices, row by row from the top.
    pub pixels: Vec<u8>,
}

impl Picture {
    /// The picture as a PNG file. `palette` has red, green, blue of each colour; the width must be 128 to 191 pixels.
    #[must_use]
    pub fn png(&self, palette: &[[u8; 3]]) -> Vec<u8> {
        let mut raw = Vec::with_capacity(self.pixels.len() + self.pixels.len() / self.width.max(1));
        for row in self.pixels.chunks(self.width) {
            // Filter type 0: none.
            raw.push(0);
            raw.extend_from_slice(row);
        }
        let height = self.pixels.len() / self.width.max(1);
        let mut head = Vec::new();
        [self.width, height].iter().for_each(|size| head.extend_from_slice(&(*size as u32).to_be_bytes()));
        // Bit depth 8, palette colour, deflate, adaptive filtering, no interlace.
        head.extend_from_slice(&[8, 3, 0, 0, 0]);
        let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
        chunk(b"IHDR", &head, &mut file);
        chunk(b"PLTE", palette.as_flattened(), &mut file);
        chunk(b"IDAT", &zlib(&raw, self.width + 1), &mut file);
        chunk(b"IEND", &[], &mut file);
        file
    }
}

fn chunk(kind: &[u8; 4], data: &[u8], file: &mut Vec<u8>) {
    file.extend_from_slice(&(data.len() as u32).to_be_bytes());
    let start = file.len();
    file.extend_from_slice(kind);
    file.extend_from_slice(data);
    let check = crc32(&file[start..]);
    file.extend_from_slice(&check.to_be_bytes());
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| crc >> 1 ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 })
    })
}

fn adler32(bytes: &[u8]) -> u32 {
    let (a, b) = bytes.iter().fold((1_u32, 0_u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65_521;
        (a, (b + a) % 65_521)
    });
    b << 16 | a
}

/// A bit writer; the first bit goes to the lowest place of a byte.
#[derive(Default)]
struct Bits {
    bytes: Vec<u8>,
    used: u32,
}

impl Bits {
    fn bit(&mut self, bit: u32) {
        if self.used == 0 {
            self.bytes.push(0);
        }
        if let Some(last) = self.bytes.last_mut() {
            *last |= ((bit & 1) as u8) << self.used;
        }
        self.used = (self.used + 1) % 8;
    }

    /// Writes a number, lowest bit first.
    fn number(&mut self, value: u32, bits: u32) {
        (0..bits).for_each(|at| self.bit(value >> at));
    }

    /// Writes a Huffman code, highest bit first.
    fn code(&mut self, value: u32, bits: u32) {
        (0..bits).rev().for_each(|at| self.bit(value >> at));
    }
}

/// Compresses `raw` to a zlib stream; `stride`, 129 to 192, is the distance in bytes to the row above.
fn zlib(raw: &[u8], stride: usize) -> Vec<u8> {
    let mut bits = Bits::default();
    // The last block, with fixed Huffman codes.
    bits.number(1, 1);
    bits.number(1, 2);
    let mut at = 0;
    while at < raw.len() {
        let same = |distance: usize| {
            let before = at.checked_sub(distance)?;
            let equal =
                raw[at..].iter().zip(&raw[before..]).take(LONGEST).take_while(|(a, b)| a == b).count();
            Some((equal, distance))
        };
        let longest = [stride, 1].into_iter().filter_map(same).max_by_key(|(equal, _)| *equal);
        match longest {
            Some((equal, distance)) if equal >= 3 => {
                let length = if equal == LONGEST { LONGEST } else { equal.min(PLAIN) };
                if length == LONGEST {
                    bits.code(0b1100_0101, 8);
                } else {
                    bits.code(length as u32 - 2, 7);
                }
                if distance == 1 {
                    bits.code(0, 5);
                } else {
                    bits.code(14, 5);
                    bits.number(distance as u32 - 129, 6);
                }
                at += length;
            }
            _ => {
                bits.code(0x30 + u32::from(raw[at]), 8);
                at += 1;
            }
        }
    }
    bits.code(0, 7);
    let mut data = vec![0x78, 0x01];
    data.append(&mut bits.bytes);
    data.extend_from_slice(&adler32(raw).to_be_bytes());
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Decompresses the output of [`zlib`].
    fn unpacked(data: &[u8]) -> Vec<u8> {
        let body = &data[2..data.len() - 4];
        let mut at = 0;
        let mut bit = || {
            let bit = body[at / 8] >> (at % 8) & 1;
            at += 1;
            u32::from(bit)
        };
        assert_eq!([bit(), bit(), bit()], [1, 1, 0], "the last block, fixed codes");
        let mut out: Vec<u8> = Vec::new();
        loop {
            let seven = (0..7).fold(0, |code, _| code << 1 | bit());
            let length = if seven == 0 {
                break;
            } else if seven < 0b001_1000 {
                seven as usize + 2
            } else {
                let code = seven << 1 | bit();
                if code < 0b1100_0000 {
                    out.push((code - 0x30) as u8);
                    continue;
                }
                assert_eq!(code, 0b1100_0101);
                LONGEST
            };
            let distance = match (0..5).fold(0, |code, _| code << 1 | bit()) {
                0 => 1,
                14 => 129 + (0..6).fold(0, |number, place| number | (bit() as usize) << place),
                code => panic!("distance code {code}"),
            };
            for _ in 0..length {
                out.push(out[out.len() - distance]);
            }
        }
        let check = u32::from_be_bytes(data[data.len() - 4..].try_into().unwrap());
        assert_eq!(check, adler32(&out));
        out
    }

    #[test]
    fn what_is_packed_comes_back() {
        let mut noise = 1_u32;
        let raw: Vec<u8> = (0..20_000_usize)
            .map(|at| {
                noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                if at % 977 < 300 { (noise >> 27) as u8 } else { (at / 5_000) as u8 }
            })
            .collect();
        assert_eq!(unpacked(&zlib(&raw, 161)), raw);
        assert_eq!(unpacked(&zlib(&[], 161)), Vec::<u8>::new());
        assert!(zlib(&vec![3; 25_600], 161).len() < 200);
    }

    #[test]
    fn checks_are_those_of_the_standards() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
        assert_eq!(adler32(b"Wikipedia"), 0x11E6_0398);
        let file = Picture { width: 160, pixels: vec![0; 160 * 2] }.png(&[[1, 2, 3]]);
        assert_eq!(
            (&file[..8], &file[12..16], &file[16..24]),
            (&b"\x89PNG\r\n\x1a\n"[..], &b"IHDR"[..], &[0, 0, 0, 160, 0, 0, 0, 2][..])
        );
    }
}

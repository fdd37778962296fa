//! Images of many ticks as columns: one column per field.
//!
//! A column is a list of changes: ticks since the previous change, and the difference (or, for names and frames, the
//! new bytes). The noise of a converter takes two small bytes per change, which compress to a few bits.

use rcs_core::{plain::StructSchema, reflect};

use crate::{
    layout::{self, Piece},
    proto::wire::{put_varint, take_varint, unzigzag, zigzag},
};

struct Column {
    piece: Piece,
    last: Vec<u8>,
    changed: u64, // tick of the last change
}

fn columns(record: &'static StructSchema) -> Vec<Column> {
    let column = |piece: Piece| Column { last: vec![0; piece.size], piece, changed: 0 };
    layout::pieces(record).into_iter().map(column).collect()
}

pub struct Columns {
    columns: Vec<(Column, Vec<u8>)>,
    tick: u64,
}

impl Columns {
    pub fn new(record: &'static StructSchema) -> Self {
        Self { columns: columns(record).into_iter().map(|column| (column, Vec::new())).collect(), tick: 0 }
    }

    pub fn add(&mut self, image: &[u8]) {
        self.tick += 1;
        for (column, out) in &mut self.columns {
            let Piece { offset, size, number } = column.piece;
            let Some(now) = image.get(offset..offset + size) else { continue };
            if now == column.last {
                continue;
            }
            put_varint(self.tick - column.changed, out);
            if number {
                let unused = 64 - 8 * now.len().clamp(1, 8);
                let difference = reflect::unsigned(now).wrapping_sub(reflect::unsigned(&column.last));
                put_varint(zigzag((difference << unused).cast_signed() >> unused), out);
            } else {
                out.extend_from_slice(now);
            }
            column.changed = self.tick;
            column.last.copy_from_slice(now);
        }
    }

    pub fn finish(self) -> Vec<Vec<u8>> {
        self.columns.into_iter().map(|(_, out)| out).collect()
    }
}

pub struct Reader<'a> {
    columns: Vec<(Column, Option<u64>, &'a [u8])>,
    image: Vec<u8>,
    tick: u64,
    sound: bool,
}

impl<'a> Reader<'a> {
    pub fn new(record: &'static StructSchema, bytes: &'a [Vec<u8>]) -> Self {
        let columns = columns(record);
        let sound = columns.len() == bytes.len();
        let next = |(column, mut rest): (Column, &'a [u8])| {
            let due = take_varint(&mut rest);
            (column, due, rest)
        };
        let columns = columns.into_iter().zip(bytes.iter().map(Vec::as_slice)).map(next).collect();
        Self { columns, image: vec![0; record.size()], tick: 0, sound }
    }

    /// The image of the next tick; `None` if the columns do not fit the record.
    pub fn next_image(&mut self) -> Option<&[u8]> {
        self.tick += 1;
        for (column, due, rest) in &mut self.columns {
            if *due == Some(self.tick) {
                self.sound &= change(column, due, rest, &mut self.image).is_some();
            }
        }
        self.sound.then_some(&self.image)
    }
}

fn change(column: &Column, due: &mut Option<u64>, rest: &mut &[u8], image: &mut [u8]) -> Option<()> {
    let Piece { offset, size, number } = column.piece;
    let field = image.get_mut(offset..offset + size)?;
    if number {
        let difference = unzigzag(take_varint(rest)?).cast_unsigned();
        let sum = reflect::unsigned(field).wrapping_add(difference);
        field.iter_mut().zip(sum.to_le_bytes()).for_each(|(slot, byte)| *slot = byte);
    } else {
        let (bytes, behind) = rest.split_at_checked(field.len())?;
        field.copy_from_slice(bytes);
        *rest = behind;
    }
    // After a gap of zero ticks, a column would never be due again.
    *due = match rest.is_empty() {
        true => None,
        false => Some((*due)?.checked_add(take_varint(rest).filter(|gap| *gap > 0)?)?),
    };
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::ExternalInputs;
    use proptest::prelude::*;
    use rcs_core::Plain;

    proptest! {
        #[test]
        fn column_images_round_trip(
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0_usize..4), 0..200),
        ) {
            let mut image = vec![0; ExternalInputs::SIZE];
            let (mut images, mut columns) = (Vec::new(), Columns::new(ExternalInputs::STRUCT));
            for (at, byte, quiet) in changes {
                let at = at.index(image.len());
                image[at] = byte;
                for _ in 0..=quiet {
                    columns.add(&image);
                    images.push(image.clone());
                }
            }
            let bytes = columns.finish();
            let mut reader = Reader::new(ExternalInputs::STRUCT, &bytes);
            for image in images {
                prop_assert_eq!(reader.next_image(), Some(image.as_slice()));
            }
        }

        #[test]
        fn damaged_columns_are_detected_or_harmless(
            bytes in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..9), 0..300),
        ) {
            let mut reader = Reader::new(ExternalInputs::STRUCT, &bytes);
            let whole = layout::pieces(ExternalInputs::STRUCT).len() == bytes.len();
            for _ in 0..300 {
                let image = reader.next_image();
                prop_assert!(whole || image.is_none());
            }
        }
    }

    #[test]
    fn constant_field_has_an_empty_column() {
        let mut columns = Columns::new(ExternalInputs::STRUCT);
        for _ in 0..1000 {
            columns.add(&vec![0; ExternalInputs::SIZE]);
        }
        assert!(columns.finish().iter().all(Vec::is_empty));
    }
}

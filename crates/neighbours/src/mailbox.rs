//! Mailboxes of the factory network (IX, Table IX.1).
//!
//! A mailbox is an area of fixed size at a fixed address of common memory: length, mailgram number, read and write
//! lock, data. Figure IX.1, with their order and sizes, is lost. CHOSEN: four 16-bit words in the order of the text,
//! low byte first as in the processors of the boards.
//!
//! ```text
//!   byte  0        2            4          6           8 ...
//!         length   mailgram #   read lock  write lock  data
//! ```

use std::fmt;

pub const HEAD: usize = 8; // bytes before the data (CHOSEN)

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub name: &'static str,
    pub address: u32,
    pub size: usize, // bytes, including the head
}

pub const HWSC_COMMAND: Place = Place { name: "HWSC to RCS Command", address: 0xF_6000, size: 256 };
pub const HWSC_STATUS: Place = Place { name: "HWSC from RCS Status", address: 0xF_6200, size: 256 };
pub const DATA_SYSTEM_COMMAND: Place =
    Place { name: "Data System from RCS Command", address: 0xF_7000, size: 512 };
pub const DATA_SYSTEM_STATUS: Place =
    Place { name: "Data System to RCS Status", address: 0xF_7300, size: 256 };
pub const PEDESTAL_COMMAND: Place = Place { name: "Pedestal from RCS Command", address: 0xF_5000, size: 256 };
pub const PEDESTAL_STATUS: Place = Place { name: "Pedestal to RCS Status", address: 0xF_5300, size: 256 };
pub const PEDESTAL_GRIPPER_STATUS: Place =
    Place { name: "Pedestal Gripper to RCS Status", address: 0xF_5600, size: 256 };
pub const PEDESTAL_TABLE_STATUS: Place =
    Place { name: "Pedestal Table to RCS Status", address: 0xF_5900, size: 256 };

/// Not in the table: actions of the workstation (vise, trays, machine) in the simulated cell.
pub const CELL_COMMAND: Place = Place { name: "Workstation to Cell Command", address: 0xF_6400, size: 256 };
pub const CELL_STATUS: Place = Place { name: "Workstation from Cell Status", address: 0xF_6600, size: 256 };

/// Not in the table: sensor words of the pedestal's devices in the simulated cell.
pub const PEDESTAL_SENSORS: Place =
    Place { name: "Pedestal from Cell Sensors", address: 0xF_5C00, size: 256 };
pub const PEDESTAL_ORDERS: Place = Place { name: "Pedestal to Cell Orders", address: 0xF_5E00, size: 256 };
/// The request areas of the vision mailbox (IX.4). Figure IX.3 is lost; address and size CHOSEN.
pub const VISION_REQUEST: Place = Place { name: "Vision from RCS Request", address: 0xF_8000, size: 256 };
/// Ready words and response areas of the vision mailbox; address and size CHOSEN.
pub const VISION_RESPONSE: Place = Place { name: "Vision to RCS Response", address: 0xF_8200, size: 256 };
/// Not in the manual: the picture of the simulated camera.
pub const VISION_PICTURE: Place =
    Place { name: "Vision from Cell Picture", address: 0xF_8400, size: MAX_SIZE };

pub const TABLE: [Place; 8] = [
    HWSC_COMMAND,
    HWSC_STATUS,
    DATA_SYSTEM_COMMAND,
    DATA_SYSTEM_STATUS,
    PEDESTAL_COMMAND,
    PEDESTAL_STATUS,
    PEDESTAL_GRIPPER_STATUS,
    PEDESTAL_TABLE_STATUS,
];

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MailboxError {
    #[error("{mailbox}: at most {room} bytes of data were expected, found {found}")]
    TooLong { mailbox: Place, room: usize, found: usize },
    #[error("{mailbox}: {} bytes were expected, found {found}", .mailbox.size)]
    Size { mailbox: Place, found: usize },
    #[error("{mailbox}: a length of {HEAD} to {} was expected, found {found}", .mailbox.size)]
    Length { mailbox: Place, found: u16 },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "mailbox {} at {:05X}", self.name, self.address)
    }
}

pub const MAX_SIZE: usize = 4096; // bytes

/// A mailbox that a process writes or has read. Writing and copying do not allocate.
#[derive(Debug)]
pub struct Mailbox {
    place: Place,
    bytes: [u8; MAX_SIZE], // zero after the size of the mailbox
}

/// Most contents are short, and mailboxes are copied in every tick, so `clone_from` copies only the used bytes.
impl Clone for Mailbox {
    fn clone(&self) -> Self {
        Self { place: self.place, bytes: self.bytes }
    }

    fn clone_from(&mut self, source: &Self) {
        if self.place.size == source.place.size {
            self.place = source.place;
            self.bytes[..self.place.size].copy_from_slice(source.image());
        } else {
            *self = source.clone();
        }
    }
}

impl PartialEq for Mailbox {
    fn eq(&self, other: &Self) -> bool {
        self.place == other.place && self.image() == other.image()
    }
}

impl Eq for Mailbox {}

impl Mailbox {
    /// A mailbox with a length word, zeros and no data (IX).
    #[must_use]
    pub fn initialized(place: Place) -> Self {
        let mut mailbox = Self { place, bytes: [0; MAX_SIZE] };
        mailbox.set_length(HEAD);
        mailbox
    }

    #[must_use]
    pub const fn place(&self) -> Place {
        self.place
    }

    /// Removes the data and sets the mailgram number to 0 (IX).
    pub fn initialize(&mut self) {
        *self = Self::initialized(self.place);
    }

    /// Fails if the size or the length word is wrong.
    pub fn from_image(place: Place, image: &[u8]) -> Result<Self, MailboxError> {
        if image.len() != place.size {
            return Err(MailboxError::Size { mailbox: place, found: image.len() });
        }
        let mut mailbox = Self { place, bytes: [0; MAX_SIZE] };
        mailbox.bytes[..place.size].copy_from_slice(image);
        let length = mailbox.word(0);
        if (HEAD..=place.size).contains(&usize::from(length)) {
            Ok(mailbox)
        } else {
            Err(MailboxError::Length { mailbox: place, found: length })
        }
    }

    /// Copies received head and data. After [`MailboxError::Length`] the mailbox is unchanged.
    pub fn receive(&mut self, used: &[u8]) -> Result<(), MailboxError> {
        let found = used.first_chunk().map_or(0, |word| u16::from_le_bytes(*word));
        let legal = (HEAD..=self.place.size).contains(&used.len()) && used.len() == usize::from(found);
        if !legal {
            return Err(MailboxError::Length { mailbox: self.place, found });
        }
        let (here, unused) = self.bytes.split_at_mut(used.len());
        here.copy_from_slice(used);
        unused.fill(0);
        Ok(())
    }

    /// Head and data, as the network carries them.
    #[must_use]
    pub fn used(&self) -> &[u8] {
        &self.bytes[..usize::from(self.word(0))]
    }

    /// The next mailgram number makes the network send the mailbox (IX); 0 is only the number after initialization.
    pub fn write(&mut self, data: &[u8]) -> Result<(), MailboxError> {
        let room = self.place.size - HEAD;
        if data.len() > room {
            return Err(MailboxError::TooLong { mailbox: self.place, room, found: data.len() });
        }
        let (used, unused) = self.bytes[HEAD..self.place.size].split_at_mut(data.len());
        used.copy_from_slice(data);
        unused.fill(0);
        self.set_length(HEAD + data.len());
        let next = self.mailgram().checked_add(1).unwrap_or(1);
        self.bytes[2..4].copy_from_slice(&next.to_le_bytes());
        Ok(())
    }

    #[must_use]
    pub fn data(&self) -> &[u8] {
        &self.bytes[HEAD..usize::from(self.word(0))]
    }

    /// 0 after initialization, incremented by each write.
    #[must_use]
    pub fn mailgram(&self) -> u16 {
        self.word(2)
    }

    #[must_use]
    pub fn image(&self) -> &[u8] {
        &self.bytes[..self.place.size]
    }

    fn word(&self, at: usize) -> u16 {
        u16::from_le_bytes([self.bytes[at], self.bytes[at + 1]])
    }

    /// `length` is at most the size of the mailbox, which fits into a word.
    fn set_length(&mut self, length: usize) {
        let length = u16::try_from(length).unwrap_or(u16::MAX);
        self.bytes[..2].copy_from_slice(&length.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_mailboxes_overlap() {
        let pedestal = [PEDESTAL_SENSORS, PEDESTAL_ORDERS];
        let vision = [VISION_REQUEST, VISION_RESPONSE, VISION_PICTURE];
        let mut places = [&TABLE[..], &[CELL_COMMAND, CELL_STATUS], &pedestal, &vision].concat();
        places.sort_by_key(|place| place.address);
        for pair in places.windows(2) {
            assert!(pair[0].address as usize + pair[0].size <= pair[1].address as usize, "{}", pair[1]);
        }
    }

    #[test]
    fn written_values_are_read_and_counted() {
        let mut mailbox = Mailbox::initialized(HWSC_STATUS);
        assert_eq!((mailbox.mailgram(), mailbox.data()), (0, &[][..]));
        mailbox.write(&[1, 2, 3]).unwrap();
        mailbox.write(&[4]).unwrap();
        assert_eq!((mailbox.mailgram(), mailbox.data()), (2, &[4][..]));
        assert_eq!(&mailbox.image()[..12], &[9, 0, 2, 0, 0, 0, 0, 0, 4, 0, 0, 0]);
        assert_eq!(Mailbox::from_image(HWSC_STATUS, mailbox.image()), Ok(mailbox));
    }

    #[test]
    fn copy_does_not_depend_on_the_previous_contents() {
        let mut small = Mailbox::initialized(HWSC_STATUS);
        small.write(&[7; 248]).unwrap();
        for place in [HWSC_STATUS, HWSC_COMMAND, VISION_PICTURE] {
            let mut other = Mailbox::initialized(place);
            other.write(&vec![9; place.size - HEAD]).unwrap();
            assert_ne!(other, small);
            let large = other.clone();
            other.clone_from(&small);
            assert_eq!(other, small);
            assert_eq!(other.bytes, small.bytes, "to the last byte");
            other.clone_from(&large);
            assert_eq!((other.bytes, other.place), (large.bytes, place));
        }
    }

    #[test]
    fn mailgram_number_never_returns_to_zero() {
        let mut mailbox = Mailbox::initialized(PEDESTAL_STATUS);
        for _ in 0..=u32::from(u16::MAX) {
            mailbox.write(&[]).unwrap();
        }
        assert_eq!(mailbox.mailgram(), 1);
    }

    #[test]
    fn wrong_sizes_are_refused_without_effect() {
        let mut mailbox = Mailbox::initialized(HWSC_STATUS);
        mailbox.write(&[7; 248]).unwrap();
        let before = mailbox.clone();
        let error = mailbox.write(&[8; 249]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "mailbox HWSC from RCS Status at F6200: at most 248 bytes of data were expected, found 249"
        );
        assert_eq!(mailbox, before);
    }

    #[test]
    fn network_messages_are_stored_whole_or_discarded() {
        let mut sent = Mailbox::initialized(HWSC_STATUS);
        sent.write(&[1, 2, 3]).unwrap();
        let mut mailbox = Mailbox::initialized(HWSC_STATUS);
        mailbox.write(&[9; 20]).unwrap();
        mailbox.receive(sent.used()).unwrap();
        assert_eq!(mailbox, sent);
        for wrong in [&[][..], &[11], &[11, 0, 1, 0, 0, 0, 0, 0, 1, 2], &[7, 0, 1, 0, 0, 0, 0], &[1; 257]] {
            assert!(mailbox.receive(wrong).is_err(), "{wrong:?}");
            assert_eq!(mailbox, sent);
        }
    }

    #[test]
    fn image_of_another_size_or_length_is_refused() {
        assert_eq!(
            Mailbox::from_image(HWSC_STATUS, &[0; 255]),
            Err(MailboxError::Size { mailbox: HWSC_STATUS, found: 255 })
        );
        for found in [0_u16, 7, 257] {
            let mut image = [0; 256];
            image[..2].copy_from_slice(&found.to_le_bytes());
            assert_eq!(
                Mailbox::from_image(HWSC_STATUS, &image),
                Err(MailboxError::Length { mailbox: HWSC_STATUS, found })
            );
        }
    }
}

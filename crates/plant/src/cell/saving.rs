//! A cell as bytes, and its digest.
//!
//! The state contains all data on which the next tick depends, including the solver and the noise. A restored cell
//! continues bit for bit. Fixed bodies are made from the description, which must be the same.
//!
//! ```text
//! RCSCELL\0   version u32   length u64   digest u64   the state, in postcard
//! ```
//! All numbers are little-endian; length and digest are those of the state.

use rcs_core::digest::Digest;

use super::Cell;
use crate::{description::CellDescription, fingerprint, scene::furniture};

const MAGIC: [u8; 8] = *b"RCSCELL\0"; // first bytes of every saved cell
/// Version of the saved state: increase it with every change of the fields of a cell.
const VERSION: u32 = 5;
const HEADER: usize = 28; // bytes before the state

#[derive(Debug, thiserror::Error)]
#[error("the state of the cell cannot be written: {0}")]
pub struct SaveError(#[from] postcard::Error);

#[derive(Debug, PartialEq, thiserror::Error)]
pub enum RestoreError {
    #[error("this is not a saved cell: it does not begin with RCSCELL")]
    Foreign,
    #[error("this cell was saved in version {found} of the format, expected version {VERSION}")]
    Version { found: u32 },
    /// The number of bytes differs from that in the header.
    #[error("a saved cell of {expected} bytes was expected, found {found}")]
    Length {
        expected: u64, // number of bytes in the header; if the header is incomplete, its own length
        found: u64,    // number of bytes found
    },
    #[error("the saved cell is damaged: its digest is {found:016x}, expected {expected:016x}")]
    Damaged {
        expected: u64,
        found: u64, // digest of the bytes
    },
    /// The bytes are undamaged but cannot be decoded: their writer should have increased the version.
    #[error("the saved cell cannot be read: {0}")]
    Unreadable(#[from] postcard::Error),
    #[error("the cell was saved from another description than the one given")]
    OtherDescription,
}

impl Cell {
    /// The whole state as bytes, for [`Cell::restore`]. Fails with [`SaveError`] if the format cannot hold the state.
    pub fn save(&self) -> Result<Vec<u8>, SaveError> {
        let mut bytes = Vec::with_capacity(256 * 1024);
        bytes.extend([0; HEADER]);
        let mut bytes = postcard::to_extend(self, bytes)?;
        let (header, state) = bytes.split_at_mut(HEADER);
        let length = state.len() as u64;
        let fields: [&[u8]; 4] =
            [&MAGIC, &VERSION.to_le_bytes(), &length.to_le_bytes(), &digest_of(state).to_le_bytes()];
        header.copy_from_slice(&fields.concat());
        Ok(bytes)
    }

    /// Restore a saved cell, built from `description`. Fails with [`RestoreError`] if the bytes are not a complete,
    /// undamaged cell of this description.
    pub fn restore(description: &CellDescription, bytes: &[u8]) -> Result<Self, RestoreError> {
        let mut cell: Self = postcard::from_bytes(state_in(bytes)?)?;
        // A pedestal that a fault has moved from its mark is restored at that place.
        let description = cell.faults.displaced(description);
        if cell.description != description {
            return Err(RestoreError::OtherDescription);
        }
        cell.furniture = furniture(&description);
        cell.obstacles = crate::bodies::standing(&cell.description, &cell.furniture);
        Ok(cell)
    }

    /// Digest of all positions, velocities and device states: equal while two runs are in the same state.
    #[must_use]
    pub fn digest(&self) -> u64 {
        let mut bytes = Vec::with_capacity(8 * 1024);
        for (_, body) in self.world.bodies.iter() {
            let (at, turn) = (body.translation().to_array(), body.rotation().to_array());
            let (speed, spin) = (body.linvel().to_array(), body.angvel().to_array());
            for number in at.iter().chain(&turn).chain(&speed).chain(&spin) {
                bytes.extend_from_slice(&number.to_le_bytes());
            }
        }
        let camera = (&self.optics, &self.analysis);
        let robot = (&self.t3, &self.droop, &self.changer, &self.grippers, camera, &self.joystick);
        let beside = (&self.drum, &self.pedestal, &self.vise, &self.parts, self.next_part, &self.clearance);
        let noise = (&self.gripper_noise, &self.pedestal_noise, &self.force_noise, &self.placement_noise);
        let sensors =
            (&self.resolver_noise, &self.resolver_box, &self.dead_times, &self.faults, self.jaw_waits);
        fingerprint::append(&(robot, beside, noise, sensors, &self.events), &mut bytes)
            .expect("devices are plain values, which can be written down");
        digest_of(&bytes)
    }
}

fn state_in(bytes: &[u8]) -> Result<&[u8], RestoreError> {
    let known = MAGIC.len().min(bytes.len());
    if bytes[..known] != MAGIC[..known] {
        return Err(RestoreError::Foreign);
    }
    let found = bytes.len() as u64;
    let mut rest = bytes.get(MAGIC.len()..).unwrap_or_default();
    let too_short = RestoreError::Length { expected: HEADER as u64, found };
    let (Some(version), Some(length), Some(expected)) = (take(&mut rest), take(&mut rest), take(&mut rest))
    else {
        return Err(too_short);
    };
    let version = u32::from_le_bytes(version);
    if version != VERSION {
        return Err(RestoreError::Version { found: version });
    }
    let length = u64::from_le_bytes(length);
    if rest.len() as u64 != length {
        return Err(RestoreError::Length { expected: length.saturating_add(HEADER as u64), found });
    }
    let (expected, found) = (u64::from_le_bytes(expected), digest_of(rest));
    if expected != found {
        return Err(RestoreError::Damaged { expected, found });
    }
    Ok(rest)
}

fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (here, after) = rest.split_first_chunk::<N>()?;
    *rest = after;
    Some(*here)
}

fn digest_of(bytes: &[u8]) -> u64 {
    let mut digest = Digest::new();
    digest.add(bytes);
    digest.value()
}

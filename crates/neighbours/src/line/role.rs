use std::{fmt, str::FromStr};

use crate::mailbox::{
    CELL_COMMAND, CELL_STATUS, DATA_SYSTEM_COMMAND, DATA_SYSTEM_STATUS, HWSC_COMMAND, HWSC_STATUS,
    PEDESTAL_COMMAND, PEDESTAL_GRIPPER_STATUS, PEDESTAL_ORDERS, PEDESTAL_SENSORS, PEDESTAL_STATUS,
    PEDESTAL_TABLE_STATUS, Place, VISION_PICTURE, VISION_REQUEST, VISION_RESPONSE,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u16)]
pub enum Role {
    Workstation = 1,
    DataSystem = 2,
    Pedestal = 3,
    Vision = 4,
    /// An operator has no mailboxes: its connection carries the lines of a session (crate `operator`).
    Operator = 5,
}

impl Role {
    pub const ALL: [Self; 5] =
        [Self::Workstation, Self::DataSystem, Self::Pedestal, Self::Vision, Self::Operator];

    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Workstation => "workstation",
            Self::DataSystem => "data-system",
            Self::Pedestal => "pedestal",
            Self::Vision => "vision",
            Self::Operator => "operator",
        }
    }

    #[must_use]
    pub const fn to_controller(self) -> &'static [Place] {
        match self {
            Self::Workstation => &[HWSC_COMMAND, CELL_COMMAND],
            Self::DataSystem => &[DATA_SYSTEM_STATUS],
            Self::Pedestal => {
                &[PEDESTAL_STATUS, PEDESTAL_GRIPPER_STATUS, PEDESTAL_TABLE_STATUS, PEDESTAL_ORDERS]
            }
            Self::Vision => &[VISION_RESPONSE],
            Self::Operator => &[],
        }
    }

    #[must_use]
    pub const fn from_controller(self) -> &'static [Place] {
        match self {
            Self::Workstation => &[HWSC_STATUS, CELL_STATUS],
            Self::DataSystem => &[DATA_SYSTEM_COMMAND],
            Self::Pedestal => &[PEDESTAL_COMMAND, PEDESTAL_SENSORS],
            // The picture is first, so that it has arrived before the neighbour reads the request.
            Self::Vision => &[VISION_PICTURE, VISION_REQUEST],
            Self::Operator => &[],
        }
    }

    #[must_use]
    pub fn from_number(number: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|&role| role as u16 == number)
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} was expected, found {found}", Role::ALL.map(Role::text).join(" or "))]
pub struct UnknownRole {
    found: String,
}

impl FromStr for Role {
    type Err = UnknownRole;

    fn from_str(text: &str) -> Result<Self, UnknownRole> {
        Self::ALL
            .into_iter()
            .find(|role| role.text() == text)
            .ok_or_else(|| UnknownRole { found: text.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn role_words_and_numbers_round_trip() {
        for role in Role::ALL {
            assert_eq!(role.text().parse(), Ok(role));
            assert_eq!(Role::from_number(role as u16), Some(role));
        }
        assert_eq!(Role::from_number(0), None);
        assert_eq!(
            "foreman".parse::<Role>().unwrap_err().to_string(),
            "workstation or data-system or pedestal or vision or operator was expected, found foreman"
        );
    }

    #[test]
    fn every_mailbox_has_one_writer() {
        let mut all: Vec<u32> = Role::ALL
            .iter()
            .flat_map(|role| role.to_controller().iter().chain(role.from_controller()))
            .map(|place| place.address)
            .collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}

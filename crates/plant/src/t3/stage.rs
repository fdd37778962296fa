use serde::{Deserialize, Serialize};

/// Progress of the start-up.
///
/// ```text
///   Dark
///    │ power on
///    ▼            fault reset          key at ENABLE            manual on
///   Faulted ───────────────────► Ready ─────────────► Enabled ─────────────► Rising
///    ▲                                                   ▲                     │ first jump
///    │ E-stop, no pressure (any)                                      │ manual off (any)    ▼
///    └── ...                                             └── ...             Manual: align 1 to 6
///                                                                              │ auto
///                 two motions            cycle start            second jump    ▼
///   Depc ◄────────────────── Rehearsing ◄───────────── Auto ◄──────────────── Homing
///    │ │                         │ interrupt                                   ▲ ▲
///    │ └─ 18 ────────────────────┼─────────────────────────────────────────────┘ │
///    │ CANCEL, CANCEL            ▼                                               │ auto
///    └─────────────────────► PreManual ──────────────────────────────────────────┘
/// ```
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub enum Stage {
    Dark,
    Faulted,
    Ready,
    Enabled,
    /// The pump is starting; the pressure builds up after a short delay.
    Rising,
    Manual,
    /// Moving to HOME after AUTO, or after the end of the program.
    Homing,
    Auto,
    Rehearsing,
    /// The program is in the DEPC function, see [`super::T3Controller::depc`].
    Depc,
    /// Pre-manual mode: the program has ended, the axes are still aligned.
    PreManual,
}

impl Stage {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Dark => "control power off",
            Self::Faulted => "fault",
            Self::Ready => "hydraulics disabled",
            Self::Enabled => "hydraulics enabled",
            Self::Rising => "hydraulics starting",
            Self::Manual => "manual",
            Self::Homing => "moving to HOME",
            Self::Auto => "auto, at HOME",
            Self::Rehearsing => "vertical motions",
            Self::Depc => "DEPC",
            Self::PreManual => "pre-manual",
        }
    }

    /// True if the hydraulics have pressure or will have it soon.
    #[must_use]
    pub const fn is_live(self) -> bool {
        !matches!(self, Self::Dark | Self::Faulted | Self::Ready | Self::Enabled)
    }
}

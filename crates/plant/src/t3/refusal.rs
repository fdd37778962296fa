use interfaces::station::EStop;

/// Refusal of a key that was pressed at the wrong time, with the missing step (IV.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    #[error("the controller has no power: control power on comes first")]
    NoPower,
    #[error("control power is on already")]
    PowerIsOn,
    #[error("boards are changed without power: control power off comes first")]
    Powered,
    #[error("the FAULT RESET button is lit: fault reset comes first")]
    Fault,
    #[error("the E-stop {} is still in: release it first", .0.place())]
    Pressed(EStop),
    #[error("the E-stop {} is not pressed", .0.place())]
    NotPressed(EStop),
    #[error("the FAULT RESET button is not lit: there is nothing to reset")]
    NoFault,
    #[error("the HYDRAULICS keyswitch is not at ENABLE: hydraulics enable comes first")]
    NotEnabled,
    #[error("the HYDRAULICS keyswitch is already in this position")]
    KeyIsThere,
    #[error("the robot's hydraulics are off: manual on comes first")]
    NoPressure,
    #[error("the robot's hydraulics are on already")]
    PressureIsOn,
    #[error("the robot moves: wait until it has stopped")]
    Moving,
    #[error("not all axes are aligned: align comes first")]
    NotAligned,
    /// Axes are aligned in manual mode only.
    #[error("axes are aligned in manual mode, before AUTO")]
    NotManual,
    /// The pendant moves axes in manual mode only.
    #[error("the pendant moves axes in manual mode: before AUTO, or after INTERRUPT and CANCEL twice")]
    JogInAuto,
    #[error("an axis from 1 to 6 was expected, found {0}")]
    NoAxis(u8),
    #[error("axis {0} would turn beyond its limit")]
    Limit(u8),
    /// The E-stop circuit is open: the Prim Interface Box has no power.
    #[error("the Prim Interface Box has no power: prim box on comes first (IV.1)")]
    PrimBoxOff,
    #[error("the robot is not in auto mode at HOME: auto comes first")]
    NotAuto,
    #[error("the program runs: interrupt it first")]
    Running,
    #[error("no program runs")]
    NotRunning,
    #[error("a warning is on the screen: answer it with enter, or with cancel twice")]
    Warned,
    #[error("there is no warning on the screen to answer")]
    NothingToAnswer,
    /// The error P-IG can only be cancelled.
    #[error("the error P-IG can only be cancelled")]
    OnlyCancel,
}

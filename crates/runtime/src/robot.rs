//! The other end of the DEPC line: the T3 controller of the simulated cell (through the fault injector), a robot at a
//! serial port, or one with EGM or of the caller, with a DEPC function here. The rest of the cell is still simulated,
//! and follows the position that the robot has acknowledged or reported.

use std::{
    sync::atomic::Ordering,
    thread,
    time::{Duration, Instant},
};

use closed_loop::{
    RobotInputs,
    workstation::{OWN_PANEL, is_at_robot},
};
use depc::{Plate, warning::Warning, wire::FRAME_BYTES};
use executive::{
    alloc::Section,
    histogram::{Histogram, Summary},
    serial::{SerialCounts, SerialLine},
};
use geometry::{frame::Frame, pose::WireFrame};
use interfaces::device::{DeviceOutputs, LinkBytes};
use rcs_core::tick::TICK_MS;
use taskdata::load::{Job, Step};

use crate::{config::RunConfig, egm::EgmPort, error::StartError, observer::Observer, own::OwnPort};

const PERIOD: Duration = Duration::from_millis(TICK_MS); // length of a tick

/// Checks that a job leaves the panel of a robot alone that is not the simulated one. Errors:
/// [`StartError::PanelElsewhere`].
pub fn check_panel(job: &Job) -> Result<(), StartError> {
    let is_refused = |step: &Step| match step {
        Step::Workstation(action) | Step::After { action, .. } => is_at_robot(action),
        Step::Command(_) => false,
    };
    let lines = job.steps.iter().filter(|line| is_refused(&line.step));
    let lines: Vec<String> = lines.map(|line| format!("`{}`: {OWN_PANEL}", line.text)).collect();
    if lines.is_empty() { Ok(()) } else { Err(StartError::PanelElsewhere(lines)) }
}

pub enum Robot {
    Simulated,
    Serial(Port),
    Egm(Box<EgmPort>),
    Own(OwnPort),
}

/// A serial line, with its measurements.
pub struct Port {
    line: SerialLine,
    sent: Option<Instant>,      // time when the last data command was written to the port
    deviations: Box<Histogram>, // deviation of the time between two data commands from a tick, ns
}

impl Port {
    #[must_use]
    pub fn new(line: SerialLine) -> Self {
        Self { line, sent: None, deviations: Box::default() }
    }

    fn send(&mut self, tx: &LinkBytes) {
        let now = Instant::now();
        // The line counts the bytes that the port refuses, sends nothing for a tick, and informs T3I.
        self.line.send(tx);
        if tx.as_slice().len() != FRAME_BYTES {
            return;
        }
        if let Some(before) = self.sent.replace(now) {
            let deviation = now.saturating_duration_since(before).abs_diff(PERIOD);
            self.deviations.add(u64::try_from(deviation.as_nanos()).unwrap_or(u64::MAX));
        }
    }

    /// The trouble of the port as text; `None` while it is usable.
    #[must_use]
    pub fn trouble(&self) -> Option<String> {
        (!self.line.is_there()).then(|| format!("the port {} has disappeared", self.line.path().display()))
    }

    #[must_use]
    pub const fn counts(&self) -> SerialCounts {
        self.line.counts()
    }

    /// Deviation of the time between two data commands from a tick.
    #[must_use]
    pub fn deviations(&self) -> Summary {
        self.deviations.summary()
    }
}

impl Robot {
    /// Wait until the robot controller at a port has switched DTR on. Without DTR the run begins, and fails.
    pub fn gather(&mut self, config: &RunConfig, observer: &mut dyn Observer) {
        let port = match self {
            Self::Simulated | Self::Own(_) => return,
            Self::Serial(port) => port,
            Self::Egm(egm) => return egm.gather(config, observer),
        };
        let (wait, interrupted) = (config.wait, &config.stop);
        let (limit, started) = (Duration::from_secs(wait.into()), Instant::now());
        let mut said = false;
        while !port.line.is_ready() && !interrupted.load(Ordering::Relaxed) {
            let path = port.line.path().display();
            if started.elapsed() >= limit {
                let text = format!("the robot controller at {path} has not switched DTR on within {wait} s");
                observer.message(&text);
                return;
            }
            if !said {
                observer.message(&format!(
                    "waiting for the robot controller at {path}: its DTR is off; power it up and start its \
                     program (IV.3.3)"
                ));
                said = true;
            }
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Before the controller's tick, receives from a robot outside the cell. This takes part of the tick's time.
    pub fn receive(&mut self) -> Option<RobotInputs> {
        let _section = Section::enter();
        match self {
            Self::Simulated => None,
            Self::Serial(port) => {
                let mut rx = LinkBytes::default();
                let ready = port.line.receive(&mut rx);
                Some(RobotInputs { rx, ready, unsent: port.line.has_unsent(), resolvers: None })
            }
            Self::Egm(egm) => Some(egm.receive()),
            Self::Own(own) => Some(own.receive()),
        }
    }

    /// Sends over the line after the controller's tick, as part of it. `exact` gives Prim's commanded tool frame,
    /// rounded and exact, for EGM.
    pub fn send(&mut self, outputs: &DeviceOutputs, exact: impl FnOnce() -> Option<(WireFrame, Frame)>) {
        let _section = Section::enter();
        match self {
            Self::Simulated => {}
            Self::Serial(port) => port.send(&outputs.link_tx),
            Self::Egm(egm) => egm.send(&outputs.link_tx, outputs.robot_stop, exact()),
            Self::Own(own) => own.send(&outputs.link_tx, outputs.robot_stop),
        }
    }

    /// The position of a robot outside the cell after the controller's tick, if known. `acknowledged` gives the
    /// position of a robot at a port.
    pub fn moved(&mut self, acknowledged: impl FnOnce() -> Option<Plate>) -> Option<Plate> {
        match self {
            Self::Simulated => None,
            Self::Serial(_) => acknowledged(),
            Self::Egm(egm) => {
                egm.advance(PERIOD);
                egm.feedback()
            }
            Self::Own(own) => own.position(),
        }
    }

    /// Expected lag of the robot behind the commanded positions, ms; `None` for that of the T3.
    #[must_use]
    pub fn lag_ms(&self) -> Option<u16> {
        match self {
            Self::Simulated | Self::Serial(_) => None,
            Self::Egm(egm) => Some(egm.lag_ms()),
            Self::Own(own) => Some(own.lag_ms()),
        }
    }

    /// The new warning of the DEPC function of the caller's robot in this tick.
    #[must_use]
    pub const fn news(&self) -> Option<Warning> {
        if let Self::Own(own) = self { own.news() } else { None }
    }

    #[must_use]
    pub const fn is_elsewhere(&self) -> bool {
        !matches!(self, Self::Simulated)
    }

    #[must_use]
    pub const fn is_own(&self) -> bool {
        matches!(self, Self::Own(_))
    }

    /// The trouble of the connection to a robot outside the cell, as text, if any.
    #[must_use]
    pub fn trouble(&self) -> Option<String> {
        match self {
            Self::Simulated => None,
            Self::Serial(port) => port.trouble(),
            Self::Egm(egm) => egm.trouble(),
            Self::Own(own) => own.trouble(),
        }
    }

    #[must_use]
    pub const fn port(&self) -> Option<&Port> {
        if let Self::Serial(port) = self { Some(port) } else { None }
    }

    #[must_use]
    pub const fn egm(&self) -> Option<&EgmPort> {
        if let Self::Egm(egm) = self { Some(egm) } else { None }
    }
}

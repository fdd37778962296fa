//! Forms for sensors of guarded moves and for relative moves at holsters and tool drum. They are extensions: in the
//! manual both are code (V.1.1, V.3.1).
//!
//! ```text
//! ( -sen-  "sensor"   source  which  threshold )
//!   -sen-  HOL-R-NEAR near    1      0
//!   -sen-  INS-FX     fx      0      -60
//! ( -rel-  "name"     type "loc-name"  acc  vel  smoo  brk  "mov-name" {"sensor"} )
//!   -rel-  INS-IN     lpt  TOOL-TRNS   4    10   10    0    T-IN       INS-FX
//! ```

use std::ops::RangeInclusive;

use diagnostics::nearest;

use crate::files::SensorSource;

use super::{
    entries::{Entry, RelativeEntry, SensorEntry},
    forms::{PLACES, parameters},
    parser::{BEGINNINGS, Parser, Skip, is_compiling_word, is_integer},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beginning {
    Location,            // pose of the command's location
    After(&'static str), // end of another relative move of the command
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnownMove {
    pub name: &'static str,
    pub from: Beginning,
    pub guarded: bool, // by a sensor: GO-UNTIL, GO-WHILE
}

const fn known(name: &'static str, from: Beginning, guarded: bool) -> KnownMove {
    KnownMove { name, from, guarded }
}

/// All relative moves that commands look up (V.2.1), in the order of each command.
pub const RELATIVE_MOVES: &[KnownMove] = &[
    known("QCD-DOWN", Beginning::Location, true),
    known("QCD-SEAT", Beginning::After("QCD-DOWN"), true),
    known("QCD-UP", Beginning::After("QCD-SEAT"), false),
    known("QCA-FAST", Beginning::Location, false),
    known("QCA-SLOW", Beginning::Location, false),
    known("QCA-BACK", Beginning::Location, false),
    known("QCA-LIFT", Beginning::Location, false),
    known("QCA-UP", Beginning::Location, false),
    known("WITHDRAW", Beginning::Location, false),
    known("INS-FAR", Beginning::Location, false),
    known("INS-NEAR", Beginning::Location, true),
    known("INS-IN", Beginning::Location, true),
    known("REL-SLIDE", Beginning::Location, true),
    known("REL-BACK", Beginning::After("REL-SLIDE"), false),
    known("ACQ-NEAR", Beginning::Location, false),
    known("ACQ-STRIKE", Beginning::Location, true),
    known("ACQ-SLIDE", Beginning::After("ACQ-STRIKE"), true),
    known("REM-OUT", Beginning::Location, true),
];

/// `None` if no command looks up the name.
#[must_use]
pub fn relative_move_named(name: &str) -> Option<&'static KnownMove> {
    RELATIVE_MOVES.iter().find(|known| known.name == name)
}

const THRESHOLD: RangeInclusive<i32> = -1000..=1000; // lb or in lb: well above the tool gripper's
const HOLSTER: RangeInclusive<i32> = 1..=3; // right, left and centre
const BEAM: RangeInclusive<i32> = 0..=8; // one of eight, or 0 for any (III.3.4)

pub(super) fn sensor(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let name = p.name("name of the sensor")?;
    let Some(source) = p.peek().and_then(|w| SensorSource::from_text(w.text)) else {
        let words: Vec<&str> = SensorSource::ALL.iter().map(|s| s.text()).collect();
        let skip = p.expected(&format!("source of the sensor ({})", words.join(", ")));
        return Err(skip);
    };
    p.take();
    let which = match source {
        SensorSource::Near | SensorSource::Seated => p.integer("holster", HOLSTER)?,
        SensorSource::Beam => p.integer("beam", BEAM)?,
        SensorSource::Fx | SensorSource::Fy | SensorSource::Fz | SensorSource::My => {
            p.integer("which (nothing to choose for a force)", 0..=0)?
        }
    };
    let threshold = if source.is_force() {
        let threshold = p.integer("threshold", THRESHOLD)?;
        if threshold == 0 {
            let message = format!("the threshold of {} is 0: it would always hold", name.name);
            let help = "give the force in lb or the moment in in lb at which the move ends, with its sign";
            p.flaw("sensor.threshold", p.last_at(), message, Some(help.to_owned()));
        }
        threshold
    } else {
        p.integer("threshold (a switch has none)", 0..=0)?
    };
    Ok(Entry::Sensor(SensorEntry { name, source, which, threshold }))
}

/// `-rel- "name" loc-type "loc-name" acc-fac vel-max smooth-acc brk-dst "mov-name" {"sensor"}`.
pub(super) fn relative_move(p: &mut Parser<'_, '_>) -> Result<Entry, Skip> {
    let name = p.name::<10>("name of the relative move")?;
    let place = p.typed("location", PLACES)?;
    let para = parameters(p)?;
    let movetable = p.name("movetable")?;
    let sensor = if sensor_follows(p) { Some(p.name("sensor")?) } else { None };
    let at = name.at.to(p.last_at());
    Ok(Entry::Relative(RelativeEntry { name, place, para, movetable, sensor, at }))
}

/// False if the next word begins another entry, misspelt or not, or a heading.
fn sensor_follows(p: &Parser<'_, '_>) -> bool {
    p.peek().is_some_and(|word| {
        let text = word.text;
        let misspelt = text.starts_with('-') && nearest(text, BEGINNINGS.iter().copied()).is_some();
        !(misspelt || is_integer(text) || text.starts_with('"') || is_compiling_word(text))
    })
}

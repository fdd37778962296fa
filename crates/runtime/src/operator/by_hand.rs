//! An operator's orders to the Active Pedestal, and statements about the object in the gripper. Orders that the tables
//! (`levels::subtask::manual`, `levels::task::support`) would refuse in the next tick are refused here.

use geometry::units::inches;
use interfaces::{
    CommonMemory, ProcessId,
    emove::Holding,
    grip::Felt,
    operator::{HandOrder, Support, may_be_written},
    pedestal::PedestalVerb,
};
use levels::{subtask::manual, task::support};
use rcs_core::{name::Name16, tick::Tick};
use taskdata::files::TaskData;

const ORDERS: &str = "pedestal pre-grip OBJECT, grip OBJECT, flip DEGREES, release [by hand] or pause";
const LARGEST_FLIP: f64 = 360.0; // largest angle that FLIP takes, degrees

/// Read the words after `pedestal`. Errors: a message with the expected and the found text.
pub fn order(words: &[&str]) -> Result<HandOrder, String> {
    let expected = || format!("{ORDERS} was expected; found pedestal {}", words.join(" "));
    let of = |command| HandOrder { command, ..HandOrder::default() };
    Ok(match *words {
        ["pre-grip", object] => with_object(of(PedestalVerb::PreGrip), object)?,
        ["grip", object] => with_object(of(PedestalVerb::Grip), object)?,
        ["flip", degrees] => HandOrder { table_angle: tenths(degrees)?, ..of(PedestalVerb::Flip) },
        ["release"] => of(PedestalVerb::Release),
        ["release", "by", "hand"] => HandOrder { by_hand: true, ..of(PedestalVerb::Release) },
        ["pause"] => of(PedestalVerb::Pause),
        _ => return Err(expected()),
    })
}

fn with_object(order: HandOrder, object: &str) -> Result<HandOrder, String> {
    let name = Name16::new(object);
    let name = name.map_err(|_| format!("an object was expected, at most 16 characters; found {object}"))?;
    Ok(HandOrder { object: Some(name), ..order })
}

fn tenths(degrees: &str) -> Result<i32, String> {
    let angle = degrees.parse::<f64>().ok().filter(|angle| angle.abs() <= LARGEST_FLIP);
    let angle = angle.ok_or_else(|| {
        format!("an angle of -{LARGEST_FLIP} to {LARGEST_FLIP} degrees was expected; found {degrees}")
    })?;
    Ok(geometry::units::rounded(angle * 10.0))
}

/// Read the words after `confirm`. Errors: a message with the expected and the found text.
pub fn confirmation(words: &[&str]) -> Result<Support, String> {
    let text = words.join(" ");
    Support::from_text(&text).ok_or_else(|| {
        format!(
            "confirm {} or confirm {} was expected; found confirm {text}",
            Support::Clamped,
            Support::ByHand
        )
    })
}

/// Check an order for the next tick. Returns the answer for operator and log. Errors: the reason of the refusal.
pub fn check_order(
    order: &HandOrder,
    tick: Tick,
    memory: &CommonMemory,
    data: &TaskData<'_>,
) -> Result<String, String> {
    runs(ProcessId::Subtask, memory)?;
    match manual::judge(order, tick, memory, data) {
        Ok(()) => Ok(format!("{} is sent to the pedestal; `pedestal` shows its state", order.command)),
        Err(why) => Err(why.text().to_owned()),
    }
}

/// Check a statement for the next tick. Returns the answer for operator and log. Errors: the reason of the refusal.
pub fn check_confirmation(by: Support, memory: &CommonMemory, data: &TaskData<'_>) -> Result<String, String> {
    runs(ProcessId::Task, memory)?;
    let below = &memory.subtask.status;
    if below.held == Holding::Nothing {
        return Err("the gripper holds nothing: there is nothing to confirm".to_owned());
    }
    let Some(at) = below.at else {
        return Err("the robot is not at a known place: move it to one first".to_owned());
    };
    let held =
        below.held.object().map_or_else(|| "what the gripper may hold".to_owned(), |held| held.to_string());
    match (by, support::TaskSupport::of_place(below, None, data)) {
        (Support::Clamped, support::TaskSupport::Jaws) => Ok(format!(
            "{held} is treated as clamped at {} as long as the robot stands there",
            at.site.location
        )),
        (Support::Clamped, _) => Err(format!(
            "the robot does not hold an object at a vise: {held} at {}; hold it and send `confirm by hand`",
            at.site.location
        )),
        (Support::ByHand, _) => Ok(format!(
            "{held} is treated as held by hand as long as the robot stands at {}: POSITION opens the gripper",
            at.site.location
        )),
    }
}

/// Check that a process runs and can therefore read the request.
fn runs(process: ProcessId, memory: &CommonMemory) -> Result<(), String> {
    if may_be_written(process, memory) {
        Err(format!("{process} does not run: `board {} go` starts it", process.board()))
    } else {
        Ok(())
    }
}

pub fn state(memory: &CommonMemory) -> String {
    let status = &memory.pedestal.status;
    let regrip =
        memory.subtask.regrip.map_or_else(|| "a part".to_owned(), |regrip| regrip.object.to_string());
    let holds = match status.felt {
        Felt::Something if status.gripped => format!("holds {regrip}"),
        Felt::NotKnown if status.gripped => format!("may hold {regrip}"),
        Felt::Something | Felt::Nothing | Felt::NotKnown => "holds nothing".to_owned(),
    };
    let angle = status.table_position.map_or_else(
        || "at an unknown angle".to_owned(),
        |tenths| format!("at {:.1} degrees", f64::from(tenths) / 10.0),
    );
    let last = match memory.subtask.pedestal.command {
        PedestalVerb::None => "no command",
        verb => verb.text(),
    };
    let reason = status.reason.text();
    let why = if reason.is_empty() { String::new() } else { format!(": {reason}") };
    let opening = inches(status.grip_size);
    format!("the hand {holds}, opening {opening:.2} in; the table is {angle}; {last} {}{why}", status.report)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<HandOrder, String> {
        order(&line.split(' ').collect::<Vec<_>>())
    }

    #[test]
    fn pedestal_orders_parse_with_object_angle_and_hand() {
        let grip = read("grip LCLEVIS_IH").unwrap();
        assert_eq!((grip.command, grip.object), (PedestalVerb::Grip, Name16::new("LCLEVIS_IH").ok()));
        assert_eq!(read("flip -183.5").unwrap().table_angle, -1835);
        assert!(read("release by hand").unwrap().by_hand && !read("release").unwrap().by_hand);
        assert_eq!(read("pause").unwrap().command, PedestalVerb::Pause);
        for (line, word) in [
            ("grip", "grip OBJECT"),
            ("release by foot", "release [by hand]"),
            ("flip far", "-360 to 360 degrees"),
            ("flip 400", "found 400"),
            ("grip A-NAME-OF-MORE-THAN-16", "at most 16 characters"),
        ] {
            assert!(read(line).unwrap_err().contains(word), "{line}: {:?}", read(line));
        }
    }

    #[test]
    fn confirmations_parse_and_an_empty_hand_is_refused() {
        assert_eq!(confirmation(&["clamped"]), Ok(Support::Clamped));
        assert_eq!(confirmation(&["by", "hand"]), Ok(Support::ByHand));
        assert!(confirmation(&["maybe"]).unwrap_err().contains("confirm clamped or confirm by hand"));
        let refused = check_confirmation(Support::ByHand, &CommonMemory::default(), &TaskData::default());
        assert!(refused.unwrap_err().contains("the gripper holds nothing"));
    }
}

//! A search through neighbouring processes in pairs: the real tables and the real handshake of both, breadth first
//! over all reachable states, with every possible behaviour of their environment.
//!
//! ```text
//!   commander ── any command, in any tick ──► upper ──► lower ──► orders: any answer, any delay
//! ```
//!
//! In every state, each command that is reported done has had its effect, by its own orders. From every state
//! without further commands, the pair comes to rest within a bound (no livelock), if each order completes, fails,
//! or exceeds its time limit. After PAUSE the bound is smaller.
//!
//! `RCS_PAIRS=full` searches with mishaps in every state: restarting processes and silent neighbours.

#![expect(clippy::print_stdout, reason = "the figures of a search are printed")]

mod data;
mod emove;
#[path = "../environment/emove.rs"]
mod emove_orders;
mod fingers;
mod frame;
mod grip;
mod hand;
mod holster;
mod image;
mod jaws;
mod parts_gripper;
mod pedestal;
mod prim;
mod ring;
mod robot;
mod search;
mod subtask;
mod task;

use interfaces::{emove::EmoveVerb, pedestal::PedestalVerb};
use levels::jaws::{CylindricalPartGripper, ToolGripper};
use search::{Found, World, search};
use subtask::{BRING, GET, GOTO, GRIPPER, PAUSE, PLACE, POSITION, RELEASE};

fn is_full() -> bool {
    std::env::var("RCS_PAIRS").is_ok_and(|value| value == "full")
}

fn grouped(number: impl ToString) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev();
    groups.map(String::from_utf8_lossy).collect::<Vec<_>>().join(",")
}

fn is_sound<W: World>(name: &str, first: W, most: usize) -> Found<W::Event> {
    let found = search(first, most);
    println!(
        "{name}: {} states, {} ticks; at rest {} ticks after PAUSE at most, {} after any command",
        found.states, found.ticks, found.pause, found.any
    );
    assert!(found.wrong.is_none(), "{name}: {:#?}", found.wrong);
    if !is_full() {
        // A role or an image that merges different states makes a search smaller, without a failure.
        let row = format!("| {name} | {} | {} |", grouped(found.states), grouped(found.ticks));
        let sizes = include_str!("sizes.txt");
        assert!(sizes.contains(&row), "crates/levels/tests/pairs/sizes.txt needs the row `{row}`");
    }
    found
}

const SOME: &[PedestalVerb] = &[PedestalVerb::PreGrip, PedestalVerb::Flip, PedestalVerb::Pause];

fn commands() -> &'static [PedestalVerb] {
    if is_full() { PedestalVerb::ALL } else { SOME }
}

#[test]
fn pedestal_and_table() {
    let found = is_sound("Pedestal and table", pedestal::first(0, commands()), 1_000_000);
    assert!(found.pause <= 22 && found.any <= 44, "{} and {}", found.pause, found.any);
}

#[test]
fn pedestal_and_table_with_a_mishap() {
    let commands = if is_full() { SOME } else { &[PedestalVerb::Flip, PedestalVerb::Pause] };
    is_sound("Pedestal and table, a mishap", pedestal::first(1, commands), 8_000_000);
}

const HOLDING: &[PedestalVerb] = &[PedestalVerb::Grip, PedestalVerb::Release, PedestalVerb::Pause];

#[test]
fn pedestal_and_hand() {
    let commands = if is_full() { PedestalVerb::ALL } else { HOLDING };
    let found = is_sound("Pedestal and hand", hand::first(0, commands), 1_000_000);
    assert!(found.pause <= 21 && found.any <= 29, "{} and {}", found.pause, found.any);
}

#[test]
fn pedestal_and_hand_with_a_mishap() {
    let commands = if is_full() { HOLDING } else { &[PedestalVerb::Grip, PedestalVerb::Pause] };
    is_sound("Pedestal and hand, a mishap", hand::first(1, commands), 1_000_000);
}

const HANDLING: &[&str] = &[
    "PAUSE",
    "TRANSFER LINKBAR1 +2 PFIXTURE 0 +2 UNIT_1 1 SAFE 0",
    "POSITION LINKBAR1 +2 PFIXTURE 0 +0 -- 0 -- 0",
    "MOVE -- +0 -- 0 +0 HOME 0 -- 0",
    "ACQUIRE LINKBAR1 +2 PFIXTURE 0 +0 -- 0 -- 0",
];
/// Commands that need the Data System.
const DATA_SYSTEM_COMMANDS: &[&str] =
    &["PAUSE", "STARTUP", "POSITION LINKBAR1 +2 PFIXTURE 0 +0 -- 0 -- 0", "SHUTDOWN"];

/// Search Task and Subtask with these commands; a resting pair takes `any` ticks at most.
fn tasks(name: &str, mishaps: u8, lines: &[&str], any: u32) {
    let found = is_sound(name, task::first(mishaps, data::commands(lines)), 4_000_000);
    assert!(found.pause <= 14 && found.any <= any, "{} and {}", found.pause, found.any);
}

#[test]
fn task_and_subtask_handle_an_object() {
    let some = if is_full() { 5 } else { 3 };
    tasks("Task and Subtask, an object", 0, &HANDLING[..some], 23);
}

#[test]
fn task_and_subtask_update_the_data_system() {
    let some = if is_full() { 4 } else { 3 };
    tasks("Task and Subtask, the Data System", 0, &DATA_SYSTEM_COMMANDS[..some], 23);
}

/// Ticks to the end of a TRANSFER that first reports where the replaced command has left an object, and then the
/// place of its own.
const TWO_UPDATES_TICKS: u32 = 32;

#[test]
fn task_and_subtask_release_an_object() {
    let mut commands = data::commands(&[HANDLING[0], HANDLING[2], HANDLING[1]]);
    commands.truncate(if is_full() { 3 } else { 2 });
    let pair = task::first(0, commands.clone()).carrying(&commands[1]);
    let found = is_sound("Task and Subtask, an object in the database", pair, 4_000_000);
    assert!(found.pause <= 14 && found.any <= TWO_UPDATES_TICKS, "{} and {}", found.pause, found.any);
}

#[test]
fn task_and_subtask_take_an_object_out_of_the_mbd() {
    let mut commands =
        data::commands(&["TRANSFER LINKBAR1 +2 UNIT_1 1 +2 PFIXTURE 0 SAFE 0", HANDLING[2], HANDLING[0]]);
    commands.truncate(if is_full() { 3 } else { 2 });
    let pair = task::first(0, commands).connected("UNIT_1").promptly(!is_full());
    let found = is_sound("Task and Subtask, an object taken out of the MBD", pair, 4_000_000);
    assert!(found.pause <= 14 && found.any <= TWO_UPDATES_TICKS, "{} and {}", found.pause, found.any);
}

#[test]
fn task_and_subtask_with_a_mishap() {
    tasks("Task and Subtask, a mishap", 1, &["PAUSE", "MOVE -- +0 -- 0 +0 HOME 0 -- 0"], 14);
}

#[test]
fn task_and_subtask_transfer_with_a_mishap() {
    tasks("Task and Subtask, TRANSFER with a mishap", 1, &HANDLING[..2], 25);
}

const GRASPING: &[emove::Line] =
    &[(EmoveVerb::GraspObj, None), (EmoveVerb::Release, None), (EmoveVerb::Pause, None)];

/// `early` commands replace others (any number for `None`). The pair comes to rest within `pause` and `any` ticks.
fn grasping<G: emove::Fingered>(
    name: &str,
    commands: &'static [emove::Line],
    (early, restarts): (Option<u8>, u8),
    (pause, any): (u32, u32),
) {
    let found = is_sound(name, emove::first::<G>(commands, early, restarts), 2_500_000);
    assert!(found.pause <= pause && found.any <= any, "{} and {}", found.pause, found.any);
}

#[test]
fn emove_and_grip() {
    grasping::<grip::Grip>("E-move and Grip", GRASPING, (None, 0), (25, 30));
}

#[test]
fn emove_and_grip_with_a_restart() {
    let early = if is_full() { None } else { Some(0) };
    grasping::<grip::Grip>("E-move and Grip, a restart", GRASPING, (early, 1), (25, 30));
}

type VGrip = jaws::Jaws<CylindricalPartGripper>;
type ToolGrip = jaws::Jaws<ToolGripper>;

#[test]
fn emove_and_v_grip() {
    grasping::<VGrip>("E-move and V-Grip", GRASPING, (None, 0), (67, 76));
}

#[test]
fn emove_and_v_grip_with_a_restart() {
    let commands = if is_full() { GRASPING } else { &GRASPING[..2] };
    grasping::<VGrip>("E-move and V-Grip, a restart", commands, (Some(0), 1), (67, 76));
}

#[test]
fn emove_and_tool_grip() {
    let commands = if is_full() { GRASPING } else { &GRASPING[..2] };
    grasping::<ToolGrip>("E-move and Tool-Grip", commands, (None, 0), (67, 76));
}

#[test]
fn emove_and_tool_grip_with_a_restart() {
    let (commands, early) = if is_full() { (&GRASPING[..2], 1) } else { (&GRASPING[..1], 0) };
    grasping::<ToolGrip>("E-move and Tool-Grip, a restart", commands, (Some(early), 1), (67, 76));
}

/// The robot moves away with its object, and back with the object or with open fingers.
const AWAY: emove::Line = (EmoveVerb::MovToLoc, Some("SAFE"));
const BRING_BACK: emove::Line = (EmoveVerb::MovObjTo, None);
const BACK: emove::Line = (EmoveVerb::MovToObj, None);
const CARRYING: &[emove::Line] = &[GRASPING[0], AWAY, BRING_BACK, GRASPING[1]];
const GOING_BACK: &[emove::Line] = &[GRASPING[0], AWAY, BACK, GRASPING[2]];

#[test]
fn emove_and_grip_carry_an_object() {
    let early = u8::from(is_full());
    grasping::<grip::Grip>("E-move and Grip, carrying", CARRYING, (Some(early), 0), (25, 35));
}

#[test]
fn emove_and_grip_go_back_to_an_object() {
    let (some, early) = if is_full() { (4, 1) } else { (3, 0) };
    grasping::<grip::Grip>("E-move and Grip, going back", &GOING_BACK[..some], (Some(early), 0), (25, 35));
}

#[test]
fn emove_and_grip_carry_an_object_with_a_restart() {
    let some = if is_full() { 4 } else { 2 };
    grasping::<grip::Grip>("E-move and Grip, carrying, a restart", &CARRYING[..some], (Some(0), 1), (25, 32));
}

#[test]
fn emove_and_v_grip_go_back_to_an_object() {
    let some = if is_full() { 3 } else { 2 };
    grasping::<VGrip>("E-move and V-Grip, going back", &GOING_BACK[..some], (Some(0), 0), (67, 76));
}

const THERE_AND_BACK: &[prim::Line] =
    &[(EmoveVerb::Pause, ""), (EmoveVerb::MovToLoc, "HOME"), (EmoveVerb::MovToLoc, "SAFE")];

/// `motions` commands interrupt a motion, and `faults` faults occur.
fn moves(name: &str, motions: u8, faults: u8) {
    let found = is_sound(name, prim::Pair::first("HOME", THERE_AND_BACK, motions, faults), 1_000_000);
    assert!(found.pause <= 10 && found.any <= 30, "{} and {}", found.pause, found.any);
}

#[test]
fn emove_and_prim() {
    moves("E-move and Prim", if is_full() { 2 } else { 1 }, 0);
}

#[test]
fn emove_and_prim_with_a_fault() {
    moves("E-move and Prim, a fault", u8::from(is_full()), 1);
}

const CHANGING_TOOLS: &[prim::Line] = &[
    (EmoveVerb::AcquireTool, prim::DRUM),
    (EmoveVerb::RemoveTool, prim::DRUM),
    (EmoveVerb::MovToLoc, "TOOL-SAFE"),
    (EmoveVerb::InsertTool, prim::DRUM),
    (EmoveVerb::ReleaseTool, prim::DRUM),
    (EmoveVerb::Pause, ""),
];

/// Searches guarded moves at the drum, with so many unusual events, commands that interrupt a motion, and faults. The
/// pair comes to rest within `any` ticks.
fn guards(name: &str, commands: usize, (unusual, motions, faults): (u8, u8, u8), any: u32) {
    let first = prim::Pair::at_drum(&CHANGING_TOOLS[..commands], unusual, motions, faults);
    let found = is_sound(name, first, 1_000_000);
    assert!(found.pause <= 10 && found.any <= any, "{} and {}", found.pause, found.any);
}

#[test]
fn emove_and_prim_change_tools() {
    let (unusual, any) = if is_full() { (2, 86) } else { (1, 65) };
    guards("E-move and Prim, tools", 5, (unusual, 0, 0), any);
}

#[test]
fn emove_and_prim_change_tools_with_an_interruption() {
    let (unusual, any) = if is_full() { (1, 65) } else { (0, 41) };
    guards("E-move and Prim, tools, an interruption", 6, (unusual, 1, 0), any);
}

#[test]
fn emove_and_prim_change_tools_with_a_fault() {
    let commands = if is_full() { 6 } else { 4 };
    guards("E-move and Prim, tools, a fault", commands, (0, 0, 1), 41);
}

const CHANGING_GRIPPERS: &[prim::Line] =
    &[(EmoveVerb::QcAttach, prim::HOLSTER), (EmoveVerb::QcDetach, prim::HOLSTER), (EmoveVerb::Pause, "")];

/// Like [`guards`], at a holster.
fn exchanges(name: &str, commands: usize, (unusual, motions, faults): (u8, u8, u8), any: u32) {
    let first = prim::Pair::at_holster(&CHANGING_GRIPPERS[..commands], unusual, motions, faults);
    let found = is_sound(name, first, 1_000_000);
    assert!(found.pause <= 10 && found.any <= any, "{} and {}", found.pause, found.any);
}

#[test]
fn emove_and_prim_change_grippers() {
    let unusual = if is_full() { 3 } else { 1 };
    exchanges("E-move and Prim, grippers", 2, (unusual, 0, 0), 38);
}

#[test]
fn emove_and_prim_change_grippers_with_an_interruption() {
    let (unusual, motions) = if is_full() { (1, 2) } else { (0, 1) };
    exchanges("E-move and Prim, grippers, an interruption", 3, (unusual, motions, 0), 46);
}

#[test]
fn emove_and_prim_change_grippers_with_a_fault() {
    let (commands, unusual) = if is_full() { (3, 1) } else { (2, 0) };
    exchanges("E-move and Prim, grippers, a fault", commands, (unusual, 0, 1), 44);
}

/// `early` commands replace others, and `mishaps` happen. The pair comes to rest within `any` ticks.
fn fetches(name: &str, object: &str, lines: &[subtask::Line], (early, mishaps): (u8, u8), any: u32) {
    let found = is_sound(name, subtask::first(object, lines, early, mishaps), 4_000_000);
    assert!(found.pause <= 12 && found.any <= any, "{} and {}", found.pause, found.any);
}

/// An object with a place in the data, and one that vision must locate.
const KNOWN: &str = "LINKBAR1";
const LOOKED_FOR: &str = "LINKBAR1_BH";

#[test]
fn subtask_and_emove() {
    let some = if is_full() { 4 } else { 3 };
    fetches("Subtask and E-move", KNOWN, &[PAUSE, GET, PLACE, GOTO][..some], (0, 0), 21);
}

#[test]
fn subtask_and_emove_with_pictures() {
    let (some, early) = if is_full() { (3, 1) } else { (2, 0) };
    fetches("Subtask and E-move, pictures", LOOKED_FOR, &[PAUSE, GET, PLACE][..some], (early, 0), 52);
}

#[test]
fn subtask_and_emove_with_a_command_too_early() {
    let some = if is_full() { 3 } else { 2 };
    fetches("Subtask and E-move, too early", KNOWN, &[PAUSE, GET, PLACE][..some], (1, 0), 28);
}

#[test]
fn subtask_and_emove_with_a_mishap() {
    let lines: &[_] = if is_full() { &[PAUSE, GET, PLACE] } else { &[PAUSE, GOTO] };
    fetches("Subtask and E-move, a mishap", KNOWN, lines, (0, 1), 28);
}

#[test]
fn subtask_and_emove_with_other_commands() {
    let lines: &[_] = if is_full() {
        &[PAUSE, GET, BRING, RELEASE, POSITION, GRIPPER]
    } else {
        &[PAUSE, GRIPPER, POSITION]
    };
    fetches("Subtask and E-move, other commands", KNOWN, lines, (0, 0), 28);
}

/// `early` commands replace others, and `faults` occur.
fn changes(name: &str, early: u8, faults: u8) {
    let found = is_sound(name, ring::first(early, faults), 1_000_000);
    assert!(found.pause <= 14 && found.any <= 43, "{} and {}", found.pause, found.any);
}

#[test]
fn emove_and_quick_change() {
    changes("E-move and Quick Change", u8::from(is_full()), 0);
}

#[test]
fn emove_and_quick_change_with_a_fault() {
    changes("E-move and Quick Change, a fault", u8::from(is_full()), 1);
}

//! LOAD by the workstation controller (IV.2.4): a block of the run's data directory takes effect with the next
//! command.

use std::{fs, os::unix::fs::symlink, path::PathBuf};

use interfaces::HwsCommand;
use neighbours::workstation::cell::Trouble;
use rcs_core::name::Name16;
use record::{Log, OperatorLine};
use whole_system_tests::Scratch;

use super::bench::{Controller, Workstation, bare};

/// The finger point of SAFE-P, and one half an inch higher with its wrist and tool point.
const SAFE: &str = "   -3362    -3734      638\n   -4781    -5310    -1483\n   -2552    -7317    -1483";
const HIGHER: &str = "   -3362    -3734      688\n   -4781    -5310    -1433\n   -2552    -7317    -1433";

struct Cell {
    scratch: Scratch,
}

struct Left {
    scratch: Scratch,
    digest: String,
    lines: Vec<OperatorLine>,
}

impl Cell {
    fn new(name: &str) -> Self {
        let scratch = Scratch::new(name);
        scratch.copy_data();
        Self { scratch }
    }

    fn poses(&self) -> PathBuf {
        self.scratch.file("data").join("poses.blk")
    }

    fn change(&self, from: &str, to: &str) {
        let text = fs::read_to_string(self.poses()).expect("poses");
        assert_eq!(text.matches(from).count(), 1, "{from}");
        fs::write(self.poses(), text.replace(from, to)).expect("it can be written");
    }

    fn play(self, more: &[&str], play: impl FnOnce(&Self, &mut Workstation)) -> Left {
        let text = |name: &str| self.scratch.file(name).display().to_string();
        let (data, log, socket) = (text("data"), text("run.mcap"), format!("unix:{}", text("rcs.sock")));
        let arguments = [&["--json", "--data", &data, "--log", &log][..], more].concat();
        // The data are read during the run, so they need another directory.
        let controller =
            Controller::start_at(Scratch::new("loading"), Some(&socket), "workstation", &arguments);
        let mut workstation = Workstation::connect(&controller);
        play(&self, &mut workstation);
        drop(workstation);
        let ended = controller.end();
        assert_eq!(ended.status, Some(0), "{}", ended.said);
        let lines = Log::open(&self.scratch.file("run.mcap")).expect("a log").operator_lines().collect();
        let digest = ended.result["digest"].as_str().expect("a digest").to_owned();
        Left { scratch: self.scratch, digest, lines }
    }
}

fn line(workstation: &mut Workstation, line: &str) -> (Trouble, String) {
    workstation.begin_in_cell(line);
    loop {
        workstation.tick();
        if workstation.cell_is_idle() {
            return (workstation.cell().trouble, workstation.cell().text.to_owned());
        }
    }
}

fn to_safe(number: u32) -> HwsCommand {
    HwsCommand { destination: Some(Name16::clipped("SAFE")), ..bare(number, "MOVE") }
}

fn finishes(workstation: &mut Workstation, command: &HwsCommand) {
    let outcome = workstation.carry_out(command);
    assert_eq!(outcome, ("finished".to_owned(), String::new()));
}

/// PAUSE, LOAD of block 610 with another SAFE, MOVE to SAFE.
fn load_and_move(cell: &Cell, workstation: &mut Workstation) {
    finishes(workstation, &bare(1, "PAUSE"));
    cell.change(SAFE, HIGHER);
    assert_eq!(line(workstation, "load 21000 610"), (Trouble::None, String::new()));
    finishes(workstation, &to_safe(2));
}

#[test]
fn block_loaded_by_the_workstation_takes_effect_with_the_next_command() {
    let without = Cell::new("without").play(&[], |_, workstation| {
        finishes(workstation, &bare(1, "PAUSE"));
        assert_eq!(line(workstation, "load 21000 999").0, Trouble::Refused); // as many ticks as the load takes
        finishes(workstation, &to_safe(2));
    });
    let loaded = Cell::new("loaded").play(&[], load_and_move);
    assert_ne!(loaded.digest, without.digest, "the robot moves to another SAFE");
    let [line] = &loaded.lines[..] else { panic!("{:?}", loaded.lines) };
    let said = (line.source.as_str(), line.line.as_str(), line.refused.as_deref());
    assert_eq!(said, ("workstation controller", "load 21000 610", None));
    assert_eq!(line.answer, "block 610 (offset 21000) of poses.blk is loaded; the data have generation 1");
    // Several boards check the block; the run in fast clock waits for them.
    let split = Cell::new("split").play(&["--boards", "split"], load_and_move);
    assert_eq!((split.digest, split.lines), (loaded.digest.clone(), loaded.lines.clone()));
    // The repetition reads the text from the log, because the present file does not contain it.
    let log = loaded.scratch.file("run.mcap").display().to_string();
    let again = Cell::new("again").play(&["--inputs", &log], |_, workstation| {
        finishes(workstation, &bare(1, "PAUSE"));
        assert_eq!(self::line(workstation, "load 21000 610"), (Trouble::None, String::new()));
        finishes(workstation, &to_safe(2));
    });
    assert_eq!((again.digest, again.lines), (loaded.digest, loaded.lines));
}

#[test]
fn a_refused_load_keeps_the_old_data() {
    let play = |cell: &Cell, workstation: &mut Workstation, text: &str, lines: &[(&str, &str)]| {
        finishes(workstation, &bare(1, "PAUSE"));
        cell.change(SAFE, text);
        for (sent, why) in lines {
            let (trouble, text) = line(workstation, sent);
            assert!(trouble == Trouble::Refused && text.contains(why), "{sent}: {text:?}");
        }
        workstation.run_to(100);
        finishes(workstation, &to_safe(2));
    };
    let quiet = Cell::new("quiet").play(&[], |cell, workstation| play(cell, workstation, HIGHER, &[]));
    let cell = Cell::new("refused");
    let outside = cell.scratch.file("outside.blk"); // a block outside, and a link to it in the data directory
    fs::write(&outside, "BLOCK# 777 OFFSET 21000\n( nothing )\n").expect("it can be written");
    symlink(&outside, cell.scratch.file("data").join("inside.blk")).expect("it can be made");
    let outside = format!("load {}", outside.display());
    let expected = "load OFFSET BLOCK was expected, such as load 21000 610";
    let lines = [
        ("load 21000 610", "with this change the task data have errors: poses.blk:"),
        ("load 21000 999", "the run's data directory has no block 999 (offset 21000)"),
        ("load 21000 777", "inside.blk is a link to a file outside of the run's data directory"),
        ("load ../outside.blk 777", expected),
        ("load /etc 610", expected),
        ("load ../outside.blk", expected),
        (&outside, expected),
        ("load 21000 -1", expected),
    ];
    let nonsense = "   -3362    -3734      nonsense";
    let refused = cell.play(&[], |cell, workstation| play(cell, workstation, nonsense, &lines));
    assert_eq!(refused.digest, quiet.digest);
    // Invalid loads are refused like other lines for the cell.
    let logged: Vec<_> = refused.lines.iter().map(|line| line.refused.is_some()).collect();
    assert_eq!(logged, [true; 3]);
    // A repetition refuses the loads that the log refuses, although the text is now valid.
    let log = refused.scratch.file("run.mcap").display().to_string();
    let again = Cell::new("refused-again").play(&["--inputs", &log], |cell, workstation| {
        play(cell, workstation, HIGHER, &lines[..3]);
    });
    assert_eq!((again.digest, again.lines), (refused.digest, refused.lines));
}

#[test]
fn no_block_is_loaded_during_a_command() {
    Cell::new("busy").play(&[], |_, workstation| {
        finishes(workstation, &bare(1, "PAUSE"));
        workstation.send(&to_safe(2));
        workstation.run_to(workstation.tick + 20);
        let (trouble, text) = line(workstation, "load 21000 610");
        assert_eq!((trouble, text.starts_with("a command is executed")), (Trouble::Refused, true), "{text}");
        while workstation.status().report.text() != "finished" {
            workstation.tick();
        }
        assert_eq!(line(workstation, "load 21000 610"), (Trouble::None, String::new()));
    });
}

/// The block is checked in parallel with the ticks. Meanwhile the cell is busy.
#[test]
fn on_the_grid_a_load_is_answered_later() {
    for boards in ["one", "split"] {
        let cell = Cell::new(&format!("grid-{boards}"));
        let data = cell.scratch.file("data").display().to_string();
        let more = ["--json", "--clock", "real", "--boards", boards, "--data", &data];
        let controller = Controller::start("grid", "workstation", &more);
        let mut workstation = Workstation::connect(&controller);
        assert_eq!(workstation.carry_out(&bare(1, "PAUSE")).0, "finished");
        cell.change(SAFE, HIGHER);
        assert_eq!(line(&mut workstation, "load 21000 610"), (Trouble::None, String::new()));
        cell.change(HIGHER, "   nonsense");
        let (trouble, text) = line(&mut workstation, "load 21000 610");
        assert!(trouble == Trouble::Refused && text.contains("have errors"), "{text}");
        assert_eq!(workstation.carry_out(&bare(2, "PAUSE")).0, "finished");
    }
}

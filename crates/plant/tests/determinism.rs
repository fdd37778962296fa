//! Equal seeds give equal bits: in ten runs, in two processes, and after saving and restoring the cell during contacts.

use crate::rig::{Rig, description, scenes, tape::Tape};
use plant::{Cell, RestoreError};

const COMPARED_TICKS: usize = 500; // ticks for which a restored cell is compared with the saved one

fn tape(rig: Rig) -> Tape {
    rig.tape.unwrap()
}

#[test]
fn ten_runs_have_the_same_digests_in_every_tick() {
    let first = tape(scenes::clamping(7));
    assert!(first.digests.len() > 1000);
    for run in 1..10 {
        let again = tape(scenes::clamping(7));
        let differs = first.digests.iter().zip(&again.digests).position(|(a, b)| a != b);
        assert_eq!(differs, None, "run {run} differs from the first one from this tick on");
        assert_eq!(first.digests.len(), again.digests.len());
    }
    assert_ne!(first.chain(), tape(scenes::clamping(8)).chain(), "another seed is another run");
}

#[test]
fn motion_in_a_tick_changes_the_digest() {
    let tape = tape(scenes::clamping(7));
    let still = tape.digests.windows(2).filter(|pair| pair[0] == pair[1]).count();
    assert_eq!(still, 0, "the noise of the sensors changes in every tick");
}

/// Prints the chains of this process for [`two_processes_have_the_same_digests`].
#[test]
#[ignore = "is run by another test, in a process of its own"]
fn chains_of_this_process() {
    println!("chains {:016x} {:016x}", tape(scenes::clamping(3)).chain(), tape(scenes::drumming(3)).chain());
}

#[test]
fn two_processes_have_the_same_digests() {
    let chains = || {
        let output = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "determinism::chains_of_this_process", "--ignored", "--nocapture"])
            .output()
            .unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let at = text.find("chains ").unwrap_or_else(|| panic!("no chains in {text}"));
        text[at..].lines().next().unwrap().to_owned()
    };
    let here = format!(
        "chains {:016x} {:016x}",
        tape(scenes::clamping(3)).chain(),
        tape(scenes::drumming(3)).chain()
    );
    assert_eq!([chains(), chains()], [here.clone(), here]);
}

/// Play a tape again, save and copy the cell every `every` ticks, and continue each of them along the tape.
fn saved_and_copied_cells_continue(rig: Rig, seed: u64, every: usize) {
    let description = rig.description.clone();
    let tape = tape(rig);
    let mut cell = Cell::new(&description, seed).unwrap();
    let mut saved = Vec::new();
    for (tick, beat) in tape.beats.iter().enumerate() {
        if tick % every == 0 {
            saved.push((tick, cell.save().unwrap(), cell.clone()));
        }
        beat.play(&mut cell);
        assert_eq!(cell.digest(), tape.digests[tick], "the tape in tick {tick}");
    }
    for (tick, bytes, copy) in &saved {
        for mut cell in [Cell::restore(&description, bytes).unwrap(), copy.clone()] {
            assert_eq!(cell.save().unwrap(), *bytes, "saved again in tick {tick}");
            let ahead = tape.beats.iter().zip(&tape.digests).enumerate().skip(*tick).take(COMPARED_TICKS);
            for (now, (beat, digest)) in ahead {
                beat.play(&mut cell);
                assert_eq!(cell.digest(), *digest, "saved in tick {tick}, differs in tick {now}");
            }
            let later = saved.iter().find(|(other, ..)| *other == tick + COMPARED_TICKS);
            assert!(
                later.is_none_or(|(_, bytes, _)| cell.save().unwrap() == *bytes),
                "{COMPARED_TICKS} ticks after {tick}"
            );
        }
    }
}

#[test]
fn cell_restored_during_gripping_continues_bit_for_bit() {
    saved_and_copied_cells_continue(scenes::clamping(5), 5, 50);
}

#[test]
fn cell_restored_with_a_tool_in_the_drum_continues_bit_for_bit() {
    saved_and_copied_cells_continue(scenes::drumming(5), 5, 50);
}

#[test]
fn invalid_saved_cells_are_refused() {
    let cell = Cell::new(&description(), 1).unwrap();
    let bytes = cell.save().unwrap();
    let refused = |bytes: &[u8]| Cell::restore(&description(), bytes).map(|_| ()).unwrap_err();
    let foreign = refused(b"MCAP0\r\n and more");
    assert_eq!(foreign.to_string(), "this is not a saved cell: it does not begin with RCSCELL");
    let found = bytes.len() as u64;
    for length in [0, 5, 20, 28, bytes.len() / 2, bytes.len() - 1] {
        let error = refused(&bytes[..length]);
        let expected = if length < 28 { 28 } else { found };
        assert_eq!(error, RestoreError::Length { expected, found: length as u64 });
    }
    let longer = [bytes.as_slice(), b"x"].concat();
    assert_eq!(refused(&longer), RestoreError::Length { expected: found, found: found + 1 });
    for at in [28, 1000, bytes.len() - 1] {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        assert!(matches!(refused(&damaged), RestoreError::Damaged { .. }), "byte {at}");
    }
    // Magic, then the version. No more is read of another version, even if it is undamaged.
    let written = u32::from_le_bytes(bytes[8..12].try_into().unwrap());
    for other in (0..written).chain([written + 1, 77]) {
        let mut bytes = bytes.clone();
        bytes[8..12].copy_from_slice(&other.to_le_bytes());
        let error = refused(&bytes);
        assert_eq!(error, RestoreError::Version { found: other });
        let said =
            format!("this cell was saved in version {other} of the format, expected version {written}");
        assert_eq!(error.to_string(), said);
    }
    let other = scenes::with_tool_gripper();
    assert_eq!(Cell::restore(&other, &bytes).map(|_| ()).unwrap_err(), RestoreError::OtherDescription);
}

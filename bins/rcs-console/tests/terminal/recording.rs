//! The start-up of the manual (IV.3.3) and a taught point (III.3.3) with an operator's keys. For a recording for
//! `asciinema play`: `RCS_RECORDING=docs/console.cast cargo test --release -p programs --test console recording`.

use std::{env, fmt::Write as _};

use serde_json::json;
use sessions::operator::Client;

use super::*;

const LAST: &str = "19b"; // the last step of IV.3.3
const LOOK: &str = "6"; // the step that the operator must confirm
/// Time after which Enter is repeated if the robot controller was not ready. In a recording it is ten times as long.
const AGAIN: Duration = Duration::from_millis(300);

/// A recording in version 2 of asciicast: a header, then one line per piece of output.
fn asciicast(written: &Written) -> String {
    let title = "rcs-console: start-up of the robot (IV.3.3), and a taught point (III.3.3)";
    let header =
        json!({ "version": 2, "width": COLUMNS, "height": LINES, "idle_time_limit": 2.0, "title": title });
    let mut text = format!("{header}\n");
    let mut rest: Vec<u8> = Vec::new();
    for (time, bytes) in written {
        rest.extend_from_slice(bytes);
        // A read can split a character.
        let whole = match std::str::from_utf8(&rest) {
            Ok(all) => all.len(),
            Err(error) => error.valid_up_to(),
        };
        let tail = rest.split_off(whole);
        let line =
            json!([(time.as_secs_f64() * 1000.0).round() / 1000.0, "o", String::from_utf8_lossy(&rest)]);
        rest = tail;
        writeln!(text, "{line}").unwrap();
    }
    text
}

fn step_under_cursor(screen: &str) -> Option<(String, String)> {
    let line = screen.lines().skip(3).find(|line| line.starts_with("> "))?;
    let part =
        |from: usize, to: usize| line.get(from..to.min(line.len())).unwrap_or_default().trim().to_owned();
    Some((part(2, 8), part(8, 13)))
}

fn do_all_steps(console: &mut Terminal, pause: Duration) {
    let again = if pause.is_zero() { AGAIN } else { 10 * AGAIN };
    let mut done = Vec::new();
    loop {
        let (mark, step) = step_under_cursor(&console.screen()).unwrap_or_default();
        if step == LAST && !mark.is_empty() {
            break;
        }
        thread::sleep(pause);
        let begun = Instant::now();
        console.press(if step == LOOK { "y" } else { "\r" });
        let mut pressed = Instant::now();
        let has_next = |screen: &str| {
            step_under_cursor(screen).is_some_and(|(mark, now)| now != step || !mark.is_empty())
        };
        while !has_next(&console.screen()) {
            let screen = console.screen();
            if begun.elapsed() > TIME_LIMIT {
                console.press("1");
                console.wait_for(">1 Ladder");
                panic!("step {step} is not done, after {done:?}:\n{screen}\n{}", console.screen());
            }
            if screen.contains("Enter again confirms") {
                thread::sleep(pause);
                console.press("\r");
                console.wait_while(|screen| screen.contains("Enter again confirms"), "the warning stays");
                pressed = Instant::now();
            } else if pressed.elapsed() > again && step != LOOK {
                console.press("\r");
                pressed = Instant::now();
            }
            thread::sleep(Duration::from_millis(20));
        }
        done.push(step);
    }
    // Steps whose conditions hold from the beginning need no key.
    for step in ["1b", "2", "4", "5", "6", "7", "8", "9", "10", "12", "12b", "13", "14", "15", "17", "19"] {
        assert!(done.iter().any(|one| one == step), "step {step} was not done by a key: {done:?}");
    }
}

#[test]
fn recording_shows_the_start_up_and_a_taught_point() {
    let file = env::var_os("RCS_RECORDING").map(PathBuf::from);
    let (speed, pause) = if file.is_some() { (5, Duration::from_millis(900)) } else { (10, Duration::ZERO) };
    let directory = tempfile::tempdir().unwrap();
    let data = own_data(directory.path());
    let name = format!("recorded-{}", std::process::id());
    let (run, stop) = waiting_run(directory.path(), &data, &name, speed);
    // A run begins with the robot under control, so the power is switched off first.
    let socket = executive::memory::operator_socket(&name.parse().unwrap());
    let mut before = Client::connect(&socket, &"before".parse().unwrap()).unwrap();
    for line in ["estop terminals", "panel power off", "leave"] {
        let begun = Instant::now();
        // On a busy machine an answer may be late; such a request is void.
        loop {
            let answer = before.ask(line);
            if matches!(answer, Ok(Ok(_))) {
                break;
            }
            assert!(begun.elapsed() < TIME_LIMIT, "{line}: {answer:?}");
        }
    }
    let mut console = Terminal::start(&["--run", &name, "--operate"], directory.path(), &[]);
    console.wait_for("OPERATOR");
    thread::sleep(pause);
    console.press("7");
    console.wait_for("IV.3.3");
    thread::sleep(pause);
    console.press("jjj");
    thread::sleep(pause);
    console.press("\r");
    console.wait_for("initialize the link (IV.3.3)");
    do_all_steps(&mut console, pause);
    drop(before);
    thread::sleep(pause);
    // The knob stays at 0 after the start-up.
    console.press(":joystick velocity 1000\r");
    console.wait_for("speed 100 %");
    teach(&mut console, pause);
    thread::sleep(pause * 2);
    console.escape(">5 Terminal");
    console.press("q");
    let written = console.written();
    assert_eq!(console.end(), Some(0));
    stop.store(true, Ordering::Relaxed);
    run.join().unwrap();
    let poses = std::fs::read_to_string(data.join("poses.blk")).unwrap();
    assert!(poses.contains("-pose-   ...         VIA-1"));
    // The recording equals the screen: played back, it ends with the taught point.
    let text = asciicast(&written);
    let mut played = vt100::Parser::new(LINES, COLUMNS, 0);
    let mut shown = Vec::new();
    for line in text.lines().skip(1) {
        let (_, _, output): (f64, String, String) = serde_json::from_str(line).unwrap();
        played.process(output.as_bytes());
        shown.push(played.screen().contents());
    }
    for picture in ["the robot is at HOME, and Task reports finished", "box       WORLD", "generation 1"] {
        assert!(shown.iter().any(|screen| screen.contains(picture)), "{picture} is not in the recording");
    }
    if let Some(file) = file {
        std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file), text).unwrap();
    }
}

//! A run and an operator in one process: `cargo run --release -p sessions --example operator`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use std::{env, error::Error, fs, process, thread, time::Duration};

use sessions::operator::{Client, Event, Listener, Name};

fn main() -> Result<(), Box<dyn Error>> {
    let directory = env::temp_dir().join(format!("session-{}", process::id()));
    fs::create_dir(&directory)?;
    let listener = Listener::start(&directory.join("operator"), "example")?;
    let path = listener.path().to_owned();

    let name: Name = "me".parse()?;
    let operator = thread::spawn(move || -> Result<_, sessions::operator::ClientError> {
        let mut client = Client::connect(&path, &name)?;
        println!("connected to the run {}", client.run());
        Ok([client.ask("tick")?, client.ask("dance")?])
    });

    // The run handles the received events between two ticks, without waiting.
    for tick in 1.. {
        while let Some(given) = listener.try_next() {
            println!("tick {tick}: {} from {}", given.event, given.source);
            let verdict = match &given.event {
                Event::Line(line) if line == "tick" => Ok(format!("{tick}")),
                _ => Err("expected tick".to_owned()),
            };
            given.answer(verdict);
        }
        if operator.is_finished() {
            break;
        }
        thread::sleep(Duration::from_millis(40));
    }
    for answer in operator.join().map_err(|_| "the operator's thread panicked")?? {
        println!("answer: {answer:?}");
    }
    drop(listener);
    Ok(fs::remove_dir_all(directory)?)
}

//! `rcs-log serve`: plays a log to Foxglove and Lichtblick, as `rcs-run --live` shows a run.

use std::{
    path::PathBuf,
    process::ExitCode,
    sync::mpsc::channel,
    thread,
    time::{Duration, Instant},
};

use os_io::stderr_line;
use record::Log;
use sessions::live::{Feed, Options, Origin, Port, Server, protocol::ServerInfo};

use crate::Error;

/// Interval of checking whether viewers have connected or disconnected.
const LOOK: Duration = Duration::from_millis(50);

/// Arguments of `serve`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The log
    pub file: PathBuf,
    /// The port on 127.0.0.1; 0 for any that is free
    #[arg(long, value_name = "PORT", default_value_t = 8765)]
    port: u16,
    /// Speed of playing; 1 is the speed of the run with --clock real
    #[arg(long, value_name = "N", default_value = "1", value_parser = rate)]
    rate: f64,
    /// Let web pages of this origin connect, such as http://localhost:8080; may be given several times
    #[arg(long, value_name = "ORIGIN")]
    live_origin: Vec<Origin>,
}

fn rate(text: &str) -> Result<f64, String> {
    let rate: Option<f64> = text.parse().ok();
    rate.filter(|rate| (0.01..=1000.0).contains(rate))
        .ok_or_else(|| format!("a number from 0.01 to 1000 was expected, found {text}"))
}

/// Plays a log once, from its start; begins when a viewer has subscribed to a channel.
pub fn serve(arguments: &Arguments) -> Result<ExitCode, Error> {
    let path = &arguments.file;
    // The log contains its schemas, so logs of other versions can be shown too.
    let log = Log::open(path).map_err(|source| Error::Read { path: path.clone(), source })?;
    if let Some(damage) = log.damage() {
        stderr_line!("rcs-log: {}: {damage}", path.display());
    }
    let unreachable = |source| Error::Port { port: arguments.port, source };
    let port = Port::take(arguments.port).map_err(unreachable)?;
    let name = arguments.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let info = ServerInfo { name, metadata: log.run.clone(), ..ServerInfo::new()? };
    let (sender, notices) = channel::<String>();
    thread::spawn(move || notices.iter().for_each(|why| stderr_line!("rcs-log: {why}")));
    let origins = arguments.live_origin.clone();
    let options = Options { origins, info, notices: Some(sender), ..Options::default() };
    let feed = Feed::default();
    let mut tap = feed.tap();
    log.send_channels(&mut *tap);
    let server = Server::start(port, options, feed.clone()).map_err(unreachable)?;
    stderr_line!(
        "rcs-log: viewers can connect at ws://{}; the log plays when a viewer has subscribed",
        server.address()
    );
    while !feed.is_watched() {
        thread::sleep(LOOK);
    }
    let mut pace = Pace { rate: arguments.rate, start: None };
    log.play(&mut *tap, |time| pace.wait(time));
    stderr_line!("rcs-log: the log has ended; rcs-log ends when the last viewer disconnects");
    while feed.viewers() > 0 {
        thread::sleep(LOOK);
    }
    Ok(ExitCode::SUCCESS)
}

struct Pace {
    rate: f64,
    start: Option<(u64, Instant)>, // time stamp of the first message, ns, and the instant of sending it
}

impl Pace {
    fn wait(&mut self, time: u64) {
        let (first, begin) = *self.start.get_or_insert_with(|| (time, Instant::now()));
        let seconds = Duration::from_nanos(time.saturating_sub(first)).as_secs_f64() / self.rate;
        // A damaged log can have any time stamp. If its time is out of range, the player waits as long as possible.
        let due = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        thread::sleep(due.saturating_sub(begin.elapsed()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rate_must_be_positive() {
        assert_eq!((rate("1"), rate("0.5"), rate("1000")), (Ok(1.0), Ok(0.5), Ok(1000.0)));
        for wrong in ["0", "-1", "1001", "NaN", "inf", "x", ""] {
            assert!(rate(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn message_times_follow_time_stamps_and_rate() {
        let mut pace = Pace { rate: 10.0, start: None };
        let begin = Instant::now();
        pace.wait(5_000_000_000);
        pace.wait(5_400_000_000);
        pace.wait(5_200_000_000);
        assert!(begin.elapsed() >= Duration::from_millis(40));
    }
}

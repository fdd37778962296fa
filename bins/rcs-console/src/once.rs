//! Prints one screen as text, for scripts, tests and bug reports.

use crate::rcs_console::{
    cli::Cli,
    error::ConsoleError,
    model::{Model, Place, Screen},
    source::{Live, Recorded, Source},
    view::{LEAST, Look, Scene, compose},
};

/// Print a screen of the run or log on the command line.
pub fn print(cli: &Cli, screen: Screen) -> Result<(), ConsoleError> {
    let (source, name): (Box<dyn Source>, String) = match (&cli.run, &cli.log) {
        (Some(run), _) => (Box::new(Live::open(run, None)?), run.to_string()),
        (None, Some(log)) => (Box::new(Recorded::open(log)?), String::new()),
        (None, None) => return Err(ConsoleError::NothingNamed),
    };
    let (first, last) = source.range().ok_or(ConsoleError::NoPicture(name))?;
    if let Some(tick) = cli.tick.filter(|tick| !(first..=last).contains(tick)) {
        return Err(ConsoleError::NoTick { tick, first, last });
    }
    let mut model = Model::new(screen);
    model.place = cli.tick.map_or(Place::Last, Place::At);
    model.take(source.as_ref());
    let text = screen_text(&model, source.as_ref(), cli.look());
    os_io::console::answer(&text).map_err(ConsoleError::Output)
}

/// The screen of a model as lines of text, without colour, in the smallest size of a terminal.
#[must_use]
pub fn screen_text(model: &Model, source: &dyn Source, look: Look) -> String {
    let (lines, _) = compose(&Scene::Source(model, source), look, LEAST.0.into(), LEAST.1.into());
    lines.iter().map(|line| format!("{}\n", line.to_string().trim_end())).collect()
}

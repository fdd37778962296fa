//! Runs the console in the terminal: reads keys, draws frames, and restores the terminal at the end.
//!
//! The terminal is restored after quitting, an error, a panic (by the hook of `ratatui`), and signals.

use std::{
    io, mem,
    path::{Path, PathBuf},
    process,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use closed_loop::failure::Failure;
use executive::{
    boards,
    memory::{self, RunName},
};
use ratatui::{
    DefaultTerminal,
    crossterm::{
        event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers},
        terminal,
    },
};
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM},
    iterator::Signals,
};

use crate::rcs_console::{
    cli::Cli,
    error::ConsoleError,
    hand::Hand,
    hang_up::{end_with_terminal, terminal_error},
    model::{Effect, Key, Model, Operating, Place, Screen, terminal::library::Library},
    redraw::{cleared, suspended, with_control},
    search::Search,
    source::{Live, Recorded, Source, State},
    story::process_named,
    view::{Look, Scene, Waiting, draw},
    watch,
};

const LOOK_AT: Duration = Duration::from_millis(40); // time between two reads of a run: a tick
const DRAW: Duration = Duration::from_millis(80); // time between two frames: every other tick (VI.6)
const END_LIMIT: Duration = Duration::from_secs(1); // time limit for an orderly end after a signal

/// Show the source on the command line until the user quits.
pub fn show(cli: &Cli) -> Result<(), ConsoleError> {
    let stop = Arc::new(AtomicBool::new(false));
    end_by_signal(Arc::clone(&stop)).map_err(ConsoleError::Signals)?;
    // Errors of the source are reported before the terminal changes.
    let scene = Console::open(cli)?;
    let screen = ratatui::try_init().map_err(terminal_error)?;
    end_with_terminal().map_err(terminal_error)?;
    let ended = Session {
        console: scene,
        look: cli.look(),
        stop,
        drawn: None,
        log: cli.log.clone(),
        operate: cli.operate,
        ends_run: cli.ends_run,
        data: cli.data.to_path_buf(),
        watch: watch::place(),
        watched: Vec::new(),
    }
    .prepared()
    .run(screen);
    ratatui::try_restore().map_err(terminal_error)?;
    ended
}

enum Console {
    /// A run or a log, and the session of an operator with the run.
    Source(Box<Model>, Box<dyn Source>, Option<Hand>),
    Waiting(Waiting, Search),
}

impl Console {
    fn open(cli: &Cli) -> Result<Self, ConsoleError> {
        let mut model = Model::new(Screen::Ladder);
        let mut hand = None;
        let source: Box<dyn Source> = match (&cli.run, &cli.log) {
            // The run waits for boards or neighbours. Its buffers can be shown from its first tick on.
            (Some(run), _) if memory::starting(run).is_some() || boards::coming_up(run).is_some() => {
                return Ok(Self::search(Some(run.clone())));
            }
            (Some(run), _) => {
                hand = cli.operate.then(|| Hand::reach(run)).transpose()?;
                Box::new(Live::open(run, Some(stuck))?)
            }
            (None, Some(_)) if cli.operate => return Err(ConsoleError::OperateLog),
            (None, Some(log)) => {
                let log = Recorded::open(log)?;
                model.place = cli.tick.map_or(Place::Last, Place::At);
                Box::new(log)
            }
            (None, None) => return Ok(Self::search(None)),
        };
        model.operating = hand.as_ref().map(|_| Operating::default());
        Ok(Self::Source(Box::new(model), source, hand))
    }

    fn search(wanted: Option<RunName>) -> Self {
        let (waiting, search) = Search::begin(wanted);
        Self::Waiting(waiting, search)
    }
}

/// Let a signal set `stop`. If the terminal blocks output (Ctrl-S, a hung line), the program ends after a time limit.
fn end_by_signal(stop: Arc<AtomicBool>) -> io::Result<()> {
    let mut signals = Signals::new([SIGTERM, SIGHUP, SIGINT, SIGQUIT])?;
    let wait = move || {
        if signals.forever().next().is_some() {
            stop.store(true, Ordering::Relaxed);
            thread::sleep(END_LIMIT);
            let _ = terminal::disable_raw_mode();
            process::exit(1);
        }
    };
    thread::Builder::new().name("signals".into()).spawn(wait).map(drop)
}

/// End this program: the run's shared memory is damaged, and opening it does not return.
fn stuck(limit: Duration) {
    ratatui::restore();
    os_io::stderr_line!(
        "rcs-console: the shared memory of the run could not be opened within {} s: another program has damaged it",
        limit.as_secs()
    );
    process::exit(2);
}

struct Session {
    console: Console,
    look: Look,
    stop: Arc<AtomicBool>,
    drawn: Option<Instant>, // time of the last frame
    log: Option<PathBuf>,   // path of the run's log, if it was named
    operate: bool,
    ends_run: bool,
    data: PathBuf, // directory of the task data for listing blocks, if neither run nor log names one
    watch: Option<PathBuf>, // file with the list of watched fields
    watched: Vec<String>,
}

impl Session {
    /// Set the saved watched fields and the blocks of the data.
    fn prepared(mut self) -> Self {
        self.watched = self.watch.as_deref().map(watch::load).unwrap_or_default();
        self.equip();
        self
    }

    /// Give a new model the list of watched fields, the blocks, and the effect of quitting.
    fn equip(&mut self) {
        if let Console::Source(model, source, _) = &mut self.console {
            model.watch.clone_from(&self.watched);
            model.ends_run = self.ends_run && source.about().state != State::Log;
            model.terminal.library = match source.blocks() {
                Some(blocks) => Library::with(blocks.to_vec()),
                None => Library::of(self.data.clone()),
            };
        }
    }

    /// Save the list of watched fields if it has changed.
    fn keep_watch(&mut self) {
        let Console::Source(model, ..) = &mut self.console else { return };
        let old = mem::replace(&mut self.watched, model.watch.clone());
        if old != self.watched
            && let Some(path) = &self.watch
            && let Err(error) = watch::save(path, &self.watched)
        {
            model.answer = Some(format!("the list cannot be saved: {}: {error}", path.display()));
        }
    }

    fn run(mut self, mut terminal: DefaultTerminal) -> Result<(), ConsoleError> {
        while !self.stop.load(Ordering::Relaxed) {
            self.refresh();
            if self.drawn.is_none_or(|drawn| drawn.elapsed() >= DRAW) {
                self.draw(&mut terminal).map_err(terminal_error)?;
            }
            match event::poll(LOOK_AT) {
                Ok(false) => {}
                Ok(true) => {
                    let event = event::read().map_err(terminal_error)?;
                    match with_control(&event) {
                        Some('l') => terminal = cleared().map_err(terminal_error)?,
                        Some('z') => terminal = suspended(terminal)?,
                        _ => {}
                    }
                    if self.take(&event) == Effect::Quit {
                        return Ok(());
                    }
                    self.drawn = None;
                }
                // A signal interrupted the call; the flag tells which one.
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(terminal_error(error)),
            }
        }
        Ok(())
    }

    fn refresh(&mut self) {
        match &mut self.console {
            Console::Source(model, source, hand) => {
                source.refresh();
                model.take(source.as_ref());
                if let (Some(hand), Some(operating)) = (hand, &mut model.operating) {
                    hand.work(operating, source.about().state == State::Over);
                    if let Some(directory) = operating.directory.take() {
                        model.terminal.library = Library::of(crate::shipped::resolve(directory.into()));
                    }
                }
            }
            Console::Waiting(waiting, search) => {
                if let Some(only) = search.go_on(waiting) {
                    self.attach(&only);
                }
            }
        }
    }

    fn attach(&mut self, run: &RunName) {
        let opened = Live::open(run, Some(stuck)).map_err(ConsoleError::from).and_then(|live| {
            let hand = self.operate.then(|| Hand::reach(run)).transpose()?;
            Ok((live, hand))
        });
        match (opened, &mut self.console) {
            (Ok((live, hand)), _) => {
                let mut model = Model::new(Screen::Ladder);
                model.operating = hand.as_ref().map(|_| Operating::default());
                self.console = Console::Source(Box::new(model), Box::new(live), hand);
                self.equip();
            }
            (Err(error), Console::Waiting(waiting, _)) => waiting.refused = Some(error.to_string()),
            (Err(_), Console::Source(..)) => {}
        }
    }

    fn draw(&mut self, terminal: &mut DefaultTerminal) -> io::Result<()> {
        let mut reach = None;
        terminal.draw(|frame| {
            let scene = match &self.console {
                Console::Source(model, source, _) => Scene::Source(model, source.as_ref()),
                Console::Waiting(waiting, _) => Scene::Waiting(waiting),
            };
            reach = Some(draw(frame, &scene, self.look));
        })?;
        if let (Some(reach), Console::Source(model, ..)) = (reach, &mut self.console) {
            model.limit_scroll(reach.up, reach.down);
        }
        self.drawn = Some(Instant::now());
        Ok(())
    }

    fn take(&mut self, event: &Event) -> Effect {
        let Event::Key(pressed) = event else { return Effect::Draw };
        let Some(key) = key(pressed) else { return Effect::Draw };
        let effect = match &mut self.console {
            Console::Source(model, source, _) => model.key(key, source.as_ref()),
            Console::Waiting(..) => return self.choose(key),
        };
        if effect == Effect::OpenLog {
            self.open_log();
            self.equip();
        }
        self.keep_watch();
        effect
    }

    fn choose(&mut self, key: Key) -> Effect {
        let Console::Waiting(waiting, _) = &mut self.console else { return Effect::Draw };
        match key {
            Key::Char('q') | Key::Interrupt => return Effect::Quit,
            Key::Char('j') | Key::Down => {
                waiting.cursor = (waiting.cursor + 1).min(waiting.runs.len().saturating_sub(1))
            }
            Key::Char('k') | Key::Up => waiting.cursor = waiting.cursor.saturating_sub(1),
            Key::Enter => {
                if let Some(run) = waiting.chosen().cloned() {
                    waiting.refused = None;
                    self.attach(&run);
                }
            }
            _ => {}
        }
        Effect::Draw
    }

    /// Open the log of the present run, at the first cause of its failure.
    fn open_log(&mut self) {
        let Console::Source(model, source, hand) = &mut self.console else { return };
        match log_of(source.as_ref(), self.log.as_deref()) {
            Ok(log) => {
                let first = log.story().account().map(|account| account.first);
                let tick = first.as_ref().map_or(model.tick(), Failure::shown_at);
                model.show(Place::At(tick), first.and_then(|first| process_named(&first.process)));
                *source = Box::new(log);
                *hand = None;
            }
            Err(why) => model.answer = Some(why),
        }
    }
}

/// The log of a run: the named log, or the log of its job in `runs/`. It must contain the last tick of the run, bit for
/// bit.
fn log_of(source: &dyn Source, named: Option<&Path>) -> Result<Recorded, String> {
    let about = source.about();
    if about.state == State::Log {
        return Err("this is a log already; c goes to the first cause".to_owned());
    }
    if about.state != State::Over {
        return Err("the log is complete when the run has ended; p freezes the picture meanwhile".to_owned());
    }
    let (job, _) = about.name.rsplit_once('-').unwrap_or((about.name, ""));
    let path = named.map_or_else(|| Path::new("runs").join(job).with_extension("mcap"), Path::to_owned);
    let log = Recorded::open(&path).map_err(|error| format!("{error}; name it with --log FILE"))?;
    let last = source.range().and_then(|(_, last)| source.picture(last));
    let same = last
        .is_some_and(|last| log.picture(last.tick.0).is_some_and(|picture| picture.memory == last.memory));
    if same {
        Ok(log)
    } else {
        Err(format!("{} is of another run; name the log with --log FILE", path.display()))
    }
}

/// The key of an event, if the console uses it.
fn key(pressed: &KeyEvent) -> Option<Key> {
    if pressed.kind == KeyEventKind::Release {
        return None;
    }
    Some(match pressed.code {
        KeyCode::Char('c') if pressed.modifiers.contains(KeyModifiers::CONTROL) => Key::Interrupt,
        KeyCode::Char(_) if pressed.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT) => {
            return None;
        }
        KeyCode::Char(typed) => Key::Char(typed),
        KeyCode::Enter => Key::Enter,
        KeyCode::Esc => Key::Esc,
        KeyCode::Tab => Key::Tab,
        KeyCode::BackTab => Key::BackTab,
        KeyCode::Up => Key::Up,
        KeyCode::Down => Key::Down,
        KeyCode::Left => Key::Left,
        KeyCode::Right => Key::Right,
        KeyCode::F(1) => Key::F1,
        KeyCode::F(2) => Key::F2,
        KeyCode::PageUp => Key::PageUp,
        KeyCode::PageDown => Key::PageDown,
        KeyCode::Home => Key::Home,
        KeyCode::End => Key::End,
        KeyCode::Backspace => Key::Backspace,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_with_control_are_not_letters() {
        let event = |code, modifiers| KeyEvent::new(code, modifiers);
        assert_eq!(key(&event(KeyCode::Char('q'), KeyModifiers::NONE)), Some(Key::Char('q')));
        assert_eq!(key(&event(KeyCode::Char('c'), KeyModifiers::CONTROL)), Some(Key::Interrupt));
        assert_eq!(key(&event(KeyCode::Char('q'), KeyModifiers::CONTROL)), None);
        assert_eq!(key(&event(KeyCode::Char('N'), KeyModifiers::SHIFT)), Some(Key::Char('N')));
        assert_eq!(key(&event(KeyCode::F(1), KeyModifiers::NONE)), Some(Key::F1));
        assert_eq!(key(&event(KeyCode::F(2), KeyModifiers::NONE)), Some(Key::F2));
        assert_eq!(key(&event(KeyCode::F(3), KeyModifiers::NONE)), None);
    }
}

//! Control-L and Control-Z: draw the terminal again, at once or when the shell continues this program.

use std::io;

use ratatui::{
    DefaultTerminal,
    backend::CrosstermBackend,
    crossterm::{
        event::{Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers},
        execute,
        terminal::{Clear, ClearType},
    },
};
use signal_hook::{consts::SIGTSTP, low_level::emulate_default_handler};

use crate::rcs_console::error::ConsoleError;

pub fn with_control(event: &Event) -> Option<char> {
    match event {
        Event::Key(KeyEvent { code: KeyCode::Char(letter), modifiers, kind, .. })
            if *modifiers == KeyModifiers::CONTROL && *kind != KeyEventKind::Release =>
        {
            Some(*letter)
        }
        _ => None,
    }
}

/// Clear the terminal. `Terminal::clear` would wait for the terminal's cursor report.
pub fn cleared() -> io::Result<DefaultTerminal> {
    execute!(io::stdout(), Clear(ClearType::All))?;
    DefaultTerminal::new(CrosstermBackend::new(io::stdout()))
}

/// Return the terminal to the shell until it continues this program. Meanwhile the run releases stick and buttons.
pub fn suspended(terminal: DefaultTerminal) -> Result<DefaultTerminal, ConsoleError> {
    drop(terminal);
    ratatui::try_restore().map_err(ConsoleError::Terminal)?;
    emulate_default_handler(SIGTSTP).map_err(ConsoleError::Signals)?;
    ratatui::try_init().map_err(ConsoleError::Terminal)
}

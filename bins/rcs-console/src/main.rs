//! `rcs-console`: shows what every control process of a run or a log does and why.

use std::process::ExitCode;

use programs::{
    pages,
    rcs_console::{cli::Cli, once, terminal},
    shipped,
};

const UNUSABLE: u8 = 2; // exit status of a usage or file error

fn main() -> ExitCode {
    shipped::carry();
    let cli: Cli = pages::parse();
    let ended = match cli.once {
        Some(screen) => once::print(&cli, screen),
        None => terminal::show(&cli),
    };
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            os_io::stderr_line!("rcs-console: {error}");
            ExitCode::from(UNUSABLE)
        }
    }
}

//! The program `rcs-run`.

use std::process::ExitCode;

use os_io::{console::stderr_drawn, stderr_line};
use programs::{
    pages,
    rcs_run::{cli::Cli, execute, memory_fault},
    shipped,
};

// Counts the allocations of the controller; the result of every run contains the count.
#[global_allocator]
static ALLOCATOR: executive::alloc::Counting = executive::alloc::Counting;

fn main() -> ExitCode {
    shipped::carry();
    let cli: Cli = pages::parse();
    let outcome =
        memory_fault::explain().and_then(|()| memory_fault::survive_file_limit()).and_then(|()| execute(cli));
    match outcome {
        Ok(code) => code,
        Err(error) => {
            let details = error.details();
            if !details.is_empty() {
                stderr_drawn(details.trim_end());
            }
            stderr_line!("rcs-run: {error}");
            ExitCode::from(error.status())
        }
    }
}

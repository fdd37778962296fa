//! A program that greets; `greet --generate DIR` writes its manual page, completions and reference page.
//! `cargo run --release -p cli-pages --example greet -- --help`.

use clap::Parser;

/// Greet a person by name
#[derive(Parser)]
#[command(name = "greet")]
struct Cli {
    /// Name of the person
    name: String,
}

fn main() {
    let Cli { name } = cli_pages::parse();
    os_io::stdout_line!("good morning, {name}");
}

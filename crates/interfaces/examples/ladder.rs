//! Prints the processes from the lowest up: board, buffer size, inputs: `cargo run --release -p interfaces --example
//! ladder`.

#![expect(clippy::print_stdout, reason = "an example prints its results")]

use interfaces::{CommonMemory, ExternalInputs, ProcessId};
use rcs_core::Plain;

fn main() {
    for process in ProcessId::upward() {
        let indent = 2 * process.depth();
        println!("{:indent$}{process} (board {}, common memory: {})", "", process.board(), process.field());
        for input in process.reads() {
            println!("{:indent$}    reads {input}", "");
        }
    }
    println!("common memory {} bytes, inputs from outside {}", CommonMemory::SIZE, ExternalInputs::SIZE);
}

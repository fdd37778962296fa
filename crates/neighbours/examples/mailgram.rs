//! A workstation's command in its mailbox: `cargo run --release -p neighbours --example mailgram`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use std::error::Error;

use interfaces::HwsCommand;
use neighbours::workstation::command::{decode, encode};
use rcs_core::name::Name16;

fn main() -> Result<(), Box<dyn Error>> {
    let command = HwsCommand {
        number: 5,
        command: Name16::clipped("MOVE"),
        destination: Some(Name16::clipped("HOME")),
        ..HwsCommand::default()
    };
    let bytes = encode(&command)?;
    for (line, row) in bytes.chunks(16).enumerate() {
        let hex: Vec<String> = row.iter().map(|byte| format!("{byte:02x}")).collect();
        let text: String =
            row.iter().map(|byte| if byte.is_ascii_graphic() { char::from(*byte) } else { '.' }).collect();
        println!("{:>3}  {:<47}  {text}", 16 * line, hex.join(" "));
    }
    println!("{}", decode(&bytes)?);
    // Refused with an error message.
    if let Err(error) = decode(&[0xff; 3]) {
        println!("3 bytes of 255: {error}");
    }
    Ok(())
}

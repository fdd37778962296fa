//! The frames of a tick on the DEPC line, as text (A 2.3).

use depc::{
    Plate,
    wire::{Control, DataCommand, FILL, FRAME_BYTES, Report, Response, START},
};

#[must_use]
pub fn sent(bytes: &[u8]) -> Vec<String> {
    split(bytes, |bytes| match bytes.first()? {
        &START => {
            let frame = bytes.get(..FRAME_BYTES)?;
            let text = match DataCommand::parse(frame) {
                Ok(command) => format!("go to {}", position(&command.plate)),
                Err(error) => format!("a data command that is damaged: {error}"),
            };
            Some((text, FRAME_BYTES))
        }
        byte => match Control::from_byte(*byte)? {
            Control::Restart => Some(("re-start: report the position again".to_owned(), 1)),
            Control::Cancel => Some(("cancel: end the DEPC function".to_owned(), 1)),
        },
    })
}

/// The frames that the robot controller sent in a tick.
#[must_use]
pub fn received(bytes: &[u8]) -> Vec<String> {
    split(bytes, |bytes| match bytes.first()? {
        &FILL => {
            let frame = bytes.get(..FRAME_BYTES)?;
            let text = match Report::parse(frame) {
                Ok(report) => format!("report: the robot is at {}", position(&report.plate)),
                Err(error) => format!("a report that is damaged: {error}"),
            };
            Some((text, FRAME_BYTES))
        }
        byte => match Response::from_byte(*byte)? {
            Response::Ack => Some(("ACK: understood".to_owned(), 1)),
            Response::Nak => Some(("NAK: not understood, send it again".to_owned(), 1)),
        },
    })
}

/// Splits bytes into frames. A byte at which no frame begins is shown unchanged.
fn split(mut bytes: &[u8], frame: impl Fn(&[u8]) -> Option<(String, usize)>) -> Vec<String> {
    let mut found = Vec::new();
    while let Some((text, length)) = frame(bytes) {
        found.push(text);
        bytes = bytes.get(length..).unwrap_or_default();
    }
    if !bytes.is_empty() {
        let hex: Vec<String> = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
        found.push(format!("no whole frame: {}", hex.join(" ")));
    }
    found
}

fn position(plate: &Plate) -> String {
    let [x, y, z, d, e, r] = plate.words.map(|word| f64::from(word) / 100.0);
    format!("X {x:.2} Y {y:.2} Z {z:.2} in, D {d:.2} E {e:.2} R {r:.2} deg")
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: [u8; 16] = [3, 0, 0, 0, 0, 0xE7, 0x68, 0xFD, 0x85, 0xDC, 0xD8, 0x34, 0xB7, 0, 0, 0x73];

    #[test]
    fn frames_are_described_as_text() {
        assert_eq!(sent(&HOME), ["go to X 0.00 Y -62.96 Z -6.35 in, D -90.00 E 134.95 R 0.00 deg"]);
        assert_eq!(sent(&[5]), ["re-start: report the position again"]);
        assert_eq!(received(&[6, 0x15]), ["ACK: understood", "NAK: not understood, send it again"]);
        let mut report = HOME;
        report[..3].copy_from_slice(&[0xFF, 0xFF, 3]);
        assert!(received(&report)[0].starts_with("report: the robot is at X 0.00"));
        assert!(sent(&[]).is_empty() && received(&[]).is_empty());
    }

    #[test]
    fn damaged_and_partial_frames_are_listed() {
        let mut damaged = HOME;
        damaged[5] ^= 1;
        assert!(sent(&damaged)[0].starts_with("a data command that is damaged: "));
        assert_eq!(sent(&HOME[..3]), ["no whole frame: 03 00 00"]);
        assert_eq!(received(&[6, 0x41]), ["ACK: understood", "no whole frame: 41"]);
    }
}

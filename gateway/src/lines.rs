//! Moves an operator's lines (docs/operator.md "The protocol") between a Unix socket and the network. A payload has
//! whole lines; an empty one is the end. Nothing is sent on an operator's behalf: the run ends motion by hand 250 ms
//! after the last line of the operator, not of a gateway.

use std::{
    os::fd::AsFd as _,
    time::{Duration, Instant},
};

use sockets::Line;

use crate::{
    address::Name,
    end::{CLOSING, End, GRACE},
    inbox::Inbox,
};

/// Greatest length of a line, bytes; the run refuses a line that is longer than 260.
const LONGEST: usize = 1024;
const NAME: usize = 24; // greatest length of an operator's name, bytes
const HELLO: &str = "hello ";
/// An operator that sends nothing for this time loses its claim, so that another operator can command.
const SILENCE: Duration = Duration::from_secs(10);

/// Moves lines until the claim ends. `unread` are bytes that were already received from the socket. At the gateway,
/// `name` precedes the operator's name, and an operator that is silent for 10 s loses its claim.
pub fn relay(
    mut line: Line,
    mut unread: Vec<u8>,
    mut name: Option<&Name>,
    inbox: &Inbox,
    publish: &mut dyn FnMut(&[u8]),
) -> End {
    let (mut outgoing, mut gone) = (Vec::new(), None);
    let mut heard = name.map(|_| Instant::now());
    let end = loop {
        match turn(&mut line, &mut unread, &mut outgoing, &mut name, inbox, publish, (&mut gone, &mut heard))
        {
            Ok(()) => {}
            Err(end) => break end,
        }
    };
    if !matches!(end, End::Network(_) | End::Gone) {
        publish(&[]);
    }
    let until = Instant::now() + CLOSING;
    line.finish(&mut outgoing, until);
    line.drain(until);
    end
}

fn turn(
    line: &mut Line,
    unread: &mut Vec<u8>,
    outgoing: &mut Vec<u8>,
    name: &mut Option<&Name>,
    inbox: &Inbox,
    publish: &mut dyn FnMut(&[u8]),
    (gone, heard): (&mut Option<Instant>, &mut Option<Instant>),
) -> Result<(), End> {
    if inbox.is_stopped() {
        return Err(End::Stopped);
    }
    if inbox.has_overflown() {
        return Err(End::Violation("lines were lost: more waited than the run takes".to_owned()));
    }
    if let Some(payload) = line.is_flushed().then(|| inbox.take()).flatten() {
        if payload.is_empty() {
            return Err(End::Network(String::new()));
        }
        if let Some(heard) = heard {
            *heard = Instant::now();
        }
        match name.take() {
            Some(name) => outgoing.extend(signed(&payload, name)),
            None => outgoing.extend(payload),
        }
    } else if inbox.is_gone() && gone.get_or_insert_with(Instant::now).elapsed() >= GRACE {
        return Err(End::Gone);
    } else if heard.is_some_and(|heard| heard.elapsed() >= SILENCE) {
        return Err(End::Silent);
    }
    let lost = |error: std::io::Error| End::Local(error.to_string());
    line.send(outgoing).map_err(lost)?;
    if let Some(last) = unread.iter().rposition(|&byte| byte == b'\n') {
        let lines: Vec<u8> = unread.drain(..=last).collect();
        publish(&lines);
    }
    if unread.len() > LONGEST {
        return Err(End::Violation(format!("expected a line of at most {LONGEST} bytes")));
    }
    let wake = line.is_flushed().then(|| inbox.as_fd());
    let until = [gone.map(|since| since + GRACE), heard.map(|heard| heard + SILENCE)];
    let ready = line.wait(wake, until.into_iter().flatten().min()).map_err(lost)?;
    if ready && !line.receive(|bytes| unread.extend_from_slice(bytes)).map_err(lost)? {
        publish(unread);
        return Err(End::Local(String::new()));
    }
    Ok(())
}

/// The first payload of an operator, `hello anna`, with the name of its certificate: `hello op-1.anna`.
fn signed(payload: &[u8], name: &Name) -> Vec<u8> {
    let Some(rest) = payload.strip_prefix(HELLO.as_bytes()) else { return payload.to_vec() };
    let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
    let (own, rest) = rest.split_at(end);
    let whole = format!("{name}.{}", String::from_utf8_lossy(own));
    let whole: String = whole.chars().take(NAME).collect();
    [HELLO.as_bytes(), whole.as_bytes(), rest].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn name_of_the_certificate_precedes_the_operators() {
        let name: Name = "op-1".parse().unwrap();
        assert_eq!(signed(b"hello anna\n\n", &name), b"hello op-1.anna\n\n");
        assert_eq!(signed(b"1 stop\n", &name), b"1 stop\n");
        assert_eq!(
            signed(b"hello an-operator-with-a-long-name\n", &name),
            b"hello op-1.an-operator-with-a-\n"
        );
    }
}

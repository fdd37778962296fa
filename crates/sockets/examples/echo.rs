//! Echoes a line of text over a Unix socket: `cargo run --release -p sockets --example echo -- TEXT`.

use std::{
    env, io,
    io::Write as _,
    os::unix::net::UnixStream,
    sync::mpsc::channel,
    time::{Duration, Instant},
};

use sockets::{Acceptor, Line};

fn main() -> io::Result<()> {
    let text = env::args().nth(1).unwrap_or_else(|| "hello".to_owned());
    let path = env::temp_dir().join(format!("sockets-echo-{}", std::process::id()));
    let (accepted, connections) = channel();
    let _acceptor = Acceptor::start(&path, "echo", move |stream| {
        // This may fail, because the example ends before its receiver.
        let _ = accepted.send(stream);
    })?;
    let mut near = Line::new(UnixStream::connect(&path)?)?;
    let stream = connections.recv_timeout(Duration::from_secs(1)).map_err(io::Error::other)?;
    let mut far = Line::new(stream)?;
    far.check_user()?;
    let until = Instant::now() + Duration::from_secs(1);
    near.send(&mut text.into_bytes())?;
    far.wait(None, Some(until))?;
    let mut echo = Vec::new();
    far.receive(|bytes| echo.extend_from_slice(bytes))?;
    far.finish(&mut echo, until);
    near.wait(None, Some(until))?;
    let mut answer = Vec::new();
    near.receive(|bytes| answer.extend_from_slice(bytes))?;
    answer.push(b'\n');
    io::stdout().write_all(&answer)
}

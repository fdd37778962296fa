//! Serial lines over pseudo-terminals: a tick, and a port that disappears and returns.

use std::{
    fs::{self, File},
    io::{Read as _, Write as _},
    os::unix::fs::symlink,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use executive::{
    alloc::{Counting, Section, allocations, is_installed},
    serial::{OpenError, RETRY, SerialCounts, SerialLine, SerialSettings},
};
use interfaces::device::LinkBytes;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action, for a busy machine

struct Peer {
    master: File,
    path: PathBuf,
}

impl Peer {
    fn new() -> Self {
        let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
        let master = openpt(flags).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        let path = PathBuf::from(ptsname(&master, Vec::new()).unwrap().into_string().unwrap());
        Self { master: File::from(master), path }
    }

    fn line(&self) -> SerialLine {
        SerialLine::open(SerialSettings::new(&self.path)).unwrap()
    }

    fn read(&mut self, count: usize) -> Vec<u8> {
        let mut bytes = vec![0; count];
        self.master.read_exact(&mut bytes).unwrap();
        bytes
    }
}

fn bytes(of: &[u8]) -> LinkBytes {
    let mut bytes = LinkBytes::default();
    assert_eq!(bytes.extend(of), of.len());
    bytes
}

/// Receives until `count` bytes are there.
fn received(line: &mut SerialLine, count: usize) -> LinkBytes {
    let (started, mut rx) = (Instant::now(), LinkBytes::default());
    while usize::from(rx.length) < count {
        assert!(started.elapsed() < TIME_LIMIT, "{} of {count} bytes were received", rx.length);
        line.wait(Duration::from_millis(10));
        line.receive(&mut rx);
    }
    rx
}

#[test]
fn all_byte_values_pass_unchanged_both_ways() {
    let mut peer = Peer::new();
    let mut line = peer.line();
    let all: Vec<u8> = (0..=255).collect();
    for chunk in all.chunks(64) {
        assert!(line.send(&bytes(chunk)));
        assert_eq!(peer.read(64), chunk);
        peer.master.write_all(chunk).unwrap();
        assert_eq!(received(&mut line, 64).as_slice(), chunk);
    }
    let expected = SerialCounts { received: 256, sent: 256, ..SerialCounts::default() };
    assert_eq!(line.counts(), expected);
}

#[test]
fn a_tick_reads_a_buffer_and_leaves_the_rest_in_the_port() {
    let mut peer = Peer::new();
    let mut line = peer.line();
    peer.master.write_all(&[7; 100]).unwrap();
    assert_eq!(received(&mut line, 64).length, 64);
    assert_eq!(received(&mut line, 36).length, 36);
}

#[test]
fn tick_with_a_lost_port_does_not_allocate() {
    assert!(is_installed());
    let mut peer = Peer::new();
    let mut line = peer.line();
    // The sum is over all threads; no other test of this program enters a counted section.
    let within = |line: &mut SerialLine| {
        let before = allocations();
        let section = Section::enter();
        let mut rx = LinkBytes::default();
        let ready = line.receive(&mut rx);
        line.send(&bytes(&[3; 16]));
        drop(section);
        (ready, allocations() - before)
    };
    for _ in 0..100 {
        peer.master.write_all(&[6]).unwrap();
        assert_eq!(within(&mut line), (true, 0));
        peer.read(16);
        assert_eq!(within(&mut line), (true, 0), "with nothing to read");
        peer.read(16);
    }
    drop(peer);
    assert_eq!(within(&mut line), (false, 0), "when it goes");
    assert_eq!(within(&mut line), (false, 0), "while it is gone");
    assert_eq!(line.counts().losses, 1);
}

#[test]
fn a_blocked_line_is_reported_and_rests_for_a_tick() {
    let peer = Peer::new();
    let mut line = peer.line();
    // A pseudo-terminal takes some ten thousand unread bytes. A line that waits until they are read would hang.
    let sent = (0..2000).take_while(|_| line.send(&bytes(&[3; 64]))).count();
    assert!(sent > 0 && sent < 2000, "{sent} frames were taken");
    assert!(line.counts().unsent > 0 && line.has_unsent());
    let mut rx = LinkBytes::default();
    assert!(!line.receive(&mut rx) && line.is_there(), "the link must begin again");
    assert!(line.receive(&mut rx));
    assert!(line.has_unsent(), "receiving sends nothing");
    assert!(line.send(&bytes(&[5])), "what waited was thrown away");
    assert!(!line.has_unsent());
}

#[test]
fn a_port_that_reappears_is_reopened_and_starts_clean() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("port");
    let plug = |peer: &Peer| {
        let _ = fs::remove_file(&path);
        symlink(&peer.path, &path).unwrap();
    };
    let first = Peer::new();
    plug(&first);
    let mut line = SerialLine::open(SerialSettings::new(&path)).unwrap();
    assert!(line.receive(&mut LinkBytes::default()));
    drop(first);
    let lost = Instant::now();
    let mut rx = bytes(&[1, 2, 3]);
    assert!(!line.receive(&mut rx));
    assert_eq!((rx, line.is_there()), (LinkBytes::default(), false));
    let second = Peer::new();
    plug(&second);
    (&second.master).write_all(b"sent before the port was open").unwrap();
    while !line.receive(&mut rx) {
        assert!(lost.elapsed() < TIME_LIMIT, "it was not opened again");
        thread::sleep(Duration::from_millis(20));
    }
    assert!(lost.elapsed() >= RETRY, "attempts are a second apart");
    assert_eq!(rx.length, 0);
    (&second.master).write_all(&[6]).unwrap();
    assert_eq!(received(&mut line, 1).as_slice(), &[6]);
    assert_eq!((line.counts().losses, line.counts().reopened), (1, 1));
}

#[test]
fn unopenable_files_are_reported() {
    let open = |path: &Path| SerialLine::open(SerialSettings::new(path)).err();
    assert_eq!(open(Path::new("/dev/none")), Some(OpenError::Missing("/dev/none".into())));
    let null = open(Path::new("/dev/null"));
    assert!(matches!(&null, Some(OpenError::Unusable { reason, .. }) if reason.contains("not a terminal")));
    let peer = Peer::new();
    let line = peer.line();
    assert_eq!(open(&peer.path), Some(OpenError::Busy(peer.path.clone())));
    drop(line);
    let again = peer.line();
    assert!(!again.has_modem_lines() && again.is_there());
}

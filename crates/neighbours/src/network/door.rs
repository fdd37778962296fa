//! The places of connections that have not said yet who they are.
//!
//! There are few of them, so that strangers cost the run little. Who has been there for a while without a hello makes room for somebody
//! who comes: strangers that say nothing, or a byte now and then, keep nobody out. Who was refused keeps his place for the same while, so
//! that nobody can guess as fast as he likes, or fill the log.

use std::{
    io,
    sync::Mutex,
    time::{Duration, Instant},
};

use super::{office::locked, stream::Stream};

/// Connections that have not said who they are, at most.
pub(super) const PLACES: usize = 8;
/// For so long a place is safe: enough for a hello, and the penalty for a wrong one.
pub(super) const SAFE: Duration = Duration::from_secs(1);

/// The places.
#[derive(Default)]
pub(super) struct Door {
    inner: Mutex<Inner>,
}

#[derive(Default)]
struct Inner {
    last: u64,
    places: [Option<Waiting>; PLACES],
}

/// Who has a place.
struct Waiting {
    ticket: u64,
    since: Instant,
    stream: Stream,
}

/// One's own place; free again when this is dropped, if it is still one's own.
pub(super) struct Place<'a> {
    door: &'a Door,
    ticket: u64,
}

impl Door {
    /// Give a connection a place, if need be that of the one who has waited longest; its ticket. `None` if there is none.
    ///
    /// # Errors
    /// If the system has no descriptor left.
    pub fn enter(&self, stream: &Stream) -> io::Result<Option<u64>> {
        let stream = stream.try_clone()?;
        let mut inner = locked(&self.inner);
        let now = Instant::now();
        let waited = |place: &Option<Waiting>| place.as_ref().map_or(Duration::MAX, |who| now - who.since);
        let Some(longest) = inner.places.iter().map(waited).max().filter(|longest| *longest >= SAFE) else {
            return Ok(None);
        };
        inner.last += 1;
        let ticket = inner.last;
        let place = inner.places.iter_mut().find(|place| waited(place) == longest);
        if let Some(before) = place.and_then(|place| place.replace(Waiting { ticket, since: now, stream })) {
            before.stream.shut_down();
        }
        Ok(Some(ticket))
    }

    /// The place of a ticket.
    pub const fn place(&self, ticket: u64) -> Place<'_> {
        Place { door: self, ticket }
    }
}

impl Drop for Place<'_> {
    fn drop(&mut self) {
        let mut inner = locked(&self.door.inner);
        for place in &mut inner.places {
            place.take_if(|who| who.ticket == self.ticket);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{io::Read as _, os::unix::net::UnixStream};

    use super::*;

    fn connection() -> (Stream, UnixStream) {
        let (ours, theirs) = UnixStream::pair().unwrap();
        (Stream::Unix(ours), theirs)
    }

    /// Let everybody be there for so much longer.
    fn wait(door: &Door, time: Duration) {
        locked(&door.inner).places.iter_mut().flatten().for_each(|who| who.since -= time);
    }

    #[test]
    fn who_has_waited_longest_makes_room() {
        let door = Door::default();
        let mut silent: Vec<_> = (0..PLACES)
            .map(|_| {
                wait(&door, Duration::from_millis(1));
                let (ours, theirs) = connection();
                assert!(door.enter(&ours).unwrap().is_some());
                (ours, theirs)
            })
            .collect();
        assert_eq!(door.enter(&connection().0).unwrap(), None, "nobody has had his time");
        wait(&door, SAFE);
        assert!(door.enter(&connection().0).unwrap().is_some());
        assert_eq!(silent[0].1.read(&mut [0]).unwrap(), 0, "the first was put out");
        silent[1].1.set_nonblocking(true).unwrap();
        assert_eq!(silent[1].1.read(&mut [0]).unwrap_err().kind(), io::ErrorKind::WouldBlock);
    }

    #[test]
    fn a_place_is_freed_by_who_has_it() {
        let door = Door::default();
        let tickets: Vec<_> = (0..PLACES).filter_map(|_| door.enter(&connection().0).unwrap()).collect();
        drop(door.place(tickets[3]));
        assert!(door.enter(&connection().0).unwrap().is_some());
        drop(door.place(tickets[3]));
        assert_eq!(door.enter(&connection().0).unwrap(), None, "it is another's now");
    }
}

//! `rcs-gateway page`: the page of a run, for browsers on the network of the cell.
//!
//! ```text
//!   browser == TLS 1.3, cookie of a login == rcs-gateway page -- Unix, person and role -- rcs-run
//! ```
//!
//! The gateway authenticates the person, sends name and role to the run, and passes bytes on unchanged. The run gives a
//! viewer no rights, and treats an operator like any other operator.

pub mod forms;
pub mod http;
pub mod limits;
pub mod logins;
pub mod people;
pub mod pump;
pub mod tls;

use std::{
    fs, io,
    io::Write as _,
    net::{IpAddr, SocketAddr, TcpListener, TcpStream},
    os::unix::{fs::MetadataExt as _, net::UnixStream},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant, SystemTime},
};

use rustls::ServerConfig;
use sockets::check_user;

use crate::{
    address::Name,
    cli::PageArguments,
    end::GRACE,
    error::Error,
    keys::Keys,
    page::{
        http::{BAD, Refusal, Request},
        limits::{PeerCounts, Source, Stranger, Tries},
        logins::{Connection, Logins, VALIDITY},
        people::People,
        pump::{Ended, Upward, pump},
        tls::Tls,
    },
    sample::plain,
    say, say_refused, signals,
};

/// Time limit for the handshake and the request of a connection.
const REQUEST: Duration = Duration::from_secs(5);
const ANSWER: Duration = Duration::from_secs(5); // time limit for reading an answer
const LOOK: Duration = Duration::from_millis(500); // time between two looks at the file of persons
const PAUSE: Duration = Duration::from_millis(100); // pause after a connection that could not be accepted

struct Gateway {
    cell: Name,
    run: PathBuf,
    tls: Arc<ServerConfig>,
    people: Mutex<People>,
    logins: Logins,
    strangers: PeerCounts,
    tries: Tries,
    checking: Mutex<()>, // one secret is checked at a time: a check takes 19 MB and tens of milliseconds
}

enum Answer {
    Own(Vec<u8>),
    Page(Connection, UnixStream),
    Live(Connection, UnixStream, Vec<u8>), // a WebSocket of the run, and the bytes after its request
}

/// Serves the page until a signal arrives. Fails if the keys, the persons or the endpoint cannot be used.
pub fn page(arguments: &PageArguments) -> Result<(), Error> {
    let PageArguments { cell, endpoint, run, keys, people: path } = arguments;
    let tls = tls::config(&Keys::load(keys, cell)?)?;
    let people = People::load(path)?;
    let signals = signals::receive()?;
    let failed = |source| Error::Endpoint { endpoint: *endpoint, source };
    let listener = TcpListener::bind(endpoint.0).map_err(failed)?;
    let address = listener.local_addr().map_err(failed)?;
    let gateway = Arc::new(Gateway {
        cell: cell.clone(),
        run: run.path().to_owned(),
        tls,
        people: Mutex::new(people),
        logins: Logins::default(),
        strangers: PeerCounts::default(),
        tries: Tries::default(),
        checking: Mutex::new(()),
    });
    let (accepting, watching, path) = (Arc::clone(&gateway), Arc::clone(&gateway), path.clone());
    thread::spawn(move || accepting.accept(&listener));
    thread::spawn(move || watching.watch(&path));
    say!("page of {cell} at https://{address}/, for the run at {run}");
    signals::wait(signals);
    gateway.logins.retain(Instant::now(), |_| false);
    thread::sleep(2 * GRACE);
    Ok(())
}

impl Gateway {
    fn accept(self: Arc<Self>, listener: &TcpListener) {
        loop {
            let Ok((socket, peer)) = listener.accept() else {
                // No descriptor is left, or the client has gone already.
                thread::sleep(PAUSE);
                continue;
            };
            let Some(stranger) = self.strangers.admit(peer.ip().into()) else {
                say_refused!("{}: too many connections without a login", peer.ip());
                continue;
            };
            let gateway = Arc::clone(&self);
            // If the thread cannot start, the connection is closed.
            let _ = thread::Builder::new().spawn(move || {
                let served = gateway.serve(socket, peer, stranger);
                // Browsers open unused connections. A TLS alert has the reason why a browser refuses the certificate.
                if let Err(error) = served
                    && error.kind() == io::ErrorKind::InvalidData
                {
                    say_refused!("{}: {error}", peer.ip());
                }
            });
        }
    }

    /// Ends the logins of persons that the file no longer has, and those that have expired.
    fn watch(&self, path: &Path) {
        let mut known = None;
        loop {
            let found = state(path);
            if known.as_ref() != Some(&found) {
                *self.people() = People::load(path).unwrap_or_else(|error| {
                    say!("{error}; until then nobody is admitted");
                    People::default()
                });
                known = Some(found);
            }
            let people = self.people().clone();
            self.logins.retain(Instant::now(), |login| people.has(&login.person));
            thread::sleep(LOOK);
        }
    }

    fn people(&self) -> MutexGuard<'_, People> {
        self.people.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn serve(&self, socket: TcpStream, peer: SocketAddr, stranger: Stranger) -> io::Result<()> {
        let own = socket.local_addr()?;
        let mut tls = Tls::new(socket, Arc::clone(&self.tls))?;
        let request = http::read(&mut tls, Instant::now() + REQUEST)?;
        let answer = request.and_then(|request| self.answer(request, own, peer.ip()));
        match answer {
            Ok(Answer::Own(bytes)) => tls.finish(&bytes, Instant::now() + ANSWER),
            Err((status, why)) => {
                let body = forms::notice(status, &why, false);
                tls.finish(&http::answer(status, "", &body), Instant::now() + ANSWER)
            }
            Ok(Answer::Page(connection, run)) => {
                drop(stranger);
                match pump(tls, &run, Upward::Nothing, &connection.0) {
                    Ended::Failed(error) => Err(error),
                    _ => Ok(()),
                }
            }
            Ok(Answer::Live(connection, run, first)) => {
                drop(stranger);
                let login = &connection.0;
                let (name, role) = (&login.person.name, login.person.role);
                say!("{role} {name} has connected from {}", peer.ip());
                let ended = pump(tls, &run, Upward::All(first), login);
                say!("{role} {name} has disconnected: {ended}");
                Ok(())
            }
        }
    }

    fn answer(&self, mut request: Request, own: SocketAddr, peer: IpAddr) -> Result<Answer, Refusal> {
        let host = host(own);
        if !request.host.eq_ignore_ascii_case(&host) {
            return Err(("421 Misdirected Request", format!("this page has the address https://{host}/")));
        }
        let origin = format!("https://{host}");
        let is_own = request.origin.as_ref().is_some_and(|found| found.eq_ignore_ascii_case(&origin));
        let is_bound = request.is_post || request.upgrade.is_some();
        if !is_own && (is_bound || request.origin.is_some()) {
            let found = request.origin.as_deref().unwrap_or("no page");
            let why =
                format!("requests of the page {origin} are accepted, found {}", plain(found.as_bytes()));
            return Err(("403 Forbidden", why));
        }
        let now = Instant::now();
        let login = request.cookie.as_deref().and_then(|id| self.logins.find(id, now));
        match (request.is_post, request.path.as_str(), request.upgrade.take()) {
            (false, "/", Some(upgrade)) => {
                let login = login.ok_or(("401 Unauthorized", "log in first, at /login".to_owned()))?;
                let connection = Connection::open(login).ok_or_else(too_many)?;
                let person = &connection.0.person;
                let more = format!("{upgrade}Rcs-Person: {}\r\nRcs-Role: {}\r\n", person.name, person.role);
                let run = self.enter(&more).map_err(|why| (UNAVAILABLE, why))?;
                Ok(Answer::Live(connection, run, request.rest))
            }
            (false, "/", None) => match login {
                None => Ok(Answer::Own(http::see("/login", None))),
                Some(login) => {
                    let connection = Connection::open(login).ok_or_else(too_many)?;
                    Ok(match self.enter("") {
                        Ok(run) => Answer::Page(connection, run),
                        Err(why) => {
                            let body = forms::notice(&format!("Cell {}", self.cell), &why, true);
                            Answer::Own(http::answer(UNAVAILABLE, "", &body))
                        }
                    })
                }
            },
            (false, "/login", None) => {
                let body = match login {
                    Some(login) => forms::logged_in(&self.cell, &login.person),
                    None => forms::login(&self.cell, None),
                };
                Ok(Answer::Own(http::answer("200 OK", "", &body)))
            }
            (true, "/login", None) => Ok(Answer::Own(self.log_in(&request.form, peer))),
            (true, "/logout", None) => {
                self.logins.retain(now, |other| login.as_ref().is_none_or(|login| login.id != other.id));
                Ok(Answer::Own(http::see("/login", Some(("", 0)))))
            }
            (true, _, _) => Err(("405 Method Not Allowed", "/login and /logout have forms".to_owned())),
            (false, _, _) => Err(("404 Not Found", "the page is at /, the login at /login".to_owned())),
        }
    }

    fn log_in(&self, form: &[u8], peer: IpAddr) -> Vec<u8> {
        let refuse = |status: &str, why: &str| http::answer(status, "", &forms::login(&self.cell, Some(why)));
        let (Some(name), Some(secret)) = (http::field(form, "name"), http::field(form, "secret")) else {
            return refuse(BAD, "Enter a name and a secret.");
        };
        let source = Source::from(peer);
        if !self.tries.may_try(source, Instant::now()) {
            say_refused!("{peer}: too many failed logins");
            return refuse(
                "429 Too Many Requests",
                "Too many logins have failed. Wait a minute and try again.",
            );
        }
        let people = self.people().clone();
        let person = {
            let _alone = self.checking.lock().unwrap_or_else(PoisonError::into_inner);
            people.verify(&name, &secret).cloned()
        };
        let Some(person) = person else {
            let name: String = plain(name.as_bytes()).chars().take(16).collect();
            say_refused!("{peer}: login of {name:?} failed: wrong name or secret");
            return refuse("401 Unauthorized", "Wrong name or secret.");
        };
        self.tries.succeeded(source);
        match self.logins.open(person, Instant::now()) {
            Ok(login) => {
                say!("{} {} has logged in from {peer}", login.person.role, login.person.name);
                http::see("/", Some((&login.id, VALIDITY.as_secs())))
            }
            Err(error) => refuse(UNAVAILABLE, &format!("The system has no random numbers: {error}.")),
        }
    }

    /// Connects to the run, and asks for its page or, with the headers of a WebSocket, for the WebSocket.
    fn enter(&self, more: &str) -> Result<UnixStream, String> {
        let path = self.run.display();
        let absent = |error: io::Error| {
            format!("No run listens at {path}: {error}. Start one with --live --live-socket unix:{path}.")
        };
        let mut run = UnixStream::connect(&self.run).map_err(absent)?;
        check_user(&run).map_err(absent)?;
        run.write_all(format!("GET / HTTP/1.1\r\nHost: localhost\r\n{more}\r\n").as_bytes())
            .map_err(absent)?;
        Ok(run)
    }
}

const UNAVAILABLE: &str = "503 Service Unavailable";

fn too_many() -> Refusal {
    ("429 Too Many Requests", "this login has too many connections: close another tab".to_owned())
}

/// The header `Host` of a browser that has connected to an address: the port is omitted if it is that of HTTPS.
fn host(own: SocketAddr) -> String {
    let own = SocketAddr::new(own.ip().to_canonical(), own.port());
    let text = own.to_string();
    text.strip_suffix(":443").map_or(text.clone(), str::to_owned)
}

/// Values that change when a file is replaced or written; `None` without a file.
fn state(path: &Path) -> Option<(u64, u64, Option<SystemTime>, u32)> {
    let found = fs::metadata(path).ok()?;
    Some((found.ino(), found.len(), found.modified().ok(), found.mode()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn host_is_the_address_at_which_the_browser_has_connected() {
        let host = |text: &str| host(text.parse().unwrap());
        assert_eq!(host("10.0.0.1:8443"), "10.0.0.1:8443");
        assert_eq!(host("10.0.0.1:443"), "10.0.0.1");
        assert_eq!(host("[::ffff:10.0.0.1]:8443"), "10.0.0.1:8443");
        assert_eq!(host("[fd00::1]:443"), "[fd00::1]");
    }
}

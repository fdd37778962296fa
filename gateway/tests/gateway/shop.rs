//! A cell with its gateway, as processes: run, `serve`, `connect` and neighbours. Every process ends with its owner.

use std::{
    fs::{self, File},
    io::{Read as _, Write as _},
    net::TcpListener,
    os::unix::net::UnixStream,
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

use neighbours::{
    line::{Role, Session, session::Event},
    mailbox::{HWSC_COMMAND, HWSC_STATUS, Mailbox},
    workstation::{command, player, status},
};
use os_io::stderr_line;
use rcs_core::name::Name16;
use tempfile::TempDir;

pub const CELL: &str = "t3";
/// Limits for a busy machine. They detect that something never happens; benchmarks measure times.
pub const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action
const RUN_LIMIT: Duration = Duration::from_secs(600); // of a process that ends by itself, after a shift at most

/// A program of the main workspace; RCS_PROGRAMS names another directory than `target/release`.
pub fn program(name: &str) -> PathBuf {
    let built = concat!(env!("CARGO_MANIFEST_DIR"), "/../target/release");
    let path =
        std::env::var_os("RCS_PROGRAMS").map_or_else(|| PathBuf::from(built), PathBuf::from).join(name);
    assert!(path.exists(), "{}: cargo build --release --workspace builds it", path.display());
    path
}

pub struct Process {
    pub child: Child,
    errors: PathBuf,
}

impl Process {
    pub fn start(command: &mut Command, errors: PathBuf) -> Self {
        command.stderr(File::create(&errors).unwrap()).stdin(Stdio::null());
        Self { child: command.spawn().unwrap(), errors }
    }

    pub fn errors(&self) -> String {
        fs::read_to_string(&self.errors).unwrap()
    }

    pub fn wait_for(&self, text: &str) {
        assert!(eventually(|| self.errors().contains(text)), "expected {text:?} in:\n{}", self.errors());
    }

    pub fn finish(&mut self) -> ExitStatus {
        let child = &mut self.child;
        let mut status = None;
        let ended = within(RUN_LIMIT, || {
            status = child.try_wait().unwrap();
            status.is_some()
        });
        assert!(ended, "still running after {RUN_LIMIT:?}:\n{}", self.errors());
        status.unwrap()
    }

    pub fn kill(&mut self) {
        let _ = self.child.kill();
        self.child.wait().unwrap();
    }

    pub fn terminate(&self) {
        let pid = rustix::process::Pid::from_child(&self.child);
        rustix::process::kill_process(pid, rustix::process::Signal::TERM).unwrap();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
        if thread::panicking() {
            stderr_line!("--- {}\n{}", self.errors.display(), self.errors());
        }
    }
}

/// Waits until a condition holds. Returns false if it does not hold within [`TIME_LIMIT`].
pub fn eventually(condition: impl FnMut() -> bool) -> bool {
    within(TIME_LIMIT, condition)
}

/// The condition is checked at intervals of 0.1 s, because a run blocks a client that it has refused eight times in a
/// second (docs/neighbours.md "Security").
fn within(limit: Duration, mut condition: impl FnMut() -> bool) -> bool {
    let start = Instant::now();
    loop {
        let holds = condition();
        if holds || start.elapsed() >= limit {
            return holds;
        }
        thread::sleep(Duration::from_millis(100));
    }
}

pub fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

pub struct Shop {
    pub directory: TempDir,
    pub port: u16,
}

impl Shop {
    pub fn new(names: &[&str]) -> Self {
        let shop = Self { directory: tempfile::tempdir().unwrap(), port: free_port() };
        make_keys(&shop.path("keys"), CELL, names);
        shop
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub fn run_socket(&self) -> PathBuf {
        self.path("run.sock")
    }

    pub fn endpoint(&self) -> String {
        format!("tls/127.0.0.1:{}", self.port)
    }

    /// A run whose `--network` is the socket of this shop.
    pub fn run(&self, arguments: &[&str]) -> Process {
        let mut command = Command::new(program("rcs-run"));
        // Operators need shared memory; its place is this shop's.
        let memory = if arguments.contains(&"--operator") { "on" } else { "off" };
        command.args(arguments).args(["--log", "none", "--shared-memory", memory, "--json", "--network"]);
        command.arg(format!("unix:{}", self.run_socket().display())).current_dir(self.directory.path());
        command.arg("--data").arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../data"));
        command.stdout(File::create(self.path("run.json")).unwrap());
        // A run that was killed leaves its socket.
        let _ = fs::remove_file(self.run_socket());
        let run = Process::start(&mut command, self.path("run.err"));
        assert!(eventually(|| self.run_socket().exists()), "no socket:\n{}", run.errors());
        run
    }

    /// A run in real time that a workstation controller commands.
    pub fn real_run(&self) -> Process {
        self.run(&["--clock", "real", "--outside", "workstation"])
    }

    pub fn digest(&self) -> String {
        let result = fs::read_to_string(self.path("run.json")).unwrap();
        let result: serde_json::Value = serde_json::from_str(&result).unwrap();
        result["digest"].as_str().unwrap().to_owned()
    }

    pub fn serve(&self, allow: &[&str]) -> Process {
        let gateway = self.start_serve(allow);
        gateway.wait_for("t3 at tls/");
        gateway
    }

    pub fn router(&self, endpoint: &str) -> Process {
        start_router(self.directory.path(), endpoint, &[CELL])
    }

    /// Starts the gateway without waiting for it, because it may fail.
    pub fn start_serve(&self, allow: &[&str]) -> Process {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-gateway"));
        command
            .args(["serve", CELL, &self.endpoint(), "--run"])
            .arg(format!("unix:{}", self.run_socket().display()));
        command.arg("--keys").arg(self.path("keys")).arg("--allow").args(allow);
        Process::start(&mut command, self.path("serve.err"))
    }

    /// The other end for a role, with a certificate; it listens at the socket with the name of the certificate.
    pub fn connect(&self, role: &str, name: &str) -> Process {
        self.connect_to(&self.endpoint(), role, name)
    }

    /// As [`Shop::connect`], to another endpoint.
    pub fn connect_to(&self, endpoint: &str, role: &str, name: &str) -> Process {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-gateway"));
        command.args([
            "connect",
            &format!("{CELL}@{endpoint}"),
            role,
            &self.socket_address(name),
            "--name",
            name,
        ]);
        command.arg("--keys").arg(self.path("keys"));
        let connect = Process::start(&mut command, self.path(&format!("connect-{name}.err")));
        connect.wait_for("waits for a program");
        connect
    }

    pub fn socket_address(&self, name: &str) -> String {
        format!("unix:{}", self.path(&format!("{name}.sock")).display())
    }

    pub fn neighbour(&self, role: &str, network: &str, arguments: &[&str]) -> Process {
        let mut command = Command::new(program("rcs-neighbour"));
        command.args([role, "--network", network, "--wait", "20"]).args(arguments).stdout(Stdio::null());
        command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
        Process::start(&mut command, self.path(&format!("neighbour-{role}.err")))
    }

    pub fn hwsc(&self, name: &str) -> Result<Hwsc, String> {
        Hwsc::connect(&self.path(&format!("{name}.sock")))
    }
}

pub fn start_router(directory: &Path, endpoint: &str, cells: &[&str]) -> Process {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-gateway"));
    command.args(["router", endpoint, "--name", "router", "--monitors", "mes", "--keys"]);
    command.arg(directory.join("keys")).arg("--cells").args(cells);
    let router = Process::start(&mut command, directory.join("router.err"));
    router.wait_for(" at tls/");
    router
}

pub fn make_keys(directory: &Path, cell: &str, names: &[&str]) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../tools/keys.sh");
    let made = Command::new(script).arg(directory).args([cell, "127.0.0.1"]).args(names).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
}

pub struct Hwsc {
    session: Session,
    stream: UnixStream,
    command: Mailbox,
    status: Mailbox,
    tick: u64,
    number: u16,
}

impl Hwsc {
    pub fn connect(path: &Path) -> Result<Self, String> {
        let stream = UnixStream::connect(path).map_err(|error| error.to_string())?;
        stream.set_read_timeout(Some(TIME_LIMIT)).unwrap();
        let mut hwsc = Self {
            session: Session::neighbour(Role::Workstation, Instant::now()),
            stream,
            command: Mailbox::initialized(HWSC_COMMAND),
            status: Mailbox::initialized(HWSC_STATUS),
            tick: 0,
            number: 0,
        };
        hwsc.read()?;
        Ok(hwsc)
    }

    fn read(&mut self) -> Result<(), String> {
        loop {
            match self.session.event(Instant::now()).map_err(|error| error.to_string())? {
                Some(Event::Mailgram(HWSC_STATUS, used)) => self.status.receive(used).unwrap(),
                Some(Event::Pulse(tick)) => {
                    self.tick = tick;
                    return Ok(());
                }
                Some(_) => {}
                None => {
                    self.flush()?;
                    let mut bytes = [0; 8192];
                    let count = self.stream.read(&mut bytes).map_err(|error| error.to_string())?;
                    if count == 0 {
                        return Err("closed".to_owned());
                    }
                    self.session.receive(&bytes[..count], Instant::now());
                }
            }
        }
    }

    fn flush(&mut self) -> Result<(), String> {
        let bytes = std::mem::take(self.session.output());
        self.stream.write_all(&bytes).map_err(|error| error.to_string())
    }

    pub fn tick(&mut self) -> Result<u64, String> {
        self.session.pulse(self.tick, Instant::now());
        self.flush()?;
        self.read()?;
        Ok(self.tick)
    }

    pub fn status(&self) -> status::Status<'_> {
        status::decode(self.status.data()).unwrap()
    }

    /// Send PAUSE and wait until it is finished; returns how many ticks that took.
    pub fn pause(&mut self) -> Result<u64, String> {
        self.send("PAUSE", None)?;
        let start = self.tick;
        self.finish()?;
        Ok(self.tick - start)
    }

    /// Send a MOVE without an object to a location, and wait until Task executes it.
    pub fn start_move(&mut self, location: &str) -> Result<(), String> {
        self.send("MOVE", Some(location))?;
        while !self.is_reported("executing") {
            self.tick()?;
        }
        Ok(())
    }

    fn send(&mut self, verb: &str, location: Option<&str>) -> Result<(), String> {
        while self.status.data().is_empty() {
            self.tick()?;
        }
        self.number = self.status().echo.checked_add(1).unwrap_or(1);
        let mut sent = player::pause();
        sent.number = u32::from(self.number);
        sent.command = Name16::clipped(verb);
        sent.destination = location.map(Name16::clipped);
        self.command.write(&command::encode(&sent).unwrap()).unwrap();
        self.session.send(&self.command);
        Ok(())
    }

    pub fn is_reported(&self, report: &str) -> bool {
        let status = self.status();
        status.echo == self.number && status.report.to_string() == report
    }

    /// Treat the command in progress, from an earlier connection, as the last one of this connection.
    pub fn follow_last(&mut self) -> Result<(), String> {
        while self.status.data().is_empty() {
            self.tick()?;
        }
        self.number = self.status().echo;
        Ok(())
    }

    pub fn finish(&mut self) -> Result<(), String> {
        while !self.is_reported("finished") {
            self.tick()?;
            assert!(!self.is_reported("error"), "{}", self.status().reason);
        }
        Ok(())
    }
}

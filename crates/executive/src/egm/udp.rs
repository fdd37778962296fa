//! The host with a UDP socket in its own thread, which answers each datagram when it arrives. Orders and reports go
//! through bounded ring buffers: neither thread waits for the other.

use std::{
    io::ErrorKind,
    net::{IpAddr, SocketAddr, UdpSocket},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use egm::{Host, LinkState, Sample, host::Settings, message::MOST_BYTES};
use rtrb::{Consumer, Producer, RingBuffer};

use crate::egm::exchange::{Cause, Order, Refusals, Refused, Report};

const MOST_ORDERS: usize = 16; // capacity of the ring of orders: several ticks
const MOST_REPORTS: usize = 256; // capacity of the ring of reports: one second
/// Capacity of the ring of refused datagrams; in a tick with more, the last one is not the newest.
const MOST_REFUSED: usize = 64;
/// Longest wait for a datagram before the thread checks for orders and for the time.
const WAIT: Duration = Duration::from_millis(4);
const MOST_RECEIVED: usize = 2048; // longest datagram of EGM, bytes

#[derive(Debug, thiserror::Error)]
#[error("EGM cannot listen at UDP {address}: {source}")]
pub struct UdpError {
    address: SocketAddr,
    source: std::io::Error,
}

#[derive(Default)]
struct Counts {
    invalid: AtomicU64,
    elsewhere: AtomicU64,
}

pub struct UdpLine {
    origin: Instant,
    orders: Producer<Order>,
    reports: Consumer<Report>,
    sample: Sample,
    counts: Arc<Counts>,
    refused: Consumer<Refused>,
    last: Option<Refused>, // the last refused datagram
    stop: Arc<AtomicBool>,
    address: SocketAddr,
    thread: Option<JoinHandle<()>>,
}

impl UdpLine {
    /// Listens at `address`; with `peer`, only to that address. The thread first calls `prepare`, for example for
    /// real-time requests.
    pub fn open(
        address: SocketAddr,
        peer: Option<IpAddr>,
        settings: Settings,
        prepare: impl FnOnce() + Send + 'static,
    ) -> Result<Self, UdpError> {
        let failed = |source| UdpError { address, source };
        let socket = UdpSocket::bind(address).map_err(failed)?;
        socket.set_read_timeout(Some(WAIT)).map_err(failed)?;
        let address = socket.local_addr().map_err(failed)?;
        let (orders, to_do) = RingBuffer::new(MOST_ORDERS);
        let (done, reports) = RingBuffer::new(MOST_REPORTS);
        let (refusing, refused) = RingBuffer::new(MOST_REFUSED);
        let (stop, counts) = (Arc::new(AtomicBool::new(false)), Arc::<Counts>::default());
        let origin = Instant::now();
        let host = Host::new(settings);
        let mut worker = Worker {
            socket,
            origin,
            host,
            orders: to_do,
            reports: done,
            allowed: peer,
            robot: None,
            counts: Arc::clone(&counts),
            refused: refusing,
            heard: None,
            lost: false,
        };
        let ended = Arc::clone(&stop);
        let thread = thread::Builder::new()
            .name("egm".into())
            .spawn(move || {
                prepare();
                while !ended.load(Ordering::Relaxed) {
                    worker.step();
                }
            })
            .map_err(failed)?;
        let sample = Sample::default();
        let thread = Some(thread);
        Ok(Self { origin, orders, reports, sample, counts, refused, last: None, stop, address, thread })
    }

    #[must_use]
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    pub(crate) fn refusals(&self) -> Refusals {
        let [invalid, elsewhere] =
            [&self.counts.invalid, &self.counts.elsewhere].map(|count| count.load(Ordering::Relaxed));
        Refusals { invalid, elsewhere, last: self.last }
    }

    pub(crate) fn now(&self) -> u64 {
        nanoseconds(self.origin)
    }

    pub(crate) const fn sample(&self) -> Sample {
        self.sample
    }

    /// A full ring means that the thread has stopped: the order is lost, and the path ends.
    pub(crate) fn order(&mut self, order: &Order) {
        let _ = self.orders.push(*order);
    }

    pub(crate) fn reports(&mut self, mut take: impl FnMut(&Report)) {
        while let Ok(report) = self.reports.pop() {
            self.sample = report.sample;
            take(&report);
        }
        while let Ok(refused) = self.refused.pop() {
            self.last = Some(refused);
        }
    }
}

impl Drop for UdpLine {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn nanoseconds(origin: Instant) -> u64 {
    u64::try_from(origin.elapsed().as_nanos()).unwrap_or(u64::MAX)
}

struct Worker {
    socket: UdpSocket,
    origin: Instant,
    host: Host,
    orders: Consumer<Order>,
    reports: Producer<Report>,
    allowed: Option<IpAddr>,
    robot: Option<SocketAddr>, // address of the robot: the sender of the first valid message
    counts: Arc<Counts>,
    refused: Producer<Refused>,
    heard: Option<u64>,
    lost: bool, // the loss of the robot has been reported
}

impl Worker {
    fn step(&mut self) {
        let mut datagram = [0; MOST_RECEIVED];
        let received = self.socket.recv_from(&mut datagram);
        let now = nanoseconds(self.origin);
        while let Ok(order) = self.orders.pop() {
            let _ = order.carry_out(&mut self.host);
        }
        match received {
            Ok((length, sender)) => self.answer(now, datagram.get(..length).unwrap_or_default(), sender),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            // An earlier answer was refused because the robot's program has ended. A new datagram can come at any time.
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => {}
            Err(_) => thread::sleep(WAIT),
        }
        self.host.poll(now);
        let lost = self.host.sample().link == LinkState::Lost;
        if lost && !self.lost {
            self.robot = None;
            let _ = self.reports.push(Report { sample: self.host.sample(), cycle: None, answered: 0 });
        }
        self.lost = lost;
    }

    fn answer(&mut self, now: u64, datagram: &[u8], sender: SocketAddr) {
        if let Some(cause) = self.stranger(sender) {
            return self.refuse(sender, cause);
        }
        let mut buffer = [0; MOST_BYTES];
        let answer = match self.host.receive(now, datagram, &mut buffer) {
            Ok(Some(answer)) => answer,
            Ok(None) => return,
            Err(error) => return self.refuse(sender, Cause::Message(error)),
        };
        self.robot = Some(sender);
        let _ = self.socket.send_to(answer, sender);
        let answered = nanoseconds(self.origin).saturating_sub(now);
        let cycle = self.heard.replace(now).map(|before| now.saturating_sub(before));
        // If the ring is full, the newest report is dropped; the next tick brings newer ones.
        let _ = self.reports.push(Report { sample: self.host.sample(), cycle, answered });
    }
    fn stranger(&self, sender: SocketAddr) -> Option<Cause> {
        if self.allowed.is_some_and(|allowed| allowed != sender.ip()) {
            return Some(Cause::NotAllowed);
        }
        self.robot.filter(|robot| *robot != sender).map(Cause::OtherRobot)
    }

    fn refuse(&mut self, from: SocketAddr, cause: Cause) {
        let count = match cause {
            Cause::Message(_) => &self.counts.invalid,
            Cause::NotAllowed | Cause::OtherRobot(_) => &self.counts.elsewhere,
        };
        count.fetch_add(1, Ordering::Relaxed);
        // If the ring is full, the count is still correct, and one of the last datagrams is shown.
        let _ = self.refused.push(Refused { from, cause });
    }
}

//! A session with an emulated coupler, in simulated time: no sockets, no waiting, and it can be cloned.

use modbus::{Client, MOST_FRAME_BYTES, Request, Response};

use crate::{
    MS,
    emulated::Emulated,
    link::{Fault, Link},
    plan::{Plan, PlanError},
    report::{Orders, Report},
    session::Session,
};

#[derive(Clone, Debug)]
pub struct Simulated {
    session: Session,
    line: SimulatedLine,
}

impl Simulated {
    /// A device that is not connected yet. An answer that is missing costs `timeout_ms`.
    ///
    /// # Errors
    /// [`PlanError`] if the plan cannot be followed.
    pub fn new(plan: Plan, coupler: Emulated, timeout_ms: u16) -> Result<Self, PlanError> {
        let line = SimulatedLine {
            client: Client::new(plan.unit),
            coupler,
            timeout: u64::from(timeout_ms) * MS,
            now: 0,
            connections: 0,
            is_cut: false,
            is_broken: false,
            is_full: false,
            is_hanging: false,
            waiting: None,
        };
        Ok(Self { session: Session::new(plan)?, line })
    }

    /// Carries out one exchange at the time `now`, ns.
    pub fn exchange(&mut self, now: u64, orders: &Orders) {
        self.line.now = self.line.now.max(now);
        self.line.coupler.advance(self.line.now);
        self.session.exchange(&mut self.line, orders);
    }

    /// Cuts or restores the connection.
    pub const fn cut(&mut self, is_cut: bool) {
        self.line.is_cut = is_cut;
    }

    /// Other clients take all connections of the coupler, or leave it. A connection that exists is kept.
    pub const fn fill(&mut self, is_full: bool) {
        self.line.is_full = is_full;
    }

    /// Stops the program of the coupler, or lets it continue. It then carries out the request that it had received,
    /// even if the connection was reset in the meantime.
    pub const fn hang(&mut self, is_hanging: bool) {
        self.line.is_cut = is_hanging;
        self.line.is_hanging = is_hanging;
    }

    /// Switches the coupler off and on: see [`Emulated::restart`]. The connection ends.
    pub fn restart(&mut self) {
        self.line.coupler.restart();
        self.line.is_broken = true;
    }

    #[must_use]
    pub const fn report(&self) -> &Report {
        self.session.report()
    }

    #[must_use]
    pub const fn session(&self) -> &Session {
        &self.session
    }

    #[must_use]
    pub const fn coupler(&self) -> &Emulated {
        &self.line.coupler
    }

    /// The coupler, to set its inputs and faults.
    pub const fn coupler_mut(&mut self) -> &mut Emulated {
        &mut self.line.coupler
    }
}

/// The connection to an emulated coupler.
#[derive(Clone, Debug)]
struct SimulatedLine {
    client: Client,
    coupler: Emulated,
    timeout: u64,
    now: u64,
    connections: u64,
    is_cut: bool,
    /// The coupler has forgotten the connection.
    is_broken: bool,
    /// Other clients have all connections of the coupler.
    is_full: bool,
    /// Requests reach the coupler, but its program is stopped.
    is_hanging: bool,
    /// A request sent over the cut line, which the coupler receives when the connection is restored.
    waiting: Option<Waiting>,
}

#[derive(Clone, Debug)]
struct Waiting {
    frame: [u8; MOST_FRAME_BYTES],
    length: usize,
}

impl Link for SimulatedLine {
    fn now(&mut self) -> u64 {
        self.now
    }

    fn connect(&mut self) -> Result<(), Fault> {
        if self.is_cut {
            self.now += self.timeout;
            return Err(Fault::NoConnection);
        }
        if self.is_full {
            return Err(Fault::NoConnection);
        }
        self.is_broken = false;
        if let Some(Waiting { frame, length }) = self.waiting.take() {
            let mut answer = [0; MOST_FRAME_BYTES];
            // The answer goes to a connection that was reset.
            let _ = self.coupler.answer(self.now, self.connections, &frame[..length], &mut answer);
        }
        self.connections += 1;
        Ok(())
    }

    fn exchange<'a>(
        &mut self,
        request: &Request<'_>,
        buffer: &'a mut [u8; MOST_FRAME_BYTES],
    ) -> Result<Response<'a>, Fault> {
        if self.is_broken && !self.is_cut {
            return Err(Fault::Disconnected);
        }
        if let Some(Waiting { frame, length }) = self.waiting.take_if(|_| !self.is_cut) {
            // The coupler carries the request out late, and its answer is dropped.
            self.coupler
                .answer(self.now, self.connections, &frame[..length], buffer)
                .map_err(|_| Fault::Disconnected)?;
        }
        if self.waiting.is_some() {
            self.now += self.timeout;
            return Err(Fault::Unanswered);
        }
        let mut frame = [0; MOST_FRAME_BYTES];
        let length = self.client.request(request, &mut frame)?;
        if self.is_cut {
            self.waiting = Some(Waiting { frame, length });
            self.now += self.timeout;
            return Err(Fault::NoAnswer);
        }
        let answered = self
            .coupler
            .answer(self.now, self.connections, &frame[..length], buffer)
            .map_err(|_| Fault::Disconnected)?;
        Ok(self.client.answer(request, &buffer[..answered])?)
    }

    fn reset(&mut self) {
        if !self.is_hanging {
            self.waiting = None;
        }
    }
}

//! The camera of a station, as the neighbour `vision` of its runs. It pictures the station's own cell only.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use interfaces::device::{VisionRequest, VisionResponse};
use neighbours::{
    mailbox::{Mailbox, VISION_REQUEST, VISION_RESPONSE},
    vision::{Areas, Ready, request},
};
use os_io::stdout_line;
use sessions::network::{Address, Peer, PeerError, Received, Role};

const PAUSE: Duration = Duration::from_millis(500); // wait for a run, and pause after a failed connection

/// Requests between the thread and the cell, with the station's own numbers, because each run restarts its numbers.
#[derive(Debug, Default)]
struct VisionExchange {
    request: Option<VisionRequest>,
    number: u32,
    response: VisionResponse,
}

pub struct Camera {
    desk: Arc<Mutex<VisionExchange>>,
    stop: Arc<AtomicBool>,
}

impl Camera {
    pub fn start(address: Address) -> Result<Self, String> {
        let (desk, stop) =
            (Arc::new(Mutex::new(VisionExchange::default())), Arc::new(AtomicBool::new(false)));
        let (shared, ended) = (Arc::clone(&desk), Arc::clone(&stop));
        // A thread that waits for a run does not keep the program from ending.
        thread::Builder::new()
            .name("camera".into())
            .spawn(move || serve(&address, &shared, &ended))
            .map_err(|error| format!("no thread for the camera: {error}"))?;
        Ok(Self { desk, stop })
    }

    pub fn request(&self) -> VisionRequest {
        let desk = locked(&self.desk);
        desk.request
            .map_or_else(VisionRequest::default, |request| VisionRequest { number: desk.number, ..request })
    }

    pub fn answer(&self, response: &VisionResponse) {
        let mut desk = locked(&self.desk);
        let echo = desk.request.map_or(0, |request| request.number);
        if response.echo == desk.number && echo != 0 {
            desk.response = VisionResponse { echo, ..*response };
        }
    }
}

impl Drop for Camera {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

fn locked(desk: &Mutex<VisionExchange>) -> MutexGuard<'_, VisionExchange> {
    // All values of a desk are valid, even after a panic.
    desk.lock().unwrap_or_else(PoisonError::into_inner)
}

fn serve(address: &Address, desk: &Mutex<VisionExchange>, stop: &AtomicBool) {
    let mut refused = None;
    while !stop.load(Ordering::Relaxed) {
        match Peer::connect_within(PAUSE, address, Role::Vision) {
            Ok(mut peer) => {
                stdout_line!("[vision] connected to a run");
                refused = None;
                let ended = attend(&mut peer, desk, stop);
                let number = locked(desk).number;
                *locked(desk) = VisionExchange { number, ..VisionExchange::default() };
                if let Err(error) = ended {
                    stdout_line!("[vision] {error}");
                }
            }
            Err(error) if error.is_passing() => {}
            Err(error) => {
                let said = error.to_string();
                if refused.replace(said.clone()) != Some(said) {
                    stdout_line!("[vision] {error}");
                }
            }
        }
        thread::sleep(PAUSE);
    }
}

fn attend(peer: &mut Peer, desk: &Mutex<VisionExchange>, stop: &AtomicBool) -> Result<(), PeerError> {
    let mut response_box = Mailbox::initialized(VISION_RESPONSE);
    let mut read = 0;
    while !stop.load(Ordering::Relaxed) {
        let Received::Pulse(pulse) = peer.receive()? else { continue };
        let requests = peer.mailbox(VISION_REQUEST);
        if requests.mailgram() != read {
            read = requests.mailgram();
            match (read != 0).then(|| request::decode(requests.data())) {
                Some(Ok(request)) => {
                    let mut desk = locked(desk);
                    (desk.request, desk.number) = (Some(request), desk.number.wrapping_add(1).max(1));
                }
                Some(Err(why)) => stdout_line!("[vision] a request cannot be read: {why}"),
                // A freshly initialized mailbox holds no request.
                None => {}
            }
        }
        let areas = Areas { output: Ready::Ready, response: locked(desk).response, ..Areas::INITIALIZED };
        match areas.encode() {
            Ok(bytes) if response_box.data() != bytes => {
                response_box.write(&bytes).map_err(PeerError::Mailbox)?;
                peer.send(&response_box)?;
            }
            Ok(_) => {}
            Err(why) => stdout_line!("[vision] an answer cannot be sent: {why}"),
        }
        peer.pulse(pulse)?;
    }
    Ok(())
}

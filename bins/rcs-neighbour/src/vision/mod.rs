//! The vision system: the picture analysis of the simulated cell behind the vision mailboxes, for one run after the
//! other.

pub mod fault;

use std::path::Path;

use geometry::frame::Vector;
use interfaces::device::{VisionRequest, VisionStatus};
use neighbours::{
    mailbox::{Mailbox, VISION_PICTURE, VISION_REQUEST, VISION_RESPONSE},
    vision::{Areas, Picture, Ready, VisionError, picture::Part, request},
};
use plant::{
    CellDescription,
    camera::{Analysis, Face, Subject},
};
use sessions::network::{Peer, PeerError, Received, Role};

use self::fault::{Fault, Kind};
use crate::{Error, Reconnect, cli::VisionArguments, connect, connect_again};

/// File of the cell description in the data directory.
const CELL: &str = "cell.toml";

/// Serves runs until none connects within the waiting time.
pub fn serve(arguments: &VisionArguments) -> Result<(), Error> {
    let mut vision = Vision::new(&arguments.data.join(CELL), arguments.fault.clone())?;
    let mut peer = connect(&arguments.controller, Role::Vision)?;
    let mut reconnect = Reconnect::new();
    loop {
        match attend(&mut peer, &mut vision) {
            Ok(()) => {}
            Err(Error::Peer(error)) if error.is_passing() => os_io::stdout_line!("{error}"),
            other => return other,
        }
        // The old connection is closed first, because the controller accepts one neighbour of each role.
        drop(peer);
        let Some(next) = connect_again(&arguments.controller, Role::Vision, &mut reconnect)? else {
            return Ok(());
        };
        peer = next;
        vision.forget();
    }
}

/// Answers the requests of a run, until a fault closes the connection.
fn attend(peer: &mut Peer, vision: &mut Vision) -> Result<(), Error> {
    let mut response_box = Mailbox::initialized(VISION_RESPONSE);
    loop {
        let Received::Pulse(pulse) = peer.receive()? else { continue };
        vision.look(peer.mailbox(VISION_REQUEST), peer.mailbox(VISION_PICTURE))?;
        if vision.leaves() {
            return Ok(());
        }
        if let Some(bytes) = vision.work()?
            && response_box.data() != bytes
        {
            response_box.write(&bytes).map_err(PeerError::Mailbox)?;
            peer.send(&response_box)?;
        }
        peer.pulse(pulse)?;
    }
}

/// The state of the vision system between its mailboxes.
struct Vision {
    cell: CellDescription,
    faults: Vec<Fault>,
    /// Mailgram number of the request that was read last.
    read: u16,
    /// A request whose picture has not arrived yet.
    request: Option<VisionRequest>,
    /// Seed and analysis of the present run, known from its first picture.
    analysis: Option<(u64, Analysis)>,
    /// Number of pictures in all runs.
    pictures: u32,
    fault: Option<Kind>,
    /// Status reported last on standard output; each answer is reported once.
    said: VisionStatus,
}

impl Vision {
    fn new(cell: &Path, faults: Vec<Fault>) -> Result<Self, Error> {
        let cell = CellDescription::load(cell)?;
        Ok(Self {
            cell,
            faults,
            read: 0,
            request: None,
            analysis: None,
            pictures: 0,
            fault: None,
            said: VisionStatus::Idle,
        })
    }

    /// Resets the state for a new run or a new connection.
    fn forget(&mut self) {
        (self.read, self.request, self.analysis, self.fault) = (0, None, None, None);
        self.said = VisionStatus::Idle;
    }

    /// Reads the controller's mailboxes and starts a new request when its picture has arrived. A request or picture
    /// that cannot be decoded is reported on standard error and not answered.
    fn look(&mut self, requests: &Mailbox, pictures: &Mailbox) -> Result<(), Error> {
        let said = |what: &str, why: &VisionError| {
            os_io::stderr_line!("rcs-neighbour: {what} cannot be read: {why}")
        };
        if requests.mailgram() != self.read {
            self.read = requests.mailgram();
            // A freshly initialized mailbox holds no request.
            let request = (self.read != 0).then(|| request::decode(requests.data()));
            self.request = request.and_then(|read| read.inspect_err(|why| said("a request", why)).ok());
        }
        let Some(request) = self.request else { return Ok(()) };
        if pictures.data().is_empty() {
            return Ok(());
        }
        match Picture::decode(pictures.data()) {
            Ok(picture) if u32::from(picture.number) == request.number => {
                self.request = None;
                self.begin(&request, &picture)
            }
            Ok(_) => Ok(()),
            Err(why) => {
                self.request = None;
                said("a picture", &why);
                Ok(())
            }
        }
    }

    fn begin(&mut self, request: &VisionRequest, picture: &Picture) -> Result<(), Error> {
        let expected = Analysis::fingerprint(&self.cell);
        if picture.cell != expected {
            return Err(Error::AnotherCell { expected, found: picture.cell });
        }
        self.pictures = self.pictures.saturating_add(1);
        self.said = VisionStatus::Busy;
        let fault = self.faults.iter().find(|fault| fault.pictures.contains(&self.pictures));
        self.fault = fault.map(|fault| fault.kind);
        let mut seen: Vec<Subject> = picture.parts.iter().map(subject).collect();
        if self.fault == Some(Kind::CameraBlind) {
            seen.clear();
        }
        if self.analysis.as_ref().is_none_or(|(seed, _)| *seed != picture.seed) {
            self.analysis = Some((picture.seed, Analysis::new(&self.cell.camera, picture.seed)));
        }
        if let Some((_, analysis)) = &mut self.analysis {
            analysis.expose(request, &seen, self.cell.seen_as(request.object_id));
        }
        Ok(())
    }

    /// Returns true if a fault closes the connection now.
    fn leaves(&self) -> bool {
        let leaves = self.fault == Some(Kind::Gone);
        if leaves {
            os_io::stdout_line!("picture {}: the line is cut", self.pictures);
        }
        leaves
    }

    /// Executes one tick; returns the bytes for the mailbox, or `None` to leave it unchanged.
    fn work(&mut self) -> Result<Option<Vec<u8>>, Error> {
        let mut areas = Areas { output: Ready::Ready, ..Areas::INITIALIZED };
        if let Some((_, analysis)) = &mut self.analysis {
            areas.response = analysis.answer();
        }
        if areas.response.status != self.said && self.said == VisionStatus::Busy {
            self.said = areas.response.status;
            self.tell(&areas);
        }
        let spoiled = self.fault.map_or(Some(areas), |fault| fault.spoil(areas));
        let Some(areas) = spoiled else { return Ok(None) };
        let mut bytes = areas.encode().map_err(|error| Error::Job(error.to_string()))?.to_vec();
        if let Some(fault) = self.fault.filter(|_| areas.response.status != VisionStatus::Busy) {
            fault.garble(&mut bytes);
        }
        Ok(Some(bytes))
    }

    /// Prints one line for every picture.
    fn tell(&self, areas: &Areas) {
        let response = &areas.response;
        let at = |hundredths: i32| f64::from(hundredths) / 100.0;
        let mut text = format!("picture {}: {}", self.pictures, response.status.text());
        if response.status == VisionStatus::Done {
            text += &format!(
                " at ({:.2} {:.2}) in, turned {:.2}",
                at(response.y),
                at(response.z),
                at(response.angle)
            );
        }
        if let Some((word, _)) = Kind::ALL.into_iter().find(|(_, kind)| Some(*kind) == self.fault) {
            text += &format!("; fault: {word}");
        }
        os_io::stdout_line!("{text}");
    }
}

/// The view of a part, as the camera sees it.
fn subject(part: &Part) -> Subject {
    let edges = part.edges.map(|(direction, length)| (Vector::from(direction), length));
    Subject::from_raster(Face { centre: Vector::from(part.centre), edges }, part.reflectance, part.seen)
}

#[cfg(test)]
mod tests {
    use interfaces::device;

    use super::*;

    const CELL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/cell.toml");

    fn request(number: u32) -> [u8; request::RequestLayout::BYTES] {
        let request = VisionRequest {
            number,
            picture: device::Picture::Precise,
            object_id: 17,
            range_mm: 600,
            ..VisionRequest::default()
        };
        request::encode(&request)
    }

    #[test]
    fn an_unreadable_request_is_not_answered_and_the_next_one_is() {
        let mut vision = Vision::new(Path::new(CELL), Vec::new()).unwrap();
        let mut requests = Mailbox::initialized(VISION_REQUEST);
        let mut pictures = Mailbox::initialized(VISION_PICTURE);
        let dark = |number| {
            let cell = Analysis::fingerprint(&vision.cell);
            Picture { number, seed: 1, cell, parts: Vec::new() }.encode()
        };
        let (fourth, fifth) = (dark(4), dark(5));
        for (asked, shown) in
            [(&b"look!"[..], &fourth[..]), (&request(4), b"what a view"), (&request(5), &fifth)]
        {
            requests.write(asked).unwrap();
            pictures.write(shown).unwrap();
            vision.look(&requests, &pictures).unwrap();
        }
        assert_eq!(vision.pictures, 1, "of the others none was taken");
        let response = loop {
            let bytes = vision.work().unwrap().unwrap();
            let response = Areas::decode(&bytes).unwrap().response;
            if response.status != VisionStatus::Busy {
                break response;
            }
        };
        assert_eq!((response.echo, response.status), (5, VisionStatus::NothingSeen));
    }
}

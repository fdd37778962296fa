//! A slot: one value in shared memory, with one writer and any number of readers.
//!
//! A slot is an entry of an iceoryx2 blackboard: the tick that wrote it (the *stamp*), then the byte image
//! ([`rcs_core::plain`]). The writer encodes in place and publishes the whole entry at once. A reader takes one copy,
//! then checks it: later writes cannot make it illegal (docs/design/memory.md "One copy"). The name of a service ends
//! with its [`Epoch`].

use std::{cell::RefCell, fmt::Debug, marker::PhantomData};

use iceoryx2::{
    node::Node,
    port::{
        reader::{BlackboardValue, EntryHandle, Reader as Port},
        writer::{EntryHandleMut, Writer as WriterPort},
    },
    prelude::ipc,
    service::builder::blackboard::Creator,
};
use rcs_core::{
    Plain,
    plain::{DecodeError, Reader, Writer},
    tick::Tick,
};

use super::{error::SharedMemoryError, layout::Epoch, runs};

pub(crate) const UNWRITTEN: Tick = Tick(u64::MAX);

/// Size of a slot that holds a `T`, bytes.
pub(crate) const fn size<T: Plain>() -> usize {
    Tick::SIZE + T::SIZE
}

fn encode<const N: usize, T: Plain>(stamp: Tick, value: &T, bytes: &mut [u8; N]) {
    let mut w = Writer::new(bytes);
    stamp.encode(&mut w);
    value.encode(&mut w);
    debug_assert_eq!(w.missing(), 0);
}

pub(crate) struct NewService {
    service: &'static str,
    creator: Creator<u32, ipc::Service>,
}

impl NewService {
    /// A service without slots for at most `readers` readers.
    pub fn new(
        node: &Node<ipc::Service>,
        service: &'static str,
        epoch: Epoch,
        readers: usize,
    ) -> Result<Self, SharedMemoryError> {
        let creator = node
            .service_builder(&runs::service_name(service, epoch)?)
            .blackboard_creator::<u32>()
            .max_readers(readers)
            .max_nodes(readers + 1);
        Ok(Self { service, creator })
    }

    /// Add a slot. It holds `first`, written in tick `stamp`.
    pub fn slot<const N: usize, T: Plain>(mut self, key: u32, stamp: Tick, first: &T) -> Self {
        let mut bytes = [0; N];
        encode(stamp, first, &mut bytes);
        self.creator = self.creator.add(key, bytes);
        self
    }

    /// Create the service; an existing one is an error.
    pub fn create(self) -> Result<ServiceWriter, SharedMemoryError> {
        let Self { service, creator } = self;
        let failed = |what: &dyn Debug| SharedMemoryError::service(service, what);
        let factory = creator.create().map_err(|error| failed(&error))?;
        let port = factory.writer_builder().create().map_err(|error| failed(&error))?;
        Ok(ServiceWriter { service, port })
    }
}

pub(crate) struct ServiceWriter {
    service: &'static str,
    port: WriterPort<ipc::Service, u32>,
}

impl ServiceWriter {
    /// The writer's end of a slot. It stays valid without the service's end.
    pub fn slot<const N: usize, T>(&self, key: u32) -> Result<SlotWriter<N, T>, SharedMemoryError> {
        let entry = self.port.entry(&key);
        let entry = entry.map_err(|error| SharedMemoryError::service(self.service, &error))?;
        Ok(SlotWriter { entry: Some(entry), holds: PhantomData })
    }
}

pub(crate) struct SlotWriter<const N: usize, T> {
    entry: Option<EntryHandleMut<ipc::Service, u32, [u8; N]>>, // absent only while a value is written
    holds: PhantomData<T>,
}

impl<const N: usize, T: Plain> SlotWriter<N, T> {
    /// Write `value` and the tick that wrote it. Does not allocate.
    pub fn write(&mut self, stamp: Tick, value: &T) {
        let Some(entry) = self.entry.take() else { return };
        let mut loan = entry.loan_uninit();
        encode(stamp, value, loan.value_mut().write([0; N]));
        #[expect(unsafe_code, reason = "the line above initializes all bytes of the loan")]
        let written = unsafe { loan.assume_init_and_update() };
        self.entry = Some(written);
    }
}

pub(crate) struct ServiceReader {
    service: &'static str,
    port: Port<ipc::Service, u32>,
}

impl ServiceReader {
    /// Open a service; one that does not exist may be created later.
    pub fn open(
        node: &Node<ipc::Service>,
        service: &'static str,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        let failed = |what: &dyn Debug| SharedMemoryError::service(service, what);
        let builder = node.service_builder(&runs::service_name(service, epoch)?).blackboard_opener::<u32>();
        let factory = builder.open().map_err(|error| failed(&error))?;
        let port = factory.reader_builder().create().map_err(|error| failed(&error))?;
        Ok(Self { service, port })
    }

    /// A reader's end of a slot. It stays valid without the service's end.
    pub fn slot<const N: usize, T>(&self, key: u32) -> Result<SlotReader<N, T>, SharedMemoryError> {
        let entry = self.port.entry(&key);
        let entry = entry.map_err(|error| SharedMemoryError::service(self.service, &error))?;
        Ok(SlotReader { entry, last: RefCell::new(None) })
    }
}

pub(crate) struct SlotReader<const N: usize, T> {
    entry: EntryHandle<ipc::Service, u32, [u8; N]>,
    last: RefCell<Option<Decoded<N, T>>>,
}

struct Decoded<const N: usize, T> {
    image: BlackboardValue<[u8; N]>,
    found: (Tick, T),
}

impl<const N: usize, T: Plain> SlotReader<N, T> {
    /// The stamp and the value. Does not allocate. Fails if the bytes are not the image of a legal value.
    pub fn read(&self) -> Result<(Tick, T), DecodeError> {
        if let Some(last) = &*self.last.borrow()
            && self.entry.is_up_to_date(&last.image)
        {
            return Ok(last.found);
        }
        let image = self.entry.get();
        let mut r = Reader::new(&*image);
        let found = (Tick::decode(&mut r)?, T::decode(&mut r)?);
        self.last.replace(Some(Decoded { image, found }));
        Ok(found)
    }

    /// The value, if it was written in tick `stamp`. Does not allocate. Errors: those of [`Self::read`].
    pub fn read_at(&self, stamp: Tick) -> Result<Option<T>, DecodeError> {
        let (written, value) = self.read()?;
        Ok((written == stamp).then_some(value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::RunName;

    const SIZE: usize = size::<Option<u32>>();

    #[test]
    fn a_slot_holds_the_last_value_and_its_stamp() {
        let node = runs::enter(&RunName::unique("slot"), "test").expect("this machine has shared memory");
        let new = NewService::new(&node, "slot", 1, 1).expect("a valid name");
        let new = new.slot::<SIZE, _>(0, UNWRITTEN, &Some(7_u32));
        let mut writer =
            new.create().and_then(|service| service.slot::<SIZE, Option<u32>>(0)).expect("a new service");
        let service = ServiceReader::open(&node, "slot", 1).expect("the service exists");
        let reader = service.slot::<SIZE, Option<u32>>(0).expect("the slot exists");
        assert_eq!(reader.read(), Ok((UNWRITTEN, Some(7))));
        for (tick, value) in [(1, None), (2, Some(u32::MAX)), (2, Some(0))] {
            writer.write(Tick(tick), &value);
            // Twice: the second value is not decoded again.
            assert_eq!([reader.read(), reader.read()], [Ok((Tick(tick), value)); 2]);
        }
        assert_eq!(reader.read_at(Tick(2)), Ok(Some(Some(0))));
        assert_eq!(reader.read_at(Tick(1)), Ok(None));
        assert!(service.slot::<SIZE, Option<u32>>(1).is_err(), "the service has no such slot");
    }
}

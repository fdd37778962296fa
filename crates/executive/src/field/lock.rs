//! A lock on a device: only one process of this machine at a time may write it.
//!
//! The lock is a name in the abstract namespace of Unix sockets: the system frees it with the process, also after
//! `kill -9`. The session detects writes of other machines when it reads the outputs back.

use std::{
    io::{self, ErrorKind},
    net::SocketAddr,
    os::{
        linux::net::SocketAddrExt as _,
        unix::net::{SocketAddr as UnixAddress, UnixListener},
    },
};

use super::device::DeviceError;

/// A device that this process alone may write. Dropping it frees the device.
#[derive(Debug)]
pub struct Lock {
    _socket: UnixListener,
}

impl Lock {
    /// Fails if any process of this machine, including this one, has the device.
    pub fn take(address: SocketAddr, unit: u8) -> Result<Self, DeviceError> {
        let failed = |source: io::Error| match source.kind() {
            ErrorKind::AddrInUse => DeviceError::InUse { address },
            _ => DeviceError::Lock { address, source },
        };
        let name = UnixAddress::from_abstract_name(format!("rcs-field {address} {unit}")).map_err(failed)?;
        Ok(Self { _socket: UnixListener::bind_addr(&name).map_err(failed)? })
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;

    #[test]
    fn device_is_free_again_after_its_lock_is_dropped() {
        // No other test may use this port, because tests run at the same time.
        let device = SocketAddr::from((Ipv4Addr::new(127, 77, 0, 1), 502));
        let first = Lock::take(device, 1).expect("Linux has the namespace");
        assert!(matches!(Lock::take(device, 1), Err(DeviceError::InUse { .. })));
        assert!(Lock::take(device, 2).is_ok(), "another unit behind the same address");
        drop(first);
        assert!(Lock::take(device, 1).is_ok());
    }
}

//! Checks whether the system has a permanent entry for the hardware address of a coupler.
//!
//! A machine that loses its link discards learnt hardware addresses and keeps packets for up to three seconds: an old
//! image arrives at the coupler when the link is back. With a permanent entry the packets are dropped.

use std::{fs, io, net::IpAddr};

const TABLE: &str = "/proc/net/arp"; // the table of neighbours of IPv4
const PERMANENT: u32 = 0x04; // flag of a permanent entry (`ATF_PERM`)

/// True if the entry of `address` is permanent; `None` without an entry, as for this machine or behind a router.
pub fn is_permanent(address: IpAddr) -> io::Result<Option<bool>> {
    fs::read_to_string(TABLE).map(|table| entry(&table, address))
}

/// `10.0.0.7  0x1  0x6  02:00:00:00:00:07  *  eth0`: address, type, flags, hardware address, mask, device.
fn entry(table: &str, address: IpAddr) -> Option<bool> {
    table.lines().skip(1).find_map(|line| {
        let mut words = line.split_whitespace();
        let found: IpAddr = words.next()?.parse().ok()?;
        let flags = words.nth(1)?.strip_prefix("0x")?;
        let flags = u32::from_str_radix(flags, 16).ok()?;
        (found == address).then_some(flags & PERMANENT != 0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entry_of_the_address_decides() {
        let table = "IP address       HW type     Flags       HW address            Mask     Device\n\
                     10.0.0.2         0x1         0x2         02:00:00:00:00:02     *        eth0\n\
                     10.0.0.22        0x1         0x6         02:00:00:00:00:22     *        eth0\n";
        let entry_of = |text: &str| entry(table, text.parse().unwrap());
        assert_eq!(entry_of("10.0.0.22"), Some(true));
        assert_eq!(entry_of("10.0.0.2"), Some(false));
        assert_eq!(entry_of("127.0.0.1"), None);
    }

    #[test]
    fn table_of_this_machine_is_read() {
        assert_eq!(is_permanent(IpAddr::from([127, 0, 0, 1])).expect("Linux has the table"), None);
    }
}

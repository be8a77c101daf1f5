//! Ranges of internet addresses, as `10.0.0.0/8`.

use std::{fmt, net::IpAddr, str::FromStr};

use serde::{Deserialize, Deserializer};

/// Bits of an IPv6 address that name one customer's link; who has one address of it has all.
const IPV6_LINK_BITS: u8 = 64;
/// Bits that name one customer's network, which has tens of thousands of links.
const IPV6_NETWORK_BITS: u8 = 48;

/// Fewest bits of a network of proxies: what is wider is no network of one's own.
const PROXIES_BITS_MIN: (u8, u8) = (8, 16);

/// Addresses that begin with the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct AddressRange {
    /// The first address; its bits beyond the prefix are zero.
    first: IpAddr,
    prefix_bits: u8,
}

/// A text is no range of addresses.
#[derive(Debug, thiserror::Error)]
#[error(
    "a range of addresses is an address as 192.0.2.7 or a prefix as 10.0.0.0/8 or 2001:db8::/32"
)]
pub struct AddressRangeError;

impl AddressRange {
    /// Returns the range that begins with `prefix_bits` of the address; at most all of its bits count.
    #[must_use]
    pub fn new(address: IpAddr, prefix_bits: u8) -> Self {
        let address = address.to_canonical();
        let prefix_bits = prefix_bits.min(bits_of(address));
        Self { first: masked(address, prefix_bits), prefix_bits }
    }

    /// Returns the addresses that one client can choose from: of IPv4 the one, of IPv6 its /64.
    #[must_use]
    pub fn of_client(address: IpAddr) -> Self {
        let address = address.to_canonical();
        let prefix_bits = if address.is_ipv6() { IPV6_LINK_BITS } else { bits_of(address) };
        Self::new(address, prefix_bits)
    }

    /// Returns the addresses of which one owner has all: of IPv4 the range itself, of IPv6 its /48.
    #[must_use]
    pub fn network(&self) -> Self {
        let is_within_network = self.first.is_ipv6() && self.prefix_bits > IPV6_NETWORK_BITS;
        Self::new(self.first, if is_within_network { IPV6_NETWORK_BITS } else { self.prefix_bits })
    }

    /// Returns true if all its addresses are those of this machine alone.
    #[must_use]
    pub fn is_loopback(&self) -> bool {
        let bits_min = if self.first.is_ipv4() { 8 } else { 128 };
        self.first.is_loopback() && self.prefix_bits >= bits_min
    }

    /// Returns true if it is too wide for proxies, whose word about their clients is believed.
    #[must_use]
    pub const fn is_beyond_proxies(&self) -> bool {
        let (of_v4, of_v6) = PROXIES_BITS_MIN;
        self.prefix_bits < if self.first.is_ipv4() { of_v4 } else { of_v6 }
    }

    /// Returns true if the address lies in this range. IPv4 inside IPv6 counts as IPv4.
    #[must_use]
    pub fn contains(&self, address: IpAddr) -> bool {
        let address = address.to_canonical();
        address.is_ipv4() == self.first.is_ipv4() && masked(address, self.prefix_bits) == self.first
    }
}

const fn bits_of(address: IpAddr) -> u8 {
    match address {
        IpAddr::V4(_) => 32,
        IpAddr::V6(_) => 128,
    }
}

fn masked(address: IpAddr, prefix_bits: u8) -> IpAddr {
    match address {
        IpAddr::V4(v4) => {
            let mask = u32::MAX.checked_shl(32 - u32::from(prefix_bits)).unwrap_or(0);
            IpAddr::V4((v4.to_bits() & mask).into())
        }
        IpAddr::V6(v6) => {
            let mask = u128::MAX.checked_shl(128 - u32::from(prefix_bits)).unwrap_or(0);
            IpAddr::V6((v6.to_bits() & mask).into())
        }
    }
}

impl FromStr for AddressRange {
    type Err = AddressRangeError;

    fn from_str(text: &str) -> Result<Self, AddressRangeError> {
        let (address, prefix) = match text.split_once('/') {
            Some((address, prefix)) => (address, Some(prefix)),
            None => (text, None),
        };
        let address: IpAddr = address.parse().map_err(|_| AddressRangeError)?;
        let prefix_bits = match prefix {
            Some(prefix) => prefix.parse().map_err(|_| AddressRangeError)?,
            None => bits_of(address),
        };
        if prefix_bits > bits_of(address) {
            return Err(AddressRangeError);
        }
        Ok(Self::new(address, prefix_bits))
    }
}

impl fmt::Display for AddressRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.first, self.prefix_bits)
    }
}

impl<'de> Deserialize<'de> for AddressRange {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(text: &str) -> IpAddr {
        text.parse().expect("an address")
    }

    #[test]
    fn a_range_has_the_addresses_with_its_prefix() {
        for (range, inside, outside) in [
            ("10.0.0.0/8", "10.255.1.2", "11.0.0.1"),
            ("10.1.2.3/8", "10.0.0.0", "::10"),
            ("192.0.2.7", "192.0.2.7", "192.0.2.8"),
            ("2001:db8::/32", "2001:db8:1::1", "2001:db9::1"),
            ("0.0.0.0/0", "8.8.8.8", "2001:db8::1"),
            ("::1", "::1", "127.0.0.1"),
            ("127.0.0.0/8", "::ffff:127.0.0.1", "::1"),
        ] {
            let parsed: AddressRange = range.parse().expect("a range");
            assert!(parsed.contains(address(inside)), "{range} {inside}");
            assert!(!parsed.contains(address(outside)), "{range} {outside}");
        }
        for wrong in ["", "localhost", "10.0.0.0/33", "10.0.0.0/", "::/129", "1.2.3.4:80"] {
            assert!(wrong.parse::<AddressRange>().is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn a_range_of_proxies_is_this_machine_or_a_network_of_ones_own() {
        for (text, is_loopback, is_beyond_proxies) in [
            ("127.0.0.1", true, false),
            ("127.0.0.0/8", true, false),
            ("::1", true, false),
            ("::ffff:127.0.0.1", true, false),
            ("126.0.0.0/7", false, true),
            ("::/127", false, false),
            ("10.0.0.7", false, false),
            ("10.0.0.0/8", false, false),
            ("10.0.0.0/7", false, true),
            ("0.0.0.0/0", false, true),
            ("2001:db8::/32", false, false),
            ("2001::/16", false, false),
            ("2000::/15", false, true),
            ("::/0", false, true),
        ] {
            let range: AddressRange = text.parse().expect("a range");
            assert_eq!(range.is_loopback(), is_loopback, "{text}");
            assert_eq!(range.is_beyond_proxies(), is_beyond_proxies, "{text}");
        }
    }

    #[test]
    fn a_client_has_one_address_of_ipv4_and_64_bits_of_ipv6() {
        let of = |text| AddressRange::of_client(address(text)).to_string();
        assert_eq!(of("192.0.2.7"), "192.0.2.7/32");
        assert_eq!(of("::ffff:192.0.2.7"), "192.0.2.7/32");
        assert_eq!(of("2001:db8:1:2:3:4:5:6"), "2001:db8:1:2::/64");
        let network = |text| AddressRange::of_client(address(text)).network().to_string();
        assert_eq!(network("192.0.2.7"), "192.0.2.7/32");
        assert_eq!(network("2001:db8:1:2:3:4:5:6"), "2001:db8:1::/48");
    }
}

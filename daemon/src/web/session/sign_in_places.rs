//! Places of sign-ins under way. They are few, so that who has taken many makes room for others.

use std::collections::HashMap;

use tokio_util::sync::CancellationToken;

use crate::web::address_range::AddressRange;

/// Sign-ins under way or waiting at once.
const PLACES_MAX: usize = 64;
/// Part of strangers among them: of users from where they have not signed in before. The rest is for the others.
const PLACES_OF_STRANGERS_MAX: usize = 48;
/// Share of one client's addresses, so that no single one keeps all others out.
const PLACES_PER_CLIENT_MAX: usize = 16;

/// Places that are taken, by client.
#[derive(Default)]
pub(super) struct SignInPlaces {
    taken: HashMap<AddressRange, Vec<TakenPlace>>,
    next_number: u64,
}

struct TakenPlace {
    number: u64,
    is_strangers: bool,
    displaced: CancellationToken,
}

/// Reason for which there is no place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoPlace {
    /// The client has all that it may have.
    OfClient,
    /// All are taken, and no network has more than its own.
    Full,
}

impl SignInPlaces {
    /// Takes a place, and returns its number with what is cancelled once another takes it. Where all are taken, a
    /// stranger takes the newest place of the network of which strangers have most, if that is more than they have of
    /// its own, and a known user the same in any case.
    ///
    /// # Errors
    /// The reason for which there is none.
    pub(super) fn take(
        &mut self,
        client: AddressRange,
        is_stranger: bool,
    ) -> Result<(u64, CancellationToken), NoPlace> {
        let own = self.taken.get(&client).map_or(0, Vec::len);
        if own >= PLACES_PER_CLIENT_MAX {
            if is_stranger {
                return Err(NoPlace::OfClient);
            }
            self.displace(|one| *one == client).ok_or(NoPlace::OfClient)?;
        } else if self.is_full(is_stranger) {
            let networks = self.strangers_of_networks();
            let largest = networks.iter().max_by_key(|(_, held)| **held);
            let (largest, held) = largest.ok_or(NoPlace::Full)?;
            let own_strangers = networks.get(&client.network()).copied().unwrap_or(0);
            if is_stranger && *held <= own_strangers + 1 {
                return Err(NoPlace::Full);
            }
            self.displace(|one| one.network() == *largest).ok_or(NoPlace::Full)?;
        }
        let (number, displaced) = (self.next_number, CancellationToken::new());
        self.next_number += 1;
        let place = TakenPlace { number, is_strangers: is_stranger, displaced: displaced.clone() };
        self.taken.entry(client).or_default().push(place);
        Ok((number, displaced))
    }

    /// Returns true where all places are taken that a stranger may have, or a known user.
    pub(super) fn is_full(&self, is_stranger: bool) -> bool {
        let of_strangers: usize = self.taken.values().map(|places| strangers(places)).sum();
        let all: usize = self.taken.values().map(Vec::len).sum();
        all >= PLACES_MAX || (is_stranger && of_strangers >= PLACES_OF_STRANGERS_MAX)
    }

    /// Gives a place back, if none has taken it meanwhile.
    pub(super) fn release(&mut self, client: &AddressRange, number: u64) {
        self.remove(client, number);
    }

    /// Returns how many places strangers have of each network: one owner of a network of IPv6 has many clients.
    fn strangers_of_networks(&self) -> HashMap<AddressRange, usize> {
        let mut networks: HashMap<AddressRange, usize> = HashMap::new();
        for (client, places) in &self.taken {
            match strangers(places) {
                0 => {}
                held => *networks.entry(client.network()).or_default() += held,
            }
        }
        networks
    }

    /// Ends the newest of the places that strangers have of these clients: the others have waited longer. None where
    /// they have none.
    fn displace(&mut self, is_of: impl Fn(&AddressRange) -> bool) -> Option<()> {
        let of_strangers =
            self.taken.iter().filter(|(client, _)| is_of(client)).flat_map(|(client, places)| {
                let places = places.iter().filter(|place| place.is_strangers);
                places.map(move |place| (place.number, *client))
            });
        let (number, client) = of_strangers.max_by_key(|(number, _)| *number)?;
        self.remove(&client, number)?.displaced.cancel();
        Some(())
    }

    fn remove(&mut self, client: &AddressRange, number: u64) -> Option<TakenPlace> {
        let places = self.taken.get_mut(client)?;
        let place = places.remove(places.iter().position(|place| place.number == number)?);
        if places.is_empty() {
            self.taken.remove(client);
        }
        Some(place)
    }
}

fn strangers(places: &[TakenPlace]) -> usize {
    places.iter().filter(|place| place.is_strangers).count()
}

#[cfg(test)]
mod tests {
    use std::net::IpAddr;

    use super::*;

    fn client(number: u16) -> AddressRange {
        let [high, low] = number.to_be_bytes();
        AddressRange::of_client(IpAddr::from([198, 18, high, low]))
    }

    /// Takes places until one is refused, and returns how many it got.
    fn taken(places: &mut SignInPlaces, client: AddressRange, is_stranger: bool) -> usize {
        (0..100).take_while(|_| places.take(client, is_stranger).is_ok()).count()
    }

    fn held(places: &SignInPlaces, client: AddressRange) -> usize {
        places.taken.get(&client).map_or(0, Vec::len)
    }

    #[test]
    fn clients_share_the_places_and_each_newcomer_gets_one() {
        let mut places = SignInPlaces::default();
        for number in 0..4 {
            assert!(taken(&mut places, client(number), true) >= 12, "client {number}");
        }
        let (_, displaced) = places.take(client(4), true).expect("a fifth client gets a place");
        assert!(!displaced.is_cancelled());
        for number in 5..48 {
            assert!(places.take(client(number), true).is_ok(), "client {number}");
        }
        let all: usize = (0..48).map(|number| held(&places, client(number))).sum();
        assert_eq!(all, 48);
        assert_eq!(places.take(client(99), true).map(drop), Err(NoPlace::Full), "each has one");
    }

    #[test]
    fn one_network_of_ipv6_is_one_however_many_clients_it_has() {
        let link = |network: u16, link: u16| {
            let address = [0x2001, 0xdb8, network, link, 0, 0, 0, 1];
            AddressRange::of_client(IpAddr::from(address))
        };
        let mut places = SignInPlaces::default();
        for number in 0..48 {
            places.take(link(1, number), true).expect("free");
        }
        for number in 0..24 {
            places.take(link(2, number), true).expect("in the place of one of the other network");
        }
        let none = places.take(link(2, 24), true).map(drop);
        assert_eq!(none, Err(NoPlace::Full), "each has half of them");
        assert!(places.take(client(1), true).is_ok(), "a third one");
        let kept = (0..24).filter(|number| held(&places, link(1, *number)) == 1).count();
        assert!(kept >= 23, "{kept} of those who came first");
    }

    #[test]
    fn known_users_have_places_whatever_strangers_do() {
        let mut places = SignInPlaces::default();
        for number in 0..100 {
            let _ = places.take(client(number), true);
        }
        assert_eq!(taken(&mut places, client(200), false), 16, "those that strangers cannot have");
        assert_eq!(taken(&mut places, client(201), false), 16, "in the place of strangers");
        assert_eq!(places.taken.values().map(Vec::len).sum::<usize>(), 64);
        // Strangers at the address of a known user, as in an office.
        let mut places = SignInPlaces::default();
        assert_eq!(taken(&mut places, client(1), true), 16);
        assert_eq!(taken(&mut places, client(1), false), 16);
        assert_eq!(places.take(client(1), true).map(drop), Err(NoPlace::OfClient));
    }

    #[test]
    fn the_newest_is_displaced_and_places_are_given_back() {
        let mut places = SignInPlaces::default();
        let of_one: Vec<_> = (0..16).map(|_| places.take(client(1), true).expect("free")).collect();
        for number in 2..34 {
            places.take(client(number), true).expect("free");
        }
        places.take(client(99), true).expect("it displaces one");
        let ended: Vec<_> = of_one.iter().map(|(_, displaced)| displaced.is_cancelled()).collect();
        assert!(ended[15] && !ended[..15].contains(&true), "{ended:?}");
        for (number, _) in &of_one {
            places.release(&client(1), *number);
        }
        assert_eq!(held(&places, client(1)), 0);
        places.take(client(98), true).expect("free again");
    }
}

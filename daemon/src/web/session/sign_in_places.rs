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

impl SignInPlaces {
    /// Takes a place, and returns its number with what is cancelled once another takes it. Where all are taken, a
    /// stranger takes the newest place of the client of whom strangers have most, if that is more than they have of its
    /// own, and a known user the same in any case. None where there is no place.
    pub(super) fn take(
        &mut self,
        client: AddressRange,
        is_stranger: bool,
    ) -> Option<(u64, CancellationToken)> {
        let own = self.taken.get(&client).map_or(0, Vec::len);
        let of_strangers: usize = self.taken.values().map(|places| strangers(places)).sum();
        let all: usize = self.taken.values().map(Vec::len).sum();
        let is_full = all >= PLACES_MAX || (is_stranger && of_strangers >= PLACES_OF_STRANGERS_MAX);
        if own >= PLACES_PER_CLIENT_MAX {
            if is_stranger {
                return None;
            }
            self.displace(&client)?;
        } else if is_full {
            let (largest, held) = self.largest()?;
            let own_strangers = self.taken.get(&client).map_or(0, |places| strangers(places));
            if is_stranger && held <= own_strangers + 1 {
                return None;
            }
            self.displace(&largest)?;
        }
        let (number, displaced) = (self.next_number, CancellationToken::new());
        self.next_number += 1;
        let place = TakenPlace { number, is_strangers: is_stranger, displaced: displaced.clone() };
        self.taken.entry(client).or_default().push(place);
        Some((number, displaced))
    }

    /// Gives a place back, if none has taken it meanwhile.
    pub(super) fn release(&mut self, client: &AddressRange, number: u64) {
        self.remove(client, |place| place.number == number);
    }

    /// Returns the client of whom strangers have most places, with their number.
    fn largest(&self) -> Option<(AddressRange, usize)> {
        let held = self.taken.iter().map(|(client, places)| (*client, strangers(places)));
        held.filter(|(_, held)| *held > 0).max_by_key(|(_, held)| *held)
    }

    /// Ends the newest of the places that strangers have of a client: the others have waited longer. None where they
    /// have none.
    fn displace(&mut self, client: &AddressRange) -> Option<()> {
        let place = self.remove(client, |place| place.is_strangers)?;
        place.displaced.cancel();
        Some(())
    }

    /// Removes the newest place of a client that is meant.
    fn remove(
        &mut self,
        client: &AddressRange,
        is_meant: impl Fn(&TakenPlace) -> bool,
    ) -> Option<TakenPlace> {
        let places = self.taken.get_mut(client)?;
        let place = places.remove(places.iter().rposition(is_meant)?);
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
        (0..100).take_while(|_| places.take(client, is_stranger).is_some()).count()
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
            assert!(places.take(client(number), true).is_some(), "client {number}");
        }
        let all: usize = (0..48).map(|number| held(&places, client(number))).sum();
        assert_eq!(all, 48);
        assert!(places.take(client(99), true).is_none(), "each has one");
    }

    #[test]
    fn known_users_have_places_whatever_strangers_do() {
        let mut places = SignInPlaces::default();
        for number in 0..100 {
            places.take(client(number), true);
        }
        assert_eq!(taken(&mut places, client(200), false), 16, "those that strangers cannot have");
        assert_eq!(taken(&mut places, client(201), false), 16, "in the place of strangers");
        assert_eq!(places.taken.values().map(Vec::len).sum::<usize>(), 64);
        // Strangers at the address of a known user, as in an office.
        let mut places = SignInPlaces::default();
        assert_eq!(taken(&mut places, client(1), true), 16);
        assert_eq!(taken(&mut places, client(1), false), 16);
        assert!(places.take(client(1), true).is_none());
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

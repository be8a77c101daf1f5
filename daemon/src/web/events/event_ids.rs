//! Ids of events that tell nothing of the number behind them.

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use rand::RngCore;
use ring::aead::{Aad, CHACHA20_POLY1305, LessSafeKey, NONCE_LEN, Nonce, Tag, UnboundKey};

/// Length of the number, between the nonce and the tag.
const NUMBER_LEN: usize = size_of::<u64>();
/// Length of the tag behind the number.
const TAG_LEN: usize = 16;
/// Length of what an id has behind its mark, in bytes.
const SEALED_LEN: usize = NONCE_LEN + NUMBER_LEN + TAG_LEN;

/// Maker and reader of ids, `{mark}-{sealed number}`. Numbers are sealed by a key of this log with a
/// nonce of each id, so that ids of one number differ, and those of two have no order.
pub(super) struct EventIds {
    mark: String,
    key: LessSafeKey,
}

impl EventIds {
    pub(super) fn new(start_mark: u64) -> Self {
        let mut key = [0_u8; 32];
        rand::rng().fill_bytes(&mut key);
        let key = UnboundKey::new(&CHACHA20_POLY1305, &key).expect("a key of 32 bytes");
        Self { mark: format!("{start_mark:016x}"), key: LessSafeKey::new(key) }
    }

    /// Makes an id of an event. Each call makes another one.
    pub(super) fn seal(&self, number: u64) -> String {
        let mut nonce = [0_u8; NONCE_LEN];
        rand::rng().fill_bytes(&mut nonce);
        let mut text = number.to_be_bytes();
        let unique = Nonce::assume_unique_for_key(nonce);
        let tag = self.key.seal_in_place_separate_tag(unique, Aad::empty(), &mut text);
        let tag = tag.expect("a number is short");
        let mut sealed = Vec::with_capacity(SEALED_LEN);
        sealed.extend_from_slice(&nonce);
        sealed.extend_from_slice(&text);
        sealed.extend_from_slice(tag.as_ref());
        format!("{}-{}", self.mark, URL_SAFE_NO_PAD.encode(sealed))
    }

    /// Returns the number behind an id of this log; `None` for those of another one or start.
    pub(super) fn open(&self, id: &str) -> Option<u64> {
        let sealed = id.strip_prefix(&self.mark)?.strip_prefix('-')?;
        let sealed: [u8; SEALED_LEN] =
            URL_SAFE_NO_PAD.decode(sealed).ok()?.as_slice().try_into().ok()?;
        let (nonce, rest) = sealed.split_first_chunk::<NONCE_LEN>()?;
        let (text, tag) = rest.split_first_chunk::<NUMBER_LEN>()?;
        let (nonce, tag) = (Nonce::assume_unique_for_key(*nonce), Tag::try_from(tag).ok()?);
        let mut number = *text;
        self.key.open_in_place_separate_tag(nonce, Aad::empty(), tag, &mut number, 0..).ok()?;
        Some(u64::from_be_bytes(number))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    const IDS: u64 = 64;

    #[test]
    fn ids_of_consecutive_events_neither_order_nor_repeat() {
        let ids = EventIds::new(0xab);
        let sealed: Vec<String> = (0..IDS).chain(0..IDS).map(|number| ids.seal(number)).collect();
        let distinct: BTreeSet<&String> = sealed.iter().collect();
        assert_eq!(distinct.len(), sealed.len());
        let lengths: BTreeSet<usize> = sealed.iter().map(String::len).collect();
        assert_eq!(lengths, BTreeSet::from(["00000000000000ab-".len() + 48]));
        // By chance, half of the neighbours ascend; all or none of 127 do once in 2^126 runs.
        let ascending = sealed.windows(2).filter(|pair| pair[0] < pair[1]).count();
        assert!((1..sealed.len() - 1).contains(&ascending), "{ascending} of {}", sealed.len());
    }

    #[test]
    fn an_id_opens_to_its_number_where_it_was_made() {
        let ids = EventIds::new(0xab);
        for number in [0, 1, u64::MAX] {
            assert_eq!(ids.open(&ids.seal(number)), Some(number));
        }
    }

    #[test]
    fn a_foreign_id_is_refused() {
        let ids = EventIds::new(0xab);
        let id = ids.seal(7);
        let sealed = id.split_once('-').expect("a mark").1;
        let other_start = format!("00000000000000cd-{sealed}");
        let mut changed = URL_SAFE_NO_PAD.decode(sealed).expect("base64");
        changed[NONCE_LEN] ^= 1;
        let changed = format!("00000000000000ab-{}", URL_SAFE_NO_PAD.encode(changed));
        // The number in plain, as former versions had it.
        for foreign in [other_start, changed, id[1..].to_owned(), format!("{id}A"), "ab-7".into()] {
            assert_eq!(ids.open(&foreign), None, "{foreign}");
        }
        // Another log has another key, even with the same mark.
        assert_eq!(ids.open(&EventIds::new(0xab).seal(7)), None);
    }
}

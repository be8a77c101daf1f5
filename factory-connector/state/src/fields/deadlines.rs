//! Deadlines of fields, in order: those that are due are found without a scan of all fields.

use std::collections::BTreeSet;

use asi_model::DateTime;

/// Deadlines of all fields, by time and field number.
#[derive(Debug, Default)]
pub(super) struct Deadlines {
    /// Gates that want to be asked again.
    releases: BTreeSet<(DateTime, i64)>,
    /// Requests that begin, of fields that have a value already.
    beginnings: BTreeSet<(DateTime, i64)>,
    /// Requests that end, of mapped fields.
    ends: BTreeSet<(DateTime, i64)>,
}

/// The deadlines of one field as they stand in [`Deadlines`].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Noted {
    pub(super) release: Option<DateTime>,
    end: Option<DateTime>,
}

impl Deadlines {
    pub(super) fn next(&self) -> Option<DateTime> {
        let first = |set: &BTreeSet<(DateTime, i64)>| set.first().map(|(at, _)| *at);
        [first(&self.releases), first(&self.beginnings), first(&self.ends)]
            .into_iter()
            .flatten()
            .min()
    }

    pub(super) fn note_release(&mut self, id: i64, at: Option<DateTime>, noted: &mut Noted) {
        replace(&mut self.releases, id, at, &mut noted.release);
    }

    pub(super) fn note_end(&mut self, id: i64, at: Option<DateTime>, noted: &mut Noted) {
        replace(&mut self.ends, id, at, &mut noted.end);
    }

    pub(super) fn note_beginning(&mut self, id: i64, at: DateTime) {
        self.beginnings.insert((at, id));
    }

    pub(super) fn pop_release(&mut self, now: DateTime) -> Option<i64> {
        pop(&mut self.releases, now)
    }

    pub(super) fn pop_beginning(&mut self, now: DateTime) -> Option<i64> {
        pop(&mut self.beginnings, now)
    }

    pub(super) fn ended(&self, now: DateTime) -> impl Iterator<Item = i64> {
        self.ends.iter().take_while(move |(at, _)| *at <= now).map(|(_, id)| *id)
    }

    pub(super) fn forget(&mut self, id: i64, noted: &mut Noted) {
        // A beginning may stay: it finds no field any more and is dropped when it comes.
        self.note_release(id, None, noted);
        self.note_end(id, None, noted);
    }
}

fn replace(
    set: &mut BTreeSet<(DateTime, i64)>,
    id: i64,
    at: Option<DateTime>,
    noted: &mut Option<DateTime>,
) {
    if at == *noted {
        return;
    }
    if let Some(former) = *noted {
        set.remove(&(former, id));
    }
    if let Some(at) = at {
        set.insert((at, id));
    }
    *noted = at;
}

fn pop(set: &mut BTreeSet<(DateTime, i64)>, now: DateTime) -> Option<i64> {
    let (at, _) = set.first()?;
    if *at > now {
        return None;
    }
    set.pop_first().map(|(_, id)| id)
}

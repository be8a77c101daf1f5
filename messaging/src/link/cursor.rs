//! Positions in the spool: the next rows to fetch and to send. No row is sent twice while it is in
//! flight, and none is forgotten.
//!
//! At the start of a connection all rows up to the *watermark* are backlog: the newest row of each
//! writer first, then the others in order as replay. Rows written later are live. Rows whose
//! outcome is not yet recorded are *open* and are skipped when they are read again.

use std::collections::{BTreeSet, HashMap, VecDeque};

use crate::spool::{Fetch, Lane, LaneScheduler, NextLane, ReplayShare, RowId, SpoolRow};

/// Rows fetched at once. Rows carry their bodies, so it bounds memory as well.
pub(crate) const FETCH_LIMIT: usize = 128;

/// A selection of rows that is read ahead.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Source {
    Control,
    Newest,
    Live,
    Replay,
}

#[derive(Debug)]
struct LaneReader {
    /// The last row that was fetched.
    after: RowId,
    is_drained: bool,
    rows: VecDeque<SpoolRow>,
}

impl LaneReader {
    const fn new(after: RowId) -> Self {
        Self { after, is_drained: false, rows: VecDeque::new() }
    }

    fn restart(&mut self, after: RowId) {
        *self = Self::new(after);
    }
}

/// Read positions in the spool, with the rows fetched ahead.
#[derive(Debug)]
pub(crate) struct Cursor {
    watermark: RowId,
    control: LaneReader,
    newest: LaneReader,
    live: LaneReader,
    replay: LaneReader,
    lanes: LaneScheduler,
    /// Open rows; true for rows with reports.
    open: HashMap<RowId, bool>,
    /// Rows with reports that were open at the last rewind and still are. What the store changed of one of them waits
    /// again once it is closed, so that no later row may pass it before.
    held: BTreeSet<RowId>,
}

impl Cursor {
    /// Creates the cursor of a new connection; `last` is the greatest row id at this moment.
    pub(crate) fn new(last: RowId, share: ReplayShare) -> Self {
        Self {
            watermark: last,
            control: LaneReader::new(RowId(0)),
            newest: LaneReader::new(RowId(0)),
            live: LaneReader::new(last),
            replay: LaneReader::new(RowId(0)),
            lanes: LaneScheduler::new(share),
            open: HashMap::new(),
            held: BTreeSet::new(),
        }
    }

    /// Restarts from the beginning of the spool; open rows stay open. `last` is the greatest row id
    /// at this moment.
    ///
    /// While reports are in flight, the newest rows do not go first: a message can carry reports of
    /// several writers, and its older ones would arrive after newer ones that were sent already.
    pub(crate) fn begin(&mut self, last: RowId) {
        let open = std::mem::take(&mut self.open);
        // The lanes go on with their turn: a connection that often breaks would starve the replay.
        let lanes = self.lanes.clone();
        *self = Self { open, lanes, ..Self::new(last, ReplayShare::default()) };
        self.newest.is_drained = self.open.values().any(|has_reports| *has_reports);
    }

    /// Notes that rows were written.
    pub(crate) fn on_wake(&mut self) {
        // What is written now has numbers beyond the watermark: the backlog has nothing new.
        self.control.is_drained = false;
        self.live.is_drained = false;
    }

    /// Notes that earlier rows wait again: all rows taken up to now become backlog.
    pub(crate) fn on_rewind(&mut self) {
        let taken = self.live.rows.front().map_or(self.live.after, |row| RowId(row.id.0 - 1));
        self.watermark = self.watermark.max(taken);
        // From the beginning: which rows wait again is known to the store only.
        self.control.restart(RowId(0));
        self.replay.restart(RowId(0));
        let with_reports = self.open.iter().filter(|(_, has_reports)| **has_reports);
        self.held = with_reports.map(|(id, _)| *id).collect();
    }

    /// Returns the query that must be answered before another row can be chosen; none when enough
    /// rows are fetched or no row waits.
    pub(crate) fn next_fetch(&self) -> Option<(Fetch, FetchFor)> {
        let (source, reader) = [
            (Source::Control, &self.control),
            (Source::Newest, &self.newest),
            (Source::Live, &self.live),
            (Source::Replay, &self.replay),
        ]
        .into_iter()
        // The backlog waits until the newest rows are sent.
        .filter(|(source, _)| *source != Source::Replay || self.is_newest_done())
        .find(|(_, reader)| reader.rows.is_empty() && !reader.is_drained)?;
        let (lane, through) = match source {
            Source::Control => (Lane::Control, None),
            Source::Newest => (Lane::Newest, Some(self.watermark)),
            Source::Live => (Lane::Reports, None),
            Source::Replay => (Lane::Reports, Some(self.replay_end())),
        };
        Some((Fetch { lane, after: reader.after, through, limit: FETCH_LIMIT }, FetchFor(source)))
    }

    /// Takes the fetched rows; open ones are dropped.
    pub(crate) fn on_fetched(&mut self, fetched: FetchFor, rows: Vec<SpoolRow>) {
        let reader = match fetched.0 {
            Source::Control => &mut self.control,
            Source::Newest => &mut self.newest,
            Source::Live => &mut self.live,
            Source::Replay => &mut self.replay,
        };
        reader.is_drained = rows.len() < FETCH_LIMIT;
        if let Some(last) = rows.last() {
            reader.after = last.id;
        }
        // A row that is in flight is not sent twice; the reader goes on behind it all the same.
        reader.rows.extend(rows.into_iter().filter(|row| !self.open.contains_key(&row.id)));
    }

    /// Takes the row to send next, marked as replay when it is one. It is open from now on.
    pub(crate) fn next(&mut self) -> Option<SpoolRow> {
        loop {
            let (mut row, lane) = self.choose()?;
            // The newest rows are read once more with the backlog.
            if self.open.insert(row.id, lane.is_some()).is_none() {
                row.envelope.replay = lane == Some(NextLane::Replay);
                return Some(row);
            }
        }
    }

    /// Closes a row: its outcome is recorded, or it was not sent at all.
    pub(crate) fn close(&mut self, id: RowId) {
        self.open.remove(&id);
        if self.held.remove(&id) {
            self.replay.is_drained = false;
        }
    }

    /// Returns the number of open rows.
    pub(crate) fn open(&self) -> usize {
        self.open.len()
    }

    /// Returns whether no row waits, as far as the cursor knows.
    pub(crate) fn is_idle(&self) -> bool {
        self.next_fetch().is_none() && self.open.is_empty()
    }

    /// Takes the next row, with its lane when it has reports.
    fn choose(&mut self) -> Option<(SpoolRow, Option<NextLane>)> {
        // Before any report: these are few, and the receiver judges reports by them.
        if let Some(row) = self.control.rows.pop_front() {
            return Some((row, None));
        }
        let has_live = !self.newest.rows.is_empty() || !self.live.rows.is_empty();
        let lane = self.lanes.next(has_live, !self.replay.rows.is_empty())?;
        let row = match lane {
            NextLane::Live => self.newest.rows.pop_front().or_else(|| self.live.rows.pop_front()),
            NextLane::Replay => self.replay.rows.pop_front(),
        };
        row.map(|row| (row, Some(lane)))
    }

    /// Returns the last row that may be sent as backlog at the moment.
    fn replay_end(&self) -> RowId {
        self.held.first().map_or(self.watermark, |first| self.watermark.min(RowId(first.0 - 1)))
    }

    fn is_newest_done(&self) -> bool {
        self.newest.is_drained && self.newest.rows.is_empty()
    }
}

/// The selection that a fetch is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FetchFor(Source);

#[cfg(test)]
mod tests;

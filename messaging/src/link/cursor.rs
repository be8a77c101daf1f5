//! Positions in the spool: the next rows to fetch and to send. No row is sent twice while it is in
//! flight, and none is forgotten.
//!
//! At the start of a connection all rows up to the *watermark* are backlog: the newest row of each
//! writer first, then the others in order as replay. Rows written later are live. Rows whose
//! outcome is not yet recorded are *open* and are skipped when they are read again.

use std::collections::{HashMap, VecDeque};

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
            Source::Replay => (Lane::Reports, Some(self.watermark)),
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

    fn is_newest_done(&self) -> bool {
        self.newest.is_drained && self.newest.rows.is_empty()
    }
}

/// The selection that a fetch is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct FetchFor(Source);

#[cfg(test)]
mod tests {
    use asi_model::MessageId;
    use futures::executor::block_on;
    use proptest::prelude::*;
    use time::OffsetDateTime;

    use super::*;
    use crate::{
        address::LogicalAddress,
        envelope::Envelope,
        spool::{
            RowOutcome, SendOutcome, SpoolStore,
            memory::{AcceptedReports, MemorySpool},
        },
    };

    struct Bench {
        spool: MemorySpool,
        cursor: Cursor,
    }

    impl Bench {
        fn new(rows: &[Option<u16>]) -> Self {
            let spool = MemorySpool::new(AcceptedReports::WaitForReceipt);
            let mut bench = Self { spool, cursor: Cursor::new(RowId(0), ReplayShare::default()) };
            bench.push(rows);
            bench.cursor = Cursor::new(
                block_on(bench.spool.last_row()).expect("a row"),
                ReplayShare::default(),
            );
            bench
        }

        fn push(&mut self, rows: &[Option<u16>]) {
            let address: LogicalAddress = "factory.f.ingress".parse().expect("an address");
            for writer in rows {
                let envelope = Envelope::new(MessageId::new("m").expect("an id"), "s", "");
                match writer {
                    Some(writer) => self.spool.push_report(address.clone(), envelope, *writer),
                    None => self.spool.push(address.clone(), envelope),
                };
            }
        }

        fn next(&mut self) -> Option<(i64, bool)> {
            while let Some((fetch, target)) = self.cursor.next_fetch() {
                let rows = block_on(self.spool.fetch(fetch)).expect("rows");
                self.cursor.on_fetched(target, rows);
            }
            self.cursor.next().map(|row| (row.id.0, row.envelope.replay))
        }

        fn all(&mut self) -> Vec<(i64, bool)> {
            std::iter::from_fn(|| self.next()).collect()
        }

        fn accept(&mut self, id: i64) {
            let outcome = RowOutcome {
                id: RowId(id),
                outcome: SendOutcome::Accepted,
                at: OffsetDateTime::UNIX_EPOCH,
            };
            block_on(self.spool.record(vec![outcome])).expect("recorded");
            self.cursor.close(RowId(id));
        }
    }

    #[test]
    fn after_an_outage_the_newest_go_first_then_the_backlog_in_order() {
        let mut bench = Bench::new(&[Some(1), Some(1), None, Some(2), Some(1), Some(2), Some(2)]);
        let order = bench.all();
        assert_eq!(order[0], (3, false), "control rows lead");
        assert_eq!(order[1..3], [(5, false), (7, false)], "then the newest of each writer");
        assert_eq!(order[3..], [(1, true), (2, true), (4, true), (6, true)], "then the backlog");
        assert_eq!(bench.next(), None);
    }

    #[test]
    fn a_row_whose_successor_was_sent_is_not_the_newest() {
        let mut bench = Bench::new(&[Some(1), Some(1), Some(2)]);
        assert_eq!([bench.next(), bench.next()], [Some((2, false)), Some((3, false))]);
        bench.accept(2);
        // The connection is lost before anything else leaves.
        bench.cursor = Cursor::new(RowId(3), ReplayShare::default());
        assert_eq!(bench.all(), [(3, false), (1, true)], "writer 1 has sent a newer one live");
    }

    #[test]
    fn new_rows_are_live_and_share_with_the_backlog() {
        let mut bench = Bench::new(&[Some(1); 30]);
        assert_eq!(bench.next(), Some((30, false)));
        bench.push(&[Some(1); 10]);
        bench.cursor.on_wake();
        let order = bench.all();
        let live: Vec<_> = order.iter().filter(|(_, replay)| !replay).map(|(id, _)| *id).collect();
        let replayed: Vec<_> =
            order.iter().filter(|(_, replay)| *replay).map(|(id, _)| *id).collect();
        assert_eq!(live, (31..=40).collect::<Vec<_>>());
        assert_eq!(replayed, (1..=29).collect::<Vec<_>>());
        let both = &order[..10];
        assert!(both.iter().any(|(_, replay)| *replay) && both.iter().any(|(_, replay)| !replay));
    }

    #[test]
    fn rows_that_wait_again_come_as_replay() {
        let mut bench = Bench::new(&[]);
        bench.push(&[Some(1), Some(1), Some(1)]);
        bench.cursor.on_wake();
        assert_eq!(bench.all(), [(1, false), (2, false), (3, false)]);
        for id in [1, 2, 3] {
            bench.accept(id);
        }
        bench.spool.make_wait(&[RowId(2)]);
        bench.cursor.on_rewind();
        assert_eq!(bench.all(), [(2, true)]);
        assert!(!bench.cursor.is_idle());
        bench.accept(2);
        assert!(bench.cursor.is_idle());
    }

    #[test]
    fn rows_that_were_hidden_go_as_after_an_outage() {
        let mut bench = Bench::new(&[Some(1), None]);
        assert_eq!(bench.next(), Some((2, false)), "in flight all the time");
        bench.push(&[Some(1), None, Some(2), Some(1)]);
        bench.cursor.begin(RowId(6));
        assert_eq!(bench.all(), [(4, false), (5, false), (6, false), (1, true), (3, true)]);
    }

    #[test]
    fn no_newest_row_goes_first_while_reports_are_in_flight() {
        let mut bench = Bench::new(&[]);
        bench.push(&[Some(1)]);
        bench.cursor.on_wake();
        assert_eq!(bench.next(), Some((1, false)), "in flight all the time");
        bench.push(&[Some(2), Some(1), Some(1)]);
        bench.cursor.begin(RowId(4));
        assert_eq!(bench.all(), [(2, true), (3, true), (4, true)]);
    }

    #[test]
    fn a_rewind_does_not_send_rows_in_flight() {
        let mut bench = Bench::new(&[Some(1), None, Some(2)]);
        assert_eq!(bench.all().len(), 3);
        bench.cursor.on_rewind();
        assert_eq!(bench.all(), []);
        bench.cursor.close(RowId(1));
        bench.cursor.on_rewind();
        assert_eq!(bench.all(), [(1, true)]);
    }

    proptest! {
        /// Property of any order of events: every row is sent, none twice without a rewind or while
        /// in flight, and each lane keeps its order.
        #[test]
        fn every_row_is_sent(
            first in proptest::collection::vec(proptest::option::of(0u16..3), 0..300),
            steps in proptest::collection::vec((0u8..4, 0usize..40), 0..40),
        ) {
            let mut bench = Bench::new(&first);
            let mut total = first.len();
            let mut accepted = std::collections::BTreeSet::new();
            let mut open = VecDeque::new();
            for (kind, count) in steps {
                match kind {
                    0 => {
                        bench.push(&vec![Some(1); count]);
                        total += count;
                        bench.cursor.on_wake();
                    }
                    1 => for _ in 0..count {
                        let Some((id, _)) = bench.next() else { break };
                        prop_assert!(!open.contains(&id) && !accepted.contains(&id), "row {} is sent twice", id);
                        open.push_back(id);
                    },
                    2 => for id in open.drain(..count.min(open.len())) {
                        bench.accept(id);
                        accepted.insert(id);
                    },
                    _ => bench.cursor.on_rewind(),
                }
            }
            while let Some((id, _)) = bench.next() { open.push_back(id); }
            for id in open { prop_assert!(accepted.insert(id), "row {} is sent twice", id); }
            prop_assert_eq!(accepted.len(), total);
        }
    }
}

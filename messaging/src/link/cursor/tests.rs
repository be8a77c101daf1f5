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
        bench.cursor =
            Cursor::new(block_on(bench.spool.last_row()).expect("a row"), ReplayShare::default());
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
    let replayed: Vec<_> = order.iter().filter(|(_, replay)| *replay).map(|(id, _)| *id).collect();
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
fn no_later_row_passes_one_that_was_taken_back_in_flight() {
    let mut bench = Bench::new(&[]);
    bench.push(&[Some(1), Some(1), Some(1), Some(2)]);
    bench.cursor.on_wake();
    assert_eq!(bench.all().len(), 4, "all are in flight");
    // The last ones come back, and the store changes what the others have.
    bench.cursor.close(RowId(3));
    bench.cursor.close(RowId(4));
    bench.cursor.on_rewind();
    assert_eq!(bench.next(), None, "they wait for those before them");
    bench.accept(1);
    assert_eq!(bench.next(), None);
    bench.cursor.close(RowId(2));
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
        // What was in flight at a rewind holds later rows up until it is closed.
            loop {
                while let Some((id, _)) = bench.next() { open.push_back(id); }
                let Some(id) = open.pop_front() else { break };
                bench.accept(id);
                prop_assert!(accepted.insert(id), "row {} is sent twice", id);
            }
            prop_assert_eq!(accepted.len(), total);
    }
}

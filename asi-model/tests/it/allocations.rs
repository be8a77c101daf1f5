//! Allocations of a report on its way out and in.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

use asi_model::pubsub::{
    DataSetMessage, NetworkMessage, PayloadField,
    json::{Encoding, decode, encode},
};

/// Counts the allocations of each thread.
pub struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

fn note() {
    // A thread that is ending has nothing to count for.
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        // SAFETY: the caller keeps the contract, which is the same.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract, which is the same.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        // SAFETY: the caller keeps the contract, which is the same.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

fn counted<T>(work: impl FnOnce() -> T) -> (T, usize) {
    let before = COUNT.with(Cell::get);
    let result = work();
    (result, COUNT.with(Cell::get) - before)
}

#[test]
fn a_report_takes_a_handful_of_allocations() {
    let report = NetworkMessage {
        message_id: Some("3ea281da-fad0-42e0-8c9a-713bd4257fec".parse().unwrap()),
        publisher_id: Some("FOR_MUC".into()),
        messages: vec![DataSetMessage {
            data_set_writer_id: Some(1),
            sequence_number: Some(4711),
            fields: (1..=6)
                .map(|n| PayloadField::new(format!("field{n}"), "ProgressReport"))
                .collect(),
            ..DataSetMessage::default()
        }],
        ..NetworkMessage::default()
    };
    for encoding in Encoding::ALL {
        let (bytes, count) = counted(|| encode(&report, encoding));
        assert!(count <= 2, "{count} allocations to encode as {encoding}");
        let (decoded, count) = counted(|| decode(&bytes).unwrap());
        // Names and texts are owned by the message; Verbose notes each guess.
        let limit = if encoding == Encoding::Verbose105 { 80 } else { 24 };
        assert!(count <= limit, "{count} allocations to decode {encoding}");
        drop(decoded);
    }
}

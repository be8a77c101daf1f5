//! Reports as text: the six fields of a report encoded and decoded, one thread, no I/O.

use std::{hint::black_box, time::Instant};

use anyhow::Context as _;
use asi_model::{
    pubsub::{
        DataSetMessage, MetaDataVersion, NetworkMessage, PayloadField,
        json::{Encoding, decode, encode},
    },
    values::DateTime,
};
use serde_json::Value;

use super::figures::result;

/// Rounds of which the median counts: a round that the machine interrupted does not.
const ROUNDS: usize = 51;
/// Reports of a round: long enough for the clock.
const REPORTS: u32 = 2_000;

/// Measures each encoding, and yields the slowest of them.
pub(super) fn measure() -> anyhow::Result<Vec<Value>> {
    let report = report()?;
    let (mut encoded, mut decoded) = (0.0_f64, 0.0_f64);
    for encoding in Encoding::ALL {
        let bytes = encode(&report, encoding);
        decode(&bytes).context("the report is read back")?;
        encoded = encoded.max(micros(|| drop(black_box(encode(black_box(&report), encoding)))));
        decoded = decoded.max(micros(|| drop(black_box(decode(black_box(&bytes))))));
    }
    let unit = "microseconds";
    Ok(vec![
        result("slowest report of six fields encoded", encoded, unit),
        result("slowest report of six fields decoded", decoded, unit),
    ])
}

/// Returns the time of one call, in microseconds.
fn micros(mut call: impl FnMut()) -> f64 {
    let mut rounds: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let started = Instant::now();
            (0..REPORTS).for_each(|_| call());
            started.elapsed().as_secs_f64() * 1e6 / f64::from(REPORTS)
        })
        .collect();
    rounds.sort_unstable_by(f64::total_cmp);
    rounds[ROUNDS / 2]
}

/// Makes the report of figure 4 of the DIGICOR paper, as `asi-model/benches/reports.rs` has it.
fn report() -> anyhow::Result<NetworkMessage> {
    let time = DateTime::from_ticks(131_999_999_994_123_456);
    Ok(NetworkMessage {
        message_id: Some("3ea281da-fad0-42e0-8c9a-713bd4257fec".parse()?),
        publisher_id: Some("FOR_MUC".into()),
        messages: vec![DataSetMessage {
            data_set_writer_id: Some(1),
            sequence_number: Some(4711),
            meta_data_version: Some(MetaDataVersion { major: 608_926_829, minor: 608_926_829 }),
            timestamp: Some(time),
            fields: vec![
                PayloadField::new("reportName", "ProgressReport"),
                PayloadField::new("dynamicDataRequestId", "ReqResponse1"),
                PayloadField::new("operationId", "MakeFrame1"),
                PayloadField::new("shopfloorTimestamp", time),
                PayloadField::new("progressStatus", 1_u64),
                PayloadField::new("progressStatusUnit", "PIECE"),
            ],
            ..DataSetMessage::default()
        }],
        ..NetworkMessage::default()
    })
}

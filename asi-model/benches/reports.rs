//! Cost of a report on its way out and in, and of hostile input of growing size.
//!
//! `cargo bench -p asi-model` prints times; the test in `tests/it` asserts the allocations.
#![allow(clippy::unwrap_used)]

use std::{hint::black_box, time::Duration};

use asi_model::{
    pubsub::{
        DataSetMessage, FieldRepresentation, MetaDataVersion, NetworkMessage, PayloadField,
        json::{Encoding, decode, encode},
    },
    validation::parse_any_platform_message,
    values::{DataValue, DateTime},
};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// The six fields of figure 4.
fn report() -> NetworkMessage {
    let time = DateTime::from_ticks(131_999_999_994_123_456);
    NetworkMessage {
        message_id: Some("3ea281da-fad0-42e0-8c9a-713bd4257fec".parse().unwrap()),
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
    }
}

fn reports(criterion: &mut Criterion) {
    let report = report();
    let mut pose = report.clone();
    pose.messages[0].representation = FieldRepresentation::DataValue;
    pose.messages[0].fields = (1..=6)
        .map(|axis| {
            let value = DataValue::good(
                f64::from(axis) * 12.3,
                DateTime::from_ticks(131_999_999_994_123_456),
            );
            PayloadField::with(format!("Axis{axis}.ActualPosition"), value)
        })
        .collect();
    for (name, message) in [("six fields", &report), ("six axes", &pose)] {
        for encoding in Encoding::ALL {
            let bytes = encode(message, encoding);
            criterion.bench_function(&format!("encode {name} {encoding}"), |bencher| {
                bencher.iter(|| encode(black_box(message), encoding));
            });
            criterion.bench_function(&format!("decode {name} {encoding}"), |bencher| {
                bencher.iter(|| decode(black_box(&bytes)).unwrap());
            });
        }
    }
}

/// Inputs of growing size that would hurt a careless reader; the time per byte must not grow.
fn hostile(criterion: &mut Criterion) {
    type Make = fn(usize) -> String;
    let kinds: [(&str, Make); 6] = [
        ("nesting", |bytes| "[".repeat(bytes)),
        ("many members", |bytes| {
            let members: Vec<String> = (0..bytes / 30)
                .map(|n| format!("\"k{n}\":{{\"Type\":9,\"Body\":\"1\"}}"))
                .collect();
            format!(
                "{{\"MessageType\":\"ua-data\",\"Messages\":[{{\"DataSetWriterId\":1,\"Payload\":{{{}}}}}]}}",
                members.join(",")
            )
        }),
        ("bad fields", |bytes| {
            let members: Vec<String> = (0..bytes / 30)
                .map(|n| format!("\"k{n}\":{{\"Type\":3,\"Body\":\"x\"}}"))
                .collect();
            format!(
                "{{\"MessageType\":\"ua-data\",\"Messages\":[{{\"DataSetWriterId\":1,\"Payload\":{{{}}}}}]}}",
                members.join(",")
            )
        }),
        ("same member", |bytes| format!("{{{}\"a\":1}}", "\"a\":1,".repeat(bytes / 6))),
        ("escapes", |bytes| format!("{{\"{}\":1}}", "\\u00e9".repeat(bytes / 6))),
        ("empty structures", |bytes| {
            format!(
                "{{\"a\":{{\"UaType\":22,\"Value\":[{}{{}}]}}}}",
                "{\"UaTypeId\":\"i=884\"},".repeat(bytes / 21)
            )
        }),
    ];
    let mut group = criterion.benchmark_group("hostile");
    for (name, make) in kinds {
        for bytes in [16_384, 65_536, 262_144] {
            let text = make(bytes);
            group.throughput(Throughput::Bytes(text.len() as u64));
            group.bench_with_input(BenchmarkId::new(name, bytes), &text, |bencher, text| {
                bencher.iter(|| decode(black_box(text.as_bytes())));
            });
        }
    }
    for operations in [50, 200, 800] {
        let text = chain(operations);
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_with_input(
            BenchmarkId::new("validate a chain of operations", operations),
            &text,
            |bencher, text| {
                bencher.iter(|| parse_any_platform_message(black_box(text.as_bytes())));
            },
        );
    }
    group.finish();
}

/// A request with so many operations, each depending on the one before, closed to a cycle.
fn chain(operations: usize) -> String {
    let list: Vec<String> = (0..operations)
        .map(|n| format!("{{\"operationId\":\"o{n}\",\"operationType\":\"PRODUCTION\"}}"))
        .collect();
    let relations: Vec<String> = (0..operations)
        .map(|n| {
            let next = (n + 1) % operations;
            format!(
                "{{\"operationRelationId\":\"r{n}\",\"relationType\":\"FINISH_TO_START\",\
                 \"predecessorOperationId\":\"o{n}\",\"successorOperationId\":\"o{next}\"}}"
            )
        })
        .collect();
    format!(
        "{{\"messageType\":\"operation-network\",\"messageId\":\"m\",\"factoryId\":\"F\",\"collaborationId\":\"c\",\
         \"revision\":1,\"operationNetwork\":{{\"operationNetworkId\":\"n\",\"operationList\":[{}],\
         \"operationRelationList\":[{}]}}}}",
        list.join(","),
        relations.join(",")
    )
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .measurement_time(Duration::from_secs(2))
        .warm_up_time(Duration::from_millis(500))
        .sample_size(30);
    targets = reports, hostile
}
criterion_main!(benches);

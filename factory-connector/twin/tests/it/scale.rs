//! Many interfaces, many items, many rounds. The figures printed are those of a debug build on a
//! busy machine; the bounds asserted leave room for that.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use asi_model::FieldKey;
use opcua_stack::opcua::types::{BrowseDirection, NodeId};
use twin::AsiDocument;

use crate::harness::{
    Client, DEADLINE, TestTwin, document, external, good, instance, message, next,
};

const NETWORKS: usize = 10_000;
const FIELDS_PER_NETWORK: usize = 10;

/// Runs a test in a separate process, so that other tests do not use the same memory. Returns false
/// in that process, which then runs the test itself.
async fn is_done_alone(test: &str) -> bool {
    const ALONE: &str = "TWIN_TEST_ALONE";
    if std::env::var_os(ALONE).is_some() {
        return false;
    }
    let mut command = tokio::process::Command::new(std::env::current_exe().unwrap());
    command
        .args([&format!("scale::{test}"), "--exact", "--nocapture"])
        .env(ALONE, "yes")
        .kill_on_drop(true);
    let output =
        tokio::time::timeout(Duration::from_secs(300), command.output()).await.unwrap().unwrap();
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    true
}

/// Returns a document that shares no text with another: one operation, one request, some fields.
fn large_document(network: usize, fields: usize) -> AsiDocument {
    let mut message = message(&format!("network-{network}"), 1);
    let operation = &mut message.operation_network.operation_list[0];
    let format = &mut operation.dynamic_data_request_list[0].report_data_format;
    let template = format.report_field_list[0].clone();
    format.report_field_list = (0..fields)
        .map(|field| asi_model::network::ReportField {
            name: format!("field{field}").parse().unwrap(),
            unit: template.unit.clone(),
            ..template.clone()
        })
        .collect();
    let mut document = document(message);
    let keys: Vec<FieldKey> =
        document.message.operation_network.fields().map(|(key, _, _)| key).collect();
    let record = |key: FieldKey| {
        let value = Some(good(1));
        (key, twin::FieldRecord { value, reason: Some("as agreed".into()), ..external() })
    };
    document.fields = keys.into_iter().map(record).collect();
    document
}

/// Resident memory of this process in bytes.
fn resident() -> usize {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap();
    statm.split(' ').nth(1).unwrap().parse::<usize>().unwrap() * 4096
}

fn percentile(sorted: &[Duration], percent: usize) -> Duration {
    sorted[(sorted.len() - 1) * percent / 100]
}

/// Returns the median time to browse a small interface.
async fn browse_time(client: &Client) -> Duration {
    let mut times = Vec::new();
    for _ in 0..100 {
        let start = Instant::now();
        client.browse(instance("small#OperationNetwork"), BrowseDirection::Forward).await;
        times.push(start.elapsed());
    }
    times.sort();
    percentile(&times, 50)
}

/// Reads a property until all documents are added, at least 100 times. Returns the times of the
/// reads in ascending order, and the time to add the documents.
async fn read_while_adding(
    twin: &TestTwin,
    client: &Client,
    documents: Vec<AsiDocument>,
) -> (Vec<Duration>, Duration) {
    let is_done = Arc::new(AtomicBool::new(false));
    let adding = {
        let (handle, is_done) = (twin.handle.clone(), Arc::clone(&is_done));
        tokio::task::spawn_blocking(move || {
            let start = Instant::now();
            for document in documents {
                handle.apply(document);
            }
            is_done.store(true, Ordering::Release);
            start.elapsed()
        })
    };
    let mut reads = Vec::new();
    while !is_done.load(Ordering::Acquire) || reads.len() < 100 {
        let start = Instant::now();
        assert!(client.read("small#Revision").await.status().is_good());
        reads.push(start.elapsed());
    }
    reads.sort();
    (reads, adding.await.unwrap())
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_hundred_thousand_fields_do_not_slow_down_clients() {
    if is_done_alone("a_hundred_thousand_fields_do_not_slow_down_clients").await {
        return;
    }
    let twin = TestTwin::start().await;
    twin.handle.apply(document(message("small", 1)));
    let client = twin.client("vera").await;
    let browse_alone = browse_time(&client).await;

    // Made beforehand, so that only the twin's own memory and time count.
    let documents: Vec<_> = (0..NETWORKS).map(|n| large_document(n, FIELDS_PER_NETWORK)).collect();
    let before = resident();
    let (reads, added_in) = read_while_adding(&twin, &client, documents).await;
    let grown = resident().saturating_sub(before);
    let browse_among_many = browse_time(&client).await;
    println!(
        "adding {} fields took {added_in:?}, reads meanwhile p50 {:?} p99 {:?} max {:?}; beyond their documents they \
         take {} bytes a field; browsing one interface takes {browse_alone:?} alone, {browse_among_many:?} among \
         {NETWORKS}",
        NETWORKS * FIELDS_PER_NETWORK,
        percentile(&reads, 50),
        percentile(&reads, 99),
        percentile(&reads, 100),
        grown / (NETWORKS * FIELDS_PER_NETWORK),
    );
    assert!(percentile(&reads, 95) < Duration::from_millis(20), "readers are not blocked");
    assert!(
        browse_among_many < 3 * browse_alone + Duration::from_millis(5),
        "browsing does not depend on the number of interfaces"
    );
    let folder =
        client.browse(instance("#CollaborativeProcessTwin"), BrowseDirection::Forward).await;
    assert_eq!(folder.len(), NETWORKS + 3, "the folder lists all, its property and its type");
    let last = client
        .read(&format!("network-{}/op/MakeFrame1/req/ReqResponse1/field9", NETWORKS - 1))
        .await;
    assert_eq!(last.value, Some(1_u64.into()));
    check_memory_is_reused(&twin);
    client.close().await;
    twin.stop().await;
}

/// Replaces all networks by as many others, for which the memory of the removed ones must suffice:
/// the allocator does not return it to the system.
fn check_memory_is_reused(twin: &TestTwin) {
    let full = resident();
    let start = Instant::now();
    for network in 0..NETWORKS {
        assert!(twin.handle.remove(&format!("network-{network}").parse().unwrap()));
    }
    let removed_in = start.elapsed();
    for network in NETWORKS..2 * NETWORKS {
        twin.handle.apply(large_document(network, FIELDS_PER_NETWORK));
    }
    let again = resident();
    println!(
        "removing all took {removed_in:?}; {} MiB before, {} MiB with as many others",
        full >> 20,
        again >> 20
    );
    assert!(again < full + full / 10, "the memory of removed networks is reused");
}

#[tokio::test]
async fn memory_is_reused_and_does_not_grow_over_rounds() {
    if is_done_alone("memory_is_reused_and_does_not_grow_over_rounds").await {
        return;
    }
    let twin = TestTwin::start().await;
    let fields = 200 * FIELDS_PER_NETWORK;
    let empty = resident();
    let round = |twin: &TestTwin| {
        for network in 0..200 {
            twin.handle.apply(large_document(network, FIELDS_PER_NETWORK));
        }
        let full = resident();
        for network in 0..200 {
            assert!(twin.handle.remove(&format!("network-{network}").parse().unwrap()));
        }
        full
    };
    let first = round(&twin);
    let mut later = first;
    for _ in 0..100 {
        later = round(&twin);
    }
    println!(
        "{fields} fields with their documents take {} bytes each; after 100 rounds more the process has grown by {} \
         KiB",
        first.saturating_sub(empty) / fields,
        later.saturating_sub(first) / 1024
    );
    assert!(
        later < first + 8 * 1024 * 1024,
        "rounds of adding and removing do not grow the process"
    );
    twin.stop().await;
}

#[tokio::test]
async fn fifty_thousand_items_change_in_one_tick_and_none_is_lost() {
    const ITEMS: usize = 50_000;
    const ROUNDS: u64 = 3;
    let twin = TestTwin::start().await;
    let mut keys = Vec::new();
    for network in 0..ITEMS / 500 {
        let document = large_document(network, 500);
        keys.extend(document.message.operation_network.fields().map(|(key, _, _)| key));
        twin.handle.apply(document);
    }
    let client = twin.client("vera").await;
    let id = |key: &FieldKey| -> NodeId {
        instance(&format!(
            "{}/op/MakeFrame1/req/ReqResponse1/{}",
            key.request.operation_network_id, key.field_name
        ))
    };
    let nodes: Vec<NodeId> = keys.iter().map(id).collect();
    let mut changes = client.subscribe(&nodes).await;
    let mut heard = vec![Vec::new(); ITEMS];
    for _ in 0..ITEMS {
        next(&mut changes).await;
    }
    let start = Instant::now();
    for round in 2..2 + ROUNDS {
        let values = keys.iter().map(|key| (key.clone(), good(round))).collect();
        assert_eq!(twin.handle.publish_values(values), ITEMS);
    }
    for _ in 0..ITEMS * usize::try_from(ROUNDS).unwrap() {
        let (item, value) = next(&mut changes).await;
        heard[item as usize].push(value.value.unwrap());
    }
    println!("{ITEMS} items changed {ROUNDS} times were heard in {:?}", start.elapsed());
    let expected: Vec<_> = (2..2 + ROUNDS).map(opcua_stack::opcua::types::Variant::from).collect();
    assert!(heard.iter().all(|values| *values == expected), "nothing is lost, nothing reordered");
    client.close().await;
    twin.stop().await;
}

#[tokio::test]
async fn subscriptions_come_and_go_without_a_trace() {
    if is_done_alone("subscriptions_come_and_go_without_a_trace").await {
        return;
    }
    let twin = TestTwin::start().await;
    let document = large_document(0, 100);
    let keys: Vec<FieldKey> =
        document.message.operation_network.fields().map(|(key, _, _)| key).collect();
    twin.handle.apply(document);
    let nodes: Vec<NodeId> = keys
        .iter()
        .map(|key| {
            instance(&format!("network-0/op/MakeFrame1/req/ReqResponse1/{}", key.field_name))
        })
        .collect();
    let client = twin.client("vera").await;
    let mut settled = 0;
    for round in 0..1000 {
        drop(client.subscribe(&nodes).await);
        let ids = client.session.subscription_state().lock().subscription_ids().unwrap_or_default();
        for id in ids {
            client.session.delete_subscription(id).await.unwrap();
        }
        if round == 200 {
            settled = resident();
        }
    }
    let grown = resident().saturating_sub(settled);
    println!(
        "800 subscriptions of 100 items each came and went; the process grew by {} KiB",
        grown / 1024
    );
    // The 80 000 entries that the unpatched stack kept were 12 MiB.
    assert!(grown < 6 * 1024 * 1024, "subscriptions leave nothing behind");
    client.close().await;
    twin.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_change_is_heard_at_the_next_publishing() {
    let twin = TestTwin::start().await;
    let document = large_document(0, 1);
    let key = document.message.operation_network.fields().next().unwrap().0;
    twin.handle.apply(document);
    let client = twin.client("vera").await;
    let mut changes =
        client.subscribe(&[instance("network-0/op/MakeFrame1/req/ReqResponse1/field0")]).await;
    next(&mut changes).await;
    let mut times = Vec::new();
    for value in 2..202_u64 {
        let start = Instant::now();
        twin.handle.publish_values(vec![(key.clone(), good(value))]);
        assert_eq!(next(&mut changes).await.1.value, Some(value.into()));
        times.push(start.elapsed());
        assert!(start.elapsed() < DEADLINE);
    }
    times.sort();
    let median = percentile(&times, 50);
    println!("change to notification: p50 {median:?}, p99 {:?}", percentile(&times, 99));
    assert!(
        median < Duration::from_millis(50),
        "at the next publishing of a subscription of 10 ms"
    );
    client.close().await;
    twin.stop().await;
}

//! Hostile input costs time linear in its size: four times the size takes about four times as long.

use std::time::{Duration, Instant};

use asi_model::{
    node_set,
    pubsub::json::decode,
    validation::{parse_any_platform_message, parse_factory_message},
};

/// The quickest of several runs, which disturbances of the machine touch least.
fn quickest(work: &dyn Fn()) -> Duration {
    (0..4)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed()
        })
        .min()
        .unwrap()
}

fn fields(count: usize) -> String {
    let fields: Vec<String> =
        (0..count).map(|n| format!("{{\"name\":\"f{n}\",\"type\":99,\"unit\":\"?\"}}")).collect();
    format!(
        "{{\"messageType\":\"operation-network\",\"operationNetwork\":{{\"operationList\":[{{\
         \"dynamicDataRequestList\":[{{\"reportDataFormat\":{{\"reportFieldList\":[{}]}}}}]}}]}}}}",
        fields.join(",")
    )
}

fn payload(count: usize) -> String {
    let members: Vec<String> =
        (0..count).map(|n| format!("\"k{n}\":{{\"Type\":3,\"Body\":\"x\"}}")).collect();
    format!(
        "{{\"MessageType\":\"ua-data\",\"Messages\":[{{\"Payload\":{{{}}}}}]}}",
        members.join(",")
    )
}

fn repeated(count: usize) -> String {
    format!("{{{}\"a\":1}}", "\"a\":1,".repeat(count))
}

fn structures(count: usize) -> String {
    format!(
        "{{\"a\":{{\"UaType\":22,\"Value\":[{}{{}}]}}}}",
        "{\"UaTypeId\":\"i=12079\"},".repeat(count)
    )
}

fn xml(count: usize) -> String {
    let nodes: String =
        (0..count).map(|n| format!("<UAObject NodeId=\"i={n}\" BrowseName=\"a\"/>")).collect();
    format!("<UANodeSet>{nodes}</UANodeSet>")
}

fn attributes(count: usize) -> String {
    format!("<UANodeSet {}/>", (0..count).map(|n| format!("a{n}=\"\" ")).collect::<String>())
}

/// Many operations that claim the same request with many fields.
fn shared(count: usize) -> String {
    let node = |kind: &str, id: &str, references: &str| {
        format!(
            "<{kind} NodeId=\"{id}\" BrowseName=\"{id}\"><References>{references}</References></{kind}>"
        )
    };
    let reference = |kind: &str, forward: bool, id: &str| {
        format!("<Reference ReferenceType=\"{kind}\" IsForward=\"{forward}\">{id}</Reference>")
    };
    let typed = |id: u32| reference("i=40", true, &format!("ns=1;i={id}"));
    let mut nodes = node("UAObject", "ns=2;s=n", &typed(1001));
    nodes += &node("UAObject", "ns=2;s=n#", &(typed(1002) + &reference("i=47", false, "ns=2;s=n")));
    nodes += &node("UAObject", "ns=2;s=r", &typed(1010));
    nodes += &node("UAObject", "ns=2;s=f", &(typed(1011) + &reference("i=47", false, "ns=2;s=r")));
    for n in 0..count {
        let owned = reference("i=47", false, "ns=2;s=n#") + &reference("i=47", true, "ns=2;s=r");
        nodes += &node("UAObject", &format!("ns=2;s=o{n}"), &(typed(1004) + &owned));
        nodes +=
            &node("UAVariable", &format!("ns=2;s=f{n}"), &reference("i=47", false, "ns=2;s=f"));
    }
    let uris = "<Uri>urn:verbund:UA:ASI</Uri><Uri>urn:verbund:cpt:F</Uri>";
    format!("<UANodeSet><NamespaceUris>{uris}</NamespaceUris>{nodes}</UANodeSet>")
}

#[test]
fn hostile_input_costs_linear_time() {
    type Make = fn(usize) -> String;
    let makers: [(&str, Make, usize); 7] = [
        ("attributes", attributes, 10_000),
        ("fields", fields, 4_000),
        ("payload", payload, 4_000),
        ("repeated members", repeated, 8_000),
        ("structures", structures, 2_000),
        ("node set", xml, 4_000),
        ("shared nodes", shared, 400),
    ];
    for (name, make, count) in makers {
        let time_of = |count: usize| {
            let text = make(count);
            quickest(&|| {
                let bytes = text.as_bytes();
                let _ = decode(bytes);
                let _ = parse_any_platform_message(bytes);
                let _ = parse_factory_message(bytes);
                let _ = node_set::read(bytes);
            })
        };
        // Four times the size; a quadratic reader would need sixteen times as long. Several tries,
        // should the machine be busy with something else in one of them.
        let mut ratios = Vec::new();
        for _ in 0..5 {
            let ratio = time_of(4 * count).as_secs_f64() / time_of(count).as_secs_f64().max(1e-9);
            ratios.push(ratio);
            if ratio < 8.0 {
                break;
            }
        }
        assert!(ratios.last().is_some_and(|ratio| *ratio < 8.0), "{name}: {ratios:?}");
    }
}

//! The command as partners use it: files, standard input, outputs and exit codes.
#![allow(clippy::unwrap_used)]

mod access;
mod ledger;
mod shown;

use std::{
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

struct Run {
    code: i32,
    out: String,
    err: String,
}

fn asi(arguments: &[&str], input: &str) -> Run {
    let mut child = Command::new(env!("CARGO_BIN_EXE_asi"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A command that does not read its input may be gone already.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    let output = child.wait_with_output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    Run {
        code: output.status.code().unwrap(),
        out: text(&output.stdout),
        err: text(&output.stderr),
    }
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

fn path(name: &str) -> String {
    example(name).to_str().unwrap().to_owned()
}

#[test]
fn every_example_is_valid_and_explained() {
    let mut count = 0;
    for entry in std::fs::read_dir(example("")).unwrap() {
        let file = entry.unwrap().path();
        let file = file.to_str().unwrap();
        let run = asi(&["validate", file], "");
        assert_eq!(run.code, 0, "{file}: {}", run.out);
        assert!(run.out.ends_with('\n') && run.out.contains("valid: "), "{}", run.out);
        let run = asi(&["explain", file], "");
        assert_eq!((run.code, run.out.is_empty()), (0, false), "{file}: {}", run.err);
        count += 1;
    }
    assert!(count > 20);
}

#[test]
fn faults_end_with_one_and_troubles_with_two() {
    for (arguments, input, code, part) in [
        (
            vec!["validate"],
            r#"{"messageType":"withdraw"}"#,
            1,
            "/revision: The member revision is missing. [MISSING_MEMBER]",
        ),
        (vec!["validate", "-"], "frames!", 1, "[NOT_JSON]"),
        (
            vec!["validate"],
            r#"{"Messages":[{"Payload":{"a":{"Type":1,"Body":"false"}}}]}"#,
            0,
            "note: ",
        ),
        (
            vec!["validate", "--strict"],
            r#"{"MessageType":"ua-data","Messages":[{"Payload":{"a":{"Type":1,"Body":"no"}}}]}"#,
            1,
            "[DEVIATION]",
        ),
        (
            vec!["validate", "--factory", "OTHER", &path("operation-network.json")],
            "",
            1,
            "[WRONG_FACTORY]",
        ),
        (vec!["nodeset", "types"], "", 0, "ActivityStatusInterfaceType"),
        (vec!["explain"], r#"{"messageType":"gap"}"#, 1, "MISSING_MEMBER"),
    ] {
        let run = asi(&arguments, input);
        assert_eq!(run.code, code, "{arguments:?}: {} {}", run.out, run.err);
        assert!(run.out.contains(part), "{arguments:?}: {}", run.out);
    }
    for arguments in [
        vec!["validate", "/does/not/exist"],
        vec!["convert", "--to", "uadp"],
        vec!["nodeset", "instance", &path("ua-data.json")],
        vec!["validate", "--factory", "a b"],
        vec!["rubbish"],
    ] {
        let run = asi(&arguments, "");
        // A PubSub message where a request is needed is a fault of the input.
        let expected = if arguments[0] == "nodeset" { 1 } else { 2 };
        assert_eq!((run.code, run.err.is_empty()), (expected, false), "{arguments:?}: {}", run.out);
    }
}

#[test]
fn the_acknowledgement_is_printed() {
    let run = asi(&["validate", "--json", &path("operation-network.json")], "");
    let message: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(message["result"], "ACCEPTED");
    assert_eq!(message["correlationId"], "0190c0de-0000-7000-8000-000000000001");
    let text = std::fs::read_to_string(example("operation-network.json"))
        .unwrap()
        .replace("\"type\": 9", "\"type\": 99");
    let run = asi(&["validate", "--json", "--factory", "FOR_MUC"], &text);
    assert_eq!(run.code, 1);
    let message: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(message["result"], "REJECTED");
    assert_eq!(message["faultList"][0]["code"], "UNKNOWN_TYPE");
    // What is printed is itself a valid message.
    let again = asi(&["validate"], &run.out);
    assert_eq!(again.code, 0, "{}", again.out);
}

/// The example of a request with a text in place of another.
fn changed_request(from: &str, to: &str) -> String {
    let text = std::fs::read_to_string(example("operation-network.json")).unwrap();
    assert!(text.contains(from));
    text.replacen(from, to, 1)
}

#[test]
fn what_is_no_message_is_refused() {
    let misspelt = changed_request("\"messageType\"", "\"MessageType\"");
    let batch = r#"[{"MessageType":"ua-data","Messages":[]}]"#;
    for (input, expected) in [
        ("{}", "/messageType: The member messageType is missing. [MISSING_MEMBER]"),
        ("[]", "A message must be an object, but is an array. [WRONG_TYPE]"),
        (
            r#"{"messagetype":"withdraw"}"#,
            "/messageType: The member messageType is missing; messagetype differs from it in capitals.",
        ),
        (
            &misspelt,
            "/messageType: The member messageType is missing; MessageType differs from it in capitals.",
        ),
        (r#"{"MessageId":"1","PublisherId":"p"}"#, "/Messages: The message has neither Messages"),
        (
            r#"{"MessageId":"1","messages":[]}"#,
            "/Messages: The member Messages is missing; messages differs from it in capitals.",
        ),
        (
            r#"{"MessageType":"order","Messages":[]}"#,
            "/MessageType: the MessageType of a message with Messages must be ua-data",
        ),
        (
            r#"{"DataSetWriterId":1,"Payload":5}"#,
            "/Messages: The message has neither Messages (or MetaData or Status, with its MessageType) \
             nor an object as Payload; --payload takes it for a payload itself. [MISSING_MEMBER]",
        ),
        (batch, "/0: NetworkMessages must not be in an array"),
        (r#"{"body":{"Messages":[]},"enqueuedTime":"now"}"#, "/messageType: The member"),
        ("\u{feff}{}", "the byte order mark (U+FEFF) at byte 0. [NOT_JSON]"),
        ("\u{feff}{\"MessageType\":\"ua-data\"}", "the byte order mark (U+FEFF)"),
    ] {
        let run = asi(&["validate"], input);
        assert_eq!(run.code, 1, "{input}: {}", run.out);
        assert!(run.out.contains(expected), "{input}: {}", run.out);
        // What a connector answers says the same.
        let answer = asi(&["validate", "--json"], input);
        let answered: serde_json::Value = serde_json::from_str(&answer.out).unwrap();
        assert_eq!((answer.code, &answered["result"]), (1, &"REJECTED".into()), "{input}");
        assert_ne!(answered["faultList"], serde_json::json!([]));
    }
    // A layout without headers has nothing to be recognised by.
    for (arguments, code) in [
        (vec!["validate"], 1),
        (vec!["validate", "--payload"], 0),
        (vec!["explain", "--payload"], 0),
    ] {
        let run = asi(&arguments, r#"{"temperature":{"Type":11,"Body":21.5}}"#);
        assert_eq!(run.code, code, "{arguments:?}: {}", run.out);
    }
}

#[test]
fn messages_of_other_products_are_judged() {
    const REFUSED: [&str; 7] = [
        "opc-publisher.batch.json",
        "opc-publisher.event.json",
        "opc-publisher.metadata-batch.json",
        "opc-publisher.metadata-names.json",
        // No message of PubSub; decoding without headers would take it for a payload.
        "opc-publisher.samples.json",
        "open62541.null-payload.json",
        "ua-netstandard.header-alone.json",
    ];
    let mut refused = Vec::new();
    for entry in std::fs::read_dir(example("../tests/foreign-messages")).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_some_and(|extension| extension == "json") {
            let run = asi(&["validate", file.to_str().unwrap()], "");
            if run.code != 0 {
                assert_eq!(run.code, 1, "{}: {}", file.display(), run.err);
                refused.push(file.file_name().unwrap().to_str().unwrap().to_owned());
            }
        }
    }
    refused.sort();
    assert_eq!(refused, REFUSED);
}

#[test]
fn a_rejection_is_by_the_factory_that_is_named() {
    let text = changed_request("\"revision\": 3", "\"revision\": \"x\"");
    for (arguments, expected) in [
        (vec!["validate", "--json"], "FOR_MUC"),
        (vec!["validate", "--json", "--factory", "LOG_NUE"], "LOG_NUE"),
    ] {
        let run = asi(&arguments, &text);
        let message: serde_json::Value = serde_json::from_str(&run.out).unwrap();
        assert_eq!((run.code, &message["factoryId"]), (1, &expected.into()), "{}", run.out);
    }
    let run = asi(&["validate", "--json"], "{}");
    assert!(run.out.contains("\"factoryId\": \"unknown\""), "{}", run.out);
}

#[test]
fn bare_values_are_no_deviation() {
    let (verbose, known) = (path("ua-data.1.05-verbose.json"), path("ua-metadata.1.05.json"));
    let run = asi(&["validate", "--strict", &verbose], "");
    assert_eq!(run.code, 0, "{}", run.out);
    assert!(run.out.contains("its type is a guess"), "{}", run.out);
    let run = asi(&["validate", "--strict", "--meta-data", &known, &verbose], "");
    assert_eq!(run.code, 0, "{}", run.out);
    assert!(!run.out.contains("progressStatus:"), "{}", run.out);
    // Metadata also shows what does not fit it.
    let text = std::fs::read_to_string(&verbose).unwrap().replace("\"1\"", "\"one\"");
    assert_eq!(asi(&["validate", "--strict"], &text).code, 0);
    let run = asi(&["validate", "--strict", "--meta-data", &known], &text);
    assert_eq!(run.code, 1, "{}", run.out);
    assert!(run.out.contains("/Messages/0/Payload/progressStatus: "), "{}", run.out);
}

#[test]
fn pointers_of_an_explanation_are_escaped() {
    let gap = std::fs::read_to_string(example("gap.json")).unwrap();
    let gap = gap.replacen('{', r#"{"a/b~c":1,"#, 1);
    let run = asi(&["explain"], &gap);
    assert!(run.out.contains("/a~1b~0c: 1\n"), "{} {}", run.out, run.err);
}

#[test]
fn encodings_convert_into_each_other() {
    let digicor: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(example("ua-data.json")).unwrap()).unwrap();
    let compact = asi(&["convert", "--to", "1.05-compact", &path("ua-data.json")], "");
    assert_eq!((compact.code, compact.err.as_str()), (0, ""));
    assert!(
        compact.out.contains(r#""progressStatus":{"UaType":9,"Value":"1"}"#),
        "{}",
        compact.out
    );
    let back = asi(&["convert", "--to", "digicor"], &compact.out);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&back.out).unwrap(), digicor);
    // Bare values need the metadata's types.
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("verbose.json");
    let verbose = asi(&["convert", "--to", "1.05-verbose", &path("ua-data.json")], "");
    std::fs::write(&file, &verbose.out).unwrap();
    let guessed = asi(&["convert", "--to", "digicor", file.to_str().unwrap()], "");
    assert!(
        guessed.out.contains(r#""progressStatus":{"Type":12,"Body":"1"}"#)
            && guessed.err.contains("guess")
    );
    let converted = asi(
        &[
            "convert",
            "--to",
            "digicor",
            "--meta-data",
            &path("ua-metadata.json"),
            file.to_str().unwrap(),
        ],
        "",
    );
    assert!(
        converted.out.contains(r#""progressStatus":{"Type":9,"Body":"1"}"#),
        "{}",
        converted.out
    );
    let explained =
        asi(&["explain", "--meta-data", &path("ua-metadata.json"), &path("ua-data.json")], "");
    assert!(
        explained.out.contains("progressStatus: UInt64 \"1\" piece (PRODUCED_QUANTITY)"),
        "{}",
        explained.out
    );
}

#[test]
fn interfaces_go_to_node_sets_and_back() {
    let nodes = asi(&["nodeset", "instance", &path("operation-network.transportation.json")], "");
    assert_eq!(nodes.code, 0, "{}", nodes.err);
    assert_eq!(asi(&["validate"], &nodes.out).code, 0);
    let back = asi(&["nodeset", "read"], &nodes.out);
    let message: serde_json::Value = serde_json::from_str(&back.out).unwrap();
    assert_eq!(message["operationNetwork"]["operationList"][0]["destination"], "Hamburg");
    assert_eq!(message["factoryId"], "LOG_NUE");
}

#[test]
fn schemas_are_written() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(asi(&["schema", folder.path().to_str().unwrap()], "").code, 0);
    assert!(folder.path().join("operation-network.schema.json").exists());
}

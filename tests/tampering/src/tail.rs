//! Forged entries at the end, which excuse what was done to those before.

use serde_json::{Value, json};
use transparency_log::leaf_hash;

use crate::{file::AuditFile, kinds::Kinds, signer::Signer};

/// Time of the forged entries.
const LATER: &str = "2100-01-01T00:00:00Z";

pub(crate) fn try_all(file: &AuditFile, kinds: &mut Kinds<'_>) {
    let mut forge = |name: &str, forged: &Forged| {
        for signer in Signer::ALL {
            let name = format!("{name}, {}", signer.name());
            kinds.attempt(&name, &forged.lines(file, signer), &file.checkpoint);
        }
    };
    for index in 1..file.lines.len() {
        let line = file.line(index);
        let range = range(&file.entry(index));
        if !line["report"].is_null() {
            emptied(file, index, &range, &mut forge);
            delivered(file, index, &range, &mut forge);
        }
    }
    pruned(file, &mut forge);
    added(file, &mut forge);
}

/// Lines with entries that were appended.
struct Forged {
    lines: Vec<String>,
    events: Vec<Value>,
}

impl Forged {
    fn lines(&self, file: &AuditFile, signer: Signer) -> Vec<String> {
        let last = file.lines.len() - 1;
        let number = file.entry(last)["number"].as_u64().expect("a number");
        let mut leaves = file.leaves_until(file.lines.len());
        let mut lines = self.lines.clone();
        for (number, event) in (number + 1..).zip(&self.events) {
            let mut entry = json!({ "recipient": file.entry(last)["recipient"], "number": number,
                                    "recordedAt": LATER });
            let members = event.as_object().expect("an event");
            entry.as_object_mut().expect("an object").extend(members.clone());
            let entry = entry.to_string();
            leaves.append(leaf_hash(entry.as_bytes()));
            let line = json!({ "entry": entry, "report": null, "salt": null, "sentAt": null,
                               "messageId": null, "deliveredAt": null });
            lines.push(line.to_string());
        }
        let mut start: Value = serde_json::from_str(&lines[0]).expect("JSON");
        signer.sign(file, &mut start, &leaves);
        lines[0] = start.to_string();
        lines
    }
}

type Forge<'a> = dyn FnMut(&str, &Forged) + 'a;

/// Values emptied, with a statement of their retention.
fn emptied(file: &AuditFile, index: usize, range: &Value, forge: &mut Forge<'_>) {
    let mut line = file.line(index);
    line["report"] = Value::Null;
    line["salt"] = Value::Null;
    let lines = file.with(index, &line);
    let mut whole = range.clone();
    whole["firstSequence"] = json!(0);
    whole["lastSequence"] = json!(u32::MAX);
    for (name, rule, ranges) in [
        ("with a statement", "VALUE_DAYS", json!([range])),
        ("with a statement about all of the writer", "VALUE_DAYS", json!([whole])),
        ("as if by a former version", "FORMER_VERSION", json!([range])),
        ("with a statement of another rule", "ENTRY_DAYS", json!([range])),
    ] {
        let statement =
            json!({ "event": "RETENTION", "rule": rule, "before": LATER, "emptied": ranges });
        let forged = Forged { lines: lines.clone(), events: vec![statement] };
        forge(&format!("{}: values emptied {name}", file.kind(index)), &forged);
    }
}

/// Deliveries said otherwise, with the entries that would say so.
fn delivered(file: &AuditFile, index: usize, range: &Value, forge: &mut Forge<'_>) {
    let event = |name: &str| {
        let mut event = json!({ "event": name });
        event.as_object_mut().expect("an object").extend(range.as_object().expect("one").clone());
        event
    };
    let kind = file.kind(index);
    let mut attempt = |name: &str, change: &dyn Fn(&mut Value), events: Vec<Value>| {
        let mut line = file.line(index);
        change(&mut line);
        let lines = file.with(index, &line);
        forge(&format!("{kind}: {name}"), &Forged { lines, events });
    };
    let mut in_message = event("SENT");
    in_message["messageId"] = json!("forged");
    attempt("sent later", &|line| line["sentAt"] = json!(LATER), vec![event("SENT")]);
    let sent_in = |line: &mut Value| {
        line["sentAt"] = json!(LATER);
        line["messageId"] = json!("forged");
    };
    attempt("sent in another message", &sent_in, vec![in_message.clone()]);
    attempt(
        "delivered later",
        &|line| line["deliveredAt"] = json!(LATER),
        vec![event("RECEIPTED")],
    );
    let all = |line: &mut Value| {
        sent_in(line);
        line["deliveredAt"] = json!(LATER);
    };
    attempt("sent and delivered later", &all, vec![in_message, event("RECEIPTED")]);
}

/// The first entries cut off, with the genuine leaves in their place and a statement of it.
fn pruned(file: &AuditFile, forge: &mut Forge<'_>) {
    let proven = usize::try_from(file.kept().size).expect("a small file");
    for count in 1..proven {
        let leaves = file.leaves_until(count + 1);
        let mut start = file.line(0);
        start["number"] = json!(count);
        start["leaves"] = leaves.hashes().iter().map(hex::encode).collect();
        let mut lines = file.lines.clone();
        lines.drain(1..=count);
        lines[0] = start.to_string();
        for (name, rule) in
            [("after days", "ENTRY_DAYS"), ("by a former version", "FORMER_VERSION")]
        {
            let statement = json!({ "event": "RETENTION", "rule": rule, "before": LATER,
                                    "removedThrough": count });
            let forged = Forged { lines: lines.clone(), events: vec![statement] };
            forge(&format!("entries removed {name}"), &forged);
        }
        forge("entries removed without a statement", &Forged { lines, events: Vec::new() });
    }
}

/// Entries of each kind added, as if more had happened.
fn added(file: &AuditFile, forge: &mut Forge<'_>) {
    for index in 1..file.lines.len() {
        let mut event = file.entry(index);
        let name = event["event"].as_str().expect("a name").to_owned();
        let members = event.as_object_mut().expect("an entry");
        for member in ["recipient", "number", "recordedAt"] {
            members.shift_remove(member);
        }
        let forged = Forged { lines: file.lines.clone(), events: vec![event] };
        forge(&format!("{name} once more"), &forged);
    }
}

/// Returns the reports that an entry is about.
fn range(entry: &Value) -> Value {
    let mut range = json!({});
    for member in ["dataSetWriterId", "epoch", "firstSequence", "lastSequence"] {
        range[member] = entry[member].clone();
    }
    range
}

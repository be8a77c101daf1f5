//! Tampering of every kind with an audit file, its checkpoint and its key.

use std::collections::BTreeSet;

use super::*;

/// Kinds of tampering that were tried and not found, and the number of all.
#[derive(Default)]
struct Attempts {
    names: BTreeSet<String>,
    missed: Vec<String>,
}

impl Attempts {
    fn note(&mut self, name: String, faults: u64) {
        if faults == 0 {
            self.missed.push(name.clone());
        }
        assert!(self.names.insert(name.clone()), "{name} is tried once");
    }
}

/// Returns all places in a document, as JSON pointers.
fn places(value: &Value, pointer: &str, into: &mut Vec<String>) {
    let mut inner = |name: &str, value: &Value| {
        let pointer = format!("{pointer}/{name}");
        into.push(pointer.clone());
        places(value, &pointer, into);
    };
    match value {
        Value::Object(members) => members.iter().for_each(|(name, value)| inner(name, value)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(index, item)| inner(&index.to_string(), item));
        }
        _ => {}
    }
}

fn changed(value: &Value) -> Value {
    match value {
        Value::Null => json!("1970-01-01T00:00:07Z"),
        Value::Bool(flag) => json!(!flag),
        Value::Number(number) => json!(number.as_i64().unwrap_or_default() + 1),
        Value::String(text) if text.parse::<DateTime>().is_ok() => json!("1999-01-01T00:00:00Z"),
        Value::String(text) if text.ends_with('0') => {
            json!(format!("{}1", &text[..text.len() - 1]))
        }
        Value::String(text) => json!(format!("{}0", &text[..text.len() - 1])),
        Value::Array(items) => json!([items.clone(), vec![json!("x")]].concat()),
        Value::Object(members) => {
            let mut members = members.clone();
            members.insert("added".to_owned(), json!(1));
            Value::Object(members)
        }
    }
}

fn remove(value: &mut Value, pointer: &str) {
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    match value.pointer_mut(parent).expect("a parent") {
        Value::Object(members) => drop(members.shift_remove(name)),
        Value::Array(items) => drop(items.remove(name.parse().expect("an index"))),
        _ => {}
    }
}

/// Each member of each kind of line changed, removed, and added to.
fn members(sample: &Sample, attempts: &mut Attempts) {
    let mut seen = BTreeSet::new();
    for (index, line) in sample.lines.iter().enumerate() {
        let line: Value = serde_json::from_str(line).expect("JSON");
        let entry: Value = line["entry"]
            .as_str()
            .map_or(Value::Null, |text| serde_json::from_str(text).expect("JSON"));
        let kind = entry["event"].as_str().unwrap_or("START").to_owned();
        if !seen.insert(kind.clone()) {
            continue;
        }
        let mut attempt = |name: String, line: &Value| {
            let mut lines = sample.lines.clone();
            lines[index] = line.to_string();
            attempts.note(name, faults(&lines, &sample.checkpoint(), &vkey(&key())));
        };
        for (part, document) in [("line", &line), ("entry", &entry)] {
            let put = |document: Value| match part {
                "line" => document,
                _ => {
                    let mut line = line.clone();
                    line["entry"] = json!(document.to_string());
                    line
                }
            };
            let mut pointers = Vec::new();
            places(document, "", &mut pointers);
            for pointer in pointers {
                let mut other = document.clone();
                let place = other.pointer_mut(&pointer).expect("a place");
                let is_absent = place.is_null();
                *place = changed(place);
                attempt(format!("{kind}: {part} {pointer} changed"), &put(other));
                if !is_absent {
                    let mut other = document.clone();
                    remove(&mut other, &pointer);
                    attempt(format!("{kind}: {part} {pointer} removed"), &put(other));
                }
            }
            if document.is_object() {
                attempt(format!("{kind}: {part} with a further member"), &put(changed(document)));
            }
        }
    }
}

/// Lines removed, repeated, inserted, swapped and cut at each place.
fn order(sample: &Sample, attempts: &mut Attempts) {
    let count = sample.lines.len();
    let foreign = Sample::new(8).lines;
    let mut attempt = |name: String, lines: &[String]| {
        attempts.note(name, faults(lines, &sample.checkpoint(), &vkey(&key())));
    };
    for place in 0..count {
        let change = |change: &dyn Fn(&mut Vec<String>)| {
            let mut lines = sample.lines.clone();
            change(&mut lines);
            lines
        };
        attempt(format!("line {place} removed"), &change(&|lines| drop(lines.remove(place))));
        attempt(
            format!("line {place} repeated"),
            &change(&|lines| lines.insert(place, lines[place].clone())),
        );
        attempt(format!("cut before line {place}"), &sample.lines[..place]);
        if place > 1 {
            attempt(
                format!("lines before {place} swapped"),
                &change(&|l| l.swap(place - 1, place)),
            );
            let moved = |lines: &mut Vec<String>| {
                let line = lines.remove(place);
                lines.insert(1, line);
            };
            attempt(format!("line {place} moved to the front"), &change(&moved));
        }
        if foreign[place] != sample.lines[place] {
            attempt(
                format!("line {place} of another history"),
                &change(&|lines| lines[place].clone_from(&foreign[place])),
            );
        }
        let rubbish = |lines: &mut Vec<String>| lines[place] = "rubbish".to_owned();
        attempt(format!("line {place} replaced by rubbish"), &change(&rubbish));
    }
    attempt("another history with the genuine checkpoint".to_owned(), &foreign);
}

/// Values and salts emptied, alone and together, and reports exchanged.
fn values(sample: &Sample, attempts: &mut Attempts) {
    let has_values = |index: &usize| sample.lines[*index].contains("\"report\":{");
    let queued: Vec<usize> = (1..sample.lines.len()).filter(has_values).collect();
    for index in &queued {
        let mut attempt = |name: &str, change: &dyn Fn(&mut Value)| {
            let mut lines = sample.lines.clone();
            let mut line: Value = serde_json::from_str(&lines[*index]).expect("JSON");
            change(&mut line);
            lines[*index] = line.to_string();
            let found = faults(&lines, &sample.checkpoint(), &vkey(&key()));
            attempts.note(format!("{name} at line {index}"), found);
        };
        attempt("values emptied", &|line| {
            line["report"] = Value::Null;
            line["salt"] = Value::Null;
        });
        attempt("value without its salt", &|line| line["salt"] = Value::Null);
        attempt("salt without its value", &|line| line["report"] = Value::Null);
        attempt("salt exchanged", &|line| line["salt"] = json!(hex::encode([8; 16])));
        attempt("recipient added", &|line| {
            line["report"]["Payload"]["recipientList"]["Body"] = json!(["acme", "other", "more"]);
        });
        attempt("recipient removed", &|line| {
            line["report"]["Payload"]["recipientList"]["Body"] = json!(["acme"]);
        });
        let other = queued[usize::from(*index == queued[0])];
        let other: Value = serde_json::from_str(&sample.lines[other]).expect("JSON");
        attempt("report of another entry", &|line| line["report"] = other["report"].clone());
        attempt("sent at another time", &|line| line["sentAt"] = json!("1970-01-01T00:00:09Z"));
        attempt("in another message", &|line| line["messageId"] = json!("m2"));
        attempt("delivered at another time", &|line| {
            line["deliveredAt"] = json!("1970-01-01T00:00:09Z");
        });
        attempt("delivered in one's own account only", &|line| {
            let is_delivered = !line["deliveredAt"].is_null();
            line["deliveredAt"] =
                if is_delivered { Value::Null } else { json!("1970-01-01T00:00:08Z") };
        });
    }
}

/// Checkpoints and keys exchanged, changed and cut.
fn checkpoints(sample: &Sample, attempts: &mut Attempts) {
    let genuine = sample.checkpoint();
    let mut attempt = |name: &str, lines: &[String], checkpoint: &str, by: &VerifierKey| {
        attempts.note(name.to_owned(), faults(lines, checkpoint, by));
    };
    let (own, thief) = (vkey(&key()), LedgerKey::from_secret(&[2; 32]));
    for place in 0..genuine.len() {
        let mut bytes = genuine.clone().into_bytes();
        bytes[place] ^= 1;
        let checkpoint = String::from_utf8_lossy(&bytes).into_owned();
        attempt(&format!("byte {place} of the checkpoint"), &sample.lines, &checkpoint, &own);
    }
    let mut resigned = Sample::new(8);
    resigned.log.sign_checkpoint(&thief);
    let checkpoint = resigned.checkpoint();
    attempt("everything signed by another key", &resigned.lines, &checkpoint, &own);
    attempt("the checkpoint under another key", &sample.lines, &genuine, &vkey(&thief));
    let resigned = Sample::new(8);
    attempt("a fork under the own key", &resigned.lines, &genuine, &own);
    let mut longer = Sample::new(7);
    longer.log.append("{}");
    longer.log.sign_checkpoint(&key());
    attempt("an older copy of the file", &sample.lines, &longer.checkpoint(), &own);
    let mut other = Log::new(factory(), "other".parse().expect("an id"), &Head::default());
    other.sign_checkpoint(&key());
    let other_key =
        log_verifier(&factory(), &"other".parse().expect("an id"), &key().public()).expect("a key");
    let of_other = other.checkpoint().expect("signed");
    attempt("the log of another recipient", &sample.lines, of_other, &other_key);
    attempt("another's checkpoint under the own key", &sample.lines, of_other, &own);
    let cosigner = VerifierKey::new("F/to/acme", KeyKind::CosignatureV1, &key().public());
    attempt("the key of another kind", &sample.lines, &genuine, &cosigner.expect("a key"));
    let text = genuine.split("\n\n").next().expect("a text");
    attempt("a checkpoint without signature", &sample.lines, &format!("{text}\n\n"), &own);
    let lines = genuine.rsplit_once("\n\n").expect("signatures").1;
    let extended = format!("{text}\nextension\n\n{lines}");
    attempt("a line added to the checkpoint", &sample.lines, &extended, &own);
}

#[test]
fn every_kind_of_tampering_is_found() {
    let sample = Sample::new(7);
    let mut attempts = Attempts::default();
    members(&sample, &mut attempts);
    order(&sample, &mut attempts);
    values(&sample, &mut attempts);
    checkpoints(&sample, &mut attempts);
    assert!(attempts.missed.is_empty(), "not found: {:#?}", attempts.missed);
    assert!(attempts.names.len() > 500, "{} kinds", attempts.names.len());
}

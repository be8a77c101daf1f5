//! Values, salts, recipients and deliveries changed beside the entries.

use serde_json::{Value, json};

use crate::{file::AuditFile, kinds::Kinds};

pub(crate) fn try_all(file: &AuditFile, kinds: &mut Kinds<'_>) {
    let with_values: Vec<usize> =
        (1..file.lines.len()).filter(|index| !file.line(*index)["report"].is_null()).collect();
    for index in &with_values {
        let kind = file.kind(*index);
        let mut attempt = |name: &str, change: &dyn Fn(&mut Value)| {
            let mut line = file.line(*index);
            change(&mut line);
            kinds.attempt(&format!("{kind}: {name}"), &file.with(*index, &line), &file.checkpoint);
        };
        attempt("values emptied", &|line| {
            line["report"] = Value::Null;
            line["salt"] = Value::Null;
        });
        attempt("salt emptied", &|line| line["salt"] = Value::Null);
        attempt("report emptied without its salt", &|line| line["report"] = Value::Null);
        attempt("salt exchanged", &|line| line["salt"] = json!("08".repeat(16)));
        attempt("salt shortened", &|line| {
            let salt = line["salt"].as_str().expect("a salt").to_owned();
            line["salt"] = json!(salt[2..]);
        });
        attempt("payload emptied", &|line| line["report"]["Payload"] = json!({}));
        attempt("delivered at another time", &|line| {
            line["deliveredAt"] = json!("1970-01-01T00:00:09Z");
        });
        attempt("sent at another time", &|line| line["sentAt"] = json!("1970-01-01T00:00:09Z"));
        attempt("sent in another message", &|line| line["messageId"] = json!("other"));
        attempt("its delivery turned round", &|line| {
            let is_delivered = !line["deliveredAt"].is_null();
            line["deliveredAt"] =
                if is_delivered { Value::Null } else { json!("1970-01-01T00:00:08Z") };
        });
        let recipients = "/report/Payload/recipientList/Body";
        if let Some(list) = file.line(*index).pointer(recipients).and_then(Value::as_array) {
            let mut change = |name: &str, list: Vec<Value>| {
                attempt(name, &|line| {
                    *line.pointer_mut(recipients).expect("the recipients") = json!(list);
                });
            };
            change("recipient added", [&list[..], &[json!("more")]].concat());
            change("recipient removed", list[1..].to_vec());
            change("no recipient left", Vec::new());
        }
        twice(file, *index, &kind, kinds);
        exchanged(file, *index, &with_values, &kind, kinds);
    }
}

/// Members of a report said twice: readers take the last.
fn twice(file: &AuditFile, index: usize, kind: &str, kinds: &mut Kinds<'_>) {
    let line = &file.lines[index];
    let report = file.line(index)["report"].to_string();
    for member in [r#""Payload":{}"#, r#""Payload":{"more":1}"#, r#""SequenceNumber":1"#] {
        let other = format!("{},{member}}}", report.strip_suffix('}').expect("an object"));
        let mut lines = file.lines.clone();
        lines[index] = line.replacen(&report, &other, 1);
        assert_ne!(lines[index], *line, "the report stands in the line as it was read");
        kinds.attempt(&format!("{kind}: {member} appended"), &lines, &file.checkpoint);
    }
}

/// Report, salt and delivery of another entry.
fn exchanged(
    file: &AuditFile,
    index: usize,
    with_values: &[usize],
    kind: &str,
    kinds: &mut Kinds<'_>,
) {
    let Some(other) = with_values.iter().find(|other| **other != index) else { return };
    let other = file.line(*other);
    for members in [&["report"][..], &["report", "salt"], &["salt"]] {
        let mut line = file.line(index);
        for member in members {
            line[*member] = other[*member].clone();
        }
        if line == file.line(index) {
            continue;
        }
        let name = format!("{kind}: {} of another entry", members.join(" and "));
        kinds.attempt(&name, &file.with(index, &line), &file.checkpoint);
    }
}

//! Members changed, removed and added, in each kind of line and entry.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::{file::AuditFile, kinds::Kinds};

pub(crate) fn try_all(file: &AuditFile, kinds: &mut Kinds<'_>) {
    let mut seen = BTreeSet::new();
    for index in 0..file.lines.len() {
        let kind = file.kind(index);
        if !seen.insert(kind.clone()) {
            continue;
        }
        let (line, entry) = (file.line(index), file.entry(index));
        for (part, document) in [("line", &line), ("entry", &entry)] {
            let mut attempt = |name: &str, document: Value| {
                let line = match part {
                    "line" => document,
                    _ => {
                        let mut line = line.clone();
                        line["entry"] = json!(document.to_string());
                        line
                    }
                };
                let name = format!("{kind}: {part} {name}");
                kinds.attempt(&name, &file.with(index, &line), &file.checkpoint);
            };
            let mut pointers = Vec::new();
            places(document, "", &mut pointers);
            for pointer in pointers {
                let mut other = document.clone();
                let place = other.pointer_mut(&pointer).expect("a place");
                let is_absent = place.is_null();
                *place = changed(place);
                attempt(&format!("{pointer} changed"), other);
                if !is_absent {
                    let mut other = document.clone();
                    remove(&mut other, &pointer);
                    attempt(&format!("{pointer} removed"), other);
                }
            }
            if document.is_object() {
                attempt("with a further member", changed(document));
            }
        }
    }
}

/// Returns all places in a document, as JSON pointers.
fn places(value: &Value, pointer: &str, into: &mut Vec<String>) {
    let mut inner = |name: &str, value: &Value| {
        let name = name.replace('~', "~0").replace('/', "~1");
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
        Value::String(text) if text.ends_with('Z') => json!("1999-01-01T00:00:00Z"),
        Value::String(text) if text.ends_with('0') => json!(format!("{}1", cut(text))),
        Value::String(text) => json!(format!("{}0", cut(text))),
        Value::Array(items) => json!([items.clone(), vec![json!("x")]].concat()),
        Value::Object(members) => {
            let mut members = members.clone();
            members.insert("added".to_owned(), json!(1));
            Value::Object(members)
        }
    }
}

fn cut(text: &str) -> &str {
    let end = text.char_indices().next_back().map_or(0, |(end, _)| end);
    &text[..end]
}

fn remove(value: &mut Value, pointer: &str) {
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    let name = name.replace("~1", "/").replace("~0", "~");
    match value.pointer_mut(parent).expect("a parent") {
        Value::Object(members) => drop(members.shift_remove(&name)),
        Value::Array(items) => drop(items.remove(name.parse().expect("an index"))),
        _ => {}
    }
}

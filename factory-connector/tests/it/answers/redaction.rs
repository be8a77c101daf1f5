//! Replacement of everything in an answer that differs from run to run.

use asi_model::DateTime;
use serde_json::{Value, json};
use uuid::Uuid;

/// Members whose values are replaced by their names.
const VOLATILE: [&str; 9] = [
    "MetaDataVersion",
    "clockAheadMs",
    "content",
    "csrfToken",
    "epoch",
    "hostNames",
    "messageId",
    "revocationListId",
    "spentUs",
];

/// Fewest hexadecimal digits of a hash, a key or a signature.
const HEX_DIGITS_MIN: usize = 40;
/// Fewest digits of an epoch.
const DIGITS_MIN: usize = 9;

/// Returns a document with volatile members, times, ids, hashes and addresses replaced. A text that
/// is a JSON object is shown as that object.
pub fn redacted(value: &Value, volatile: &[&str]) -> Value {
    match value {
        Value::Object(members) => members
            .iter()
            .map(|(name, value)| {
                let is_volatile = VOLATILE.contains(&name.as_str()) && !value.is_null();
                // What a call names may be there or not: it depends on what comes first.
                let shown = if is_volatile || volatile.contains(&name.as_str()) {
                    json!(format!("[{name}]"))
                } else {
                    redacted(value, volatile)
                };
                (name.clone(), shown)
            })
            .collect(),
        Value::Array(elements) => {
            elements.iter().map(|element| redacted(element, volatile)).collect()
        }
        Value::String(text) => match serde_json::from_str(text) {
            Ok(object @ Value::Object(_)) => redacted(&object, volatile),
            _ => redacted_word(text).into(),
        },
        other => other.clone(),
    }
}

/// Returns a table or a page with times, ids, hashes and large numbers in its cells replaced.
pub fn redacted_text(text: &str) -> String {
    let cells = text.split_inclusive(['<', '>']).map(|cell| {
        if cell.starts_with("{&quot;") { "[text]<".to_owned() } else { redacted_words(cell) }
    });
    cells.collect()
}

fn redacted_words(cell: &str) -> String {
    let ends = ['<', '>', ',', ' ', '\r', '\n'];
    let words = cell.split_inclusive(ends).map(|ended| {
        let word = ended.trim_end_matches(ends);
        let is_number = word.len() >= DIGITS_MIN && word.bytes().all(|byte| byte.is_ascii_digit());
        let shown = if is_number { "[number]" } else { redacted_word(word) };
        shown.to_owned() + &ended[word.len()..]
    });
    words.collect()
}

fn redacted_word(word: &str) -> &str {
    let is_hash = word.len() >= HEX_DIGITS_MIN && word.bytes().all(|byte| byte.is_ascii_hexdigit());
    match word {
        _ if word.parse::<DateTime>().is_ok() => "[time]",
        _ if word.parse::<Uuid>().is_ok() => "[id]",
        _ if is_hash => "[hexadecimal]",
        _ if word.starts_with("opc.tcp://") => "[address]",
        _ => word,
    }
}

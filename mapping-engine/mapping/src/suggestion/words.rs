//! Names as words: `actPartCounter_1` is act, part, counter.

use std::collections::BTreeSet;

/// Words that mean the same on a shop floor, in English and German; the first stands for all.
const SYNONYMS: &[&[&str]] = &[
    &[
        "count", "counter", "cnt", "counts", "quantity", "qty", "number", "anzahl", "zaehler",
        "zähler", "stueck", "stück", "menge",
    ],
    &[
        "part",
        "parts",
        "piece",
        "pieces",
        "pcs",
        "workpiece",
        "product",
        "products",
        "item",
        "items",
        "teil",
        "teile",
        "werkstueck",
        "werkstück",
    ],
    &[
        "produced",
        "production",
        "made",
        "output",
        "finished",
        "completed",
        "done",
        "gefertigt",
        "fertig",
        "produziert",
    ],
    &["good", "ok", "io", "passed", "accepted", "gut"],
    &[
        "scrap",
        "bad",
        "nok",
        "reject",
        "rejected",
        "rejects",
        "waste",
        "failed",
        "ausschuss",
        "nio",
    ],
    &["state", "status", "mode", "zustand", "betriebsart"],
    &["progress", "percent", "percentage", "fortschritt", "completion", "complete"],
    &["temperature", "temp", "temperatur"],
    &["pressure", "druck"],
    &["force", "kraft"],
    &["speed", "velocity", "rpm", "drehzahl", "geschwindigkeit"],
    &["position", "pos", "lage"],
    &["power", "watt", "watts", "leistung"],
    &["energy", "energie", "kwh"],
    &["current", "strom", "amps"],
    &["start", "begin", "started", "beginn"],
    &["end", "finish", "ende"],
    &["actual", "act", "ist", "aktuell"],
    &["order", "job", "auftrag"],
    &["time", "zeit", "timestamp"],
];

/// Words that say nothing.
const EMPTY: &[&str] = &[
    "the", "a", "an", "of", "in", "and", "or", "to", "is", "for", "with", "der", "die", "das",
    "von", "value", "var", "variable", "data", "tag", "update", "this", "that", "per", "wert",
];

/// The words of a name or text, synonyms made one.
pub(super) fn words(text: &str) -> BTreeSet<String> {
    let mut words = BTreeSet::new();
    let mut word = String::new();
    let mut before = ' ';
    for c in text.chars() {
        let begins = !c.is_alphabetic() || (c.is_uppercase() && before.is_lowercase());
        if begins {
            take(&mut word, &mut words);
        }
        if c.is_alphabetic() {
            word.extend(c.to_lowercase());
        }
        before = c;
    }
    take(&mut word, &mut words);
    words
}

fn take(word: &mut String, words: &mut BTreeSet<String>) {
    let taken = std::mem::take(word);
    // Single letters are axes and indexes: they tell siblings apart but mean nothing.
    if taken.chars().count() < 2 || EMPTY.contains(&taken.as_str()) {
        return;
    }
    let group = SYNONYMS.iter().find(|group| group.contains(&taken.as_str()));
    words.insert(group.and_then(|group| group.first()).map_or(taken, |first| (*first).to_owned()));
}

/// Returns the likeness of two sets of words, 0 to 1. Each word of the smaller set counts for its
/// best partner; words left over in the larger one weigh little.
pub(super) fn likeness(a: &BTreeSet<String>, b: &BTreeSet<String>) -> f64 {
    let (small, large) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    if small.is_empty() {
        return 0.0;
    }
    let matched: f64 = small
        .iter()
        .map(|word| large.iter().map(|other| alike(word, other)).fold(0.0, f64::max))
        .sum();
    #[allow(clippy::cast_precision_loss)]
    let (small, large) = (small.len() as f64, large.len() as f64);
    matched / (0.75 * small + 0.25 * large)
}

/// Equal words, or one the beginning of the other (`temp`, `tempsensor`).
fn alike(a: &str, b: &str) -> f64 {
    let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    if short == long {
        1.0
    } else if short.len() >= 4 && long.starts_with(short) {
        0.7
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_words() {
        for (name, expected) in [
            ("actPartCounter_1", vec!["actual", "count", "part"]),
            ("ProducedQuantity", vec!["count", "produced"]),
            ("Stück-Zähler", vec!["count"]),
            ("Axis_1.ActualPosition", vec!["actual", "axis", "position"]),
            ("x", vec![]),
        ] {
            assert_eq!(words(name).into_iter().collect::<Vec<_>>(), expected, "{name}");
        }
    }

    #[test]
    fn likeness_is_between_nothing_and_all() {
        let alike = |a: &str, b: &str| likeness(&words(a), &words(b));
        assert_eq!(alike("PartCounter", "counter_parts"), 1.0);
        assert_eq!(alike("PartCounter", "Temperature"), 0.0);
        assert!(alike("goodCount", "GoodPartsCounter") > alike("goodCount", "ScrapPartsCounter"));
        assert_eq!(alike("", "x"), 0.0);
    }
}

//! Values of the fields of busy requests: each is of the kind that its mapping makes, so that none has another one's.

use std::collections::BTreeMap;

use serde_json::Value;

use super::stores::{Left, ReportKey};
use crate::scenario::load;

/// Returns what values of a factory's busy writers are of another kind.
pub(super) fn faults(factory: &str, left: &BTreeMap<ReportKey, Left>) -> Vec<String> {
    let mut faults = Vec::new();
    for request in load::requests(factory) {
        let contents = left.values().map(|report| &report.content);
        let contents: Vec<_> = contents.filter(|content| content.request == request).collect();
        for name in load::FIELDS {
            let fields = contents.iter().filter_map(|content| content.fields.get(name));
            let values = fields.filter(|field| field.status == "Good").map(|field| &field.value);
            let wrong: Vec<_> = values.filter(|value| !is_of(name, value)).collect();
            faults.extend(wrong.first().map(|value| {
                let count = wrong.len();
                format!(
                    "{request}, {name}: {count} values are none that its mapping makes, as {value}"
                )
            }));
        }
    }
    faults
}

fn is_of(name: &str, value: &Value) -> bool {
    match name {
        load::TOGGLED => value.is_number(),
        load::SCRIPTED => {
            let number = value.as_str().and_then(|text| text.strip_prefix("at "));
            number.is_some_and(|number| number.parse::<f64>().is_ok())
        }
        // A number of 64 bits is a text in JSON.
        _ => value.as_str().is_some_and(|text| text.parse::<i64>().is_ok()),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn each_field_has_values_of_its_own() {
        let values = [
            (load::TOGGLED, json!(1.5)),
            (load::SCRIPTED, json!("at 1.5")),
            (load::COUNTED, json!("7")),
        ];
        for (place, (name, _)) in values.iter().enumerate() {
            for (other, (_, value)) in values.iter().enumerate() {
                assert_eq!(is_of(name, value), place == other, "{name}: {value}");
            }
        }
        assert!(is_of(load::STEPS, &json!("8")));
        assert!(!is_of(load::SCRIPTED, &json!("at noon")));
        assert!(!is_of(load::TOGGLED, &Value::Null));
    }
}

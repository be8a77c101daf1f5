//! Units of fields, as their requests have them: the platform stores none with a report.

use std::collections::BTreeMap;

use serde_json::Value;
use sqlx::{Row as _, SqliteConnection};

/// Units by request and field.
#[derive(Debug, Default)]
pub(super) struct Units(BTreeMap<(String, String), String>);

impl Units {
    /// Returns those of some fields of a request.
    pub fn of<'n>(
        &self,
        request: &str,
        fields: impl Iterator<Item = &'n String>,
    ) -> BTreeMap<String, String> {
        let unit = |field: &String| self.0.get(&(request.to_owned(), field.clone())).cloned();
        fields.filter_map(|field| Some((field.clone(), unit(field)?))).collect()
    }

    /// Adds those of all requests in a document.
    fn add(&mut self, document: &Value) {
        if let Some(request) = document["dynamicDataRequestId"].as_str() {
            let fields = document["reportDataFormat"]["reportFieldList"].as_array();
            for field in fields.into_iter().flatten() {
                if let (Some(name), Some(unit)) = (field["name"].as_str(), field["unit"].as_str()) {
                    self.0.insert((request.to_owned(), name.to_owned()), unit.to_owned());
                }
            }
        }
        match document {
            Value::Array(all) => all.iter().for_each(|part| self.add(part)),
            Value::Object(members) => members.values().for_each(|part| self.add(part)),
            _ => {}
        }
    }
}

/// Reads the units that a factory is asked for, from the platform's store.
pub(super) async fn of_requests(
    store: &mut SqliteConnection,
    factory: &str,
) -> anyhow::Result<Units> {
    let rows = sqlx::query("SELECT document FROM network_part WHERE factory_id = ?")
        .bind(factory)
        .fetch_all(store)
        .await?;
    let mut units = Units::default();
    for row in rows {
        units.add(&serde_json::from_str(row.get("document"))?);
    }
    Ok(units)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn units_are_found_wherever_a_request_is() {
        let fields = json!([{ "name": "made", "unit": "PIECE" }, { "name": "text" }]);
        let request = json!({ "dynamicDataRequestId": "r", "reportDataFormat": { "reportFieldList": fields } });
        let mut units = Units::default();
        units.add(&json!({ "operationNetwork": { "operationList": [{ "requests": [request] }] } }));
        let names = ["made".to_owned(), "text".to_owned()];
        let made = BTreeMap::from([("made".to_owned(), "PIECE".to_owned())]);
        assert_eq!(units.of("r", names.iter()), made);
        assert_eq!(units.of("other", names.iter()), BTreeMap::new());
    }
}

//! Precision of values, from the consents that ledger entries name.

use std::collections::{BTreeMap, HashMap};

use disclosure::{DisclosurePolicy, Statement};
use serde_json::Value;
use sqlx::SqliteConnection;

use crate::store::{consents, error::StoreError};

/// Consents whose precision is remembered at most.
const CONSENTS_MAX: usize = 100_000;

/// A consent that an entry names.
struct NamedConsent {
    field_name: String,
    /// The field's key as text.
    field: String,
    version: u64,
}

/// Precision of each consent, remembered: many entries name the same one.
#[derive(Default)]
pub(super) struct Precisions(HashMap<(String, u64), Statement>);

impl Precisions {
    /// Returns the precision under each consent that an entry names, by field name.
    pub async fn of(
        &mut self,
        connection: &mut SqliteConnection,
        content: &str,
        report: Option<&str>,
    ) -> Result<BTreeMap<String, Statement>, StoreError> {
        let mut precision = BTreeMap::new();
        for consent in consents_in(content, report) {
            let found = self.statement(connection, consent.field, consent.version).await?;
            precision.extend(found.map(|statement| (consent.field_name, statement)));
        }
        Ok(precision)
    }

    async fn statement(
        &mut self,
        connection: &mut SqliteConnection,
        field: String,
        version: u64,
    ) -> Result<Option<Statement>, StoreError> {
        let key = (field, version);
        if let Some(known) = self.0.get(&key) {
            return Ok(Some(known.clone()));
        }
        let policy = consents::policy(connection, &key.0, version).await?;
        let policy = policy.and_then(|text| serde_json::from_str::<DisclosurePolicy>(&text).ok());
        let Some(statement) = policy.map(|policy| Statement::of(&policy, None)) else {
            return Ok(None);
        };
        if self.0.len() < CONSENTS_MAX {
            self.0.insert(key, statement.clone());
        }
        Ok(Some(statement))
    }
}

/// Lists the consents that an entry names: that of a decision, or those of a report's values.
fn consents_in(content: &str, report: Option<&str>) -> Vec<NamedConsent> {
    let entry: Value = serde_json::from_str(content).unwrap_or_default();
    if let Some(name) = entry["field"]["fieldName"].as_str() {
        return named(&entry["field"], name, &entry["version"]).into_iter().collect();
    }
    let Some(versions) = entry["consents"].as_object() else { return Vec::new() };
    let report: Value =
        report.and_then(|report| serde_json::from_str(report).ok()).unwrap_or_default();
    versions.iter().filter_map(|(name, version)| named(&report["Payload"], name, version)).collect()
}

/// Names a consent by the members of a request's key, which are texts or OPC UA variants.
fn named(request: &Value, field_name: &str, version: &Value) -> Option<NamedConsent> {
    let id = |member: &str| {
        let value = &request[member];
        value.as_str().or_else(|| value["Body"].as_str()).or_else(|| value["Value"].as_str())
    };
    Some(NamedConsent {
        field: format!(
            "{}/{}/{}/{field_name}",
            id("operationNetworkId")?,
            id("operationId")?,
            id("dynamicDataRequestId")?
        ),
        field_name: field_name.to_owned(),
        version: version.as_u64()?,
    })
}

//! Content of a report: what left, and what the platform understood of it.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::Context as _;
use asi_model::{
    DateTime, StatusCode,
    pubsub::{ReportHeader, unit_member},
};
use serde_json::Value;

// Built-in types (OPC 10000-6, table 1).
const STATUS_CODE: u8 = 19;
const DATA_VALUE: u8 = 23;

/// Content of a report, times in ticks.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Content {
    pub request: String,
    pub report_name: String,
    /// Organisations that may read it.
    pub readers: BTreeSet<String>,
    pub report_time: Option<i64>,
    pub shopfloor_time: Option<i64>,
    pub fields: BTreeMap<String, FieldContent>,
    /// Units of the fields that have one: as they left, or as the request has them.
    pub units: BTreeMap<String, String>,
}

/// Content of one field.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FieldContent {
    pub value: Value,
    /// Name of the status, as "Good".
    pub status: String,
    /// Time of the source, in ticks.
    pub source_time: Option<i64>,
}

impl Content {
    /// Reads a DataSetMessage in the reversible encoding, with those to whom it was released.
    pub fn of_message(message: &Value, readers: BTreeSet<String>) -> anyhow::Result<Self> {
        let payload = message["Payload"].as_object().context("a payload")?;
        let member = |name: &str| payload.get(name).map_or(&Value::Null, |member| &member["Body"]);
        // Beside a field there is its unit.
        let is_unit =
            |name: &str| name.strip_suffix("Unit").is_some_and(|field| payload.contains_key(field));
        let fields = payload.iter().filter(|(name, _)| !ReportHeader::is_member(name));
        let fields = fields.filter(|(name, _)| !is_unit(name));
        let shopfloor_time = ticks(member(ReportHeader::SHOPFLOOR_TIMESTAMP))?;
        let text = |name: &str| member(name).as_str().map(str::to_owned);
        let units =
            payload.keys().filter_map(|name| Some((name.clone(), text(&unit_member(name))?)));
        let units = units.collect();
        let fields = fields.map(|(name, field)| {
            let mut content = FieldContent::of(field)?;
            // A value without a time of its own has that of the report's values.
            content.source_time = content.source_time.or(shopfloor_time);
            Ok((name.clone(), content))
        });
        Ok(Self {
            request: text(ReportHeader::DYNAMIC_DATA_REQUEST_ID)
                .context("the request of a report")?,
            report_name: text(ReportHeader::REPORT_NAME).context("the name of a report")?,
            readers,
            report_time: ticks(&message["Timestamp"])?,
            shopfloor_time,
            fields: fields.collect::<anyhow::Result<_>>()?,
            units,
        })
    }

    /// Returns what of this content the other one has not, or has otherwise.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let mut found = Vec::new();
        if (&self.request, self.report_time, self.shopfloor_time)
            != (&other.request, other.report_time, other.shopfloor_time)
        {
            found.push(format!(
                "left for {} at {:?} of {:?}, is held for {} at {:?} of {:?}",
                self.request,
                self.report_time,
                self.shopfloor_time,
                other.request,
                other.report_time,
                other.shopfloor_time
            ));
        }
        if self.report_name != other.report_name {
            let (left, held) = (&self.report_name, &other.report_name);
            found.push(format!("left with the name {left:?}, is held as {held:?}"));
        }
        if self.readers != other.readers {
            let (left, held) = (&self.readers, &other.readers);
            found.push(format!("left to the readers {left:?}, is held for {held:?}"));
        }
        if self.units != other.units {
            let (left, asked) = (&self.units, &other.units);
            found.push(format!("left with the units {left:?}, its request has {asked:?}"));
        }
        for (name, field) in &self.fields {
            match other.fields.get(name) {
                None => found.push(format!("{name} is missing")),
                Some(there) if !field.is_same(there) => {
                    found.push(format!("{name} left as {field:?}, is held as {there:?}"));
                }
                Some(_) => {}
            }
        }
        let invented = other.fields.keys().filter(|name| !self.fields.contains_key(*name));
        found.extend(invented.map(|name| format!("{name} never left")));
        found
    }
}

impl FieldContent {
    /// Reads a variant, or a data value in one. A bare status has no value.
    fn of(field: &Value) -> anyhow::Result<Self> {
        let is_data_value = field["Type"] == DATA_VALUE;
        let body = &field["Body"];
        let variant = if is_data_value { &body["Value"] } else { field };
        let is_status = variant["Type"] == STATUS_CODE;
        let status = match (is_status, is_data_value) {
            (true, _) => &variant["Body"],
            (false, true) => &body["Status"],
            (false, false) => &Value::Null,
        };
        let code = u32::try_from(status.as_u64().unwrap_or_default())?;
        Ok(Self {
            value: if is_status { Value::Null } else { variant["Body"].clone() },
            status: StatusCode(code).to_string(),
            source_time: if is_data_value { ticks(&body["SourceTimestamp"])? } else { None },
        })
    }

    /// Equal as values: 6 and 6.0 are one number.
    fn is_same(&self, other: &Self) -> bool {
        let numbers = self.value.as_f64().zip(other.value.as_f64());
        let is_same_value =
            self.value == other.value || numbers.is_some_and(|(one, other)| one == other);
        is_same_value && self.status == other.status && self.source_time == other.source_time
    }
}

/// Reads fields as the platform stores them.
pub(super) fn shown_fields(fields: &Value) -> anyhow::Result<BTreeMap<String, FieldContent>> {
    let all = fields.as_object().into_iter().flatten();
    all.map(|(name, field)| {
        let status = field["status"].as_str().context("a status")?.to_owned();
        let source_time = ticks(&field["sourceTimestamp"])?;
        Ok((name.clone(), FieldContent { value: field["value"].clone(), status, source_time }))
    })
    .collect()
}

fn ticks(time: &Value) -> anyhow::Result<Option<i64>> {
    let time: Option<DateTime> = serde_json::from_value(time.clone()).context("a time")?;
    Ok(time.map(DateTime::ticks))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_is_missing_or_other_is_seen() {
        let message = json!({ "Timestamp": "2026-01-01T00:00:00Z", "Payload": {
            "dynamicDataRequestId": { "Type": 12, "Body": "r" },
            "reportName": { "Type": 12, "Body": "Report" },
            "shopfloorTimestamp": { "Type": 13, "Body": "2026-01-01T00:00:00Z" },
            "made": { "Type": 9, "Body": "7" }, "madeUnit": { "Type": 12, "Body": "PIECE" },
            "level": { "Type": 23, "Body": { "Value": { "Type": 11, "Body": 1.5 },
                "Status": 0x4000_0000_u32, "SourceTimestamp": "2026-01-01T00:00:01Z" } },
            "lost": { "Type": 19, "Body": 0x8000_0000_u32 } } });
        let readers = BTreeSet::from(["buyer".to_owned()]);
        let left = Content::of_message(&message, readers).expect("a message");
        assert_eq!(left.units, BTreeMap::from([("made".to_owned(), "PIECE".to_owned())]));
        assert_eq!(left.fields.keys().collect::<Vec<_>>(), ["level", "lost", "made"]);
        assert_eq!(left.differences(&left), [""; 0]);
        let changed = |change: &dyn Fn(&mut Content)| {
            let mut held = left.clone();
            change(&mut held);
            left.differences(&held).len()
        };
        assert_eq!(changed(&|held| drop(held.fields.remove("made"))), 1);
        assert_eq!(changed(&|held| held.report_time = None), 1);
        assert_eq!(changed(&|held| held.shopfloor_time = Some(0)), 1);
        assert_eq!(changed(&|held| held.report_name.clear()), 1);
        assert_eq!(changed(&|held| held.readers.clear()), 1);
        assert_eq!(changed(&|held| held.readers.extend(["other".to_owned()])), 1);
        assert_eq!(changed(&|held| held.units.clear()), 1);
        let level = |change: &dyn Fn(&mut FieldContent)| {
            changed(&|held| change(held.fields.get_mut("level").expect("a field")))
        };
        assert_eq!(level(&|level| level.status = "Good".to_owned()), 1);
        assert_eq!(level(&|level| level.source_time = None), 1);
        assert_eq!(level(&|level| level.value = json!(2)), 1);
        let invented = left.fields["made"].clone();
        assert_eq!(changed(&|held| drop(held.fields.insert("more".into(), invented.clone()))), 1);
    }
}

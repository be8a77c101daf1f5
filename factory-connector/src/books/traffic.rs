//! How many values come and leave, for the leak budget and for what "every change" would add. Kept
//! in memory only.

use asi_model::{DateTime, FieldKey, FieldName, OrganisationId};
use std::{collections::BTreeMap, sync::Arc};

use super::{Books, Field};
use disclosure::{DisclosurePolicy, Measured, OpenField};

/// Hours that are counted.
const HOURS: usize = 24;
const HOUR_MS: i64 = 3_600_000;

/// Counts per hour over the last day.
#[derive(Debug, Clone)]
pub struct Traffic {
    since: DateTime,
    /// The present hour, since 1970, and its counts.
    hour: i64,
    present: (u32, u32),
    /// The counts of the hours before it, each in the place of its hour; made when they are first
    /// needed.
    earlier: Option<Box<[(u32, u32); HOURS]>>,
}

impl Traffic {
    /// Nothing counted yet.
    #[must_use]
    pub fn new(since: DateTime) -> Self {
        Self {
            since,
            hour: since.unix_millis().div_euclid(HOUR_MS),
            present: (0, 0),
            earlier: None,
        }
    }

    /// A value came.
    pub fn came(&mut self, now: DateTime) {
        self.turn_to(now);
        self.present.0 = self.present.0.saturating_add(1);
    }

    /// A value left.
    pub fn left(&mut self, now: DateTime) {
        self.turn_to(now);
        self.present.1 = self.present.1.saturating_add(1);
    }

    /// What was counted.
    #[must_use]
    #[allow(clippy::cast_precision_loss)]
    pub fn measured(&self, now: DateTime) -> Measured {
        let mut counted = self.clone();
        counted.turn_to(now);
        let counts =
            || counted.earlier.iter().flat_map(|hours| hours.iter()).chain([&counted.present]);
        let hours = (now.since(self.since).as_secs_f64() / 3600.0).min(HOURS as f64);
        Measured {
            candidates: counts().map(|(came, _)| u64::from(*came)).sum(),
            released: counts().map(|(_, left)| u64::from(*left)).sum(),
            hours,
        }
    }

    /// Goes on to the hour of `now`; hours that are over a day ago are forgotten.
    fn turn_to(&mut self, now: DateTime) {
        let hour = now.unix_millis().div_euclid(HOUR_MS);
        if hour <= self.hour {
            return;
        }
        let place = |hour: i64| usize::try_from(hour.rem_euclid(HOURS as i64)).unwrap_or(0);
        if self.present != (0, 0) || self.earlier.is_some() {
            let earlier = self.earlier.get_or_insert_with(|| Box::new([(0, 0); HOURS]));
            earlier[place(self.hour)] = std::mem::take(&mut self.present);
            for passed in (self.hour + 1..=hour).rev().take(HOURS) {
                earlier[place(passed)] = (0, 0);
            }
        }
        self.hour = hour;
    }
}

/// A field that is looked at as if it had another precision, or were open.
pub type Supposed<'s> = (&'s FieldKey, &'s Arc<DisclosurePolicy>);

impl Books {
    /// What each partner gets: requesters and recipients of open fields. `supposed` counts as open.
    #[must_use]
    pub fn open_fields<'b>(
        &'b self,
        now: DateTime,
        supposed: Option<Supposed<'b>>,
    ) -> BTreeMap<&'b OrganisationId, Vec<OpenField<'b>>> {
        let mut open: BTreeMap<&OrganisationId, Vec<OpenField<'_>>> = BTreeMap::new();
        for message in self.networks.values().filter_map(|network| network.message.as_ref()) {
            for operation in &message.operation_network.operation_list {
                for request in &operation.dynamic_data_request_list {
                    for definition in &request.report_data_format.report_field_list {
                        let Some((key, field)) =
                            self.find(message, operation, request, &definition.name)
                        else {
                            continue;
                        };
                        let as_supposed =
                            supposed.filter(|(wanted, _)| *wanted == key).map(|(_, policy)| policy);
                        let Some(policy) = as_supposed
                            .or_else(|| field.decision.is_mapped().then(|| field.gate.policy()))
                        else {
                            continue;
                        };
                        let measured = field.traffic.measured(now);
                        let entry = OpenField { key, definition, operation, policy, measured };
                        let mut partners: Vec<&OrganisationId> =
                            request.recipient_list.iter().collect();
                        if !partners.contains(&&request.requester_id) {
                            partners.push(&request.requester_id);
                        }
                        for partner in partners {
                            open.entry(partner).or_default().push(entry);
                        }
                    }
                }
            }
        }
        open
    }

    fn find(
        &self,
        message: &asi_model::messages::OperationNetworkMessage,
        operation: &asi_model::network::Operation,
        request: &asi_model::network::DynamicDataRequest,
        name: &FieldName,
    ) -> Option<(&FieldKey, &Field)> {
        let key = asi_model::RequestKey {
            operation_network_id: message.operation_network.operation_network_id.clone(),
            operation_id: operation.operation_id.clone(),
            dynamic_data_request_id: request.dynamic_data_request_id.clone(),
        };
        self.fields.get(&key.field(name.clone())).map(|field| (&field.key, field))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_day_is_counted() {
        let at = |minutes: i64| DateTime::from_unix_micros((480_000 * 60 + minutes) * 60_000_000);
        let mut traffic = Traffic::new(at(0));
        for minute in 0..120 {
            traffic.came(at(minute));
            if minute % 10 == 0 {
                traffic.left(at(minute));
            }
        }
        let measured = traffic.measured(at(120));
        assert_eq!((measured.candidates, measured.released, measured.hours), (120, 12, 2.0));
        assert_eq!(measured.candidates_per_hour(), Some(60.0));
        let later = traffic.measured(at(25 * 60 - 1));
        assert_eq!((later.candidates, later.hours), (60, 24.0), "the first hour is over a day ago");
        assert_eq!(traffic.measured(at(60 * 60)).candidates, 0);
    }
}

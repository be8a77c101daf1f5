//! Offers of the past as pages show them.

use std::collections::BTreeSet;

use asi_model::{DateTime, FieldName, OrganisationId, RequestKey, openapi::EncodedValue};
use connector_state::{
    ConnectorState,
    past::{Past, PastOffer, PastPart},
};
use disclosure::Statement;
use serde::Serialize;
use serde_json::{Map, Value};
use utoipa::ToSchema;

use crate::store::EpochRecipients;

/// A recipient of whose request something left before it was added.
pub(super) struct AddedRecipient {
    pub(super) request: RequestKey,
    pub(super) recipient: OrganisationId,
    /// Number of the last report that was decided about; 0 before the first decision.
    pub(super) after: i64,
}

/// Finds the recipients in effect that epochs of their requests do not have, where a field is open.
pub(super) fn added_recipients(
    state: &ConnectorState,
    epochs: &[EpochRecipients],
) -> Vec<AddedRecipient> {
    let mut found: BTreeSet<(&RequestKey, &OrganisationId)> = BTreeSet::new();
    let after = |request: &RequestKey, recipient: &OrganisationId| {
        state.past().decided_through(request, recipient).unwrap_or_default()
    };
    for epoch in epochs {
        let recipients = state.networks().recipients(&epoch.request);
        let added = recipients.iter().filter(|recipient| {
            !epoch.recipients.contains(recipient)
                && epoch.last_report > after(&epoch.request, recipient)
        });
        found.extend(added.map(|recipient| (&epoch.request, recipient)));
    }
    let is_open = |request: &RequestKey| {
        state.fields_of(request).any(|(_, field)| field.decision().is_mapped())
    };
    found
        .into_iter()
        .filter(|(request, _)| is_open(request))
        .map(|(request, recipient)| AddedRecipient {
            request: request.clone(),
            recipient: recipient.clone(),
            after: after(request, recipient),
        })
        .collect()
}

/// Offer to show a recipient what had left for others before it was added.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PastOfferView {
    request: RequestKey,
    /// The recipient that was added.
    recipient_id: OrganisationId,
    /// Number of reports that can be shown.
    report_count: u64,
    /// Root over their values, hexadecimal: names this offer in the decision.
    root: String,
    /// All reports, grouped by the consents under which they left; the oldest first.
    parts: Vec<PastPartView>,
    /// The newest reports that can be shown, as they left.
    preview: Vec<PastReportView>,
}

/// Reports that left under the same consents.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PastPartView {
    /// Number of reports.
    report_count: u64,
    /// Time of the first report.
    from: DateTime,
    /// Time of the last report.
    until: DateTime,
    /// True where they can be shown.
    is_offered: bool,
    fields: Vec<PastFieldView>,
}

/// A field of reports of the past.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PastFieldView {
    name: FieldName,
    /// Number of the consent under which it left.
    consent_version: u32,
    /// The policy of that consent in words and as codes; none where it is not known any more.
    policy: Option<Statement>,
    /// True where the field is not open to the recipient at present.
    is_closed: bool,
    /// True where that policy does not satisfy the present one.
    is_looser: bool,
}

/// Values of a report as they left.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct PastReportView {
    /// The payload by member.
    #[schema(value_type = std::collections::BTreeMap<String, EncodedValue>)]
    value: Map<String, Value>,
}

impl PastOfferView {
    /// Returns the view of an offer; `bodies` are the DataSetMessages of its newest reports.
    pub(super) fn new(past: &Past, offer: PastOffer, bodies: &[String]) -> Self {
        Self {
            request: past.request.clone(),
            recipient_id: past.recipient.clone(),
            report_count: offer.report_count,
            root: hex::encode(offer.root),
            parts: offer.parts.iter().map(|part| PastPartView::new(past, part)).collect(),
            preview: bodies.iter().filter_map(|body| PastReportView::new(body)).collect(),
        }
    }
}

impl PastPartView {
    fn new(past: &Past, part: &PastPart) -> Self {
        let field = |(name, version): (&FieldName, &u32)| PastFieldView {
            policy: past
                .policies
                .get(&(name.clone(), *version))
                .map(|policy| Statement::of(policy, None)),
            name: name.clone(),
            consent_version: *version,
            is_closed: part.closed_fields.contains(name),
            is_looser: part.looser_fields.contains(name),
        };
        Self {
            report_count: part.report_count,
            from: part.from,
            until: part.until,
            is_offered: part.is_offered(),
            fields: part.consents.iter().map(field).collect(),
        }
    }
}

impl PastReportView {
    fn new(body: &str) -> Option<Self> {
        let mut report: Map<String, Value> = serde_json::from_str(body).ok()?;
        match report.remove("Payload")? {
            Value::Object(value) => Some(Self { value }),
            _ => None,
        }
    }
}

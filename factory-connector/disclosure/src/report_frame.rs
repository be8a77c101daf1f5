//! Reports made of gates: a value and its times get into a message only through here.

use std::{fmt, ops::Deref, sync::Arc, time::Duration};

use asi_model::{
    DataValue, DateTime, FieldName, RequestKey,
    pubsub::{
        DataSetMessage, MetaDataVersion, PayloadField, RecipientList, ReportHeader,
        json::{Encoding, encode_data_set_message},
        unit_member,
    },
};

use crate::{DraftGate, Gate};

/// Resolution of the times of reports without a time step. The leak budget counts on it.
const TIMESTAMP_STEP: Duration = Duration::from_millis(1);

/// Writer and request of a report: everything in it that comes from no gate.
#[derive(Debug, Clone, Copy)]
pub struct ReportOrigin<'r> {
    pub data_set_writer_id: u16,
    pub sequence_number: u32,
    /// Version of the metadata that describes the report.
    pub version: MetaDataVersion,
    /// `reportName` of the request's ReportDataFormat.
    pub report_name: &'r str,
    pub request: &'r RequestKey,
    /// The organisations that may read the report.
    pub recipient_list: Option<&'r RecipientList>,
}

/// A field of a report: its value is the one that its gate released last.
#[derive(Debug, Clone, Copy)]
pub struct ReportedField<'g> {
    pub name: &'g FieldName,
    /// Unit in the words of the request.
    pub unit: Option<&'g str>,
    pub gate: &'g Gate,
}

/// The report of a data set. It has nothing but values that gates released, and its times are on
/// the longest time step of their policies. No code outside of this crate makes another one:
///
/// ```compile_fail,E0423
/// let _ = disclosure::ReportFrame(asi_model::pubsub::DataSetMessage::default());
/// ```
///
/// ```compile_fail,E0616
/// fn change(frame: &mut disclosure::ReportFrame) {
///     frame.0.fields.clear();
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ReportFrame(DataSetMessage);

impl ReportFrame {
    /// Makes the report of these fields at `now`; `None` before the first value.
    #[must_use]
    pub fn of<'g>(
        origin: &ReportOrigin<'_>,
        fields: impl Iterator<Item = ReportedField<'g>>,
        now: DateTime,
    ) -> Option<Self> {
        lay_out(origin, fields, now).map(Self)
    }

    /// Returns the time that the report tells of itself: on the longest time step of its fields, at
    /// least a millisecond.
    ///
    /// # Panics
    /// Never: every frame has one.
    #[must_use]
    pub fn reported_at(&self) -> DateTime {
        self.0.timestamp.expect("a frame is made with its time")
    }

    /// Encodes the report for the spool.
    #[must_use]
    pub fn encode(&self, encoding: Encoding) -> ReportBody {
        ReportBody(encode_data_set_message(&self.0, encoding))
    }
}

/// A field of a report to look at.
#[derive(Debug, Clone, Copy)]
pub struct DraftField<'g> {
    pub name: &'g FieldName,
    /// Unit in the words of the request.
    pub unit: Option<&'g str>,
    pub gate: DraftOrGate<'g>,
}

/// Gate of a field, or one under a policy that is not in force.
#[derive(Debug, Clone, Copy)]
pub enum DraftOrGate<'g> {
    Gate(&'g Gate),
    Draft(&'g DraftGate),
}

/// Makes a report to look at: laid out as [`ReportFrame::of`] does, it cannot leave, since the spool
/// takes a [`ReportBody`].
///
/// ```compile_fail,E0308
/// use disclosure::{DraftField, ReportFrame, ReportOrigin, draft_report};
/// fn leave(origin: &ReportOrigin<'_>, field: DraftField<'_>, now: asi_model::DateTime) -> Option<ReportFrame> {
///     draft_report(origin, [field].into_iter(), now)
/// }
/// ```
///
/// ```
/// use asi_model::pubsub::DataSetMessage;
/// use disclosure::{DraftField, ReportOrigin, draft_report};
/// fn show(origin: &ReportOrigin<'_>, field: DraftField<'_>, now: asi_model::DateTime) -> Option<DataSetMessage> {
///     draft_report(origin, [field].into_iter(), now)
/// }
/// ```
#[must_use]
pub fn draft_report<'g>(
    origin: &ReportOrigin<'_>,
    fields: impl Iterator<Item = DraftField<'g>>,
    now: DateTime,
) -> Option<DataSetMessage> {
    let fields = fields.map(|DraftField { name, unit, gate }| {
        let gate = match gate {
            DraftOrGate::Gate(gate) => gate,
            DraftOrGate::Draft(draft) => draft.gate(),
        };
        ReportedField { name, unit, gate }
    });
    lay_out(origin, fields, now)
}

fn lay_out<'g>(
    origin: &ReportOrigin<'_>,
    fields: impl Iterator<Item = ReportedField<'g>>,
    now: DateTime,
) -> Option<DataSetMessage> {
    let mut values = Vec::with_capacity(2 * fields.size_hint().0);
    let mut newest: Option<DateTime> = None;
    // In the same pass: it is made for every report.
    let mut step = Duration::ZERO;
    for ReportedField { name, unit, gate } in fields {
        step = step.max(gate.policy().time_step());
        let Some(released) = gate.disclosed() else { continue };
        newest = newest.max(released.source_timestamp);
        let shown = DataValue {
            source_timestamp: None,
            server_timestamp: None,
            ..DataValue::clone(released)
        };
        values.push(PayloadField::with(Arc::from(name.as_str()), shown));
        if let Some(unit) = unit {
            values.push(PayloadField::new(unit_member(name.as_str()), unit));
        }
    }
    if values.is_empty() {
        return None;
    }
    let header = ReportHeader {
        report_name: origin.report_name,
        request: origin.request,
        shopfloor_timestamp: newest.unwrap_or(now).floor_to(step),
        recipient_list: origin.recipient_list,
    };
    let mut payload = header.payload_fields();
    payload.append(&mut values);
    Some(DataSetMessage {
        data_set_writer_id: Some(origin.data_set_writer_id),
        sequence_number: Some(origin.sequence_number),
        meta_data_version: Some(origin.version),
        timestamp: Some(now.floor_to(step.max(TIMESTAMP_STEP))),
        fields: payload,
        ..DataSetMessage::default()
    })
}

/// A DataSetMessage as JSON that may leave the plant. The spool takes nothing else, and only a
/// [`ReportFrame`] makes it:
///
/// ```compile_fail,E0423
/// let _ = disclosure::ReportBody("{}".to_owned());
/// ```
///
/// ```compile_fail,E0277
/// let _: disclosure::ReportBody = "{}".to_owned().into();
/// ```
///
/// ```
/// fn length(body: &disclosure::ReportBody) -> usize {
///     body.len()
/// }
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct ReportBody(String);

impl Deref for ReportBody {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for ReportBody {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(formatter)
    }
}

#[cfg(test)]
mod tests {
    use asi_model::BuiltInType;

    use super::*;
    use crate::GateState;

    /// The step is a minute; the source measured and the report is made within one.
    #[test]
    fn the_times_of_a_report_are_on_the_longest_step_of_its_fields() {
        let at = |text: &str| text.parse::<DateTime>().expect("a time");
        let policy = serde_json::from_str(r#"{"timeStepMs":60000}"#).expect("a policy");
        let (on_step, begin) = (at("2026-11-23T10:01:00Z"), at("2026-11-23T10:00:17.5Z"));
        let gate = |policy| {
            let (policy, state) = (Arc::new(policy), GateState::default());
            let mut gate = Gate::new(policy, BuiltInType::UInt64, state, begin);
            gate.on(begin, DataValue::good(7_u64, begin));
            gate.on_time(on_step);
            gate
        };
        let (stepped, open) = (gate(policy), gate(crate::DisclosurePolicy::default()));
        let request = RequestKey {
            operation_network_id: "n".parse().expect("an id"),
            operation_id: "op".parse().expect("an id"),
            dynamic_data_request_id: "R1".parse().expect("an id"),
        };
        let origin = ReportOrigin {
            data_set_writer_id: 1,
            sequence_number: 0,
            version: MetaDataVersion::default(),
            report_name: "Progress",
            request: &request,
            recipient_list: None,
        };
        let names = ["a", "b"].map(|name| name.parse::<FieldName>().expect("a name"));
        let fields = names.iter().zip([&stepped, &open]);
        let fields = fields.map(|(name, gate)| ReportedField { name, unit: None, gate });
        let frame = ReportFrame::of(&origin, fields, at("2026-11-23T10:01:42.25Z"));
        let message = frame.expect("it has values").0;
        assert_eq!(message.timestamp, Some(on_step));
        let times = message.fields.iter().filter_map(|field| match field.value.value.as_scalar() {
            Some(asi_model::Scalar::DateTime(time)) => Some(*time),
            _ => None,
        });
        assert_eq!(times.collect::<Vec<_>>(), [at("2026-11-23T10:00:00Z")]);
    }
}

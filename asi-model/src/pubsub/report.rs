//! Payload members of reports beside the values of their fields (wire contract, "Reports").

use std::sync::Arc;

use uuid::Uuid;

use super::{DataSetMessage, FieldMetaData, PayloadField};
use crate::{
    ids::{OrganisationId, RequestKey},
    network::{DynamicDataRequest, VALUE_RANK_ARRAY, VALUE_RANK_SCALAR},
    values::{Array, BuiltInType, DateTime, Scalar, Variant},
};

/// The members that the payload of each report begins with: the request that the report answers,
/// the time of its values, and to whom they are released.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportHeader<'r> {
    /// `reportName` of the request's ReportDataFormat.
    pub report_name: &'r str,
    /// The dynamic data request.
    pub request: &'r RequestKey,
    /// Newest source time of the contained values, as coarse as their policies ask.
    pub shopfloor_timestamp: DateTime,
    /// The organisations that may read the report; [`RecipientList::of`] its request.
    pub recipient_list: Option<&'r RecipientList>,
}

impl ReportHeader<'_> {
    /// Name of the member with the report's name, a String.
    pub const REPORT_NAME: &'static str = "reportName";
    /// Name of the member with the id of the dynamic data request, a String.
    pub const DYNAMIC_DATA_REQUEST_ID: &'static str = "dynamicDataRequestId";
    /// Name of the member with the operation's id, a String.
    pub const OPERATION_ID: &'static str = "operationId";
    /// Name of the member with the operation network's id, a String.
    pub const OPERATION_NETWORK_ID: &'static str = "operationNetworkId";
    /// Name of the member with the time of the values, a DateTime.
    pub const SHOPFLOOR_TIMESTAMP: &'static str = "shopfloorTimestamp";
    /// Name of the member with the ids of the organisations that may read the report, an array of
    /// String. Reports of former connectors have no such member.
    pub const RECIPIENT_LIST: &'static str = "recipientList";

    /// Names, types and value ranks of all members, in payload order.
    pub const MEMBERS: [(&'static str, BuiltInType, i32); 6] = [
        (Self::REPORT_NAME, BuiltInType::String, VALUE_RANK_SCALAR),
        (Self::DYNAMIC_DATA_REQUEST_ID, BuiltInType::String, VALUE_RANK_SCALAR),
        (Self::OPERATION_ID, BuiltInType::String, VALUE_RANK_SCALAR),
        (Self::OPERATION_NETWORK_ID, BuiltInType::String, VALUE_RANK_SCALAR),
        (Self::SHOPFLOOR_TIMESTAMP, BuiltInType::DateTime, VALUE_RANK_SCALAR),
        (Self::RECIPIENT_LIST, BuiltInType::String, VALUE_RANK_ARRAY),
    ];

    /// Returns true for the name of a member. No report field may have such a name.
    #[must_use]
    pub fn is_member(name: &str) -> bool {
        Self::MEMBERS.iter().any(|(member, ..)| *member == name)
    }

    /// Returns the members with their values, in payload order.
    #[must_use]
    pub fn payload_fields(&self) -> Vec<PayloadField> {
        let mut fields = vec![
            PayloadField::new(Self::REPORT_NAME, self.report_name),
            PayloadField::new(
                Self::DYNAMIC_DATA_REQUEST_ID,
                self.request.dynamic_data_request_id.as_str(),
            ),
            PayloadField::new(Self::OPERATION_ID, self.request.operation_id.as_str()),
            PayloadField::new(
                Self::OPERATION_NETWORK_ID,
                self.request.operation_network_id.as_str(),
            ),
            PayloadField::new(Self::SHOPFLOOR_TIMESTAMP, self.shopfloor_timestamp),
        ];
        fields.extend(
            self.recipient_list.map(|list| PayloadField::new(Self::RECIPIENT_LIST, list.value())),
        );
        fields
    }

    /// Describes the members, in payload order; reports of some requests name no recipients
    /// ([`RecipientList::of`]). `field_id` yields the DataSetFieldId of a name.
    pub fn meta_data(
        names_recipients: bool,
        field_id: impl Fn(&str) -> Uuid,
    ) -> impl Iterator<Item = FieldMetaData> {
        Self::MEMBERS
            .into_iter()
            .filter(move |(name, ..)| names_recipients || *name != Self::RECIPIENT_LIST)
            .map(move |(name, built_in_type, value_rank)| FieldMetaData {
                value_rank,
                ..FieldMetaData::new(name, built_in_type, field_id(name))
            })
    }
}

/// The organisations that may read a report, as the array that its payload carries. A clone shares
/// the array, so that the reports of a request cost nothing each.
#[derive(Debug, Clone, PartialEq)]
pub struct RecipientList(Arc<Array>);

impl RecipientList {
    /// Makes the array for a request's reports. `None` where a field has the member's name: its
    /// network was drawn before the name was reserved, and its reports name no recipients.
    #[must_use]
    pub fn of(request: &DynamicDataRequest) -> Option<Self> {
        let mut fields = request.report_data_format.report_field_list.iter();
        let is_taken = fields.any(|field| field.name.as_str() == ReportHeader::RECIPIENT_LIST);
        (!is_taken).then(|| Self::new(&request.recipient_list))
    }

    /// Makes the array of these organisations, in their order.
    #[must_use]
    fn new(recipients: &[OrganisationId]) -> Self {
        Self(Arc::new(Array {
            element_type: BuiltInType::String,
            elements: recipients.iter().map(|id| Scalar::from(id.as_str())).collect(),
            dimensions: None,
        }))
    }

    fn value(&self) -> Variant {
        Variant::Array(Arc::clone(&self.0))
    }
}

/// Returns the organisations that may read a report; `None` where the report does not say so, as
/// those of former connectors. What is no list of ids releases it to nobody.
#[must_use]
pub fn recipient_list(message: &DataSetMessage) -> Option<Vec<OrganisationId>> {
    let elements = match &message.field(ReportHeader::RECIPIENT_LIST)?.value {
        Variant::Array(array) => &array.elements[..],
        Variant::Null => &[],
        Variant::Scalar(_) => return None,
    };
    let id = |element: &Scalar| match element {
        Scalar::String(Some(text)) => text.parse().ok(),
        _ => None,
    };
    Some(elements.iter().filter_map(id).collect())
}

/// End of the name of a member that carries a field's unit.
const UNIT_SUFFIX: &str = "Unit";

/// Returns the name of the String member that follows the field `name` and carries its unit:
/// `weight` has `weightUnit`.
#[must_use]
pub fn unit_member(name: &str) -> String {
    format!("{name}{UNIT_SUFFIX}")
}

/// Returns the name of the field whose unit a member of this name would carry.
#[must_use]
pub fn measured_field(member: &str) -> Option<&str> {
    member.strip_suffix(UNIT_SUFFIX)
}

/// Returns true for a member that carries the value of a report field: neither a member of
/// [`ReportHeader`] nor the unit of another member. A single value named `recipientList` is the
/// field of a network that is older than the member.
#[must_use]
pub fn is_report_field(message: &DataSetMessage, member: &str) -> bool {
    let is_header = match member {
        ReportHeader::RECIPIENT_LIST => recipient_list(message).is_some(),
        _ => ReportHeader::is_member(member),
    };
    !is_header && measured_field(member).is_none_or(|name| message.field(name).is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(value: impl Into<Variant>) -> DataSetMessage {
        let member = PayloadField::new(ReportHeader::RECIPIENT_LIST, value);
        DataSetMessage { fields: vec![member], ..DataSetMessage::default() }
    }

    #[test]
    fn only_a_list_of_ids_releases_a_report() {
        let ids: Vec<OrganisationId> =
            ["acme", "hull"].map(|id| id.parse().expect("an id")).to_vec();
        let nobody = Some(Vec::new());
        assert_eq!(recipient_list(&with(RecipientList::new(&ids).value())), Some(ids));
        assert_eq!(recipient_list(&with(RecipientList::new(&[]).value())), nobody);
        assert_eq!(recipient_list(&with(Variant::Null)), nobody);
        let wrong = Array {
            element_type: BuiltInType::Int32,
            elements: vec![Scalar::Int32(1)],
            dimensions: None,
        };
        assert_eq!(recipient_list(&with(Variant::Array(Arc::new(wrong)))), nobody);
        assert_eq!(recipient_list(&DataSetMessage::default()), None);
    }

    #[test]
    fn a_single_value_of_the_name_is_a_field_of_a_former_network() {
        let former = with("acme");
        assert_eq!(recipient_list(&former), None);
        assert!(is_report_field(&former, ReportHeader::RECIPIENT_LIST));
        assert!(!is_report_field(&with(Variant::Null), ReportHeader::RECIPIENT_LIST));
    }
}

//! Payload members of reports beside the values of their fields (wire contract, "Reports").

use uuid::Uuid;

use super::{DataSetMessage, FieldMetaData, PayloadField};
use crate::{
    ids::RequestKey,
    values::{BuiltInType, DateTime},
};

/// The members that the payload of each report begins with: the request that the report answers,
/// and the time of its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReportHeader<'r> {
    /// `reportName` of the request's ReportDataFormat.
    pub report_name: &'r str,
    /// The dynamic data request.
    pub request: &'r RequestKey,
    /// Newest source time of the contained values, as coarse as their policies ask.
    pub shopfloor_timestamp: DateTime,
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

    /// Names and types of all members, in payload order.
    pub const MEMBERS: [(&'static str, BuiltInType); 5] = [
        (Self::REPORT_NAME, BuiltInType::String),
        (Self::DYNAMIC_DATA_REQUEST_ID, BuiltInType::String),
        (Self::OPERATION_ID, BuiltInType::String),
        (Self::OPERATION_NETWORK_ID, BuiltInType::String),
        (Self::SHOPFLOOR_TIMESTAMP, BuiltInType::DateTime),
    ];

    /// Returns true for the name of a member. No report field may have such a name.
    #[must_use]
    pub fn is_member(name: &str) -> bool {
        Self::MEMBERS.iter().any(|(member, _)| *member == name)
    }

    /// Returns the members with their values, in payload order.
    #[must_use]
    pub fn payload_fields(&self) -> [PayloadField; 5] {
        [
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
        ]
    }

    /// Describes the members, in payload order. `field_id` yields the DataSetFieldId of a name.
    #[must_use]
    pub fn meta_data(field_id: impl Fn(&str) -> Uuid) -> [FieldMetaData; 5] {
        Self::MEMBERS
            .map(|(name, built_in_type)| FieldMetaData::new(name, built_in_type, field_id(name)))
    }
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
/// [`ReportHeader`] nor the unit of another member.
#[must_use]
pub fn is_report_field(message: &DataSetMessage, member: &str) -> bool {
    !ReportHeader::is_member(member)
        && measured_field(member).is_none_or(|name| message.field(name).is_none())
}

//! OPC UA PubSub messages (OPC 10000-14), independent of their encoding.
//!
//! [`json`] is one encoding; another (UADP) would be a module beside it and share these types.

pub mod json;
mod message;
mod meta_data;
mod report;

pub use message::{
    DataSetMessage, DataSetMessageKind, FieldRepresentation, MetaDataMessage, NetworkMessage,
    PayloadField, PubSubMessage, PubSubState, StatusMessage,
};
pub use meta_data::{
    DataSetMetaData, FieldMetaData, MetaDataChange, MetaDataLookup, MetaDataVersion,
    PROPERTY_DISCLOSURE, PROPERTY_ENGINEERING_UNITS, PROPERTY_SEMANTIC,
};
pub use report::{
    RecipientList, ReportHeader, is_report_field, measured_field, recipient_list, unit_member,
};

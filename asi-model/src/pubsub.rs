//! OPC UA PubSub messages (OPC 10000-14): what they mean, apart from how they are encoded.
//!
//! [`json`] is one encoding; another (UADP) would stand beside it and share these types.

pub mod json;
mod message;
mod meta_data;

pub use message::{
    DataSetMessage, DataSetMessageKind, FieldRepresentation, MetaDataMessage, MetaDataVersion,
    NetworkMessage, PayloadField, PubSubMessage, PubSubState, StatusMessage,
};
pub use meta_data::{
    DataSetMetaData, FieldMetaData, MetaDataChange, MetaDataLookup, PROPERTY_DISCLOSURE,
    PROPERTY_ENGINEERING_UNITS, PROPERTY_SEMANTIC,
};

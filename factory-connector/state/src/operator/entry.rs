//! Entries of operators.

use asi_model::{
    DateTime, DynamicDataRequestId, FieldKey, FieldName, OperationId, OperationNetworkId,
    RequestKey,
};
use serde::{Deserialize, Serialize};

/// Longest id, in characters.
const ID_CHARS_MAX: usize = 64;
/// Longest text about a problem, in characters.
const TEXT_CHARS_MAX: usize = 1000;
/// Most pieces that one entry adds or takes back.
const QUANTITY_MAX: f64 = 1e6;

/// An operation of a network.
#[derive(
    Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, utoipa::ToSchema,
)]
#[serde(rename_all = "camelCase")]
pub struct OperationKey {
    pub operation_network_id: OperationNetworkId,
    pub operation_id: OperationId,
}

impl OperationKey {
    /// Returns the operation of a field.
    #[must_use]
    pub fn of(field: &FieldKey) -> Self {
        Self {
            operation_network_id: field.request.operation_network_id.clone(),
            operation_id: field.request.operation_id.clone(),
        }
    }
}

/// An entry's id, made where it was entered: 1 to 64 letters, digits, `-` or `_`.
#[derive(
    Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, utoipa::ToSchema,
)]
#[schema(value_type = String, pattern = "^[A-Za-z0-9_-]{1,64}$")]
#[serde(try_from = "String", into = "String")]
pub struct EntryId(String);

impl EntryId {
    /// Returns the id as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl TryFrom<String> for EntryId {
    type Error = &'static str;
    fn try_from(text: String) -> Result<Self, Self::Error> {
        let is_fine = (1..=ID_CHARS_MAX).contains(&text.len())
            && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_'));
        if is_fine {
            Ok(Self(text))
        } else {
            Err("an entry's id has 1 to 64 letters, digits, - or _")
        }
    }
}

impl From<EntryId> for String {
    fn from(id: EntryId) -> Self {
        id.0
    }
}

/// Quality of a counted piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum Piece {
    /// Conforms to the specification.
    #[default]
    Good,
    /// Does not conform.
    Scrap,
}

/// Action that an operator entered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(tag = "action", rename_all = "SCREAMING_SNAKE_CASE", rename_all_fields = "camelCase")]
pub enum Action {
    /// Work began, or goes on after a problem.
    Start,
    /// Pieces were made; a negative quantity takes some back.
    Add {
        /// Number of pieces; 1 without it.
        #[serde(default = "one")]
        quantity: f64,
        /// Good pieces without it.
        #[serde(default)]
        piece: Piece,
    },
    /// Work is finished.
    Done,
    /// Work stands still. The text stays in the plant.
    Problem { text: String },
    /// A value was typed into a field.
    #[schema(rename_all = "camelCase")]
    Value {
        /// The field's request.
        dynamic_data_request_id: DynamicDataRequestId,
        field_name: FieldName,
        /// Value in plain JSON; 64-bit integers may be texts.
        #[schema(value_type = asi_model::openapi::PlainValue)]
        value: serde_json::Value,
    },
}

const fn one() -> f64 {
    1.0
}

/// Reason for which an entry is never accepted; it is useless to deliver it again.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EntryFault {
    /// No such operation is here, or no more.
    #[error("there is no such operation here; it may have been withdrawn")]
    UnknownOperation,
    /// The field takes no typed values.
    #[error("this field takes no typed values; an engineer has to open it for them first")]
    NotManual,
    /// The value is none of the field's type.
    #[error("{0}")]
    WrongType(String),
    /// The quantity is of no use.
    #[error("a quantity lies between -1000000 and 1000000 and is not 0")]
    Quantity,
    /// The text is empty or too long.
    #[error("a problem is described in 1 to 1000 characters")]
    Text,
    /// The entry was made too long ago.
    #[error("it was made more than 31 days ago; type the present value instead")]
    TooOld,
    /// The operation has as many entries as it may have.
    #[error(
        "the operation has 10000 entries already; type the total instead of counting single pieces"
    )]
    TooMany,
}

impl EntryFault {
    /// Returns the code of the fault, as the API states it.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::UnknownOperation => "UNKNOWN_OPERATION",
            Self::NotManual => "NOT_MANUAL",
            Self::WrongType(_) => "WRONG_TYPE",
            Self::Quantity => "INVALID_QUANTITY",
            Self::Text => "INVALID_TEXT",
            Self::TooOld => "TOO_OLD",
            Self::TooMany => "TOO_MANY",
        }
    }
}

impl Action {
    /// Checks the action without regard to its operation.
    ///
    /// # Errors
    /// [`EntryFault::Quantity`], [`EntryFault::Text`].
    pub fn check(&self) -> Result<(), EntryFault> {
        match self {
            Self::Add { quantity, .. } if !(quantity.abs() <= QUANTITY_MAX && *quantity != 0.0) => {
                Err(EntryFault::Quantity)
            }
            Self::Problem { text }
                if text.trim().is_empty() || text.chars().count() > TEXT_CHARS_MAX =>
            {
                Err(EntryFault::Text)
            }
            _ => Ok(()),
        }
    }

    /// Returns the field that a typed value is for.
    #[must_use]
    pub fn field(&self, operation: &OperationKey) -> Option<FieldKey> {
        let Self::Value { dynamic_data_request_id, field_name, .. } = self else { return None };
        let request = RequestKey {
            operation_network_id: operation.operation_network_id.clone(),
            operation_id: operation.operation_id.clone(),
            dynamic_data_request_id: dynamic_data_request_id.clone(),
        };
        Some(request.field(field_name.clone()))
    }
}

/// A stored entry.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct OperatorEntry {
    /// Made where it was entered.
    pub entry_id: EntryId,
    #[serde(flatten)]
    pub operation: OperationKey,
    /// Time of the entry by the connector's clock.
    pub made_at: DateTime,
    /// Time of its delivery.
    pub received_at: DateTime,
    /// Name of the user.
    pub made_by: String,
    #[serde(flatten)]
    pub action: Action,
}

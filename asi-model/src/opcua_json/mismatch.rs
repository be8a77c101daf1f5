//! Values that cannot be taken.

use std::borrow::Cow;

use crate::{
    json::{JsonError, JsonNode},
    values::StatusCode,
};

/// A value that cannot be taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ValueError {
    /// The text is not JSON or breaks a limit.
    #[error("the value is not acceptable JSON")]
    Json(#[from] JsonError),
    /// The JSON is not a value of the type.
    #[error("{pointer}: {message}")]
    Mismatch {
        /// JSON pointer to what is wrong.
        pointer: String,
        message: String,
        /// The status that a field with this value gets.
        status: StatusCode,
    },
}

/// A node that is not the value it should be. The pointer is only made when the mismatch is
/// reported.
#[derive(Debug)]
pub(crate) struct Mismatch<'t, 'a> {
    pub(crate) node: JsonNode<'t, 'a>,
    pub(crate) message: Cow<'static, str>,
    pub(crate) status: StatusCode,
}

impl<'t, 'a> Mismatch<'t, 'a> {
    pub(crate) fn new(node: JsonNode<'t, 'a>, message: impl Into<Cow<'static, str>>) -> Self {
        Self { node, message: message.into(), status: StatusCode::BAD_TYPE_MISMATCH }
    }

    pub(crate) fn out_of_range(
        node: JsonNode<'t, 'a>,
        message: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self { status: StatusCode::BAD_OUT_OF_RANGE, ..Self::new(node, message) }
    }

    pub(crate) fn into_error(self) -> ValueError {
        ValueError::Mismatch {
            pointer: self.node.pointer(),
            message: self.message.into_owned(),
            status: self.status,
        }
    }
}

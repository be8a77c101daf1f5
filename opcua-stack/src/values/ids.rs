//! Names, times and status codes.

use std::sync::Arc;

use asi_model::values as model;
use opcua::types as stack;

use super::ConversionError;
use crate::NamespaceTable;

/// A stack time; both count 100 ns since 1601.
#[must_use]
pub fn time_from_stack(time: stack::DateTime) -> model::DateTime {
    model::DateTime::from_ticks(time.ticks())
}

/// A time for the stack.
#[must_use]
pub fn time_to_stack(time: model::DateTime) -> stack::DateTime {
    stack::DateTime::from(time.ticks())
}

/// A stack status with all its flag bits.
#[must_use]
pub fn status_from_stack(status: stack::StatusCode) -> model::StatusCode {
    model::StatusCode(status.bits())
}

/// A status for the stack with all its flag bits.
#[must_use]
pub fn status_to_stack(status: model::StatusCode) -> stack::StatusCode {
    stack::StatusCode::from(status.0)
}

/// A node's identity with its namespace by URI. An index unknown to the table stays an index.
#[must_use]
pub fn node_id_from_stack(id: &stack::NodeId, namespaces: &NamespaceTable) -> model::NodeId {
    model::NodeId {
        namespace: namespaces.namespace(id.namespace),
        identifier: identifier_from_stack(&id.identifier),
    }
}

/// A node's identity under the peer's indexes.
///
/// # Errors
/// [`ConversionError::UnknownNamespace`] when the peer lacks the namespace.
pub fn node_id_to_stack(
    id: &model::NodeId,
    namespaces: &NamespaceTable,
) -> Result<stack::NodeId, ConversionError> {
    Ok(stack::NodeId {
        namespace: namespace_to_stack(&id.namespace, namespaces)?,
        identifier: identifier_to_stack(&id.identifier),
    })
}

/// A node's identity, maybe on another server.
#[must_use]
pub fn expanded_node_id_from_stack(
    id: &stack::ExpandedNodeId,
    namespaces: &NamespaceTable,
) -> model::ExpandedNodeId {
    let namespace = match id.namespace_uri.value() {
        Some(uri) => model::Namespace::uri(uri),
        None => namespaces.namespace(id.node_id.namespace),
    };
    let server = if id.server_index == 0 {
        model::Server::Local
    } else {
        model::Server::Index(id.server_index)
    };
    model::ExpandedNodeId {
        node_id: model::NodeId {
            namespace,
            identifier: identifier_from_stack(&id.node_id.identifier),
        },
        server,
    }
}

/// A node's identity, maybe on another server. A namespace unknown to the peer travels by its URI.
///
/// # Errors
/// [`ConversionError::UnknownServer`] when the node lives on a server that is named by its URI.
pub fn expanded_node_id_to_stack(
    id: &model::ExpandedNodeId,
    namespaces: &NamespaceTable,
) -> Result<stack::ExpandedNodeId, ConversionError> {
    let server_index = match &id.server {
        model::Server::Local => 0,
        model::Server::Index(index) => *index,
        model::Server::Uri(uri) => {
            return Err(ConversionError::UnknownServer { uri: uri.to_string() });
        }
    };
    let (namespace, namespace_uri) = match &id.node_id.namespace {
        // An index of ours means nothing on another server; only the URI does.
        model::Namespace::Uri(uri) if server_index != 0 || namespaces.index(uri).is_none() => {
            (0, stack::UAString::from(uri.as_ref()))
        }
        namespace => (namespace_to_stack(namespace, namespaces)?, stack::UAString::null()),
    };
    let identifier = identifier_to_stack(&id.node_id.identifier);
    Ok(stack::ExpandedNodeId {
        node_id: stack::NodeId { namespace, identifier },
        namespace_uri,
        server_index,
    })
}

/// A qualified name with its namespace by URI.
#[must_use]
pub fn qualified_name_from_stack(
    name: &stack::QualifiedName,
    namespaces: &NamespaceTable,
) -> model::QualifiedName {
    model::QualifiedName {
        namespace: namespaces.namespace(name.namespace_index),
        name: string_from_stack(&name.name),
    }
}

/// A qualified name under the peer's indexes.
///
/// # Errors
/// [`ConversionError::UnknownNamespace`] when the peer lacks the namespace.
pub fn qualified_name_to_stack(
    name: &model::QualifiedName,
    namespaces: &NamespaceTable,
) -> Result<stack::QualifiedName, ConversionError> {
    Ok(stack::QualifiedName {
        namespace_index: namespace_to_stack(&name.namespace, namespaces)?,
        name: string_to_stack(name.name.as_deref()),
    })
}

/// A text with its language.
#[must_use]
pub fn localized_text_from_stack(text: &stack::LocalizedText) -> model::LocalizedText {
    model::LocalizedText {
        locale: string_from_stack(&text.locale),
        text: string_from_stack(&text.text),
    }
}

/// A text with its language for the stack.
#[must_use]
pub fn localized_text_to_stack(text: &model::LocalizedText) -> stack::LocalizedText {
    stack::LocalizedText {
        locale: string_to_stack(text.locale.as_deref()),
        text: string_to_stack(text.text.as_deref()),
    }
}

pub(super) fn string_from_stack(text: &stack::UAString) -> Option<Arc<str>> {
    text.value().as_deref().map(Arc::from)
}

pub(super) fn string_to_stack(text: Option<&str>) -> stack::UAString {
    stack::UAString::from(text.map(str::to_owned))
}

fn namespace_to_stack(
    namespace: &model::Namespace,
    namespaces: &NamespaceTable,
) -> Result<u16, ConversionError> {
    match namespace {
        model::Namespace::Ua => Ok(0),
        model::Namespace::Index(index) => Ok(*index),
        model::Namespace::Uri(uri) => namespaces
            .index(uri)
            .ok_or_else(|| ConversionError::UnknownNamespace { uri: uri.to_string() }),
    }
}

fn identifier_from_stack(id: &stack::Identifier) -> model::Identifier {
    match id {
        stack::Identifier::Numeric(id) => model::Identifier::Numeric(*id),
        stack::Identifier::String(id) => model::Identifier::String(Arc::from(id.as_ref())),
        stack::Identifier::Guid(id) => model::Identifier::Guid(id.clone().into()),
        stack::Identifier::ByteString(id) => model::Identifier::Opaque(Arc::from(id.as_ref())),
    }
}

fn identifier_to_stack(id: &model::Identifier) -> stack::Identifier {
    match id {
        model::Identifier::Numeric(id) => stack::Identifier::Numeric(*id),
        model::Identifier::String(id) => {
            stack::Identifier::String(stack::UAString::from(id.as_ref()))
        }
        model::Identifier::Guid(id) => stack::Identifier::Guid((*id).into()),
        model::Identifier::Opaque(id) => {
            stack::Identifier::ByteString(stack::ByteString::from(id.to_vec()))
        }
    }
}

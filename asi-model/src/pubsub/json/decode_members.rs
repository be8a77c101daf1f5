//! Reading members that several kinds of messages have.

use std::sync::Arc;

use crate::{
    ids::MessageId,
    json::{JsonNode, Kind},
    opcua_json::{
        Decoder, Mismatch,
        decode_scalar::{integer, text},
    },
    pubsub::MetaDataVersion,
};

/// The message id; one that is not printable ASCII of up to 128 characters is dropped with a note.
pub(super) fn message_id<'t, 'a>(
    root: JsonNode<'t, 'a>,
    decoder: &mut Decoder<'_>,
) -> Result<Option<MessageId>, Mismatch<'t, 'a>> {
    let Some(node) = root.get("MessageId").filter(|id| !id.is_null()) else { return Ok(None) };
    match MessageId::new(text(node)?) {
        Ok(id) => Ok(Some(id)),
        Err(_) => {
            decoder.diagnostics.tolerate(
                node,
                "the MessageId must be 1 to 128 printable ASCII characters without blanks",
            )?;
            Ok(None)
        }
    }
}

/// The publisher id: a string, or a number as 1.04 also allowed.
pub(super) fn publisher_id<'t, 'a>(
    root: JsonNode<'t, 'a>,
) -> Result<Option<Arc<str>>, Mismatch<'t, 'a>> {
    match root.get("PublisherId") {
        None => Ok(None),
        Some(node) if node.is_null() => Ok(None),
        Some(node) => match node.integer::<u64>() {
            Some(number) => Ok(Some(number.to_string().into())),
            None => Ok(Some(text(node)?.into())),
        },
    }
}

/// The id of a DataSetWriter: a number, or its digits in quotes as the first text of 1.04 had it.
pub(super) fn writer_id<'t, 'a>(node: JsonNode<'t, 'a>) -> Result<u16, Mismatch<'t, 'a>> {
    let digits = node.text().filter(|text| text.bytes().all(|byte| byte.is_ascii_digit()));
    let from_text = digits.and_then(|digits| digits.parse().ok());
    from_text.map_or_else(|| integer(node, "a DataSetWriterId from 0 to 65535"), Ok)
}

/// A text member, if it is there.
pub(super) fn optional_text<'t, 'a>(
    root: JsonNode<'t, 'a>,
    name: &str,
) -> Result<Option<Arc<str>>, Mismatch<'t, 'a>> {
    match root.get(name) {
        Some(node) if !node.is_null() => Ok(Some(text(node)?.into())),
        _ => Ok(None),
    }
}

pub(super) fn meta_data_version<'t, 'a>(
    node: JsonNode<'t, 'a>,
) -> Result<MetaDataVersion, Mismatch<'t, 'a>> {
    let part = |name: &str| match node.get(name) {
        Some(part) => integer(part, "a number from 0 to 4294967295"),
        // Compact leaves out zeros.
        None => Ok(0),
    };
    if node.kind() != Kind::Object {
        return Err(Mismatch::new(node, "expected an object with MajorVersion and MinorVersion"));
    }
    Ok(MetaDataVersion { major: part("MajorVersion")?, minor: part("MinorVersion")? })
}

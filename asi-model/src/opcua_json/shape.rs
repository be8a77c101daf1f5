//! Telling the forms of a value apart by the members of its object.

use crate::{
    json::{JsonNode, Kind},
    values::BuiltInType,
};

/// The members of an object that may be a variant or a data value.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shape<'t, 'a> {
    pub(super) ua_type: Option<JsonNode<'t, 'a>>,
    pub(super) value: Option<JsonNode<'t, 'a>>,
    pub(super) type_id: Option<JsonNode<'t, 'a>>,
    pub(super) body: Option<JsonNode<'t, 'a>>,
    pub(super) dimensions: Option<JsonNode<'t, 'a>>,
    pub(super) status: Option<JsonNode<'t, 'a>>,
    /// The status as foreign stacks call it.
    pub(super) status_code: Option<JsonNode<'t, 'a>>,
    pub(super) source_timestamp: Option<JsonNode<'t, 'a>>,
    pub(super) source_picoseconds: Option<JsonNode<'t, 'a>>,
    pub(super) server_timestamp: Option<JsonNode<'t, 'a>>,
    pub(super) server_picoseconds: Option<JsonNode<'t, 'a>>,
    has_others: bool,
    is_empty: bool,
}

impl<'t, 'a> Shape<'t, 'a> {
    /// The shape of an object.
    pub(super) fn of(object: JsonNode<'t, 'a>) -> Self {
        let mut shape = Self { is_empty: true, ..Self::default() };
        for (name, node) in object.members() {
            shape.is_empty = false;
            let Some(name) = name.text() else { continue };
            let slot = match &*name {
                "Type" => &mut shape.type_id,
                "Body" => &mut shape.body,
                "UaType" => &mut shape.ua_type,
                "Value" => &mut shape.value,
                "Dimensions" => &mut shape.dimensions,
                "Status" => &mut shape.status,
                "StatusCode" => &mut shape.status_code,
                "SourceTimestamp" => &mut shape.source_timestamp,
                // 1.04 spelled it with a capital S.
                "SourcePicoseconds" | "SourcePicoSeconds" => &mut shape.source_picoseconds,
                "ServerTimestamp" => &mut shape.server_timestamp,
                "ServerPicoseconds" | "ServerPicoSeconds" => &mut shape.server_picoseconds,
                _ => {
                    shape.has_others = true;
                    continue;
                }
            };
            *slot = Some(node);
        }
        shape
    }

    const fn has_quality(&self) -> bool {
        self.status.is_some()
            || self.status_code.is_some()
            || self.source_timestamp.is_some()
            || self.server_timestamp.is_some()
            || self.source_picoseconds.is_some()
            || self.server_picoseconds.is_some()
    }

    /// True for `{"UaType":…}` without quality: a Variant of version 1.05.
    pub(super) const fn is_variant_105(&self) -> bool {
        self.ua_type.is_some() && !self.has_quality()
    }

    /// True for `{"UaType":…}` with status or times: a DataValue of version 1.05.
    pub(super) const fn is_data_value_105(&self) -> bool {
        self.ua_type.is_some() && self.has_quality()
    }

    /// True for `{"Type":…,"Body":…}` alone: a Variant of version 1.04. OPC Publisher also writes
    /// the name of the type.
    pub(super) fn is_variant_104(&self) -> bool {
        let is_named = |node: JsonNode<'_, '_>| {
            self.body.is_some()
                && node.text().is_some_and(|name| name.parse::<BuiltInType>().is_ok())
        };
        self.type_id.is_some_and(|node| node.kind() == Kind::Number || is_named(node))
            && !self.has_others
            && !self.has_quality()
            && self.value.is_none()
            && self.ua_type.is_none()
    }

    /// The content of `{"Body":…}` alone: a Variant of version 1.04 without its type, as umati shows it.
    pub(super) fn untyped_body(&self) -> Option<JsonNode<'t, 'a>> {
        let is_alone = !self.has_others
            && !self.has_quality()
            && self.type_id.is_none()
            && self.value.is_none()
            && self.ua_type.is_none()
            && self.dimensions.is_none();
        self.body.filter(|_| is_alone)
    }

    /// `{"Value":…}` or at least status or a time, and nothing foreign.
    pub(super) const fn is_data_value(&self) -> bool {
        !self.has_others
            && self.type_id.is_none()
            && self.body.is_none()
            && self.ua_type.is_none()
            && (self.value.is_some() || self.has_quality())
    }

    /// True for `{}`, an object without members.
    pub(super) const fn is_empty(&self) -> bool {
        self.is_empty
    }
}

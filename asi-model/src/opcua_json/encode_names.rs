//! Writing what names things: NodeIds, qualified names and localized texts.

use super::{
    DataEncoding,
    encode::{Encoder, write_name},
};
use crate::{
    json::write,
    values::{ExpandedNodeId, Identifier, LocalizedText, Namespace, NodeId, QualifiedName, Server},
};

impl Encoder<'_> {
    /// A NodeId: an object in 1.04, a text in 1.05.
    pub fn node_id(&self, out: &mut Vec<u8>, id: &NodeId) {
        if self.encoding.is_105() {
            return write::string(out, &id.to_string());
        }
        out.push(b'{');
        self.node_id_members(out, id);
        out.push(b'}');
    }

    fn node_id_members(&self, out: &mut Vec<u8>, id: &NodeId) {
        match &id.identifier {
            Identifier::Numeric(v) => {
                out.extend_from_slice(b"\"Id\":");
                write::unsigned(out, u64::from(*v));
            }
            Identifier::String(v) => {
                out.extend_from_slice(b"\"IdType\":1,\"Id\":");
                write::string(out, v);
            }
            Identifier::Guid(v) => {
                out.extend_from_slice(b"\"IdType\":2,\"Id\":");
                write::string(out, v.hyphenated().encode_lower(&mut uuid::Uuid::encode_buffer()));
            }
            Identifier::Opaque(v) => {
                out.extend_from_slice(b"\"IdType\":3,\"Id\":");
                write::base64(out, v);
            }
        }
        self.namespace_member(out, "Namespace", &id.namespace);
    }

    fn namespace_member(&self, out: &mut Vec<u8>, name: &str, namespace: &Namespace) {
        match namespace {
            Namespace::Ua => {}
            Namespace::Index(index) => {
                write_name(out, name);
                write::unsigned(out, u64::from(*index));
            }
            Namespace::Uri(uri) => {
                write_name(out, name);
                let position = self.namespaces.iter().position(|known| known == uri);
                match position {
                    Some(index) if self.encoding == DataEncoding::Reversible104 => {
                        write::unsigned(out, index as u64 + 1);
                    }
                    _ => write::string(out, uri),
                }
            }
        }
    }

    pub(super) fn expanded_node_id(&self, out: &mut Vec<u8>, id: &ExpandedNodeId) {
        if self.encoding.is_105() {
            return write::string(out, &id.to_string());
        }
        out.push(b'{');
        self.node_id_members(out, &id.node_id);
        match &id.server {
            Server::Local => {}
            Server::Index(index) => {
                write_name(out, "ServerUri");
                write::unsigned(out, u64::from(*index));
            }
            Server::Uri(uri) => {
                write_name(out, "ServerUri");
                write::string(out, uri);
            }
        }
        out.push(b'}');
    }

    /// A qualified name: an object in 1.04, a text in 1.05.
    pub fn qualified_name(&self, out: &mut Vec<u8>, name: &QualifiedName) {
        let Some(text) = &name.name else { return out.extend_from_slice(b"null") };
        if self.encoding.is_105() {
            return write::string(out, &name.to_string());
        }
        out.extend_from_slice(b"{\"Name\":");
        write::string(out, text);
        self.namespace_member(out, "Uri", &name.namespace);
        out.push(b'}');
    }

    /// A localized text; in 1.04 non-reversible the text alone.
    pub fn localized_text(&self, out: &mut Vec<u8>, text: &LocalizedText) {
        if self.encoding == DataEncoding::NonReversible104 {
            return write::nullable_string(out, text.text.as_deref());
        }
        out.push(b'{');
        if let Some(locale) = &text.locale {
            write_name(out, "Locale");
            write::string(out, locale);
        }
        if let Some(text) = &text.text {
            write_name(out, "Text");
            write::string(out, text);
        }
        out.push(b'}');
    }
}

//! XML as a small bounded tree.

use std::borrow::Cow;

use quick_xml::{
    Reader, XmlVersion,
    events::{BytesRef, BytesStart, Event},
};

use super::NodeSetError;

/// Longest document, in bytes.
const BYTES_MAX: usize = 16 * 1024 * 1024;
/// Deepest nesting of elements that is read.
const DEPTH_MAX: usize = 64;
/// Most elements of a document; more is an error.
const ELEMENTS_MAX: usize = 500_000;
/// Most attributes of one element.
const ATTRIBUTES_MAX: usize = 64;

/// An element: names without prefix, text without that of its children.
#[derive(Debug, Default)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) attributes: Vec<(String, String)>,
    pub(super) text: String,
    pub(super) children: Vec<Element>,
}

impl Element {
    pub(super) fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// The text without the blanks that XML allows around a token; no others, which may belong to
    /// an identifier.
    pub(super) fn trimmed(&self) -> &str {
        self.text.trim_matches([' ', '\t', '\r', '\n'])
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }
}

/// Text for element content and attribute values. Characters that XML 1.0 cannot carry are
/// replaced.
pub(super) fn escape(text: &str) -> Cow<'_, str> {
    let is_special = |c: char| {
        matches!(c, '&' | '<' | '>' | '"' | '\'' | '\u{FFFE}' | '\u{FFFF}') || c.is_control()
    };
    if !text.contains(is_special) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            '\t' | '\n' | '\r' | '\u{7F}'..='\u{9F}' => {
                out.push_str(&format!("&#{};", u32::from(c)))
            }
            '\u{0}'..='\u{1F}' | '\u{FFFE}' | '\u{FFFF}' => out.push(char::REPLACEMENT_CHARACTER),
            c => out.push(c),
        }
    }
    Cow::Owned(out)
}

/// Reads a document into its root element. Document types are refused, so that no entity can grow.
pub(super) fn read(bytes: &[u8]) -> Result<Element, NodeSetError> {
    if bytes.len() > BYTES_MAX {
        return Err(NodeSetError::TooLarge { what: "bytes", count_max: BYTES_MAX });
    }
    let text = std::str::from_utf8(bytes)
        .map_err(|_| NodeSetError::malformed(0, "the document is not UTF-8"))?;
    let mut reader = Reader::from_str(text.trim_start_matches('\u{feff}'));
    let mut tree = Tree { open: vec![Element::default()], count: 0 };
    loop {
        let position = reader.buffer_position();
        let malformed = |message: String| NodeSetError::Malformed { position, message };
        match reader.read_event().map_err(|error| malformed(error.to_string()))? {
            Event::Start(start) => {
                let element = tree.element(&start, position)?;
                tree.push_open(element)?;
            }
            Event::Empty(start) => {
                let element = tree.element(&start, position)?;
                tree.push_child(element);
            }
            Event::End(_) => tree.close(),
            Event::Text(content) => tree.push_text(&content.xml_content(XmlVersion::Implicit1_0)),
            Event::CData(content) => tree.push_text(&content.xml_content(XmlVersion::Implicit1_0)),
            Event::GeneralRef(reference) => {
                let c = referenced(&reference).map_err(malformed)?;
                tree.push_text(c.encode_utf8(&mut [0; 4]));
            }
            Event::DocType(_) => {
                return Err(malformed("document types are not accepted".to_owned()));
            }
            Event::Eof => return tree.into_root(),
            _ => {}
        }
    }
}

/// The character that a reference stands for: a number, or one of the five entities of XML.
fn referenced(reference: &BytesRef<'_>) -> Result<char, String> {
    match reference.resolve_char_ref().map_err(|error| error.to_string())? {
        Some(c) => Ok(c),
        None => match &*reference.xml_content(XmlVersion::Implicit1_0) {
            "amp" => Ok('&'),
            "lt" => Ok('<'),
            "gt" => Ok('>'),
            "quot" => Ok('"'),
            "apos" => Ok('\''),
            _ => Err("an entity is not known".to_owned()),
        },
    }
}

/// The elements read so far.
struct Tree {
    /// The document and the elements that are not closed yet, outermost first.
    open: Vec<Element>,
    /// Elements begun, those that are closed included.
    count: usize,
}

impl Tree {
    /// Reads the name and attributes of an element that begins.
    fn element(&mut self, start: &BytesStart<'_>, position: u64) -> Result<Element, NodeSetError> {
        self.count += 1;
        if self.count > ELEMENTS_MAX {
            return Err(NodeSetError::TooLarge { what: "elements", count_max: ELEMENTS_MAX });
        }
        let mut element =
            Element { name: start.local_name().as_ref().to_owned(), ..Element::default() };
        // The reader's own search for repeated attributes takes quadratic time; here the first one
        // counts.
        for (number, attribute) in start.attributes().with_checks(false).enumerate() {
            if number == ATTRIBUTES_MAX {
                let what = "attributes in one element";
                return Err(NodeSetError::TooLarge { what, count_max: ATTRIBUTES_MAX });
            }
            let attribute =
                attribute.map_err(|error| NodeSetError::malformed(position, &error.to_string()))?;
            let value = attribute
                .normalized_value(XmlVersion::Implicit1_0)
                .map_err(|error| NodeSetError::malformed(position, &error.to_string()))?;
            element
                .attributes
                .push((attribute.key.local_name().as_ref().to_owned(), value.into_owned()));
        }
        Ok(element)
    }

    fn push_open(&mut self, element: Element) -> Result<(), NodeSetError> {
        if self.open.len() >= DEPTH_MAX {
            return Err(NodeSetError::TooLarge { what: "levels of nesting", count_max: DEPTH_MAX });
        }
        self.open.push(element);
        Ok(())
    }

    /// Closes the element last opened. The reader has checked that the names agree.
    fn close(&mut self) {
        if self.open.len() > 1
            && let Some(element) = self.open.pop()
        {
            self.push_child(element);
        }
    }

    fn push_child(&mut self, element: Element) {
        if let Some(parent) = self.open.last_mut() {
            parent.children.push(element);
        }
    }

    fn push_text(&mut self, text: &str) {
        if let Some(element) = self.open.last_mut() {
            element.text.push_str(text);
        }
    }

    fn into_root(mut self) -> Result<Element, NodeSetError> {
        let mut document = self.open.pop().filter(|_| self.open.is_empty()).unwrap_or_default();
        match document.children.len() {
            1 => Ok(document.children.remove(0)),
            _ => Err(NodeSetError::malformed(
                0,
                "the document must have exactly one closed root element",
            )),
        }
    }
}

//! XML as a small bounded tree.

use std::borrow::Cow;

use quick_xml::{Reader, XmlVersion, events::Event};

use super::NodeSetError;

/// Longest document, in bytes.
const BYTES_MAX: usize = 16 * 1024 * 1024;
/// Deepest nesting.
const DEPTH_MAX: usize = 64;
/// Most elements.
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
    let mut open = vec![Element::default()];
    let mut count = 0;
    loop {
        let position = reader.buffer_position();
        let malformed = |message: String| NodeSetError::Malformed { position, message };
        let event = reader.read_event().map_err(|error| malformed(error.to_string()))?;
        match event {
            Event::Start(_) | Event::Empty(_) => {
                count += 1;
                if count > ELEMENTS_MAX {
                    return Err(NodeSetError::TooLarge {
                        what: "elements",
                        count_max: ELEMENTS_MAX,
                    });
                }
                let is_empty = matches!(event, Event::Empty(_));
                let (Event::Start(start) | Event::Empty(start)) = event else { continue };
                let mut element =
                    Element { name: start.local_name().as_ref().to_owned(), ..Element::default() };
                // The reader's own search for repeated attributes takes quadratic time; here the
                // first one counts.
                for (number, attribute) in start.attributes().with_checks(false).enumerate() {
                    if number == ATTRIBUTES_MAX {
                        let what = "attributes in one element";
                        return Err(NodeSetError::TooLarge { what, count_max: ATTRIBUTES_MAX });
                    }
                    let attribute = attribute.map_err(|error| malformed(error.to_string()))?;
                    let value = attribute
                        .normalized_value(XmlVersion::Implicit1_0)
                        .map_err(|error| malformed(error.to_string()))?;
                    element
                        .attributes
                        .push((attribute.key.local_name().as_ref().to_owned(), value.into_owned()));
                }
                if is_empty {
                    push_child(&mut open, element);
                } else if open.len() >= DEPTH_MAX {
                    return Err(NodeSetError::TooLarge {
                        what: "levels of nesting",
                        count_max: DEPTH_MAX,
                    });
                } else {
                    open.push(element);
                }
            }
            Event::End(_) => {
                // The reader has checked that it closes the element last opened.
                if open.len() > 1
                    && let Some(element) = open.pop()
                {
                    push_child(&mut open, element);
                }
            }
            Event::Text(content) => {
                push_text(&mut open, &content.xml_content(XmlVersion::Implicit1_0))
            }
            Event::CData(content) => {
                push_text(&mut open, &content.xml_content(XmlVersion::Implicit1_0))
            }
            Event::GeneralRef(reference) => {
                let resolved =
                    reference.resolve_char_ref().map_err(|error| malformed(error.to_string()))?;
                let c = match resolved {
                    Some(c) => c,
                    None => match &*reference.xml_content(XmlVersion::Implicit1_0) {
                        "amp" => '&',
                        "lt" => '<',
                        "gt" => '>',
                        "quot" => '"',
                        "apos" => '\'',
                        _ => return Err(malformed("an entity is not known".to_owned())),
                    },
                };
                push_text(&mut open, c.encode_utf8(&mut [0; 4]));
            }
            Event::DocType(_) => {
                return Err(malformed("document types are not accepted".to_owned()));
            }
            Event::Eof => break,
            _ => {}
        }
    }
    let mut document = open.pop().filter(|_| open.is_empty()).unwrap_or_default();
    match document.children.len() {
        1 => Ok(document.children.remove(0)),
        _ => Err(NodeSetError::malformed(
            0,
            "the document must have exactly one closed root element",
        )),
    }
}

fn push_child(open: &mut [Element], element: Element) {
    if let Some(parent) = open.last_mut() {
        parent.children.push(element);
    }
}

fn push_text(open: &mut [Element], text: &str) {
    if let Some(element) = open.last_mut() {
        element.text.push_str(text);
    }
}

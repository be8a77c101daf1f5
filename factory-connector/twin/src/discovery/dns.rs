//! As much of DNS messages (RFC 1035, RFC 6762, RFC 6763) as announcing one service takes: queries are read, answers
//! written. Everything read comes from anybody on the network, so reading is bounded and never fails loudly.

use std::net::Ipv4Addr;

/// Longest label in bytes.
pub(super) const LABEL_BYTES_MAX: usize = 63;
/// Most labels of a name.
const LABELS_MAX: usize = 16;
/// Most questions and known answers looked at in one query.
const ENTRIES_MAX: usize = 64;
/// In a header: this is an answer, and we know best.
const RESPONSE: u16 = 0x8400;
/// In a class: of a question, answer to me alone; of an answer, forget what you knew before.
const TOP_BIT: u16 = 0x8000;
/// The class of the internet.
const INTERNET: u16 = 1;

/// Types of records.
pub(super) mod kind {
    pub const A: u16 = 1;
    pub const PTR: u16 = 12;
    pub const TXT: u16 = 16;
    pub const SRV: u16 = 33;
    pub const ANY: u16 = 255;
}

/// A name as its labels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Name(pub Vec<String>);

impl Name {
    pub fn new<const N: usize>(labels: [&str; N]) -> Self {
        Self(labels.iter().map(|label| (*label).to_owned()).collect())
    }

    /// Names are the same in whatever case.
    pub fn is(&self, other: &Self) -> bool {
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(|(a, b)| a.eq_ignore_ascii_case(b))
    }
}

/// What a record says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Data {
    Address(Ipv4Addr),
    Pointer(Name),
    Service { port: u16, host: Name },
    Text(Vec<String>),
}

impl Data {
    pub const fn kind(&self) -> u16 {
        match self {
            Self::Address(_) => kind::A,
            Self::Pointer(_) => kind::PTR,
            Self::Service { .. } => kind::SRV,
            Self::Text(_) => kind::TXT,
        }
    }
}

/// One record to send.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Record {
    pub name: Name,
    pub ttl_s: u32,
    pub data: Data,
}

impl Record {
    /// Only pointers are shared with others.
    const fn is_ours_alone(&self) -> bool {
        !matches!(self.data, Data::Pointer(_))
    }
}

/// One question.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Question {
    pub name: Name,
    pub kind: u16,
    /// The answer is wanted by the one who asks alone.
    pub is_unicast: bool,
}

/// A query as far as it matters here.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Query {
    pub id: u16,
    pub questions: Vec<Question>,
    /// Pointers that the one who asks knows already, with the time they are still good for.
    pub known: Vec<(Name, Name, u32)>,
}

/// An answer of somebody else, as far as it matters here: whose names it claims.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Claims(pub Vec<(Name, u16)>);

/// What came.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Message {
    Query(Query),
    Answer(Claims),
}

/// Reads a message; `None` where it is none.
pub(super) fn read(bytes: &[u8]) -> Option<Message> {
    let mut reader = Reader { bytes, at: 0 };
    let (id, flags) = (reader.u16()?, reader.u16()?);
    let (questions, answers) = (reader.u16()?, reader.u16()?);
    reader.at += 4;
    let mut query = Query { id, ..Query::default() };
    for _ in 0..usize::from(questions).min(ENTRIES_MAX) {
        let name = reader.name()?;
        let (kind, class) = (reader.u16()?, reader.u16()?);
        if matches!(class & !TOP_BIT, INTERNET | kind::ANY) {
            query.questions.push(Question { name, kind, is_unicast: class & TOP_BIT != 0 });
        }
    }
    let is_answer = flags & 0x8000 != 0;
    let mut claims = Claims::default();
    for _ in 0..usize::from(answers).min(ENTRIES_MAX) {
        let name = reader.name()?;
        let (kind, _class, ttl_s, length) = (reader.u16()?, reader.u16()?, reader.u32()?, reader.u16()?);
        let end = reader.at.checked_add(usize::from(length)).filter(|end| *end <= bytes.len())?;
        if is_answer {
            claims.0.push((name, kind));
        } else if kind == kind::PTR {
            let target = reader.name()?;
            query.known.push((name, target, ttl_s));
        }
        reader.at = end;
    }
    Some(if is_answer { Message::Answer(claims) } else { Message::Query(query) })
}

/// Writes an answer. With `asked`, it is for one who does not speak multicast DNS itself (RFC 6762 §6.7): the question
/// is repeated and nothing is to be kept for long.
pub(super) fn answer(records: &[Record], asked: Option<(u16, &Question)>) -> Vec<u8> {
    let mut out = Vec::with_capacity(512);
    let count = u16::try_from(records.len()).unwrap_or(u16::MAX);
    let id = asked.map_or(0, |(id, _)| id);
    for number in [id, RESPONSE, u16::from(asked.is_some()), count, 0, 0] {
        out.extend(number.to_be_bytes());
    }
    if let Some((_, question)) = asked {
        write_name(&mut out, &question.name);
        out.extend(question.kind.to_be_bytes());
        out.extend(INTERNET.to_be_bytes());
    }
    for record in records {
        write_record(&mut out, record, asked.is_some());
    }
    out
}

/// Writes the question whether somebody has a name already. All are to hear the answer: where several programs of one
/// machine speak multicast DNS, an answer to one of them may reach another.
pub(super) fn probe(name: &Name) -> Vec<u8> {
    let mut out = Vec::with_capacity(128);
    for number in [0_u16, 0, 1, 0, 0, 0] {
        out.extend(number.to_be_bytes());
    }
    write_name(&mut out, name);
    out.extend(kind::ANY.to_be_bytes());
    out.extend(INTERNET.to_be_bytes());
    out
}

fn write_record(out: &mut Vec<u8>, record: &Record, is_legacy: bool) {
    write_name(out, &record.name);
    out.extend(record.data.kind().to_be_bytes());
    let flush = if record.is_ours_alone() && !is_legacy { TOP_BIT } else { 0 };
    out.extend((INTERNET | flush).to_be_bytes());
    let ttl_s = if is_legacy { record.ttl_s.min(10) } else { record.ttl_s };
    out.extend(ttl_s.to_be_bytes());
    let length_at = out.len();
    out.extend([0, 0]);
    match &record.data {
        Data::Address(address) => out.extend(address.octets()),
        Data::Pointer(target) => write_name(out, target),
        Data::Service { port, host } => {
            // Priority and weight say nothing where there is one server.
            out.extend([0; 4]);
            out.extend(port.to_be_bytes());
            write_name(out, host);
        }
        Data::Text(texts) => texts.iter().for_each(|text| write_text(out, text, usize::from(u8::MAX))),
    }
    let length = u16::try_from(out.len() - length_at - 2).unwrap_or(u16::MAX);
    out[length_at..length_at + 2].copy_from_slice(&length.to_be_bytes());
}

fn write_name(out: &mut Vec<u8>, name: &Name) {
    for label in &name.0 {
        write_text(out, label, LABEL_BYTES_MAX);
    }
    out.push(0);
}

fn write_text(out: &mut Vec<u8>, text: &str, bytes_max: usize) {
    let text = cut(text, bytes_max);
    out.push(u8::try_from(text.len()).unwrap_or(0));
    out.extend(text.as_bytes());
}

/// The beginning of a text that fits.
pub(super) fn cut(text: &str, bytes_max: usize) -> &str {
    let end = (0..=bytes_max.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
    &text[..end]
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn u8(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        Some(byte)
    }

    fn u16(&mut self) -> Option<u16> {
        Some(u16::from_be_bytes([self.u8()?, self.u8()?]))
    }

    fn u32(&mut self) -> Option<u32> {
        Some(u32::from_be_bytes([self.u8()?, self.u8()?, self.u8()?, self.u8()?]))
    }

    /// A name, whose end may stand elsewhere: always further ahead in the message, so that this comes to an end.
    fn name(&mut self) -> Option<Name> {
        let mut labels = Vec::new();
        let (mut at, mut after) = (self.at, None);
        loop {
            let length = usize::from(*self.bytes.get(at)?);
            match length {
                0 => {
                    self.at = after.unwrap_or(at + 1);
                    return Some(Name(labels));
                }
                1..=LABEL_BYTES_MAX => {
                    let label = self.bytes.get(at + 1..at + 1 + length)?;
                    if labels.len() == LABELS_MAX {
                        return None;
                    }
                    labels.push(String::from_utf8_lossy(label).into_owned());
                    at += 1 + length;
                }
                0xC0.. => {
                    let target = ((length & 0x3F) << 8) | usize::from(*self.bytes.get(at + 1)?);
                    after.get_or_insert(at + 2);
                    if target >= at {
                        return None;
                    }
                    at = target;
                }
                _ => return None,
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]
mod tests {
    use super::*;

    fn service() -> Name {
        Name::new(["_opcua-tcp", "_tcp", "local"])
    }

    #[test]
    fn a_query_with_a_compressed_known_answer_is_read() {
        let mut bytes = vec![0, 7, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0];
        write_name(&mut bytes, &service());
        bytes.extend([0, 12, 0x80, 1]);
        // The known answer points back to the question's name, and its target too.
        bytes.extend([0xC0, 12, 0, 12, 0, 1, 0, 0, 0x11, 0x94, 0, 6, 3, b'f', b'o', b'o', 0xC0, 12]);
        let Some(Message::Query(query)) = read(&bytes) else { panic!("it is a query") };
        assert_eq!(query.id, 7);
        assert_eq!(query.questions, [Question { name: service(), kind: kind::PTR, is_unicast: true }]);
        let mut instance = service();
        instance.0.insert(0, "foo".to_owned());
        assert_eq!(query.known, [(service(), instance, 4500)]);
    }

    #[test]
    fn what_is_written_can_be_read() {
        let record = Record { name: service(), ttl_s: 120, data: Data::Pointer(Name::new(["x", "local"])) };
        let Some(Message::Answer(claims)) = read(&answer(&[record], None)) else { panic!("it is an answer") };
        assert_eq!(claims.0, [(service(), kind::PTR)]);
        let Some(Message::Query(query)) = read(&probe(&service())) else { panic!("it is a query") };
        assert_eq!(query.questions, [Question { name: service(), kind: kind::ANY, is_unicast: false }]);
    }

    #[test]
    fn nonsense_is_nothing() {
        let loops = [0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0xC0, 12, 0, 12, 0, 1];
        assert_eq!(read(&loops), None, "a name that points to itself");
        assert_eq!(read(&[]), None);
        let many = [[0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0].as_slice(), &[0; 9000]].concat();
        assert!(read(&many).is_some(), "a bounded number is looked at");
        // A valid message with every byte changed to every value in turn neither panics nor takes long.
        let valid = answer(&[Record { name: service(), ttl_s: 1, data: Data::Pointer(service()) }], None);
        for at in 0..valid.len() {
            for value in 0..=u8::MAX {
                let mut bytes = valid.clone();
                bytes[at] = value;
                let _ = read(&bytes);
                let _ = read(&bytes[..at]);
            }
        }
    }

    #[test]
    fn labels_end_at_whole_characters() {
        assert_eq!(cut("Prüfstand", 3), "Pr");
        assert_eq!(cut("Prüfstand", 4), "Prü");
    }
}

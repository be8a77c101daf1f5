//! What the twin says about itself in multicast DNS: which records, to which question. Pure.

use std::net::Ipv4Addr;

use super::dns::{self, Data, LABEL_BYTES_MAX, Name, Query, Question, Record, kind};

/// The service type of OPC UA over TCP.
const SERVICE: [&str; 3] = ["_opcua-tcp", "_tcp", "local"];
/// What one asks to learn which types of services there are (RFC 6763 §9).
const ENUMERATION: [&str; 4] = ["_services", "_dns-sd", "_udp", "local"];
/// How long records hold that name a host, and the others, in seconds (RFC 6762 §10).
const TTL_HOST_S: u32 = 120;
const TTL_OTHER_S: u32 = 4500;
/// The path of the endpoint URL, and the capability of OPC 10000-12 Annex D: provides current data.
const TEXTS: [&str; 2] = ["path=/", "caps=DA"];
/// The port of multicast DNS; who asks from another one does not speak it.
pub(super) const PORT: u16 = 5353;

/// The twin's names.
#[derive(Debug, Clone)]
pub(super) struct Zone {
    pub instance: Name,
    host: Name,
    port: u16,
}

/// An answer and who gets it.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Reply {
    pub bytes: Vec<u8>,
    pub is_for_all: bool,
    /// Somebody is about to take the name, and has to hear at once that it is taken.
    pub is_defence: bool,
}

impl Zone {
    /// The n-th choice of a name, the first being 1.
    pub fn new(name: &str, host: &str, port: u16, choice: u32) -> Self {
        let number = if choice > 1 { format!(" ({choice})") } else { String::new() };
        let label = format!("{}{number}", dns::cut(name, LABEL_BYTES_MAX - number.len()));
        let mut instance = Name::new(SERVICE);
        instance.0.insert(0, label);
        Self { instance, host: Name(host.split('.').map(ToOwned::to_owned).collect()), port }
    }

    /// Everything, for those who listen.
    pub fn announcement(&self, address: Ipv4Addr) -> Vec<u8> {
        dns::answer(&[self.pointer(), self.service(), self.text(), self.address(address)], None)
    }

    /// Everything but the host's address, which may be true after the twin: good for no longer.
    pub fn goodbye(&self) -> Vec<u8> {
        let records = [self.pointer(), self.service(), self.text()].map(|record| Record { ttl_s: 0, ..record });
        dns::answer(&records, None)
    }

    /// What there is to say to a query on the interface with this address.
    pub fn reply(&self, query: &Query, address: Ipv4Addr, from_port: u16) -> Option<Reply> {
        let mut records: Vec<Record> = Vec::new();
        let mut is_for_all = false;
        for question in &query.questions {
            let found = self.answers(question, query, address);
            is_for_all |= !found.is_empty() && !question.is_unicast;
            for record in found {
                if !records.contains(&record) {
                    records.push(record);
                }
            }
        }
        if records.is_empty() {
            return None;
        }
        let is_legacy = from_port != PORT;
        let asked = query.questions.first().filter(|_| is_legacy).map(|question| (query.id, question));
        let is_defence = query.questions.iter().any(|q| q.kind == kind::ANY && q.name.is(&self.instance));
        Some(Reply { bytes: dns::answer(&records, asked), is_for_all: is_for_all && !is_legacy, is_defence })
    }

    fn answers(&self, question: &Question, query: &Query, address: Ipv4Addr) -> Vec<Record> {
        let wants = |kind| question.kind == kind || question.kind == kind::ANY;
        if question.name.is(&Name::new(ENUMERATION)) && wants(kind::PTR) {
            let data = Data::Pointer(Name::new(SERVICE));
            return vec![Record { name: Name::new(ENUMERATION), ttl_s: TTL_OTHER_S, data }];
        }
        if question.name.is(&Name::new(SERVICE)) && wants(kind::PTR) {
            // With everything that would be asked for next.
            let is_known = query.known.iter().any(|(name, target, ttl_s)| {
                name.is(&question.name) && target.is(&self.instance) && *ttl_s >= TTL_OTHER_S / 2
            });
            return match is_known {
                true => Vec::new(),
                false => vec![self.pointer(), self.service(), self.text(), self.address(address)],
            };
        }
        let mut records = Vec::new();
        if question.name.is(&self.instance) {
            if wants(kind::SRV) {
                records.extend([self.service(), self.address(address)]);
            }
            if wants(kind::TXT) {
                records.push(self.text());
            }
        } else if question.name.is(&self.host) && wants(kind::A) {
            records.push(self.address(address));
        }
        records
    }

    fn pointer(&self) -> Record {
        Record { name: Name::new(SERVICE), ttl_s: TTL_OTHER_S, data: Data::Pointer(self.instance.clone()) }
    }

    fn service(&self) -> Record {
        let data = Data::Service { port: self.port, host: self.host.clone() };
        Record { name: self.instance.clone(), ttl_s: TTL_HOST_S, data }
    }

    fn text(&self) -> Record {
        let data = Data::Text(TEXTS.iter().map(|text| (*text).to_owned()).collect());
        Record { name: self.instance.clone(), ttl_s: TTL_OTHER_S, data }
    }

    fn address(&self, address: Ipv4Addr) -> Record {
        Record { name: self.host.clone(), ttl_s: TTL_HOST_S, data: Data::Address(address) }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on should say where")]
mod tests {
    use super::*;

    const ADDRESS: Ipv4Addr = Ipv4Addr::new(192, 0, 2, 7);

    fn ask(name: Name, kind: u16) -> Query {
        Query { id: 9, questions: vec![Question { name, kind, is_unicast: false }], known: Vec::new() }
    }

    fn kinds(zone: &Zone, name: Name, kind: u16) -> Vec<u16> {
        let found = zone.answers(&ask(name.clone(), kind).questions[0], &ask(name, kind), ADDRESS);
        found.iter().map(|record| record.data.kind()).collect()
    }

    #[test]
    fn each_question_gets_its_records() {
        let zone = Zone::new("Twin of F", "press.local", 4840, 1);
        let check = |name: &[&str], kind, expected: &[u16]| {
            let name = Name(name.iter().map(|label| (*label).to_owned()).collect());
            assert_eq!(kinds(&zone, name.clone(), kind), expected, "{name:?}");
        };
        check(&["_opcua-tcp", "_tcp", "local"], kind::PTR, &[kind::PTR, kind::SRV, kind::TXT, kind::A]);
        check(&["_OPCUA-TCP", "_tcp", "LOCAL"], kind::ANY, &[kind::PTR, kind::SRV, kind::TXT, kind::A]);
        check(&["_http", "_tcp", "local"], kind::PTR, &[]);
        check(&["Twin of F", "_opcua-tcp", "_tcp", "local"], kind::SRV, &[kind::SRV, kind::A]);
        check(&["Twin of F", "_opcua-tcp", "_tcp", "local"], kind::TXT, &[kind::TXT]);
        check(&["press", "local"], kind::A, &[kind::A]);
        check(&["other", "local"], kind::A, &[]);
        check(&["_services", "_dns-sd", "_udp", "local"], kind::PTR, &[kind::PTR]);
    }

    #[test]
    fn who_knows_already_is_not_told_again() {
        let zone = Zone::new("Twin of F", "press.local", 4840, 1);
        let service = Name::new(SERVICE);
        let mut query = ask(service.clone(), kind::PTR);
        query.known.push((service.clone(), zone.instance.clone(), TTL_OTHER_S));
        assert_eq!(zone.reply(&query, ADDRESS, PORT), None);
        query.known[0].2 = TTL_OTHER_S / 3;
        assert!(zone.reply(&query, ADDRESS, PORT).is_some_and(|reply| reply.is_for_all));
        query.questions[0].is_unicast = true;
        assert!(zone.reply(&query, ADDRESS, PORT).is_some_and(|reply| !reply.is_for_all));
        assert!(zone.reply(&ask(service, kind::PTR), ADDRESS, 40_000).is_some_and(|reply| !reply.is_for_all));
        let probe = zone.reply(&ask(zone.instance.clone(), kind::ANY), ADDRESS, PORT).unwrap();
        assert!(probe.is_for_all && probe.is_defence);
    }

    #[test]
    fn a_long_name_fits_with_its_number() {
        let long = "a".repeat(100);
        for choice in [1, 2, 12] {
            let label = Zone::new(&long, "press.local", 1, choice).instance.0.swap_remove(0);
            assert_eq!(label.len(), LABEL_BYTES_MAX);
            assert_eq!(label.ends_with(&format!(" ({choice})")), choice > 1);
        }
    }
}

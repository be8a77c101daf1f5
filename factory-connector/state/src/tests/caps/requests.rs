//! Requests of partners, and what their planners do to them from revision to revision.

use asi_model::messages::OperationNetworkMessage;
use proptest::prelude::*;
use serde_json::{Value, json};

pub const PARTNERS: [&str; 3] = ["acme", "hull", "keel"];
pub const FIELDS: [&str; 3] = ["one", "two", "three"];
/// Built-in types UInt64 and Double.
const TYPES: [u8; 2] = [9, 11];

/// A request as its partner states it.
#[derive(Debug, Clone)]
pub struct Requested {
    pub id: String,
    recipients: Vec<&'static str>,
    fields: Vec<&'static str>,
    field_type: u8,
    purpose: u32,
    is_asked: bool,
}

impl Requested {
    fn new(id: &str, recipients: &[&'static str], fields: &[&'static str]) -> Self {
        Self {
            id: id.to_owned(),
            recipients: recipients.to_vec(),
            fields: fields.to_vec(),
            field_type: TYPES[0],
            purpose: 0,
            is_asked: true,
        }
    }

    fn json(&self, semantic: Option<&str>) -> Value {
        let field = |name: &&str| match semantic {
            Some(semantic) => {
                json!({ "name": name, "type": self.field_type, "semantic": semantic })
            }
            None => json!({ "name": name, "type": self.field_type }),
        };
        let fields: Vec<Value> = self.fields.iter().map(field).collect();
        json!({ "dynamicDataRequestId": self.id, "requesterId": self.recipients[0],
            "recipientList": self.recipients, "purpose": format!("Plan {}", self.purpose),
            "updateFrequency": 1, "updateFrequencyUnit": "HOUR",
            "reportDataFormat": { "reportName": "R", "reportFieldList": fields } })
    }
}

/// Change of a planner.
#[derive(Debug, Clone)]
pub enum Revision {
    /// Another purpose: the consents to all fields end.
    Purpose(usize),
    /// A recipient more or less.
    Recipient { request: usize, partner: usize },
    /// Values of another type.
    Type(usize),
    /// A field more or less.
    Field { request: usize, field: usize },
    /// The same under another id.
    Id(usize),
    /// The request is removed, or asked again.
    Presence(usize),
    /// A request more of the same, beside it.
    Copy(usize),
}

pub fn any_revision() -> impl Strategy<Value = Revision> {
    let request = || 0..4_usize;
    prop_oneof![
        3 => request().prop_map(Revision::Purpose),
        2 => (request(), 0..3_usize)
            .prop_map(|(request, partner)| Revision::Recipient { request, partner }),
        1 => request().prop_map(Revision::Type),
        2 => (request(), 0..3_usize)
            .prop_map(|(request, field)| Revision::Field { request, field }),
        2 => request().prop_map(Revision::Id),
        2 => request().prop_map(Revision::Presence),
        1 => request().prop_map(Revision::Copy),
    ]
}

/// Requests of several partners in one operation.
#[derive(Debug, Clone)]
pub struct Requests {
    pub all: Vec<Requested>,
    semantic: Option<&'static str>,
    revision: u64,
}

impl Requests {
    /// Four requests of three fields that mean nothing in particular.
    pub fn of_partners() -> Self {
        let of = |id, recipients: &[&'static str]| Requested::new(id, recipients, &FIELDS);
        let all = vec![
            of("a", &["acme"]),
            of("a2", &["acme"]),
            of("b", &["hull"]),
            of("c", &["hull", "keel"]),
        ];
        Self { all, semantic: None, revision: 1 }
    }

    /// One request of one field with a meaning.
    pub fn of_one_field() -> Self {
        let all = vec![Requested::new("a", &["acme"], &FIELDS[..1])];
        Self { all, semantic: Some("PRODUCED_QUANTITY"), revision: 1 }
    }

    /// Returns the network in the present revision.
    pub fn message(&self) -> OperationNetworkMessage {
        let asked = self.all.iter().filter(|request| request.is_asked);
        let requests: Vec<Value> = asked.map(|request| request.json(self.semantic)).collect();
        serde_json::from_value(json!({ "messageId": format!("m{}", self.revision),
            "factoryId": "F", "collaborationId": "c", "revision": self.revision,
            "operationNetwork": { "operationNetworkId": "n", "operationList": [
                { "operationId": "op", "operationType": "PRODUCTION",
                  "dynamicDataRequestList": requests } ] } }))
        .expect("a network")
    }

    /// Makes a change, and returns the network in the next revision.
    pub fn revise(&mut self, revision: &Revision) -> OperationNetworkMessage {
        self.revision += 1;
        let next = self.revision;
        let count = self.all.len();
        match *revision {
            Revision::Purpose(request) => self.all[request % count].purpose += 1,
            Revision::Recipient { request, partner } => {
                toggle(&mut self.all[request % count].recipients, PARTNERS[partner]);
            }
            Revision::Type(request) => {
                let request = &mut self.all[request % count];
                request.field_type =
                    if request.field_type == TYPES[0] { TYPES[1] } else { TYPES[0] };
            }
            Revision::Field { request, field } => {
                toggle(&mut self.all[request % count].fields, FIELDS[field]);
            }
            Revision::Id(request) => self.all[request % count].id = format!("r{next}"),
            Revision::Presence(request) => {
                let is_asked = &mut self.all[request % count].is_asked;
                *is_asked = !*is_asked;
            }
            Revision::Copy(request) => {
                let copy =
                    Requested { id: format!("r{next}"), ..self.all[request % count].clone() };
                self.all.push(copy);
            }
        }
        self.message()
    }
}

/// Adds what is not there and removes what is, but for the last one.
fn toggle(all: &mut Vec<&'static str>, one: &'static str) {
    match all.iter().position(|other| *other == one) {
        Some(at) if all.len() > 1 => drop(all.remove(at)),
        Some(_) => {}
        None => all.push(one),
    }
}

//! Changes of a network's document, derived from its schema: at every place of the document each
//! member changed to other values, removed, renamed and added, and each element of a list removed
//! and added. A member that the schema gets is walked without a row here.

use std::sync::LazyLock;

use serde_json::{Map, Value, json};

use crate::chain::ids;

/// Schema of the document, of the wire contract.
static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
    let schemas = asi_model::schema::all();
    let network = schemas.into_iter().find(|(name, _)| *name == "network.schema.json");
    let (_, schema) = network.expect("the schema of networks");
    serde_json::to_value(schema).expect("it serialises")
});

const OPERATION: &str = "operationId";
/// Members of a relation that name operations.
pub const ENDS: [&str; 2] = ["predecessorOperationId", "successorOperationId"];

/// Ids that stand in a document for things that are there.
pub struct Known {
    pub factories: Vec<String>,
    pub organisations: Vec<String>,
    /// The organisation in whose name requests are added.
    pub requester: String,
}

/// A document with one change.
#[derive(Debug, Clone)]
pub struct Change {
    /// JSON pointer of the member or element that is changed, removed, renamed or added.
    pub pointer: String,
    pub kind: Kind,
    pub document: Value,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Changed,
    Removed,
    /// The member has another name, which nobody knows.
    Renamed,
    Added,
}

/// Returns every change of a document.
pub fn changes(document: &Value, known: &Known) -> Vec<Change> {
    let mut walk = Walk { document, known, found: Vec::new() };
    walk.object(document, &SCHEMA, "");
    walk.found
}

/// Returns the schema behind references; of several the first that is not null.
fn resolved(schema: &Value) -> &Value {
    if let Some(name) = named(schema) {
        return resolved(&SCHEMA["$defs"][name]);
    }
    let is_null = |variant: &&Value| variant["type"] == "null";
    match schema["anyOf"].as_array() {
        Some(variants) => resolved(variants.iter().find(|v| !is_null(v)).expect("a variant")),
        None => schema,
    }
}

/// Returns the name of the definition to which a schema refers.
fn named(schema: &Value) -> Option<&str> {
    let variants = schema["anyOf"].as_array().into_iter().flatten();
    let mut all = std::iter::once(schema).chain(variants);
    all.find_map(|schema| schema["$ref"].as_str()?.strip_prefix("#/$defs/"))
}

/// Returns the members of an object's schema, those of all its variants.
fn members(schema: &Value) -> Map<String, Value> {
    let schema = resolved(schema);
    let variants = schema["oneOf"].as_array().into_iter().flatten();
    let all = std::iter::once(schema).chain(variants);
    let mut found = Map::new();
    for (name, member) in all.filter_map(|schema| schema["properties"].as_object()).flatten() {
        let known = found.entry(name.clone()).or_insert_with(|| member.clone());
        // Variants differ in the constant that tells them apart.
        if let Some(constant) = member.get("const") {
            let mut options = known["enum"].as_array().cloned().unwrap_or_default();
            options.push(constant.clone());
            *known = json!({ "type": "string", "enum": options });
        }
    }
    found
}

/// Lets relations follow an operation that got another id or is gone, so that the document is right but for
/// the rights of its author.
fn follow(before: &Value, after: &mut Value) {
    let operations = after["operationList"].as_array_mut().into_iter().flatten();
    let requests = operations.flat_map(|operation| {
        operation.get_mut("dynamicDataRequestList").and_then(Value::as_array_mut)
    });
    // A frequency has a period.
    for request in requests.flatten() {
        let pair = [("updateFrequency", json!(7)), ("updateFrequencyUnit", json!("MINUTE"))];
        if pair.iter().any(|(name, _)| request.get(*name).is_some()) {
            for (name, sample) in pair {
                let request = request.as_object_mut().expect("a request");
                request.entry(name).or_insert(sample);
            }
        }
    }
    let (old, new) =
        (ids(&before["operationList"], OPERATION), ids(&after["operationList"], OPERATION));
    let Some(relations) = after.get_mut("operationRelationList").and_then(Value::as_array_mut)
    else {
        return;
    };
    let gone: Vec<&String> = old.iter().filter(|id| !new.contains(id)).collect();
    if old.len() == new.len() {
        for (old, new) in old.iter().zip(&new).filter(|(old, new)| old != new) {
            for relation in relations.iter_mut() {
                for end in ENDS {
                    if relation[end] == old.as_str() {
                        relation[end] = json!(new);
                    }
                }
            }
        }
    } else {
        let is_gone = |end: &Value| gone.iter().any(|id| *end == id.as_str());
        relations.retain(|relation| !ENDS.iter().any(|end| is_gone(&relation[end])));
    }
}

/// Returns a value of a member that is more than its schema says.
fn well_formed(name: &str) -> Option<Value> {
    match name {
        "unit" | "quantityUnit" => Some(json!("KGM")),
        "type" => Some(json!("Double")),
        _ => None,
    }
}

struct Walk<'d> {
    document: &'d Value,
    known: &'d Known,
    found: Vec<Change>,
}

impl Walk<'_> {
    fn add(&mut self, pointer: String, kind: Kind, change: impl FnOnce(&mut Value, &str)) {
        let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
        let mut document = self.document.clone();
        change(document.pointer_mut(parent).expect("a parent"), name);
        follow(self.document, &mut document);
        self.found.push(Change { pointer, kind, document });
    }

    fn object(&mut self, value: &Value, schema: &Value, at: &str) {
        for (name, member) in members(schema) {
            let pointer = format!("{at}/{name}");
            match value.get(&name) {
                None => {
                    let sample = match name.as_str() {
                        "inspectedOperationId" => {
                            self.document["operationList"][0]["operationId"].clone()
                        }
                        name => well_formed(name).unwrap_or_else(|| self.sample(&member)),
                    };
                    self.add(pointer, Kind::Added, |parent, name| parent[name] = sample);
                }
                Some(inner) => {
                    self.add(pointer.clone(), Kind::Removed, |parent, name| {
                        parent.as_object_mut().expect("an object").remove(name);
                    });
                    self.add(pointer.clone(), Kind::Renamed, |parent, name| {
                        let parent = parent.as_object_mut().expect("an object");
                        let value = parent.remove(name).expect("the member");
                        parent.insert(format!("{name}Too"), value);
                    });
                    self.inner(inner, &member, &pointer);
                }
            }
        }
    }

    fn inner(&mut self, value: &Value, schema: &Value, pointer: &str) {
        let target = resolved(schema);
        if let Some(elements) = value.as_array() {
            for (index, element) in elements.iter().enumerate() {
                let at = format!("{pointer}/{index}");
                self.add(at.clone(), Kind::Removed, |list, _| {
                    list.as_array_mut().expect("a list").remove(index);
                });
                self.inner(element, &target["items"], &at);
            }
            let sample = self.sample(&target["items"]);
            self.add(format!("{pointer}/{}", elements.len()), Kind::Added, |list, _| {
                list.as_array_mut().expect("a list").push(sample);
            });
        } else if value.is_object() {
            self.object(value, schema, pointer);
        } else {
            let name = pointer.rsplit('/').next().unwrap_or_default();
            let others = well_formed(name).map(|other| vec![other]);
            for other in others.unwrap_or_else(|| self.others(value, schema)) {
                self.add(pointer.to_owned(), Kind::Changed, |parent, name| match parent {
                    Value::Array(list) => list[name.parse::<usize>().expect("an index")] = other,
                    parent => parent[name] = other,
                });
            }
        }
    }

    /// Values other than this one: of ids and enumerations all that there are.
    fn others(&self, value: &Value, schema: &Value) -> Vec<Value> {
        let target = resolved(schema);
        let options = match named(schema) {
            Some("FactoryId") => json!(self.known.factories),
            Some("OrganisationId") => json!(self.known.organisations),
            Some("OperationId") => {
                let mut ids = vec![json!("Taken")];
                let operations = self.document["operationList"].as_array().into_iter().flatten();
                ids.extend(operations.map(|operation| operation["operationId"].clone()));
                Value::Array(ids)
            }
            _ if target["enum"].is_array() => target["enum"].clone(),
            _ => match value {
                Value::Bool(flag) => json!([!flag]),
                Value::Number(number) => json!([number.as_f64().expect("a number") + 1.0]),
                _ => json!([self.sample(schema)]),
            },
        };
        let options = options.as_array().expect("options").clone();
        options.into_iter().filter(|option| option != value).collect()
    }

    /// A whole value of the schema. What it names is there, as far as the document says.
    fn sample(&self, schema: &Value) -> Value {
        let target = resolved(schema);
        match named(schema) {
            Some("OrganisationId") => return json!(self.known.requester),
            Some("FactoryId") => return json!(self.known.factories[0]),
            Some("OperationRelation") => {
                let ends = self.document["operationList"].as_array().expect("operations");
                let end = |operation: Option<&Value>| {
                    operation.map(|operation| operation["operationId"].clone())
                };
                return json!({ "operationRelationId": "Taken", "relationType": "START_TO_START",
                    "predecessorOperationId": end(ends.first()),
                    "successorOperationId": end(ends.last()) });
            }
            _ => {}
        }
        if let Some(options) = target["enum"].as_array() {
            return options[0].clone();
        }
        let kind = match &target["type"] {
            Value::Array(kinds) => &kinds[0],
            kind => kind,
        };
        match kind.as_str().expect("a type") {
            "object" => {
                let members = members(target).into_iter();
                // Only what is shown as one is a stub.
                let members = members.filter(|(name, _)| name != "stub");
                members.map(|(name, member)| (name, self.sample(&member))).collect()
            }
            "array" => json!([self.sample(&target["items"])]),
            "boolean" => json!(true),
            "integer" | "number" => json!(7),
            "string" => match target["format"].as_str() {
                Some("date-time") => json!("2031-01-01T00:00:00Z"),
                Some("duration") => json!("PT8H"),
                _ => json!("Taken"),
            },
            other => panic!("there is no sample of {other}"),
        }
    }
}

//! Composed schemas of an API's description, and those of pages.

use std::collections::BTreeSet;

use utoipa::openapi::{OpenApi, Ref, RefOr, Schema, schema::ArrayItems};

/// Prefix of the schemas of pages; the name of their items' schema follows.
const PAGE: &str = "Page_";

/// Lets pages refer to the schema of their items. The derived schema of a page repeats it.
pub fn share_page_items(description: &mut OpenApi) {
    let schemas = &mut description.components.get_or_insert_default().schemas;
    let names: Vec<String> =
        schemas.keys().filter_map(|name| name.strip_prefix(PAGE)).map(str::to_owned).collect();
    for name in names {
        let Some(RefOr::T(Schema::Object(page))) = schemas.get_mut(&format!("{PAGE}{name}")) else {
            continue;
        };
        let Some(RefOr::T(Schema::Array(list))) = page.properties.get_mut("items") else {
            continue;
        };
        let ArrayItems::RefOrSchema(items) = &mut list.items else { continue };
        let item = std::mem::replace(&mut **items, RefOr::Ref(Ref::from_schema_name(&name)));
        schemas.entry(name).or_insert(item);
    }
}

/// Lets schemas that others are composed of (`allOf`) have further members. A type that rejects
/// unknown members says so in its own schema, which would reject the other members of the whole.
pub fn open_composed_schemas(description: &mut OpenApi) {
    let schemas = &mut description.components.get_or_insert_default().schemas;
    let mut composed = BTreeSet::new();
    schemas.values_mut().for_each(|schema| open_parts(schema, &mut composed));
    for name in composed {
        if let Some(RefOr::T(schema)) = schemas.get_mut(&name) {
            open(schema);
        }
    }
}

/// Opens the inline parts of each `allOf` within a schema and collects the names of the others.
fn open_parts(schema: &mut RefOr<Schema>, composed: &mut BTreeSet<String>) {
    let RefOr::T(schema) = schema else { return };
    match schema {
        Schema::Object(object) => {
            object.properties.values_mut().for_each(|member| open_parts(member, composed));
        }
        Schema::Array(array) => {
            if let ArrayItems::RefOrSchema(items) = &mut array.items {
                open_parts(items, composed);
            }
        }
        Schema::OneOf(choice) => {
            choice.items.iter_mut().for_each(|variant| open_parts(variant, composed));
        }
        Schema::AnyOf(choice) => {
            choice.items.iter_mut().for_each(|variant| open_parts(variant, composed));
        }
        Schema::AllOf(whole) => {
            for part in &mut whole.items {
                match part {
                    RefOr::Ref(reference) => {
                        let name = reference.ref_location.rsplit('/').next();
                        composed.extend(name.map(str::to_owned));
                    }
                    RefOr::T(part) => open(part),
                }
                open_parts(part, composed);
            }
        }
        _ => {}
    }
}

fn open(schema: &mut Schema) {
    if let Schema::Object(object) = schema {
        object.additional_properties = None;
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn pages_refer_to_their_items() {
        let item = json!({ "type": "object", "description": "A rule." });
        let page = json!({ "type": "object", "properties": { "items": { "type": "array", "items": item } } });
        let mut description: OpenApi = serde_json::from_value(json!({
            "openapi": "3.1.0", "info": { "title": "t", "version": "1" }, "paths": {},
            "components": { "schemas": { "Page_Rule": page } }
        }))
        .expect("a description");
        share_page_items(&mut description);
        let shared = serde_json::to_value(description).expect("JSON");
        let schemas = &shared["components"]["schemas"];
        let reference = json!({ "$ref": "#/components/schemas/Rule" });
        assert_eq!(schemas["Page_Rule"]["properties"]["items"]["items"], reference);
        assert_eq!(schemas["Rule"], item);
    }

    #[test]
    fn parts_of_a_whole_are_opened_and_others_stay_closed() {
        let closed = json!({ "type": "object", "additionalProperties": false });
        let whole = |inline: &serde_json::Value| json!({ "allOf": [{ "$ref": "#/components/schemas/Part" }, inline] });
        let mut description: OpenApi = serde_json::from_value(json!({
            "openapi": "3.1.0", "info": { "title": "t", "version": "1" }, "paths": {},
            "components": { "schemas": { "Part": closed, "Alone": closed, "Whole": whole(&closed) } }
        }))
        .expect("a description");
        open_composed_schemas(&mut description);
        let opened = serde_json::to_value(description).expect("JSON");
        let schemas = &opened["components"]["schemas"];
        let open = json!({ "type": "object" });
        assert_eq!(schemas["Part"], open);
        assert_eq!(schemas["Alone"], closed);
        assert_eq!(schemas["Whole"], whole(&open));
    }
}

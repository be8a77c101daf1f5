//! Paths into arrays and structures: `Axes[2].Position`.

use std::{fmt, sync::Arc};

use asi_model::{
    Scalar, Variant,
    values::{ExtensionBody, LocalizedText},
};

use crate::fault::Fault;

/// Longest path, in bytes.
pub(crate) const PATH_BYTES_MAX: usize = 1024;

/// One step of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum PathElement {
    Field(Arc<str>),
    Index(usize),
}

impl fmt::Display for PathElement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Field(name) => f.write_str(name),
            Self::Index(index) => write!(f, "[{index}]"),
        }
    }
}

/// Cuts a path.
///
/// # Errors
/// A sentence saying what is wrong.
pub(crate) fn parse(text: &str) -> Result<Box<[PathElement]>, String> {
    if text.is_empty() || text.len() > PATH_BYTES_MAX {
        return Err(format!("a path has 1 to {PATH_BYTES_MAX} bytes"));
    }
    let mut parts = Vec::new();
    for (index, section) in text.split('.').enumerate() {
        let (name, brackets) = section.split_at(section.find('[').unwrap_or(section.len()));
        if !name.is_empty() {
            parts.push(PathElement::Field(name.into()));
        } else if index > 0 || brackets.is_empty() {
            return Err("a field name is empty".to_owned());
        }
        let mut rest = brackets;
        while !rest.is_empty() {
            let inside = rest.strip_prefix('[').and_then(|r| r.split_once(']'));
            let (digits, after) = inside.ok_or("an index looks like [2]")?;
            parts.push(PathElement::Index(
                digits.parse().map_err(|_| "an index is a number from 0, as [2]")?,
            ));
            rest = after;
        }
    }
    Ok(parts.into())
}

/// Returns the element or field at a path.
///
/// # Errors
/// A [`Fault`] naming the part that does not exist.
pub(crate) fn select(value: &Variant, path: &[PathElement]) -> Result<Variant, Fault> {
    let mut current = value.clone();
    for part in path {
        current = part
            .of(&current)
            .ok_or_else(|| Fault::type_mismatch(format!("there is no {part} in the value")))?;
    }
    Ok(current)
}

impl PathElement {
    fn of(&self, value: &Variant) -> Option<Variant> {
        match (self, value) {
            (Self::Index(index), Variant::Array(array)) => match array.elements.get(*index)? {
                Scalar::Variant(inner) => Some((**inner).clone()),
                element => Some(Variant::Scalar(element.clone())),
            },
            (Self::Field(name), Variant::Scalar(scalar)) => field(scalar, name),
            _ => None,
        }
    }
}

fn field(scalar: &Scalar, name: &str) -> Option<Variant> {
    match scalar {
        Scalar::ExtensionObject(object) => match &object.body {
            ExtensionBody::Structure(structure) => structure.fields.get(name).cloned(),
            _ => None,
        },
        Scalar::LocalizedText(localized) => {
            let LocalizedText { locale, text } = &**localized;
            match name {
                "text" | "Text" => Some(Variant::Scalar(Scalar::String(text.clone()))),
                "locale" | "Locale" => Some(Variant::Scalar(Scalar::String(locale.clone()))),
                _ => None,
            }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asi_model::{
        BuiltInType, NodeId,
        values::{Array, ExpandedNodeId, ExtensionObject, Server, StructureValue},
    };

    fn structure(fields: &[(&str, Variant)]) -> Scalar {
        let mut value = StructureValue::default();
        value.fields.extend(fields.iter().map(|(name, value)| (Arc::from(*name), value.clone())));
        Scalar::ExtensionObject(Box::new(ExtensionObject {
            type_id: ExpandedNodeId { node_id: NodeId::ua(1), server: Server::Local },
            body: ExtensionBody::Structure(value),
        }))
    }

    #[test]
    fn paths_lead_into_structures_and_arrays() {
        let axis = |position: f64| structure(&[("Position", position.into())]);
        let axes = Array {
            element_type: BuiltInType::ExtensionObject,
            elements: vec![axis(1.0), axis(2.5)],
            dimensions: None,
        };
        let robot = Variant::Scalar(structure(&[("Axes", Variant::Array(Arc::new(axes)))]));
        for (path, expected) in [
            ("Axes[1].Position", Some(Variant::from(2.5))),
            ("Axes[2].Position", None),
            ("X", None),
        ] {
            assert_eq!(select(&robot, &parse(path).expect("valid")).ok(), expected, "{path}");
        }
        for wrong in ["", ".a", "a..b", "a[", "a[x]", "a[1", "a]1["] {
            assert!(parse(wrong).is_err() || wrong == "a]1[" && parse(wrong).is_err(), "{wrong}");
        }
    }
}

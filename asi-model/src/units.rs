//! Engineering units: UNECE Recommendation 20 common codes, with the names people write as aliases.
//!
//! OPC 10000-8 §5.6.3.3 derives the numeric UnitId from the code's bytes, big endian.

mod table;
mod unit;

pub use unit::{EngineeringUnit, Quantity};

use std::{collections::HashMap, sync::LazyLock};

use crate::values::{
    ExpandedNodeId, ExtensionBody, ExtensionObject, LocalizedText, NodeId, Scalar, Server,
    StructureValue, Variant,
};
use table::UNITS;

/// The namespace of UNECE units in EUInformation.
pub const UNECE_NAMESPACE_URI: &str = "http://www.opcfoundation.org/UA/units/un/cefact";
/// The DataType EUInformation in namespace 0.
const EU_INFORMATION: u32 = 887;

impl EngineeringUnit {
    /// The numeric id: the code's bytes, big endian.
    #[must_use]
    pub fn unit_id(&self) -> i32 {
        self.code.bytes().fold(0, |id, byte| id << 8 | i32::from(byte))
    }

    /// The preferred alias, as `PIECE` for `H87`: the name in upper case with `_` for blanks.
    #[must_use]
    pub fn alias(&self) -> String {
        match PLAIN_ALIASES.iter().find(|(code, _)| *code == self.code) {
            Some((_, alias)) => (*alias).to_owned(),
            None => alias_of(self.description),
        }
    }

    /// Every unit known, by quantity.
    pub fn all() -> impl Iterator<Item = Self> {
        UNITS.iter().copied()
    }

    /// The unit as EUInformation (OPC 10000-8 §5.6.3.3).
    #[must_use]
    pub fn to_extension_object(&self) -> ExtensionObject {
        let text = |text: &str| {
            Variant::Scalar(Scalar::LocalizedText(Box::new(LocalizedText {
                locale: None,
                text: Some(text.into()),
            })))
        };
        let mut structure = StructureValue::default();
        structure.fields.insert("NamespaceUri".into(), UNECE_NAMESPACE_URI.into());
        structure.fields.insert("UnitId".into(), self.unit_id().into());
        structure.fields.insert("DisplayName".into(), text(self.display_name));
        structure.fields.insert("Description".into(), text(self.description));
        ExtensionObject {
            type_id: ExpandedNodeId { node_id: NodeId::ua(EU_INFORMATION), server: Server::Local },
            body: ExtensionBody::Structure(structure),
        }
    }

    /// The unit that an EUInformation names, where it is a known UNECE one.
    #[must_use]
    pub fn from_extension_object(object: &ExtensionObject) -> Option<Self> {
        let ExtensionBody::Structure(structure) = &object.body else { return None };
        if object.type_id.node_id != NodeId::ua(EU_INFORMATION) {
            return None;
        }
        let id = structure.fields.get("UnitId")?.as_scalar()?.as_i128()?;
        from_unit_id(i32::try_from(id).ok()?)
    }
}

fn alias_of(name: &str) -> String {
    name.chars()
        .filter(|c| !matches!(c, '(' | ')' | '[' | ']' | ','))
        .map(|c| if c.is_alphanumeric() { c.to_ascii_uppercase() } else { '_' })
        .collect()
}

/// Units whose name in the recommendation carries an addition that people leave out.
const PLAIN_ALIASES: &[(&str, &str)] = &[
    ("SEC", "SECOND"),
    ("MIN", "MINUTE"),
    ("DD", "DEGREE"),
    ("BAR", "BAR"),
    ("4H", "MICROMETRE"),
    ("TNE", "TONNE"),
];

/// Names beside the code, the symbol and the upper-case name: the paper's, American spellings,
/// plurals, everyday ones.
const ALIASES: &[(&str, &str)] = &[
    ("PIECES", "H87"),
    ("PCS", "H87"),
    ("PC", "H87"),
    ("PARTS", "H87"),
    ("UNITS", "H87"),
    ("DEGREE", "DD"),
    ("DEGREES", "DD"),
    ("RADIANS", "C81"),
    ("CELSIUS", "CEL"),
    ("DEGREES_CELSIUS", "CEL"),
    ("FAHRENHEIT", "FAH"),
    ("SECONDS", "SEC"),
    ("MINUTE", "MIN"),
    ("MINUTES", "MIN"),
    ("SECOND", "SEC"),
    ("HOURS", "HUR"),
    ("DAYS", "DAY"),
    ("WEEKS", "WEE"),
    ("METER", "MTR"),
    ("MILLIMETER", "MMT"),
    ("CENTIMETER", "CMT"),
    ("KILOMETER", "KMT"),
    ("MICROMETER", "4H"),
    ("MICROMETRE", "4H"),
    ("LITER", "LTR"),
    ("MILLILITER", "MLT"),
    ("TON", "TNE"),
    ("TONNE", "TNE"),
    ("KWH", "KWH"),
    ("WATTS", "WTT"),
    ("RPM", "RPM"),
    ("REVOLUTIONS_PER_MINUTE", "RPM"),
    ("PERCENTAGE", "P1"),
    ("NONE", "C62"),
    ("DIMENSIONLESS", "C62"),
];

static BY_NAME: LazyLock<HashMap<String, usize>> = LazyLock::new(|| {
    let mut names = HashMap::new();
    let position = |code: &str| UNITS.iter().position(|unit| unit.code == code);
    // Codes win over names, names over aliases, aliases over symbols: the first insertion stays.
    for (index, unit) in UNITS.iter().enumerate() {
        names.entry(unit.code.to_owned()).or_insert(index);
    }
    for (index, unit) in UNITS.iter().enumerate() {
        names.entry(unit.alias()).or_insert(index);
    }
    for (alias, code) in ALIASES {
        if let Some(index) = position(code) {
            names.entry((*alias).to_owned()).or_insert(index);
        }
    }
    for (index, unit) in UNITS.iter().enumerate() {
        names.entry(unit.display_name.to_owned()).or_insert(index);
    }
    names
});

/// The unit with this UNECE code, name (`PIECE`, `DEGREE_CELSIUS`), alias or symbol (`mm`). Codes
/// and symbols are case-sensitive; names are written in upper case.
#[must_use]
pub fn lookup(code_or_alias: &str) -> Option<EngineeringUnit> {
    BY_NAME.get(code_or_alias).map(|index| UNITS[*index])
}

/// The unit with this numeric id.
#[must_use]
pub fn from_unit_id(unit_id: i32) -> Option<EngineeringUnit> {
    UNITS.iter().find(|unit| unit.unit_id() == unit_id).copied()
}

/// Two units measure different things.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{from} measures {from_quantity:?}, but {to} measures {to_quantity:?}")]
pub struct NotConvertible {
    /// The code converted from.
    pub from: &'static str,
    pub from_quantity: Quantity,
    /// The code converted to.
    pub to: &'static str,
    pub to_quantity: Quantity,
}

/// A value in another unit of the same quantity.
///
/// # Errors
/// [`NotConvertible`] where the units measure different things, or nothing that a factor relates.
pub fn convert(
    value: f64,
    from: &EngineeringUnit,
    to: &EngineeringUnit,
) -> Result<f64, NotConvertible> {
    if from.code == to.code {
        return Ok(value);
    }
    if from.quantity != to.quantity
        || matches!(from.quantity, Quantity::Other | Quantity::Packaging)
    {
        return Err(NotConvertible {
            from: from.code,
            from_quantity: from.quantity,
            to: to.code,
            to_quantity: to.quantity,
        });
    }
    Ok((value * from.factor + from.offset - to.offset) / to.factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_unique_and_ids_follow_from_them() {
        for (index, unit) in UNITS.iter().enumerate() {
            assert!((2..=3).contains(&unit.code.len()), "{}", unit.code);
            assert_eq!(
                UNITS.iter().position(|u| u.code == unit.code),
                Some(index),
                "{} twice",
                unit.code
            );
            assert_eq!(from_unit_id(unit.unit_id()), Some(*unit));
            assert!(unit.factor > 0.0);
        }
        for (code, id) in [
            ("PIECE", 4_732_983),
            ("C62", 4_404_786),
            ("HOUR", 4_740_434),
            ("MIN", 5_065_038),
            ("SEC", 5_457_219),
            ("DEGREE", 17_476),
            ("rad", 4_405_297),
            ("W", 5_723_220),
            ("KWH", 4_937_544),
            ("°C", 4_408_652),
            ("RPM", 5_394_509),
            ("%", 20_529),
        ] {
            assert_eq!(lookup(code).map(|unit| unit.unit_id()), Some(id), "{code}");
        }
        assert!(lookup("FURLONGS").is_none());
    }

    #[test]
    fn every_alias_leads_back() {
        for (alias, code) in ALIASES {
            assert_eq!(lookup(alias).map(|unit| unit.code), Some(*code), "{alias}");
        }
        for unit in UNITS {
            assert_eq!(lookup(&unit.alias()).map(|u| u.code), Some(unit.code), "{}", unit.alias());
            assert_eq!(
                EngineeringUnit::from_extension_object(&unit.to_extension_object()).map(|u| u.code),
                Some(unit.code)
            );
        }
    }

    #[test]
    fn values_convert_within_a_quantity() {
        for (value, from, to, expected) in [
            (1.0, "HUR", "SEC", 3600.0),
            (100.0, "CEL", "FAH", 212.0),
            (0.0, "CEL", "KEL", 273.15),
            (180.0, "DD", "C81", std::f64::consts::PI),
            (1.0, "KWH", "JOU", 3.6e6),
            (25.4, "MMT", "INH", 1.0),
            (2.0, "DZN", "H87", 24.0),
            (0.5, "C62", "P1", 50.0),
            (60.0, "RPM", "HTZ", 1.0),
        ] {
            let (from, to) = (lookup(from).expect("known"), lookup(to).expect("known"));
            let found = convert(value, &from, &to);
            if from.quantity == to.quantity {
                assert!(
                    (found.expect("same quantity") - expected).abs()
                        < 1e-9 * expected.abs().max(1.0)
                );
            } else {
                assert!(found.is_err());
            }
        }
    }
}

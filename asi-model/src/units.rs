//! Engineering units: all common codes of UNECE Recommendation 20 and the packages of Recommendation
//! 21, with the names people write as aliases.
//!
//! OPC 10000-8 §5.6.3.3 derives the numeric UnitId from the code's bytes, big endian.

mod table;
mod unit;

pub use unit::{EngineeringUnit, Quantity};

use std::sync::LazyLock;

use crate::values::{
    ExpandedNodeId, ExtensionBody, ExtensionObject, LocalizedText, NodeId, Scalar, Server,
    StructureValue, Variant,
};
use table::{COUNT, UnitRow};

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

    /// The preferred alias, as `PIECE` for `H87`: the name in upper case with `_` for blanks, or the
    /// code where another unit has that name.
    #[must_use]
    pub fn alias(&self) -> String {
        UnitRow::of(self.code).map_or(self.code, |row| row.alias).to_owned()
    }

    /// Every unit known, by code.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..COUNT).map(|position| UnitRow::at(position).unit())
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

/// Positions of the units in the order of a text that each has.
struct UnitOrder {
    text: fn(&UnitRow) -> &'static str,
    positions: Box<[u16]>,
}

impl UnitOrder {
    /// Units of one text follow each other with those that have a symbol first.
    fn by(text: fn(&UnitRow) -> &'static str) -> Self {
        let count = u16::try_from(COUNT).expect("fewer units than 65536");
        let mut positions: Box<[u16]> = (0..count).collect();
        positions.sort_by_cached_key(|position| {
            let row = UnitRow::at(usize::from(*position));
            (text(&row), !row.has_symbol())
        });
        Self { text, positions }
    }

    fn find(&self, wanted: &str) -> Option<UnitRow> {
        let row = |position: &u16| UnitRow::at(usize::from(*position));
        let first = self.positions.partition_point(|found| (self.text)(&row(found)) < wanted);
        self.positions.get(first).map(row).filter(|found| (self.text)(found) == wanted)
    }
}

static BY_ALIAS: LazyLock<UnitOrder> = LazyLock::new(|| UnitOrder::by(|row| row.alias));
static BY_DISPLAY_NAME: LazyLock<UnitOrder> =
    LazyLock::new(|| UnitOrder::by(UnitRow::display_name));

/// The unit with this UNECE code, name (`PIECE`, `DEGREE_CELSIUS`), alias or symbol (`mm`). Codes
/// and symbols are case-sensitive; names are written in upper case.
#[must_use]
pub fn lookup(code_or_alias: &str) -> Option<EngineeringUnit> {
    let everyday = || {
        let (_, code) = ALIASES.iter().find(|(alias, _)| *alias == code_or_alias)?;
        UnitRow::of(code)
    };
    // Codes win over names, names over aliases, aliases over symbols.
    UnitRow::of(code_or_alias)
        .or_else(|| BY_ALIAS.find(code_or_alias))
        .or_else(everyday)
        .or_else(|| BY_DISPLAY_NAME.find(code_or_alias))
        .map(|row| row.unit())
}

/// The unit with this numeric id.
#[must_use]
pub fn from_unit_id(unit_id: i32) -> Option<EngineeringUnit> {
    let bytes = unit_id.to_be_bytes();
    let leading = bytes.iter().take_while(|byte| **byte == 0).count();
    UnitRow::of(std::str::from_utf8(&bytes[leading..]).ok()?).map(|row| row.unit())
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
        let all: Vec<EngineeringUnit> = EngineeringUnit::all().collect();
        assert!(all.len() > 2_100 && all.is_sorted_by(|a, b| a.code < b.code));
        for unit in all {
            assert!((2..=3).contains(&unit.code.len()), "{}", unit.code);
            assert_eq!(from_unit_id(unit.unit_id()), Some(unit));
            assert!(unit.factor > 0.0 && !unit.description.is_empty(), "{}", unit.code);
        }
        for id in [0, -1, i32::MIN, 0x41, i32::MAX] {
            assert_eq!(from_unit_id(id), None, "{id}");
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
        for unit in EngineeringUnit::all() {
            assert_eq!(lookup(&unit.alias()), Some(unit), "{}", unit.alias());
            assert!(lookup(unit.display_name).is_some(), "{}", unit.display_name);
            assert_eq!(
                EngineeringUnit::from_extension_object(&unit.to_extension_object()).map(|u| u.code),
                Some(unit.code)
            );
        }
    }

    #[test]
    fn both_recommendations_are_known() {
        for (code, name) in [
            ("K6", "kilolitre"),
            ("B34", "kilogram per cubic decimetre"),
            ("C80", "rad"),
            ("D10", "siemens per metre"),
            ("KWN", "kilowatt hour per normalized cubic metre"),
            ("B30", "gibibit"),
            ("N3", "print point"),
            ("4R", "ounce foot"),
            ("5I", "standard cubic foot"),
            ("RM", "ream"),
            ("XBO", "Bottle, non-protected, cylindrical"),
            ("XPF", "Pen"),
            ("XBX", "box"),
            ("XAA", "Intermediate bulk container, rigid plastic"),
        ] {
            assert_eq!(lookup(code).map(|unit| unit.description), Some(name), "{code}");
        }
        // The symbol of two units is the better known one's, as is that of a code.
        assert_eq!(lookup("rad").map(|unit| unit.code), Some("C81"));
        assert_eq!(lookup("RAD"), None);
        assert_eq!(lookup("N3").map(|unit| unit.unit_id()), Some(20_019));
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
            (1.0, "K6", "LTR", 1000.0),
            (1.0, "B34", "KMQ", 1000.0),
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

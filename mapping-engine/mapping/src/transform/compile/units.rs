//! Unit conversion: which units, and whether integers can stay integers.

use asi_model::units::{self as unece, EngineeringUnit};

use super::{Chain, Code, Compiler};
use crate::{
    document::UnitConversion,
    transform::plan::{Function, UnitFactor},
};

impl Compiler<'_> {
    pub(super) fn unit_conversion(
        &mut self,
        pointer: &str,
        conversion: &UnitConversion,
        chain: &mut Chain,
    ) -> Option<Function> {
        let target = self.mapping.target_unit.clone();
        let from =
            self.unit(pointer, "from", conversion.from.as_ref().or(chain.unit.as_ref()).cloned());
        let to = self.unit(pointer, "to", conversion.to.as_ref().or(target.as_ref()).cloned());
        let (from, to) = (from?, to?);
        chain.unit = Some(to.code.to_owned());
        match factor(&from, &to) {
            Ok(factor) => Some(Function::Unit(factor.into())),
            Err(message) => {
                self.error(pointer.to_owned(), Code::IncompatibleUnits, message);
                None
            }
        }
    }

    fn unit(
        &mut self,
        pointer: &str,
        member: &str,
        name: Option<String>,
    ) -> Option<EngineeringUnit> {
        let Some(name) = name else {
            let whose = if member == "from" { "the input" } else { "the field" };
            let message = format!("{whose} names no unit, so \"{member}\" is needed");
            self.error(format!("{pointer}/{member}"), Code::Missing, message);
            return None;
        };
        let unit = unece::lookup(&name);
        if unit.is_none() {
            let message =
                format!("\"{name}\" is not a known UNECE code or name, as MMT or MILLIMETRE");
            self.error(format!("{pointer}/{member}"), Code::UnknownUnit, message);
        }
        unit
    }
}

/// Returns the conversion between two units, exact for integers where the factor is a ratio.
fn factor(from: &EngineeringUnit, to: &EngineeringUnit) -> Result<UnitFactor, String> {
    let at = |value: f64| unece::convert(value, from, to).map_err(|error| error.to_string());
    let exact = match (at(0.0)?, at(1.0)?) {
        (0.0, slope) => ratio(slope),
        _ => None,
    };
    Ok(UnitFactor { from: *from, to: *to, exact })
}

/// A factor as a ratio of small integers where it is one: 1000, 1/1000, 60, 1/3600.
fn ratio(factor: f64) -> Option<(i128, i128)> {
    const LARGEST: f64 = 1e15;
    let whole = |value: f64| {
        let rounded = value.round();
        let is_whole =
            (1.0..=LARGEST).contains(&rounded) && ((value - rounded) / rounded).abs() < 1e-15;
        #[allow(clippy::cast_possible_truncation)]
        is_whole.then_some(rounded as i128)
    };
    whole(factor)
        .map(|multiply| (multiply, 1))
        .or_else(|| whole(factor.recip()).map(|divide| (1, divide)))
}

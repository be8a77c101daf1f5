//! Lookup tables.

use std::collections::HashMap;

use asi_model::{Scalar, Variant};

use crate::{
    convert,
    document::{Lookup, LookupEntry},
    fault::Fault,
    number::Number,
};

#[derive(Debug)]
pub(crate) enum Table {
    Exact {
        entries: HashMap<Key, Variant>,
        otherwise: Option<Variant>,
    },
    /// Sorted by the first number.
    Interpolated(Box<[(f64, f64)]>),
}

/// A value as key: numbers by value, whatever their type.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Key {
    Integer(i128),
    /// The bits of a double with a fraction.
    Real(u64),
    Boolean(bool),
    Text(Box<str>),
}

impl Key {
    /// Returns the key of a scalar; `None` for nulls and structures.
    pub fn of(scalar: &Scalar) -> Option<Self> {
        Some(match scalar {
            Scalar::Boolean(v) => Self::Boolean(*v),
            other => match Number::of(other) {
                Some(Number::Integer(v)) => Self::Integer(v),
                #[allow(clippy::cast_possible_truncation)]
                Some(Number::Real(v)) if v.fract() == 0.0 => Self::Integer(v as i128),
                Some(Number::Real(v)) => Self::Real(v.to_bits()),
                None => Self::Text(convert::to_text(other)?.into()),
            },
        })
    }
}

impl Table {
    /// Compiles a table.
    ///
    /// # Errors
    /// The index of the entry and a sentence.
    pub fn new(lookup: &Lookup) -> Result<Self, (usize, String)> {
        if lookup.interpolate {
            return Self::interpolated(&lookup.entries);
        }
        let mut entries = HashMap::with_capacity(lookup.entries.len());
        for (index, LookupEntry { from, to }) in lookup.entries.iter().enumerate() {
            let key = Key::of(&from.0).ok_or((index, "a null cannot be looked up".to_owned()))?;
            if entries.insert(key, to.to_variant()).is_some() {
                return Err((index, "this value stands in the table already".to_owned()));
            }
        }
        Ok(Self::Exact {
            entries,
            otherwise: lookup.otherwise.as_ref().map(crate::document::Literal::to_variant),
        })
    }

    fn interpolated(entries: &[LookupEntry]) -> Result<Self, (usize, String)> {
        let mut points = Vec::with_capacity(entries.len());
        for (index, LookupEntry { from, to }) in entries.iter().enumerate() {
            let number =
                |scalar: &Scalar| Number::of(scalar).map(Number::as_f64).filter(|v| v.is_finite());
            let (Some(from), Some(to)) = (number(&from.0), number(&to.0)) else {
                return Err((index, "a table that interpolates has numbers only".to_owned()));
            };
            points.push((from, to, index));
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let Some(twice) = points.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err((twice[1].2, "this value stands in the table already".to_owned()));
        }
        if points.is_empty() {
            return Err((0, "a table that interpolates has at least one entry".to_owned()));
        }
        Ok(Self::Interpolated(points.into_iter().map(|(from, to, _)| (from, to)).collect()))
    }

    /// Returns the table's value for a value.
    ///
    /// # Errors
    /// A [`Fault`] where the table has nothing for it.
    pub fn find(&self, value: &Variant) -> Result<Variant, Fault> {
        let scalar = value
            .as_scalar()
            .ok_or_else(|| Fault::type_mismatch("a lookup takes a single value"))?;
        match self {
            Self::Exact { entries, otherwise } => {
                let found = Key::of(scalar).and_then(|key| entries.get(&key));
                found.or(otherwise.as_ref()).cloned().ok_or_else(|| {
                    Fault::out_of_range(
                        "the value is not in the table, and there is no \"otherwise\"",
                    )
                })
            }
            Self::Interpolated(points) => {
                let number = Number::of(scalar).map(Number::as_f64).filter(|v| !v.is_nan());
                let x = number.ok_or_else(|| {
                    Fault::type_mismatch("a table that interpolates takes a number")
                })?;
                Ok(interpolate(points, x).into())
            }
        }
    }
}

fn interpolate(points: &[(f64, f64)], x: f64) -> f64 {
    let after = points.partition_point(|(from, _)| *from < x);
    match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (_, Some((_, y))) | (Some((_, y)), None) => *y,
        (None, None) => f64::NAN,
    }
}

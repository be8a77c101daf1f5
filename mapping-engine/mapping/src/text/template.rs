//! Templates of `format`: texts with placeholders.

use asi_model::Scalar;

use crate::{convert, fault::Fault, number::Number};

/// Longest text that `format` makes, in bytes.
const TEXT_BYTES_MAX: usize = 65_536;
/// Greatest width and number of decimals in a placeholder.
const WIDTH_MAX: usize = 64;

/// A template cut into pieces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Template(Vec<Piece>);

#[derive(Debug, Clone, PartialEq)]
enum Piece {
    Text(Box<str>),
    Placeholder { source: Source, zeros: bool, width: usize, decimals: Option<usize> },
}

/// Operand that a placeholder refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    Value,
    Input(usize),
}

impl Template {
    /// Cuts a template.
    ///
    /// # Errors
    /// A sentence and the column (in characters, from 1).
    pub fn parse(text: &str, input: &dyn Fn(&str) -> Option<usize>) -> Result<Self, (String, u32)> {
        let mut pieces = Vec::new();
        let mut plain = String::new();
        let mut chars = text.chars().zip(1_u32..).peekable();
        while let Some((c, column)) = chars.next() {
            match c {
                '{' | '}' if chars.next_if(|(next, _)| *next == c).is_some() => plain.push(c),
                '}' => {
                    return Err(("a closing brace stands alone: write \"}}\"".to_owned(), column));
                }
                '{' => {
                    let mut inside = String::new();
                    loop {
                        match chars.next() {
                            Some(('}', _)) => break,
                            Some((c, _)) => inside.push(c),
                            None => {
                                return Err((
                                    "the placeholder has no closing brace".to_owned(),
                                    column,
                                ));
                            }
                        }
                    }
                    if !plain.is_empty() {
                        pieces.push(Piece::Text(std::mem::take(&mut plain).into()));
                    }
                    pieces.push(placeholder(&inside, input).map_err(|message| (message, column))?);
                }
                c => plain.push(c),
            }
        }
        if !plain.is_empty() {
            pieces.push(Piece::Text(plain.into()));
        }
        Ok(Self(pieces))
    }

    /// Iterates over the operands of all placeholders.
    pub fn sources(&self) -> impl Iterator<Item = Source> + '_ {
        self.0.iter().filter_map(|piece| match piece {
            Piece::Placeholder { source, .. } => Some(*source),
            Piece::Text(_) => None,
        })
    }

    /// Fills the template.
    ///
    /// # Errors
    /// A [`Fault`] where a value has no text form or the text gets too long.
    pub fn fill<'a>(&self, lookup: &dyn Fn(Source) -> Option<&'a Scalar>) -> Result<String, Fault> {
        let mut text = String::new();
        for piece in &self.0 {
            match piece {
                Piece::Text(plain) => text.push_str(plain),
                Piece::Placeholder { source, zeros, width, decimals } => {
                    let scalar = lookup(*source).ok_or_else(|| {
                        Fault::type_mismatch("a placeholder takes a single value, not an array")
                    })?;
                    text.push_str(&show(scalar, *zeros, *width, *decimals)?);
                }
            }
            if text.len() > TEXT_BYTES_MAX {
                return Err(Fault::out_of_range(format!(
                    "a text has at most {TEXT_BYTES_MAX} bytes"
                )));
            }
        }
        Ok(text)
    }
}

fn placeholder(inside: &str, input: &dyn Fn(&str) -> Option<usize>) -> Result<Piece, String> {
    let (name, layout) = inside.split_once(':').unwrap_or((inside, ""));
    let source = match name.trim() {
        "value" | "" => Source::Value,
        name => match input(name) {
            Some(index) => Source::Input(index),
            None => {
                return Err(format!("\"{name}\" is neither \"value\" nor the name of an input"));
            }
        },
    };
    let (width, decimals) = match layout.split_once('.') {
        Some((width, decimals)) => (width, Some(decimals)),
        None => (layout, None),
    };
    let number = |text: &str| {
        text.parse::<usize>().ok().filter(|n| *n <= WIDTH_MAX).ok_or_else(|| {
            format!("after the colon stand a width and decimals as 06.2, each at most {WIDTH_MAX}")
        })
    };
    Ok(Piece::Placeholder {
        source,
        zeros: width.starts_with('0') && width.len() > 1,
        width: if width.is_empty() { 0 } else { number(width)? },
        decimals: decimals.map(number).transpose()?,
    })
}

fn show(
    scalar: &Scalar,
    zeros: bool,
    width: usize,
    decimals: Option<usize>,
) -> Result<String, Fault> {
    let number = Number::of(scalar).filter(|_| !matches!(scalar, Scalar::Boolean(_)));
    let plain = match (number, decimals) {
        (Some(Number::Real(v)), Some(decimals)) => format!("{v:.decimals$}"),
        (Some(Number::Integer(v)), Some(decimals)) if decimals > 0 => {
            format!("{v}.{:0decimals$}", 0)
        }
        _ => convert::to_text(scalar)
            .ok_or_else(|| Fault::type_mismatch("this value has no text form"))?,
    };
    if number.is_none() {
        return Ok(format!("{plain:<width$}"));
    }
    if !zeros {
        return Ok(format!("{plain:>width$}"));
    }
    let (sign, digits) =
        plain.strip_prefix('-').map_or(("", plain.as_str()), |digits| ("-", digits));
    let width = width.saturating_sub(sign.len());
    Ok(format!("{sign}{digits:0>width$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_fill() {
        let inputs = [Scalar::Double(21.456), Scalar::from("A-7")];
        let input = |name: &str| ["t", "id"].iter().position(|n| *n == name);
        for (template, value, expected) in [
            ("{value}", Scalar::UInt64(u64::MAX), "18446744073709551615"),
            ("{value:06}", Scalar::Int32(-42), "-00042"),
            ("{value:6}|", Scalar::Int32(42), "    42|"),
            ("{value:.2} mm", Scalar::Int32(3), "3.00 mm"),
            ("{id:5}: {t:.1} {{x}}", Scalar::Int32(3), "A-7  : 21.5 {x}"),
            ("{value}", Scalar::Boolean(true), "true"),
            ("", Scalar::Boolean(true), ""),
        ] {
            let template = Template::parse(template, &input).expect("valid");
            let lookup = |source| match source {
                Source::Value => Some(&value),
                Source::Input(index) => inputs.get(index),
            };
            assert_eq!(template.fill(&lookup).as_deref(), Ok(expected));
        }
        for (template, column) in
            [("a {x}", 3), ("}", 1), ("{value", 1), ("{value:zz}", 1), ("{value:999}", 1)]
        {
            assert_eq!(
                Template::parse(template, &input).expect_err(template).1,
                column,
                "{template}"
            );
        }
    }
}

//! Patterns of `parse`: where a value is in a text, and its form.

use asi_model::{BuiltInType, Scalar};

use crate::{
    convert::{Overflow, Rounding, convert_scalar, to_integer},
    document::Parse,
    fault::Fault,
    number::Number,
};

/// The compiled form of `parse`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pattern {
    /// Tokens before and after the value.
    before: Vec<PatternPart>,
    after: Vec<PatternPart>,
    to: BuiltInType,
    radix: Option<u32>,
    decimal_comma: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum PatternPart {
    Text(Box<str>),
    Any,
}

impl Pattern {
    /// Compiles the parameters.
    ///
    /// # Errors
    /// A sentence saying what is wrong with the pattern.
    pub fn new(parse: &Parse) -> Result<Self, String> {
        let text = parse.pattern.as_deref().unwrap_or("{}");
        let (before, after) = text.split_once("{}").ok_or("the pattern has no {} for the value")?;
        if after.contains("{}") {
            return Err("the pattern has more than one {}".to_owned());
        }
        if before.ends_with('*') {
            return Err("a * right before {} leaves open where the value begins".to_owned());
        }
        Ok(Self {
            before: tokens(before),
            after: tokens(after),
            to: parse.to.0,
            radix: parse.radix,
            decimal_comma: parse.decimal_comma,
        })
    }

    /// The value in a text.
    ///
    /// # Errors
    /// A [`Fault`] where the text does not look so or the value is not of the type.
    pub fn read(&self, text: &str) -> Result<Scalar, Fault> {
        let part = self
            .part(text)
            .ok_or_else(|| Fault::decoding("the text does not match the pattern"))?;
        if let Some(radix) = self.radix {
            let digits = part.trim();
            let digits = match radix {
                16 => digits.trim_start_matches("0x").trim_start_matches("0X"),
                _ => digits,
            };
            let value = i128::from_str_radix(digits, radix).map_err(|_| {
                Fault::decoding(format!("the text is not an integer of base {radix}"))
            })?;
            return to_integer(Number::Integer(value), self.to, Rounding::Exact, Overflow::Fault);
        }
        let part = if self.decimal_comma {
            part.replace('.', "").replace(',', ".")
        } else {
            part.to_owned()
        };
        let scalar = Scalar::from(part.as_str());
        convert_scalar(&scalar, self.to, Rounding::Exact, Overflow::Fault)
    }

    fn part<'a>(&self, text: &'a str) -> Option<&'a str> {
        let start = match_prefix(&self.before, text)?;
        let rest = &text[start..];
        match self.after.as_slice() {
            [] => Some(rest),
            [PatternPart::Any] => Some(rest.split_whitespace().next().unwrap_or("")),
            [PatternPart::Text(first), ..] => {
                // The shortest value whose remainder matches.
                rest.match_indices(&**first)
                    .map(|(at, _)| at)
                    .find(|at| matches_all(&self.after, &rest[*at..]))
                    .map(|at| &rest[..at])
            }
            [PatternPart::Any, later @ ..] => {
                let value = rest.split_whitespace().next().unwrap_or("");
                let end = rest.find(value).unwrap_or(0) + value.len();
                matches_any_tail(later, &rest[end..]).then_some(value)
            }
        }
    }
}

fn tokens(text: &str) -> Vec<PatternPart> {
    let mut tokens = Vec::new();
    for (index, part) in text.split('*').enumerate() {
        if index > 0 && tokens.last() != Some(&PatternPart::Any) {
            tokens.push(PatternPart::Any);
        }
        if !part.is_empty() {
            tokens.push(PatternPart::Text(part.into()));
        }
    }
    tokens
}

/// Returns the offset after these tokens, in bytes; `*` takes as little as possible.
fn match_prefix(tokens: &[PatternPart], text: &str) -> Option<usize> {
    let mut at = 0;
    let mut any = false;
    for token in tokens {
        match token {
            PatternPart::Any => any = true,
            PatternPart::Text(part) => {
                let found = text[at..].find(&**part)?;
                if found > 0 && !any {
                    return None;
                }
                at += found + part.len();
                any = false;
            }
        }
    }
    Some(at)
}

fn matches_all(tokens: &[PatternPart], text: &str) -> bool {
    match tokens {
        [] => text.is_empty(),
        [PatternPart::Text(part), rest @ ..] => {
            text.strip_prefix(&**part).is_some_and(|text| matches_all(rest, text))
        }
        [PatternPart::Any, rest @ ..] => matches_any_tail(rest, text),
    }
}

/// Greedy matching with leftmost finds is exact for patterns whose only wildcard is `*`.
fn matches_any_tail(tokens: &[PatternPart], text: &str) -> bool {
    match tokens {
        [] => true,
        [PatternPart::Any, rest @ ..] => matches_any_tail(rest, text),
        [PatternPart::Text(part)] => text.ends_with(&**part),
        [PatternPart::Text(part), rest @ ..] => {
            text.find(&**part).is_some_and(|at| matches_all(rest, &text[at + part.len()..]))
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::text::Template;

    fn parse(pattern: Option<&str>, to: BuiltInType) -> Parse {
        Parse {
            to: to.into(),
            pattern: pattern.map(str::to_owned),
            radix: None,
            decimal_comma: false,
        }
    }

    #[test]
    fn patterns_read() {
        use BuiltInType as T;
        for (pattern, text, to, expected) in [
            (None, "00123", T::String, Some(Scalar::from("00123"))),
            (None, "00123", T::Int32, Some(Scalar::Int32(123))),
            (Some("Temp={} *"), "Temp=21.5 C ok", T::Double, Some(Scalar::Double(21.5))),
            (Some("*id:{};*"), "a id:42; b", T::UInt16, Some(Scalar::UInt16(42))),
            (Some("{}mm"), "12mm", T::Int32, Some(Scalar::Int32(12))),
            (Some("{}mm"), "12cm", T::Int32, None),
            (Some("T{}"), "X1", T::Int32, None),
            (Some("{}*"), "7 of 9", T::Int32, Some(Scalar::Int32(7))),
            (None, "abc", T::Double, None),
        ] {
            let pattern = Pattern::new(&parse(pattern, to)).expect("valid");
            assert_eq!(pattern.read(text).ok(), expected, "{text}");
        }
        let comma =
            Pattern::new(&Parse { decimal_comma: true, ..parse(None, T::Double) }).expect("valid");
        assert_eq!(comma.read("1.234,5").ok(), Some(Scalar::Double(1234.5)));
        let hex =
            Pattern::new(&Parse { radix: Some(16), ..parse(None, T::UInt32) }).expect("valid");
        assert_eq!(hex.read("0xFF").ok(), Some(Scalar::UInt32(255)));
        for wrong in ["no placeholder", "{}{}", "*{}"] {
            assert!(Pattern::new(&parse(Some(wrong), T::Int32)).is_err(), "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn what_was_formatted_is_parsed_back(value in any::<i64>(), before in "[a-z =]{0,5}", after in "[a-z]{0,5}") {
            let template = Template::parse(&format!("{before}{{value}}{after}"), &|_| None).expect("valid");
            let scalar = Scalar::Int64(value);
            let text = template.fill(&|_| Some(&scalar)).expect("fills");
            let pattern = Pattern::new(&parse(Some(&format!("{before}{{}}{after}")), BuiltInType::Int64)).expect("valid");
            prop_assert_eq!(pattern.read(&text).ok(), Some(scalar));
        }

        #[test]
        fn no_pattern_makes_it_panic(pattern in "[a*{}ü ]{0,12}", text in "[aü1 ]{0,12}") {
            if let Ok(pattern) = Pattern::new(&parse(Some(&pattern), BuiltInType::String)) {
                let _ = pattern.read(&text);
            }
        }
    }
}

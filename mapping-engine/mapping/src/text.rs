//! Values into texts and out of them: the templates of `format` and the patterns of `parse`.

use asi_model::{BuiltInType, Scalar};

use crate::{
    convert::{self, Overflow, Rounding, convert_scalar, to_integer},
    document::Parse,
    fault::Fault,
    number::Number,
};

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

/// What a placeholder stands for.
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

    /// Which placeholders there are.
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

/// The compiled form of `parse`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pattern {
    /// What stands before and after the value; `None` between two texts is `*`.
    before: Vec<Token>,
    after: Vec<Token>,
    to: BuiltInType,
    radix: Option<u32>,
    decimal_comma: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Token {
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
            [Token::Any] => Some(rest.split_whitespace().next().unwrap_or("")),
            [Token::Text(first), ..] => {
                // The shortest value whose remainder matches.
                rest.match_indices(&**first)
                    .map(|(at, _)| at)
                    .find(|at| matches_all(&self.after, &rest[*at..]))
                    .map(|at| &rest[..at])
            }
            [Token::Any, later @ ..] => {
                let value = rest.split_whitespace().next().unwrap_or("");
                let end = rest.find(value).unwrap_or(0) + value.len();
                matches_any_tail(later, &rest[end..]).then_some(value)
            }
        }
    }
}

fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    for (index, part) in text.split('*').enumerate() {
        if index > 0 && tokens.last() != Some(&Token::Any) {
            tokens.push(Token::Any);
        }
        if !part.is_empty() {
            tokens.push(Token::Text(part.into()));
        }
    }
    tokens
}

/// Where the text after these tokens begins; `*` takes as little as possible.
fn match_prefix(tokens: &[Token], text: &str) -> Option<usize> {
    let mut at = 0;
    let mut any = false;
    for token in tokens {
        match token {
            Token::Any => any = true,
            Token::Text(part) => {
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

fn matches_all(tokens: &[Token], text: &str) -> bool {
    match tokens {
        [] => text.is_empty(),
        [Token::Text(part), rest @ ..] => {
            text.strip_prefix(&**part).is_some_and(|text| matches_all(rest, text))
        }
        [Token::Any, rest @ ..] => matches_any_tail(rest, text),
    }
}

/// Greedy matching with leftmost finds is exact for patterns whose only wildcard is `*`.
fn matches_any_tail(tokens: &[Token], text: &str) -> bool {
    match tokens {
        [] => true,
        [Token::Any, rest @ ..] => matches_any_tail(rest, text),
        [Token::Text(part)] => text.ends_with(&**part),
        [Token::Text(part), rest @ ..] => {
            text.find(&**part).is_some_and(|at| matches_all(rest, &text[at + part.len()..]))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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

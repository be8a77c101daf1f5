//! Lexer from text to tokens, each with its column.

use std::sync::Arc;

use super::{EXPRESSION_BYTES_MAX, SyntaxError};
use crate::number::Number;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    Number(Number),
    Text(Arc<str>),
    Name(String),
    Symbol(&'static str),
    End,
}

impl Token {
    /// Returns the token's name in errors.
    pub fn describe(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Text(_) => "a text".to_owned(),
            Self::Name(name) => format!("\"{name}\""),
            Self::Symbol(symbol) => format!("\"{symbol}\""),
            Self::End => "the end".to_owned(),
        }
    }
}

/// Longer ones first, so that `<=` is not read as `<`.
const SYMBOLS: [&str; 24] = [
    "**", "//", "==", "!=", "<=", ">=", "&&", "||", "+", "-", "*", "/", "%", "<", ">", "!", "?",
    ":", "(", ")", ",", "=", "&", "|",
];

/// The tokens of a text with their columns, closed by [`Token::End`].
pub(super) fn tokens(text: &str) -> Result<Vec<(Token, u32)>, SyntaxError> {
    if text.len() > EXPRESSION_BYTES_MAX {
        let message = format!("an expression has at most {EXPRESSION_BYTES_MAX} bytes");
        return Err(SyntaxError { message, column: 1 });
    }
    let mut tokens = Vec::new();
    let mut rest = text;
    let mut column = 1_u32;
    loop {
        let trimmed = rest.trim_start();
        column += chars(&rest[..rest.len() - trimmed.len()]);
        rest = trimmed;
        let Some(first) = rest.chars().next() else { break };
        let error = |message: String| SyntaxError { message, column };
        let (token, length) = match first {
            '0'..='9' | '.' => {
                number(rest).ok_or_else(|| error("this is not a number".to_owned()))?
            }
            '\'' | '"' => quoted(rest, first)
                .ok_or_else(|| error("this text has no closing quote".to_owned()))?,
            c if c.is_ascii_alphabetic() || c == '_' => {
                let length = rest
                    .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
                    .unwrap_or(rest.len());
                (Token::Name(rest[..length].to_owned()), length)
            }
            other => SYMBOLS
                .iter()
                .find(|symbol| rest.starts_with(**symbol))
                .map(|symbol| (Token::Symbol(symbol), symbol.len()))
                .ok_or_else(|| error(format!("\"{other}\" has no meaning here")))?,
        };
        tokens.push((token, column));
        column += chars(&rest[..length]);
        rest = &rest[length..];
    }
    tokens.push((Token::End, column));
    Ok(tokens)
}

fn chars(text: &str) -> u32 {
    u32::try_from(text.chars().count()).unwrap_or(u32::MAX)
}

fn number(text: &str) -> Option<(Token, usize)> {
    if let Some(hex) = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        let length = hex.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(hex.len());
        let value = i128::from_str_radix(&hex[..length], 16).ok()?;
        return Some((Token::Number(Number::Integer(value)), length + 2));
    }
    let bytes = text.as_bytes();
    let digits =
        |from: usize| from + bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    text[..end].parse().ok().map(|number| (Token::Number(number), end))
}

/// A text in quotes; a backslash takes the next character as it is.
fn quoted(text: &str, quote: char) -> Option<(Token, usize)> {
    let mut content = String::new();
    let mut chars = text.char_indices().skip(1);
    while let Some((at, c)) = chars.next() {
        match c {
            '\\' => content.push(chars.next()?.1),
            c if c == quote => return Some((Token::Text(content.into()), at + c.len_utf8())),
            c => content.push(c),
        }
    }
    None
}

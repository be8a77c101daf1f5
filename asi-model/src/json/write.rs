//! Appending JSON to a buffer, without trees and without formatting machinery on the way of every
//! report.

use std::io::Write as _;

use base64::Engine as _;

use crate::values::DateTime;

/// A string in quotes, escaped as far as RFC 8259 asks.
pub fn string(out: &mut Vec<u8>, text: &str) {
    out.push(b'"');
    let bytes = text.as_bytes();
    let mut plain_from = 0;
    for (at, &byte) in bytes.iter().enumerate() {
        if byte >= 0x20 && byte != b'"' && byte != b'\\' {
            continue;
        }
        out.extend_from_slice(&bytes[plain_from..at]);
        plain_from = at + 1;
        match byte {
            b'"' => out.extend_from_slice(b"\\\""),
            b'\\' => out.extend_from_slice(b"\\\\"),
            b'\n' => out.extend_from_slice(b"\\n"),
            b'\r' => out.extend_from_slice(b"\\r"),
            b'\t' => out.extend_from_slice(b"\\t"),
            _ => {
                const HEX: &[u8; 16] = b"0123456789abcdef";
                out.extend_from_slice(b"\\u00");
                out.push(HEX[usize::from(byte >> 4)]);
                out.push(HEX[usize::from(byte & 15)]);
            }
        }
    }
    out.extend_from_slice(&bytes[plain_from..]);
    out.push(b'"');
}

/// A string in quotes, or `null`.
pub fn nullable_string(out: &mut Vec<u8>, text: Option<&str>) {
    match text {
        Some(text) => string(out, text),
        None => out.extend_from_slice(b"null"),
    }
}

/// An unsigned integer in decimal digits.
pub fn unsigned(out: &mut Vec<u8>, mut value: u64) {
    let mut digits = [0_u8; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[at..]);
}

/// An integer in decimal digits.
pub fn signed(out: &mut Vec<u8>, value: i64) {
    if value < 0 {
        out.push(b'-');
    }
    unsigned(out, value.unsigned_abs());
}

/// A number with the fewest digits that read back the same; NaN and infinities as strings (OPC
/// 10000-6 §5.4.2.4).
pub fn double(out: &mut Vec<u8>, value: f64) {
    if !write_not_finite(out, value) {
        finite(out, format_args!("{value:?}"));
    }
}

/// Writes like [`double`], in single precision.
pub fn float(out: &mut Vec<u8>, value: f32) {
    if !write_not_finite(out, f64::from(value)) {
        finite(out, format_args!("{value:?}"));
    }
}

fn write_not_finite(out: &mut Vec<u8>, value: f64) -> bool {
    let text: &[u8] = if value.is_nan() {
        b"\"NaN\""
    } else if value == f64::INFINITY {
        b"\"Infinity\""
    } else if value == f64::NEG_INFINITY {
        b"\"-Infinity\""
    } else {
        return false;
    };
    out.extend_from_slice(text);
    true
}

fn finite(out: &mut Vec<u8>, digits: std::fmt::Arguments<'_>) {
    out.write_fmt(digits).expect("a Vec takes every write");
    if out.ends_with(b".0") {
        out.truncate(out.len() - 2);
    }
}

/// Bytes as Base64 in quotes.
pub fn base64(out: &mut Vec<u8>, bytes: &[u8]) {
    out.push(b'"');
    let start = out.len();
    out.resize(start + bytes.len().div_ceil(3) * 4, 0);
    let written = base64::engine::general_purpose::STANDARD
        .encode_slice(bytes, &mut out[start..])
        .expect("Base64 takes four bytes for every three begun");
    out.truncate(start + written);
    out.push(b'"');
}

/// A time in quotes: RFC 3339 in UTC with up to seven fraction digits; [`DateTime::MIN`] as
/// `0001-01-01T00:00:00Z`.
// Every part is in range by its modulus.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn date_time(out: &mut Vec<u8>, time: DateTime) {
    if time == DateTime::MIN {
        out.extend_from_slice(b"\"0001-01-01T00:00:00Z\"");
        return;
    }
    let ticks = time.ticks() as u64;
    let (days, in_day) = (ticks / 864_000_000_000, ticks % 864_000_000_000);
    let (seconds, fraction) = (in_day / 10_000_000, in_day % 10_000_000);
    let (year, month, day) = civil(days);
    let mut text = *b"\"0000-00-00T00:00:00.0000000Z\"";
    digits(&mut text[1..5], year);
    digits(&mut text[6..8], month);
    digits(&mut text[9..11], day);
    digits(&mut text[12..14], seconds / 3600);
    digits(&mut text[15..17], seconds / 60 % 60);
    digits(&mut text[18..20], seconds % 60);
    digits(&mut text[21..28], fraction);
    let mut end = 28;
    while text[end - 1] == b'0' {
        end -= 1;
    }
    if text[end - 1] == b'.' {
        end -= 1;
    }
    out.extend_from_slice(&text[..end]);
    out.extend_from_slice(b"Z\"");
}

fn digits(field: &mut [u8], mut value: u64) {
    for digit in field.iter_mut().rev() {
        *digit = b'0' + (value % 10) as u8;
        value /= 10;
    }
}

/// Year, month and day of the Gregorian calendar, from days since 1601-01-01 (which begins a
/// 400-year cycle).
fn civil(days: u64) -> (u64, u64, u64) {
    // Counted from 1600-03-01, so that the leap day ends a year: January and February belong to the
    // year before.
    let from_march = days + 306;
    let (era, in_era) = (from_march / 146_097, from_march % 146_097);
    let year_of_era = (in_era - in_era / 1_460 + in_era / 36_524 - in_era / 146_096) / 365;
    let in_year = in_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * in_year + 2) / 153;
    let day = in_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = 1600 + era * 400 + year_of_era + u64::from(month <= 2);
    (year, month, day)
}

/// A time as the hot path meets it, `2019-04-18T18:20:30.1234567Z`; other RFC 3339 forms go the
/// long way.
pub(crate) fn parse_date_time(text: &str) -> Option<DateTime> {
    fn number(digits: &[u8]) -> Option<i64> {
        digits.iter().try_fold(0, |value, digit| {
            digit.is_ascii_digit().then(|| value * 10 + i64::from(digit - b'0'))
        })
    }
    let quick = || {
        let bytes = text.as_bytes();
        let (head, tail) = bytes.split_at_checked(19)?;
        let (date, clock) = (&head[..10], &head[11..]);
        if date[4] != b'-'
            || date[7] != b'-'
            || head[10] != b'T'
            || clock[2] != b':'
            || clock[5] != b':'
        {
            return None;
        }
        let (year, month, day) = (number(&date[..4])?, number(&date[5..7])?, number(&date[8..])?);
        let (hour, minute, second) =
            (number(&clock[..2])?, number(&clock[3..5])?, number(&clock[6..])?);
        // Days up to 28 exist in every month; later ones are checked by the thorough reader.
        if !(1601..=9999).contains(&year) || !(1..=12).contains(&month) || !(1..=28).contains(&day)
        {
            return None;
        }
        if hour > 23 || minute > 59 || second > 59 {
            return None;
        }
        let fraction = match tail {
            b"Z" => 0,
            [b'.', digits @ .., b'Z'] if (1..=7).contains(&digits.len()) => {
                number(digits)? * 10_i64.pow(7 - u32::try_from(digits.len()).ok()?)
            }
            _ => return None,
        };
        let (years, month) =
            if month > 2 { (year - 1600, month - 3) } else { (year - 1601, month + 9) };
        let days =
            years * 365 + years / 4 - years / 100 + years / 400 + (153 * month + 2) / 5 + day
                - 1
                - 306;
        Some(DateTime::from_ticks(
            ((days * 86_400 + hour * 3600 + minute * 60 + second) * 10_000_000) + fraction,
        ))
    };
    quick().or_else(|| text.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn written(write: impl FnOnce(&mut Vec<u8>)) -> String {
        let mut out = Vec::new();
        write(&mut out);
        String::from_utf8(out).expect("UTF-8")
    }

    proptest! {
        #[test]
        fn times_are_written_and_read_as_the_thorough_way_does(ticks in 0..DateTime::MAX.ticks()) {
            let time = DateTime::from_ticks(ticks);
            let text = written(|out| date_time(out, time));
            prop_assert_eq!(&text, &format!("\"{time}\""));
            prop_assert_eq!(parse_date_time(text.trim_matches('"')), Some(time));
        }

        #[test]
        fn strings_and_numbers_read_back(text: String, double_value: f64, float_value: f32, integer: i64) {
            let read: String = serde_json::from_str(&written(|out| string(out, &text))).expect("JSON");
            prop_assert_eq!(read, text);
            if double_value.is_finite() {
                let digits = written(|out| double(out, double_value));
                prop_assert_eq!(digits.parse::<f64>().expect("number").to_bits(), double_value.to_bits());
                prop_assert!(serde_json::from_str::<serde_json::Value>(&digits).is_ok());
            }
            if float_value.is_finite() {
                let digits = written(|out| float(out, float_value));
                prop_assert_eq!(digits.parse::<f32>().expect("number").to_bits(), float_value.to_bits());
            }
            prop_assert_eq!(written(|out| signed(out, integer)), integer.to_string());
        }
    }

    #[test]
    fn odd_values() {
        assert_eq!(written(|out| double(out, f64::NAN)), "\"NaN\"");
        assert_eq!(written(|out| double(out, 12.3)), "12.3");
        assert_eq!(written(|out| double(out, -0.0)), "-0");
        assert_eq!(written(|out| double(out, 1e300)), "1e300");
        assert_eq!(written(|out| base64(out, b"abcd")), "\"YWJjZA==\"");
        assert_eq!(parse_date_time("2019-02-30T00:00:00Z"), None);
        assert_eq!(
            parse_date_time("2019-01-31T00:00:00Z").map(|t| t.to_string()),
            Some("2019-01-31T00:00:00Z".into())
        );
    }
}

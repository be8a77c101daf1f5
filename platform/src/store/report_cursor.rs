//! Place in the history of reports, by what each reader of the report knows of it.

use std::{fmt, str::FromStr};

use asi_model::FactoryId;
use serde::{Deserialize, Deserializer};

/// Report after which a page begins. Its text is `{writer}-{epoch}-{sequence}-{factory}`: the place in
/// the order of arrival counts over the reports of all, and is said to nobody.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReportCursor {
    pub factory_id: FactoryId,
    pub data_set_writer_id: u16,
    pub epoch: u32,
    pub sequence: u32,
}

/// Text that is no cursor.
#[derive(Debug, thiserror::Error)]
#[error("{0:?} is no cursor of a page of reports")]
pub struct InvalidCursor(String);

impl fmt::Display for ReportCursor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { factory_id, data_set_writer_id, epoch, sequence } = self;
        write!(f, "{data_set_writer_id}-{epoch}-{sequence}-{factory_id}")
    }
}

impl FromStr for ReportCursor {
    type Err = InvalidCursor;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        parse(text).ok_or_else(|| InvalidCursor(text.chars().take(80).collect()))
    }
}

fn parse(text: &str) -> Option<ReportCursor> {
    // The factory's id may have a hyphen itself.
    let mut parts = text.splitn(4, '-');
    let data_set_writer_id = parts.next()?.parse().ok()?;
    let epoch = parts.next()?.parse().ok()?;
    let sequence = parts.next()?.parse().ok()?;
    let factory_id = FactoryId::new(parts.next()?).ok()?;
    Some(ReportCursor { factory_id, data_set_writer_id, epoch, sequence })
}

impl<'de> Deserialize<'de> for ReportCursor {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_is_read_as_it_was_written() {
        let cursor = ReportCursor {
            factory_id: "FOR-MUC_1".parse().expect("an id"),
            data_set_writer_id: 7,
            epoch: 608_926_829,
            sequence: u32::MAX,
        };
        assert_eq!(cursor.to_string(), "7-608926829-4294967295-FOR-MUC_1");
        assert_eq!(cursor.to_string().parse::<ReportCursor>().expect("a cursor"), cursor);
    }

    #[test]
    fn a_number_alone_is_no_cursor() {
        for text in ["", "17", "7-1-2", "7-1-2-", "70000-1-2-F", "7--2-F", "7-1-2-a b"] {
            assert!(text.parse::<ReportCursor>().is_err(), "{text:?}");
        }
    }
}

//! Reading columns into types that cannot be wrong.

use std::{fmt::Display, str::FromStr};

use asi_model::DateTime;
use serde::{Serialize, de::DeserializeOwned};
use sqlx::{ColumnIndex, Decode, Row, Type};

use super::{database::Database, error::StoreError};

pub(super) type DatabaseRow = <Database as sqlx::Database>::Row;

/// Columns as our types. All columns are written by this crate, so a mismatch is a corrupt store.
pub(super) trait Columns {
    /// Reads a column as a native type.
    fn column<'r, T: Decode<'r, Database> + Type<Database>>(
        &'r self,
        name: &'static str,
    ) -> Result<T, StoreError>;

    /// Reads a text column as an identifier or another type with a text form.
    fn parsed<T: FromStr<Err: Display>>(&self, name: &'static str) -> Result<T, StoreError> {
        let text: String = self.column(name)?;
        text.parse().map_err(|error: T::Err| corrupt(name, &error))
    }

    /// Reads a text column that may be null.
    fn parsed_option<T: FromStr<Err: Display>>(
        &self,
        name: &'static str,
    ) -> Result<Option<T>, StoreError> {
        let text: Option<String> = self.column(name)?;
        text.map(|text| text.parse().map_err(|error: T::Err| corrupt(name, &error))).transpose()
    }

    /// Reads a time column.
    fn time(&self, name: &'static str) -> Result<DateTime, StoreError> {
        Ok(DateTime::from_ticks(self.column(name)?))
    }

    /// Reads a time column that may be null.
    fn time_option(&self, name: &'static str) -> Result<Option<DateTime>, StoreError> {
        let ticks: Option<i64> = self.column(name)?;
        Ok(ticks.map(DateTime::from_ticks))
    }

    /// Reads a number column that is never negative.
    fn unsigned<T: TryFrom<i64>>(&self, name: &'static str) -> Result<T, StoreError> {
        let number: i64 = self.column(name)?;
        T::try_from(number).map_err(|_| corrupt(name, &number))
    }

    /// Reads a column with so many bytes.
    fn bytes<const N: usize>(&self, name: &'static str) -> Result<[u8; N], StoreError> {
        let bytes: Vec<u8> = self.column(name)?;
        let count = bytes.len();
        bytes.try_into().map_err(|_| corrupt(name, &format_args!("{count} bytes are not {N}")))
    }

    /// Reads a column that contains a JSON document.
    fn json<T: DeserializeOwned>(&self, name: &'static str) -> Result<T, StoreError> {
        let text: String = self.column(name)?;
        serde_json::from_str(&text).map_err(|error| corrupt(name, &error))
    }
}

impl Columns for DatabaseRow
where
    &'static str: ColumnIndex<DatabaseRow>,
{
    fn column<'r, T: Decode<'r, Database> + Type<Database>>(
        &'r self,
        name: &'static str,
    ) -> Result<T, StoreError> {
        self.try_get(name).map_err(StoreError::during("read a column"))
    }
}

fn corrupt(column: &'static str, reason: &dyn Display) -> StoreError {
    StoreError::Corrupt { column, reason: reason.to_string() }
}

/// A document for its column. Our documents are maps with text keys, which always serialise.
pub(super) fn document<T: Serialize + ?Sized>(value: &T) -> String {
    serde_json::to_string(value)
        .expect("documents of the store have text keys and no foreign serialisers")
}

/// An unsigned number for its column; SQL knows signed ones only, and none of ours comes near the
/// limit.
pub(super) fn signed(number: u64) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}

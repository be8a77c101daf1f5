//! Columns by name, read into types that cannot be wrong.

use std::{fmt::Display, str::FromStr};

use asi_model::{DateTime, FieldKey, RequestKey};
use serde::{Serialize, de::DeserializeOwned};
use sqlx::{Decode, Row as _, Sqlite, Type, sqlite::SqliteRow};

use super::{error::StoreError, names::Named};

/// Columns as types of the domain. This crate writes every column, so a mismatch is a damaged
/// store: [`StoreError::Unreadable`] with the column's name.
pub(super) trait Columns {
    /// Reads a column as a native type.
    fn column<'r, T: Decode<'r, Sqlite> + Type<Sqlite>>(
        &'r self,
        name: &'static str,
    ) -> Result<T, StoreError>;

    /// Reads a text column as an identifier or another type with a text form.
    fn parsed<T: FromStr<Err: Display>>(&self, name: &'static str) -> Result<T, StoreError> {
        self.column::<String>(name)?.parse().map_err(StoreError::unreadable(name))
    }

    /// Reads a text column that may be null.
    fn parsed_option<T: FromStr<Err: Display>>(
        &self,
        name: &'static str,
    ) -> Result<Option<T>, StoreError> {
        let text: Option<String> = self.column(name)?;
        text.map(|text| text.parse().map_err(StoreError::unreadable(name))).transpose()
    }

    /// Reads a column with the name of a variant.
    fn named<T: Named>(&self, name: &'static str) -> Result<T, StoreError> {
        variant(name, &self.column::<String>(name)?)
    }

    /// Reads a column with the name of a variant that may be null.
    fn named_option<T: Named>(&self, name: &'static str) -> Result<Option<T>, StoreError> {
        let text: Option<String> = self.column(name)?;
        text.map(|text| variant(name, &text)).transpose()
    }

    /// Reads a column with microseconds since 1970 (UTC).
    fn time(&self, name: &'static str) -> Result<DateTime, StoreError> {
        Ok(DateTime::from_unix_micros(self.column(name)?))
    }

    /// Reads a time that may be null.
    fn time_option(&self, name: &'static str) -> Result<Option<DateTime>, StoreError> {
        Ok(self.column::<Option<i64>>(name)?.map(DateTime::from_unix_micros))
    }

    /// Reads a number into a type with a smaller range than SQLite's.
    fn number<T: TryFrom<i64>>(&self, name: &'static str) -> Result<T, StoreError> {
        let number: i64 = self.column(name)?;
        T::try_from(number).map_err(|_| out_of_range(name, number))
    }

    /// Reads a number that may be null.
    fn number_option<T: TryFrom<i64>>(&self, name: &'static str) -> Result<Option<T>, StoreError> {
        let number: Option<i64> = self.column(name)?;
        number.map(|number| T::try_from(number).map_err(|_| out_of_range(name, number))).transpose()
    }

    /// Reads so many bytes.
    fn bytes<const N: usize>(&self, name: &'static str) -> Result<[u8; N], StoreError> {
        let bytes: Vec<u8> = self.column(name)?;
        let count = bytes.len();
        bytes.try_into().map_err(|_| StoreError::Unreadable {
            what: name,
            reason: format!("{count} bytes are not {N}"),
        })
    }

    /// Reads 0 or 1.
    fn flag(&self, name: &'static str) -> Result<bool, StoreError> {
        Ok(self.column::<i64>(name)? != 0)
    }

    /// Reads a JSON document.
    fn document<T: DeserializeOwned>(&self, name: &'static str) -> Result<T, StoreError> {
        parse_document(name, &self.column::<String>(name)?)
    }

    /// Reads a JSON document that may be null.
    fn document_option<T: DeserializeOwned>(
        &self,
        name: &'static str,
    ) -> Result<Option<T>, StoreError> {
        let text: Option<String> = self.column(name)?;
        text.map(|text| parse_document(name, &text)).transpose()
    }

    /// Reads the three columns of a request's key.
    fn request_key(&self) -> Result<RequestKey, StoreError> {
        Ok(RequestKey {
            operation_network_id: self.parsed("operation_network_id")?,
            operation_id: self.parsed("operation_id")?,
            dynamic_data_request_id: self.parsed("dynamic_data_request_id")?,
        })
    }

    /// Reads the four columns of a field's key.
    fn field_key(&self) -> Result<FieldKey, StoreError> {
        Ok(self.request_key()?.field(self.parsed("field_name")?))
    }
}

impl Columns for SqliteRow {
    fn column<'r, T: Decode<'r, Sqlite> + Type<Sqlite>>(
        &'r self,
        name: &'static str,
    ) -> Result<T, StoreError> {
        self.try_get(name).map_err(StoreError::while_doing("read a column"))
    }
}

fn variant<T: Named>(column: &'static str, name: &str) -> Result<T, StoreError> {
    T::from_name(name).ok_or_else(|| StoreError::Unreadable {
        what: column,
        reason: format!("there is no {name}"),
    })
}

fn parse_document<T: DeserializeOwned>(column: &'static str, text: &str) -> Result<T, StoreError> {
    serde_json::from_str(text).map_err(StoreError::unreadable(column))
}

fn out_of_range(column: &'static str, number: i64) -> StoreError {
    StoreError::Unreadable { what: column, reason: format!("{number} is out of range") }
}

/// Writes a value as JSON for its column.
pub(super) fn document<T: Serialize + ?Sized>(value: &T) -> String {
    serde_json::to_string(value)
        .expect("documents of the store have text keys and no foreign serialisers")
}

/// Converts an unsigned number for its column: SQLite knows signed ones only, and no number of the
/// connector comes near their limit.
pub(super) fn signed(number: u64) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}

//! Cursor pages of long lists.

use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use crate::opaque_id::OpaqueId;

/// A page of a list.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Page<T> {
    pub items: Vec<T>,
    /// Cursor of the next page; absent on the last one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next_cursor: Option<String>,
}

/// Position and size of a page.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct PageQuery {
    /// `nextCursor` of the page before; absent for the first page.
    pub cursor: Option<String>,
    /// Most entries wanted, 1 to 1000.
    pub limit: Option<u32>,
}

impl PageQuery {
    /// The number of entries, within bounds.
    pub fn limit(&self) -> u32 {
        limit(self.limit)
    }

    /// Returns the cursor of a list whose rows have opaque ids; another text starts at the first page.
    pub fn after_id(&self) -> Option<OpaqueId> {
        self.cursor.as_deref()?.parse().ok()
    }

    /// Returns the cursor of a list ordered by number; a text that is no number starts at the first
    /// page.
    pub fn after(&self) -> Option<u64> {
        self.cursor.as_deref()?.parse().ok()
    }
}

/// A wanted number of entries, within bounds.
pub fn limit(wanted: Option<u32>) -> u32 {
    wanted.unwrap_or(100).clamp(1, 1000)
}

impl<T> Page<T> {
    /// A list that is never long, as one page.
    pub const fn whole(items: Vec<T>) -> Self {
        Self { items, next_cursor: None }
    }

    /// A page of at most `limit` entries; a full one has a successor.
    pub fn new(items: Vec<T>, limit: u32, cursor: impl Fn(&T) -> String) -> Self {
        let is_full = items.len() >= limit as usize;
        let next_cursor = items.last().filter(|_| is_full).map(cursor);
        Self { items, next_cursor }
    }
}

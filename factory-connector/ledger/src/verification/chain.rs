//! Verification of one chain: what was found of it so far.

use super::log::LogCheck;
use crate::{Anchor, Head, history::ReportHistory};

/// A chain while its entries are taken.
#[derive(Default)]
pub(super) struct ChainCheck {
    /// The last entry that was taken; none before the first.
    pub(super) head: Option<Head>,
    /// The entry that the first stored one follows, by the chain's anchor.
    pub(super) start: Option<Head>,
    pub(super) anchor: Option<Anchor>,
    pub(super) log: Option<LogCheck>,
    pub(super) history: ReportHistory,
}

impl ChainCheck {
    /// Starts after the entries that an anchor stands for.
    pub(super) fn after(start: Head, anchor: Anchor) -> Self {
        let history = ReportHistory::after(start.number);
        Self { start: Some(start), anchor: Some(anchor), history, ..Self::default() }
    }

    /// Returns the last entry that is known; number 0 where there is none.
    pub(super) fn end(&self) -> Head {
        self.head.or(self.start).unwrap_or_default()
    }
}

//! What is too old goes, and is announced.

use std::time::Duration;

use time::OffsetDateTime;

use super::{Removal, ReportRow};

/// Chooses the rows that are older than `age_max`.
#[must_use]
pub fn expire(rows: &[ReportRow], age_max: Duration, now: OffsetDateTime) -> Removal {
    let old: Vec<_> = rows.iter().filter(|r| now - r.created_at > age_max).copied().collect();
    Removal::of(&old)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spool::{RowId, tests::row};

    #[test]
    fn only_old_rows_go() {
        let mut rows = vec![row(1, 7, 0), row(2, 7, 1)];
        let now = rows[0].created_at + Duration::from_secs(100);
        rows[1].created_at = now;
        assert_eq!(expire(&rows, Duration::from_secs(100), now), Removal::default());
        assert_eq!(expire(&rows, Duration::from_secs(99), now).rows, [RowId(1)]);
    }
}

//! Answers that last, and the number of those under way.

use std::{num::NonZeroU64, time::Duration};

use axum::http::StatusCode;

use crate::web::problem::Problem;

/// Time after which another attempt makes sense.
const RETRY_AFTER: Duration = Duration::from_secs(10);

/// Kind of answers that last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// Exports, audits and verifications.
    Downloads,
    /// Answers of server-sent events, which end with the page.
    Streams,
}

impl Share {
    /// Returns the value of the metric's label `share`.
    pub(super) const fn label(self) -> &'static str {
        match self {
            Self::Downloads => "downloads",
            Self::Streams => "streams",
        }
    }

    /// Returns the problem of a member without a place.
    pub(super) fn problem(self, per_person: u32, per_organisation: u32) -> Problem {
        let (code, what) = match self {
            Self::Downloads => ("TOO_MANY_DOWNLOADS", "downloads and verifications"),
            Self::Streams => ("TOO_MANY_STREAMS", "live streams"),
        };
        let detail = format!(
            "There are at most {per_person} {what} of a person and {per_organisation} of an organisation \
             at the same time; wait until one has ended."
        );
        Problem {
            retry_after_seconds: NonZeroU64::new(RETRY_AFTER.as_secs()),
            ..Problem::new(StatusCode::TOO_MANY_REQUESTS, code, detail)
        }
    }
}

/// Number of places taken, by share.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Places {
    downloads: u32,
    streams: u32,
}

impl Places {
    pub(super) const fn taken(self, share: Share) -> u32 {
        match share {
            Share::Downloads => self.downloads,
            Share::Streams => self.streams,
        }
    }

    pub(super) fn take(&mut self, share: Share) {
        *self.of(share) += 1;
    }

    pub(super) fn release(&mut self, share: Share) {
        let taken = self.of(share);
        *taken = taken.saturating_sub(1);
    }

    pub(super) const fn are_free(self) -> bool {
        self.downloads == 0 && self.streams == 0
    }

    const fn of(&mut self, share: Share) -> &mut u32 {
        match share {
            Share::Downloads => &mut self.downloads,
            Share::Streams => &mut self.streams,
        }
    }
}

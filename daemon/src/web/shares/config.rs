//! Sizes of the shares.

use std::{num::NonZeroU32, time::Duration};

use serde::Deserialize;

use super::share::Share;

/// Shares of each person and of each organisation in what a daemon answers.
#[derive(Debug, Clone, Default)]
pub struct FairShareConfig {
    pub person: PersonShare,
    pub organisation: OrganisationShare,
}

/// Share of one person. Pages stay far below.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PersonShare {
    /// Requests per second that a person may send for long.
    pub requests_per_second: NonZeroU32,
    /// Requests that a person may send at once, after a pause.
    pub requests_at_once: NonZeroU32,
    /// Exports, audits and verifications at the same time.
    pub downloads: NonZeroU32,
    /// Live streams at the same time; each open page has one.
    pub streams: NonZeroU32,
    /// MiB of the bodies of requests that may be under way at the same time.
    pub body_mib: NonZeroU32,
}

/// Share of all people of one organisation together.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OrganisationShare {
    /// Requests per second that they may send for long.
    pub requests_per_second: NonZeroU32,
    /// Requests that they may send at once, after a pause.
    pub requests_at_once: NonZeroU32,
    /// Exports, audits and verifications at the same time.
    pub downloads: NonZeroU32,
    /// Live streams at the same time.
    pub streams: NonZeroU32,
    /// MiB of the bodies of requests that may be under way at the same time.
    pub body_mib: NonZeroU32,
}

impl Default for PersonShare {
    fn default() -> Self {
        Self {
            requests_per_second: size(200),
            requests_at_once: size(4_000),
            downloads: size(2),
            streams: size(16),
            body_mib: size(16),
        }
    }
}

impl Default for OrganisationShare {
    fn default() -> Self {
        Self {
            requests_per_second: size(500),
            requests_at_once: size(10_000),
            downloads: size(4),
            streams: size(64),
            body_mib: size(64),
        }
    }
}

const fn size(number: u32) -> NonZeroU32 {
    match NonZeroU32::new(number) {
        Some(number) => number,
        None => NonZeroU32::MIN,
    }
}

impl FairShareConfig {
    pub(super) const fn requests_of_person(&self) -> Rate {
        let PersonShare { requests_per_second, requests_at_once, .. } = self.person;
        Rate { per_second: requests_per_second, at_once: requests_at_once }
    }

    pub(super) const fn requests_of_organisation(&self) -> Rate {
        let OrganisationShare { requests_per_second, requests_at_once, .. } = self.organisation;
        Rate { per_second: requests_per_second, at_once: requests_at_once }
    }

    /// Returns the places of a person and those of an organisation.
    pub(super) const fn places(&self, share: Share) -> (u32, u32) {
        let (person, organisation) = (&self.person, &self.organisation);
        match share {
            Share::Downloads => (person.downloads.get(), organisation.downloads.get()),
            Share::Streams => (person.streams.get(), organisation.streams.get()),
        }
    }
}

/// Requests per second, and those that may come at once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rate {
    per_second: NonZeroU32,
    at_once: NonZeroU32,
}

impl Rate {
    pub(super) const fn new(per_second: NonZeroU32, at_once: NonZeroU32) -> Self {
        Self { per_second, at_once }
    }

    /// Returns the time in which one request is given back.
    pub(super) fn interval(self) -> Duration {
        Duration::from_secs(1) / self.per_second.get()
    }

    /// Returns the time in which an empty bucket fills.
    pub(super) fn refill(self) -> Duration {
        self.interval().saturating_mul(self.at_once.get())
    }
}

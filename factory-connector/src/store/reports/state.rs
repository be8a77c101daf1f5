//! State of a report.

use crate::store::names::Named;

/// State of a report from its making to the platform's receipt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ReportState {
    /// Unsent, or to be sent again.
    Waiting,
    /// Accepted by the broker, without a receipt of the platform yet.
    Sent,
    /// Set aside: the broker will never accept it.
    Parked,
    /// Receipted, given up or taken back: the spool is done with it.
    Done,
}

impl Named for ReportState {
    const ALL: &'static [Self] = &[Self::Waiting, Self::Sent, Self::Parked, Self::Done];

    fn name(self) -> &'static str {
        match self {
            Self::Waiting => "WAITING",
            Self::Sent => "SENT",
            Self::Parked => "PARKED",
            Self::Done => "DONE",
        }
    }
}

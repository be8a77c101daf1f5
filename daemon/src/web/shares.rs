//! Fair shares of pages and API: what one person or one organisation uses at once is bounded, so that
//! the others do not feel it.
//!
//! Requests draw on a bucket of their person and on one of the organisation. Downloads, which include
//! exports, audits and verifications, and live streams hold a place until their answer has ended, and
//! the bodies of requests their bytes until the answer begins. Operations that read a store with few
//! readers come in turns. A refusal is a problem document (429) and a count in `verbund_share_refusals_total` that says whose.

mod bodies;
mod bucket;
mod config;
mod read_turns;
mod refusals;
mod routes;
mod share;
mod strangers;
mod usage;

pub use self::{
    config::{FairShareConfig, OrganisationShare, PersonShare},
    refusals::count_refusal,
    routes::{downloads, hold_download, hold_stream, read_in_turn, streams},
    share::Share,
    usage::{FairShares, HeldShare, Member},
};
pub(crate) use bodies::hold_body;
pub(crate) use routes::Claim;
pub(crate) use strangers::{StrangerShares, within_share_of_client};

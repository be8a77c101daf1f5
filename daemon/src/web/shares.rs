//! Fair shares of pages and API: what one person or one organisation uses at once is bounded, so that
//! the others do not feel it.
//!
//! Requests draw on a bucket of their person and on one of the organisation. Downloads, which include
//! exports, audits and verifications, and live streams hold a place until their answer has ended, and
//! the bodies of requests their bytes until the answer begins. Operations at a store with few readers and one writer come
//! in turns. A refusal is a problem document (429) and a count in `verbund_share_refusals_total` that says whose share
//! was used up.

mod bodies;
mod bucket;
mod config;
mod member;
mod member_turns;
mod refusals;
mod routes;
mod share;
mod strangers;
mod usage;

pub use self::{
    config::{FairShareConfig, OrganisationShare, PersonShare},
    member::Member,
    member_turns::MemberTurn,
    refusals::{ShareOwner, count_refusal},
    routes::{FurtherTurns, OwnTurns, downloads, hold_download, hold_stream, in_turn, streams},
    share::Share,
    usage::{FairShares, HeldShare},
};
pub(crate) use bodies::hold_body;
pub(crate) use routes::Claim;
pub(crate) use strangers::{StrangerShares, within_share_of_client};

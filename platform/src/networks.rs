//! Operation networks: changing them, and sending each factory the part that concerns it.
//!
//! Every change makes a new revision of the whole network and works inside the caller's unit of
//! work: revision, parts and outgoing messages commit together. Notifications of pages are
//! returned, and published after the commit. Who may change what, and who sees what of it, is stated
//! in `docs/rights.md`: the author's document is compared with what the author saw ([`put`]), and
//! merged with what is hidden.

mod author;
mod change;
mod comments;
mod effect;
mod fault;
mod faults;
mod merge;
mod notifications;
mod outcome;
mod parts;
mod readers;
mod requests;
mod resend;
mod rights;
mod taken;
mod view;

pub use author::Author;
pub use change::{PutNetwork, put, withdraw};
pub use comments::{CommentError, add_comment};
pub(crate) use faults::structure as structure_faults;
pub(crate) use notifications::{comment_added, part_changed};
pub use outcome::{ChangeError, ChangeOutcome};
pub(crate) use parts::outgoing;
pub use requests::{add_request, remove_request};
pub use resend::Resender;
pub use view::{FieldView, NetworkView, PartView, view};

//! Operation networks: changing them, and sending each factory the part that concerns it.
//!
//! Every change makes a new revision of the whole network and works inside the caller's unit of
//! work: revision, parts and outgoing messages commit together. Notifications of pages are
//! returned, and published after the commit.

mod author;
mod change;
mod faults;
mod parts;
mod requests;
mod resend;
mod view;

pub use author::Author;
pub use change::{ChangeError, Outcome, PutNetwork, put, withdraw};
pub(crate) use parts::outgoing;
pub use requests::{add_request, remove_request};
pub use resend::Resender;
pub use view::{FieldView, NetworkView, PartView, view};

//! OPC UA services of a session, in requests that stay within the server's limits.

mod browse;
mod call;
mod history;
mod read;
mod translate;
mod write;

pub(super) use browse::{children_of, references, supertype_of};
pub(crate) use call::call;
pub(super) use history::{PastValues, read_history};
pub(crate) use read::read;
pub(super) use read::{is_undecoded, read_attributes, read_browse_names, read_values};
pub(super) use translate::translate;
pub(crate) use write::write;

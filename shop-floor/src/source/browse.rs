//! Browsing for people who choose variables: children of a node, search, and lists of variables.

mod children;
mod data_types;
mod details;
mod search;
mod variables;
mod walk;

pub(crate) use children::{browse, describe, describe_many};
pub(crate) use search::search;
pub(crate) use variables::list_variables;

//! Use cases and transactions on a small plant.

mod caps;
mod commit_size;
mod decisions;
mod entries;
mod mappings;
mod past;
mod policies;
mod previews;
mod reports;
mod restart;
mod revisions;
mod rules;
mod transactions;

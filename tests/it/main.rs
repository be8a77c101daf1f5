//! Tests across the parts, with the real programs, and of the form of the workspace.
#![allow(clippy::unwrap_used)]

mod broker_dead_letters;
mod chaos;
mod credentials;
mod data_directories;
mod demo;
mod faults_of_chaos;
mod former_store;
mod fuzzing;
mod hardening;
mod house;
mod mutants;
mod mutants_cover;
mod notices;
mod openapi;
mod order;
mod passwords;
mod promises;
mod shown;
mod untested_brokers;
mod vendored;

//! The cloud services of Verbund: organisations agree on operation networks here, factories get
//! their parts, reports come in, and partners see them as they happen.
//!
//! - [`config`]: what an operator sets. [`service`]: everything opened and started from it.
//! - [`store`]: the database, one repository per noun; [`accounts`], [`administrator`]: who may
//!   sign in.
//! - [`networks`]: changing networks and sending parts. [`ingest`]: what factories and tools send,
//!   each message once.
//! - [`leases`] (pure): which of a factory's running connectors speaks for it.
//! - [`progress`] (pure), [`progress_board`], [`live`]: how operations stand, and telling it.
//! - [`receipts`], [`retention`], [`outgoing`]: what is told to connectors, forgotten, sent.
//! - [`reach`], [`enrolment`], [`certificates`]: who may use the broker, and how it is trusted.
//! - [`api`]: the HTTP side.

pub mod accounts;
pub mod administrator;
pub mod api;
pub mod application;
pub mod certificates;
pub mod clock;
pub mod config;
pub mod enrolment;
pub mod ingest;
pub mod leases;
pub mod live;
pub mod networks;
pub mod outgoing;
pub mod plain;
pub mod principal;
pub mod progress;
pub mod progress_board;
pub mod reach;
pub mod receipts;
pub mod retention;
pub mod sequences;
pub mod service;
pub mod store;
pub mod tools;

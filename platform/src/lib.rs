//! Cloud services of Verbund: organisations agree on operation networks, factories are sent their
//! parts, reports are received, and partners see them as they arrive.
//!
//! Start reading at [`service`], which opens everything from the [`config`] and starts the tasks.
//! Modules from the bottom to the top:
//!
//! - Pure: [`leases`] (decides which connector speaks for a factory), [`sequences`] (received
//!   sequence numbers), [`signing`] (which keys sign for a factory), [`opaque_id`] (ids for
//!   those outside), [`tools`] (messages of partners' tools).
//! - [`disk`]: space on disks. `secrets`: sealing of secrets in the database.
//! - [`accesses`]: values leave only with a record of who got them. [`access_log_key`]: signs that.
//! - [`store`]: the database, one repository per noun. [`principal`]: rights of the signed-in user.
//! - [`progress`] (pure): progress of operations. [`live`]: events for pages.
//! - [`broker_process`]: the embedded broker, in a process of its own or in this one.
//! - [`broker_access`], [`certificates`], [`enrolment`]: users, queues and certificates of the
//!   broker, and credentials of connectors. [`spool`]: outgoing messages for the link.
//! - [`networks`]: changes of networks and the parts sent to factories. [`ingest`]: received
//!   messages, each exactly once. [`witness`]: countersigned checkpoints of factories' ledgers.
//! - Tasks: [`receipts`], [`retention`], [`progress_notifier`].
//! - [`audit`]: what people and programs change is changed with a record of it. [`accounts`],
//!   [`administrator`], [`application`], [`api`]: the HTTP API.

pub mod access_log_key;
pub mod accesses;
pub mod accounts;
pub mod administrator;
pub mod api;
pub mod application;
pub mod audit;
pub mod broker_access;
pub mod broker_process;
pub mod certificates;
pub mod clock;
pub mod config;
pub mod disk;
pub mod enrolment;
mod entitlement;
pub mod ingest;
pub mod leases;
pub mod leaving;
pub mod live;
pub mod networks;
pub mod opaque_id;
pub mod principal;
pub mod progress;
pub mod progress_notifier;
pub mod receipts;
pub mod retention;
mod secrets;
pub mod sequences;
pub mod service;
pub mod signing;
pub mod spool;
pub mod store;
pub mod tools;
pub mod witness;

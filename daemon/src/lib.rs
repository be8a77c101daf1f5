//! Parts that both daemons share, so that an operator who knows one knows the other.
//!
//! - [`configuration`]: TOML files with environment overrides, and errors with origin and
//!   remedy.
//! - [`data_directory`]: the folder of a daemon's files, for its own user alone.
//! - [`certificate_pin`]: a server's certificate, known by another way than the connection.
//! - [`client_certificate`]: certificate and key by which a daemon is known to a broker.
//! - [`secret_file`]: passwords and keys in files, for this program's user alone.
//! - [`plaintext`]: ways to other machines without TLS.
//! - [`lifecycle`]: named tasks, one shutdown, and the consequence of a task's failure.
//! - [`descriptors`]: the limit of open files.
//! - [`exit`]: message and exit code after an error.
//! - [`sealing`]: passwords in a store, sealed under a key that is kept elsewhere.
//! - [`telemetry`]: logs and metrics.
//! - [`notices`]: what others wrote, with the licences.
//! - [`confidential`]: values that must never reach a log.
//! - [`turns`]: so many of one name at a time.
//! - [`web`]: problem documents, sessions, security headers, embedded pages, live events, health.
//!
//! Independent of the purpose of either daemon.

pub mod certificate_pin;
pub mod client_certificate;
pub mod confidential;
pub mod configuration;
pub mod data_directory;
pub mod descriptors;
pub mod exit;
pub mod lifecycle;
pub mod notices;
pub mod plaintext;
pub mod sealing;
pub mod secret_file;
pub mod telemetry;
pub mod turns;
pub mod web;

pub use confidential::Confidential;

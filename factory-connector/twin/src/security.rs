//! Access to the twin: its application certificate, the trust list, and users.

pub(crate) mod application_certificate;
pub(crate) mod approvals;
pub(crate) mod certificate;
pub(crate) mod certificate_files;
pub(crate) mod connections;
pub(crate) mod issuance;
pub(crate) mod known_folders;
pub(crate) mod login;
pub(crate) mod rejected_clients;
pub(crate) mod renewal;
pub(crate) mod review;
pub(crate) mod throttle;
pub(crate) mod trust;
pub(crate) mod validation;

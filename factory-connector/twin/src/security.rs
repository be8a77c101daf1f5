//! Who may connect: the twin's own certificate, the trust list, and users.

pub(crate) mod certificate;
pub(crate) mod connections;
pub(crate) mod login;
pub(crate) mod own;
pub(crate) mod renewal;
pub(crate) mod throttle;
pub(crate) mod trust;
pub(crate) mod validation;

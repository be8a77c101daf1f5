//! Accounts of the demo.

/// Administrator of the platform.
pub const ADMIN: &str = "admin";
/// Engineer of a connector and its twin.
pub const ENGINEER: &str = "engineer";
/// The password of both in the demo; real installations make up their own at the first start.
pub const PASSWORD: &str = "frame-order-4711";
/// A broker user with the platform's rights, for tools that look at messages.
pub const OBSERVER: &str = "observer";
/// Its password.
pub const OBSERVER_PASSWORD: &str = "observer-3f9a1c77d2e84b60";

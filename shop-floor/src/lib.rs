//! shop-floor.

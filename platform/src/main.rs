//! platform.
fn main() {}

//! factory-connector.
fn main() {}

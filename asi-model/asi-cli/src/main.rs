//! asi-cli.
fn main() {}

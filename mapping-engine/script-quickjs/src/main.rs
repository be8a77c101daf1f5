//! script-quickjs.
fn main() {}

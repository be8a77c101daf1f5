//! Any message from a factory is accepted or has faults.
#![no_main]

use asi_model::validation::parse_factory_message;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Err(rejection) = parse_factory_message(bytes) {
        assert!(!rejection.faults.is_empty());
    }
});

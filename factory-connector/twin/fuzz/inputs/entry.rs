//! Entry of the fuzzer, in a file of its own: the modules beside it are those of the tests.

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| crate::requests::requests(bytes));

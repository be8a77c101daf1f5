//! Bodies of requests to the platform's API, for the fuzz target and for the test that replays its corpus.

use std::cell::RefCell;

use platform::api::bodies;
use tokio::runtime::{Builder, Runtime};

thread_local! {
    static RUNTIME: RefCell<Option<Runtime>> = const { RefCell::new(None) };
}

/// Reads bytes as a body. The first one says of which operation. A body that is refused is refused as the caller's
/// fault: no answer is a fault of the platform.
pub fn body(bytes: &[u8]) {
    let Some((number, rest)) = bytes.split_first() else { return };
    let operation = bodies::OPERATIONS[usize::from(*number) % bodies::OPERATIONS.len()];
    let outcome = RUNTIME.with_borrow_mut(|runtime| {
        let runtime = runtime
            .get_or_insert_with(|| Builder::new_current_thread().build().expect("a runtime"));
        runtime.block_on(bodies::read(operation, rest.to_vec()))
    });
    let outcome = outcome.expect("an operation with a body");
    if let Err(problem) = outcome {
        assert!((400..500).contains(&problem.status), "{operation}: {problem:?}");
    }
}

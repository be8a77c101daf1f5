//! Open files and connections that the operating system grants the process.

use rustix::process::{Resource, getrlimit, setrlimit};

/// Raises the limit of open files as far as the process may: service managers often begin with 1024,
/// fewer than the connections that the daemons' listeners allow. Returns the limit; `None` for none.
pub fn raise_limit() -> Option<u64> {
    let mut limit = getrlimit(Resource::Nofile);
    if limit.current != limit.maximum {
        let before = limit.current;
        limit.current = limit.maximum;
        if let Err(error) = setrlimit(Resource::Nofile, limit) {
            tracing::warn!(%error, limit = before, "The limit of open files cannot be raised.");
            return before;
        }
    }
    limit.current
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_is_what_the_process_may_have() {
        let raised = raise_limit();
        let limit = getrlimit(Resource::Nofile);
        assert_eq!((raised, limit.current), (limit.maximum, limit.maximum));
    }
}

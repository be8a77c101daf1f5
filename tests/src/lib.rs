//! verbund-tests.

//! factory-connector.

//! opcua-stack.

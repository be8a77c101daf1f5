//! asi-model.

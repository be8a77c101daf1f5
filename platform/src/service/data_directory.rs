//! Creation of the data directory.

use std::os::unix::fs::DirBuilderExt;

use super::error::StartError;
use crate::config::PlatformConfig;

/// Creates the data directory, readable for the daemon's own user only.
pub(super) fn create(config: &PlatformConfig) -> Result<(), StartError> {
    std::fs::DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(&config.data_directory)
        .map_err(|source| StartError::DataDirectory { path: config.data_directory.clone(), source })
}

//! Record of the people who approved certificates. Without one a certificate may have been trusted by a development
//! setting of a former version, or copied into the folder.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use asi_model::DateTime;
use serde::{Deserialize, Serialize};

use super::certificate_files::replace;
use crate::{clock, error::TwinError};

/// The folder within that of the trust list.
pub(crate) const FOLDER: &str = "approved";
/// Longest file read, in bytes.
const FILE_BYTES_MAX: u64 = 16 * 1024;

/// Approval of a certificate by a person.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Approval {
    /// Name of the person.
    pub by: String,
    pub at: DateTime,
}

/// Store of approvals, by the SHA-256 fingerprint of the certificate: one small file for each.
#[derive(Debug, Clone)]
pub(crate) struct Approvals {
    folder: PathBuf,
}

impl Approvals {
    /// Creates the store in the folder of certificates.
    pub fn new(pki_directory: &Path) -> Self {
        Self { folder: pki_directory.join(FOLDER) }
    }

    /// Records who approves a certificate now.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when it cannot be written.
    pub fn record(&self, fingerprint: &str, by: &str) -> Result<(), TwinError> {
        let approval = Approval { by: by.to_owned(), at: clock::now() };
        let bytes = serde_json::to_vec(&approval).expect("an approval has text keys only");
        replace(&self.path(fingerprint), &bytes)
    }

    /// Returns the approval of a certificate; `None` also where the record cannot be read.
    pub fn of(&self, fingerprint: &str) -> Option<Approval> {
        let path = self.path(fingerprint);
        let is_small = fs::metadata(&path).is_ok_and(|found| found.len() <= FILE_BYTES_MAX);
        is_small
            .then(|| fs::read(&path).ok())
            .flatten()
            .and_then(|bytes| serde_json::from_slice(&bytes).ok())
    }

    /// Removes the record of a certificate that is trusted no longer.
    ///
    /// # Errors
    /// [`TwinError::Pki`] when it cannot be removed.
    pub fn forget(&self, fingerprint: &str) -> Result<(), TwinError> {
        let path = self.path(fingerprint);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(TwinError::Pki { path, source: error })
            }
            _ => Ok(()),
        }
    }

    fn path(&self, fingerprint: &str) -> PathBuf {
        self.folder.join(format!("{fingerprint}.json"))
    }
}

//! Denied certificates, found again however one is written.

use std::collections::HashSet;

use x509_parser::{certificate::X509Certificate, prelude::FromDer};

use crate::security::known_folders::Items;

/// Marks of the denied certificates that their bearers cannot change. All bytes of one are no such mark: its bearer can
/// write signature and algorithm behind the signed part in other ways that verify, too.
pub(super) struct Denials {
    signed_parts: HashSet<Vec<u8>>,
    keys: HashSet<Vec<u8>>,
}

impl Denials {
    /// Reads the denied certificates; `None` where one cannot be read.
    pub fn new(denied: &Items) -> Option<Self> {
        let (mut signed_parts, mut keys) = (HashSet::new(), HashSet::new());
        for der in denied.as_slice() {
            let (_, certificate) = X509Certificate::from_der(der).ok()?;
            signed_parts.insert(signed_part(&certificate).to_vec());
            keys.insert(key(&certificate).to_vec());
        }
        Some(Self { signed_parts, keys })
    }

    /// Returns true for a denied certificate.
    pub fn have(&self, certificate: &X509Certificate<'_>) -> bool {
        self.signed_parts.contains(signed_part(certificate))
    }

    /// Returns true for a certificate of a key that a denied one has: its authority may have renewed it.
    pub fn have_key_of(&self, certificate: &X509Certificate<'_>) -> bool {
        self.keys.contains(key(certificate))
    }
}

fn signed_part<'c>(certificate: &'c X509Certificate<'_>) -> &'c [u8] {
    certificate.tbs_certificate.as_ref()
}

/// Returns the key without the parameters of its algorithm, which may be written in two ways.
fn key<'c>(certificate: &'c X509Certificate<'_>) -> &'c [u8] {
    &certificate.public_key().subject_public_key.data
}

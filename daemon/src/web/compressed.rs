//! Bodies that are part of the program, compressed once: whatever a stranger may ask for costs no more than
//! sending it.

use std::{collections::HashMap, io::Write as _, sync::LazyLock};

use axum::http::{HeaderMap, HeaderValue, header};
use bytes::Bytes;
use flate2::{Compression, write::GzEncoder};
use parking_lot::Mutex;
use sha2::{Digest as _, Sha256};

/// Shortest body worth it.
const BYTES_MIN: usize = 512;

/// Compressed bodies by the digest of the whole ones. Bounded by what is built into the program.
static COMPRESSED: LazyLock<Mutex<HashMap<[u8; 32], Bytes>>> = LazyLock::new(Mutex::default);

/// Body that is part of the program.
pub(super) struct FixedBody {
    bytes: Bytes,
    digest: [u8; 32],
}

impl FixedBody {
    /// Keeps a body that lasts as long as the program.
    pub(super) fn new(bytes: impl Into<Bytes>) -> Self {
        let bytes = bytes.into();
        let digest = Sha256::digest(&bytes).into();
        Self { bytes, digest }
    }

    /// Takes a body whose digest is known.
    pub(super) const fn with_digest(bytes: Bytes, digest: [u8; 32]) -> Self {
        Self { bytes, digest }
    }

    /// Returns the body as a client takes it, with the headers that say so.
    pub(super) fn for_client(&self, asked: &HeaderMap) -> (HeaderMap, Bytes) {
        let mut headers = HeaderMap::new();
        headers.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
        if self.bytes.len() < BYTES_MIN || !takes_gzip(asked) {
            return (headers, self.bytes.clone());
        }
        headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
        (headers, self.compressed())
    }

    fn compressed(&self) -> Bytes {
        let mut known = COMPRESSED.lock();
        let compressed = known.entry(self.digest).or_insert_with(|| {
            let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
            encoder.write_all(&self.bytes).expect("a vector takes all");
            encoder.finish().expect("a vector takes all").into()
        });
        compressed.clone()
    }
}

/// True where a client names gzip, and not as what it refuses.
fn takes_gzip(headers: &HeaderMap) -> bool {
    headers.get_all(header::ACCEPT_ENCODING).iter().any(|value| {
        let encodings = value.to_str().unwrap_or_default().split(',');
        encodings.into_iter().any(|encoding| {
            let mut parts = encoding.split(';').map(str::trim);
            parts.next().is_some_and(|name| name.eq_ignore_ascii_case("gzip"))
                && !parts.any(|part| part.trim_end_matches(['0', '.']) == "q=")
        })
    })
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use super::*;

    fn asked(encodings: &str) -> HeaderMap {
        let value = HeaderValue::from_str(encodings).expect("a header");
        HeaderMap::from_iter([(header::ACCEPT_ENCODING, value)])
    }

    #[test]
    fn a_body_is_compressed_once_and_for_those_who_take_it() {
        let text = "what is built in ".repeat(1_000);
        let body = FixedBody::new(text.clone());
        for encodings in ["gzip", "br;q=1.0, gzip;q=0.8, *;q=0.1", "deflate, GZIP"] {
            let (headers, bytes) = body.for_client(&asked(encodings));
            assert_eq!(headers[header::CONTENT_ENCODING], "gzip", "{encodings}");
            let mut read = String::new();
            flate2::read::GzDecoder::new(&bytes[..]).read_to_string(&mut read).expect("gzip");
            assert_eq!(read, text);
            let (_, again) = FixedBody::new(text.clone()).for_client(&asked(encodings));
            assert_eq!(again.as_ptr(), bytes.as_ptr(), "the same memory");
        }
        for encodings in ["br", "gzip;q=0", "gzip; q=0.000", ""] {
            let (headers, bytes) = body.for_client(&asked(encodings));
            assert!(!headers.contains_key(header::CONTENT_ENCODING), "{encodings}");
            assert_eq!(bytes, text);
        }
    }
}

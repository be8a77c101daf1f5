//! Message on the wire: the body and those headers that every broker can carry. Bodies are
//! self-contained; nothing depends on a header that a broker may drop.

use std::{io::Read, time::Duration};

use asi_model::MessageId;
use bytes::Bytes;
use time::OffsetDateTime;

/// The content type of all bodies of the wire contract.
pub const JSON: &str = "application/json";

/// Compression of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContentEncoding {
    /// Gzip of RFC 1952.
    Gzip,
}

impl ContentEncoding {
    /// Returns the name on the wire.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Gzip => "gzip",
        }
    }
}

/// A message with its headers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Envelope {
    /// Unique per message; absent only on messages of foreign senders that gave none.
    pub message_id: Option<MessageId>,
    /// The message type, as `operation-network`.
    pub subject: String,
    /// The media type of the decompressed body.
    pub content_type: String,
    pub content_encoding: Option<ContentEncoding>,
    /// The message this one answers.
    pub correlation_id: Option<MessageId>,
    /// Time at which the sender created the message.
    pub creation_time: Option<OffsetDateTime>,
    /// Time from its creation to its expiry; none when it never expires.
    pub ttl: Option<Duration>,
    /// True when it belongs to the backlog after an outage: newer messages may have been sent
    /// before.
    pub replay: bool,
    /// The number of the lease under which a factory's connector sends; none when it requests one,
    /// and for all other senders.
    pub lease: Option<u64>,
    /// The sender's signature over the body as it travels and what it binds to it, in the sender's
    /// form; none where it does not sign.
    pub signature: Option<String>,
    /// The bytes on the wire, compressed as `content_encoding` says.
    pub body: Bytes,
}

/// Fault of a body that cannot be decompressed.
#[derive(Debug, thiserror::Error)]
pub enum BodyError {
    /// The compressed bytes are damaged.
    #[error("the body is not valid gzip")]
    Damaged(#[source] std::io::Error),
    /// Decompressed, it is larger than the receiver allows.
    #[error("the unpacked body exceeds {limit} bytes")]
    TooLarge {
        /// The receiver's limit, in bytes.
        limit: usize,
    },
}

impl Envelope {
    /// Creates a JSON message without any optional header.
    #[must_use]
    pub fn new(message_id: MessageId, subject: impl Into<String>, body: impl Into<Bytes>) -> Self {
        Self {
            message_id: Some(message_id),
            subject: subject.into(),
            content_type: JSON.to_owned(),
            content_encoding: None,
            correlation_id: None,
            creation_time: None,
            ttl: None,
            replay: false,
            lease: None,
            signature: None,
            body: body.into(),
        }
    }

    /// Returns the time of expiry; none when it never expires or its creation is unknown.
    #[must_use]
    pub fn expires_at(&self) -> Option<OffsetDateTime> {
        let ttl = time::Duration::try_from(self.ttl?).ok()?;
        self.creation_time?.checked_add(ttl)
    }

    /// Returns whether the message has expired.
    #[must_use]
    pub fn is_expired(&self, now: OffsetDateTime) -> bool {
        self.expires_at().is_some_and(|at| at <= now)
    }

    /// Compresses the body with gzip if that makes it smaller.
    #[must_use]
    pub fn compressed(mut self) -> Self {
        if self.content_encoding.is_none() {
            let mut packed = Vec::with_capacity(self.body.len() / 4 + 64);
            let read = flate2::read::GzEncoder::new(&self.body[..], flate2::Compression::default())
                .read_to_end(&mut packed);
            if read.is_ok() && packed.len() < self.body.len() {
                self.body = packed.into();
                self.content_encoding = Some(ContentEncoding::Gzip);
            }
        }
        self
    }

    /// The body as the sender wrote it.
    ///
    /// # Errors
    /// [`BodyError`] when it is damaged or larger than `limit` bytes; at most `limit` bytes are
    /// ever unpacked.
    pub fn unpacked(&self, limit: usize) -> Result<Bytes, BodyError> {
        let body = match self.content_encoding {
            None => self.body.clone(),
            Some(ContentEncoding::Gzip) => {
                let mut plain = Vec::new();
                flate2::read::GzDecoder::new(&self.body[..])
                    .take(limit as u64 + 1)
                    .read_to_end(&mut plain)
                    .map_err(BodyError::Damaged)?;
                plain.into()
            }
        };
        if body.len() > limit { Err(BodyError::TooLarge { limit }) } else { Ok(body) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn envelope(body: impl Into<Bytes>) -> Envelope {
        Envelope::new(MessageId::new("m1").expect("an id"), "comment", body)
    }

    #[test]
    fn a_body_survives_packing() {
        let body = vec![b'x'; 50_000];
        let packed = envelope(body.clone()).compressed();
        assert_eq!(packed.content_encoding, Some(ContentEncoding::Gzip));
        assert!(packed.body.len() < 1000);
        assert_eq!(packed.unpacked(50_000).expect("unpacks"), body);
    }

    #[test]
    fn a_bomb_stops_at_the_limit() {
        let packed = envelope(vec![0; 10_000_000]).compressed();
        assert!(matches!(packed.unpacked(1024), Err(BodyError::TooLarge { limit: 1024 })));
    }

    #[test]
    fn damage_is_an_error() {
        let mut broken = envelope("not gzip");
        broken.content_encoding = Some(ContentEncoding::Gzip);
        assert!(matches!(broken.unpacked(1024), Err(BodyError::Damaged(_))));
    }

    #[test]
    fn a_body_that_does_not_shrink_stays_as_it_is() {
        assert_eq!(envelope("{}").compressed().content_encoding, None);
    }

    #[test]
    fn a_message_expires_after_its_time_to_live() {
        let start = OffsetDateTime::from_unix_timestamp(1_555_607_910).expect("a time");
        let mut message = envelope("{}");
        assert!(!message.is_expired(start));
        message.creation_time = Some(start);
        message.ttl = Some(Duration::from_secs(60));
        assert!(!message.is_expired(start + Duration::from_secs(59)));
        assert!(message.is_expired(start + Duration::from_secs(60)));
    }
}

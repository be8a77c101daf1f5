//! Secure channels as a client with a certificate of its own asks for them, also by policies that no library still
//! offers (OPC 10000-6, 6.7.2).

use std::{path::Path, time::Duration};

use anyhow::Context as _;
use base64::{Engine as _, engine::general_purpose::STANDARD as BASE64};
use opcua_stack::{
    limits,
    opcua::{
        client::{ClientBuilder, IdentityToken},
        crypto::{KeySize as _, PrivateKey, SecurityPolicy, X509, X509Data},
        types::{EndpointDescription, MessageSecurityMode},
    },
};
use testkit::opcua::{NO_HEADER, framed};
use tokio::time::timeout;

use crate::world::{ENGINEER, PASSWORD};

/// Time in which the server has to answer.
const PATIENCE: Duration = Duration::from_secs(20);
const NONCE: [u8; 32] = [7; 32];

/// A client with key and certificate.
pub(in crate::probes) struct Client {
    key: PrivateKey,
    pub certificate: X509,
}

impl Client {
    /// Draws a key, and makes a certificate that it signs itself.
    pub fn named(name: &str) -> anyhow::Result<Self> {
        let key = PrivateKey::new(2048).context("drawing a key")?;
        Self::with_key(key, name)
    }

    /// Makes a client with the same key and a certificate of its own.
    pub fn another(&self, name: &str) -> anyhow::Result<Self> {
        Self::with_key(self.key.clone(), name)
    }

    fn with_key(key: PrivateKey, name: &str) -> anyhow::Result<Self> {
        let data = X509Data { common_name: name.to_owned(), ..X509Data::sample_cert() };
        let certificate = X509::from_pkey(&key, &data).map_err(anyhow::Error::msg)?;
        Ok(Self { key, certificate })
    }

    /// Returns the certificate as the connector's pages take it.
    pub fn der(&self) -> anyhow::Result<Vec<u8>> {
        self.certificate.to_der().map_err(|error| anyhow::anyhow!("{error}"))
    }

    /// Asks for a session as the engineer. Returns whether it got one.
    pub async fn has_session(&self, folder: &Path, url: &str) -> anyhow::Result<bool> {
        self.signs_in(folder, url, (ENGINEER, PASSWORD)).await
    }

    /// Asks for a session with a client of the library, as a user with a password. Returns whether it got one.
    pub async fn signs_in(
        &self,
        folder: &Path,
        url: &str,
        (user, password): (&str, &str),
    ) -> anyhow::Result<bool> {
        self.write_to(folder)?;
        let builder = ClientBuilder::new()
            .application_name("Probe")
            .application_uri("urn:OPCUADemo")
            .pki_dir(folder)
            .certificate_path("own/cert.der")
            .private_key_path("private/private.pem")
            .trust_server_certs(true)
            .session_retry_limit(0);
        let mut client = limits::raise_client(builder)
            .client()
            .map_err(|faults| anyhow::anyhow!(faults.join(", ")))?;
        let offered = client.get_server_endpoints_from_url(url).await?;
        let is_wanted = |endpoint: &EndpointDescription| {
            endpoint.security_mode == MessageSecurityMode::SignAndEncrypt
                && endpoint.security_policy_uri.as_ref() == SecurityPolicy::Basic256Sha256.to_uri()
        };
        let mut endpoint =
            offered.into_iter().find(is_wanted).context("no endpoint that encrypts")?;
        // The way may lead through a relay.
        endpoint.endpoint_url = url.into();
        let user = IdentityToken::new_user_name(user, password);
        let (session, event_loop) = client.connect_to_endpoint_directly(endpoint, user)?;
        let mut events = event_loop.spawn();
        // A client that is refused ends, and no session is ever connected.
        let outcome = async {
            tokio::select! {
                has_session = session.wait_for_connection() => has_session,
                _ = &mut events => false,
            }
        };
        let has_session = timeout(PATIENCE, outcome).await.context("no answer to a client")?;
        if has_session {
            session.disconnect().await?;
        }
        events.abort();
        Ok(has_session)
    }

    /// Writes key and certificate as the library reads them.
    fn write_to(&self, folder: &Path) -> anyhow::Result<()> {
        let file = folder.join("private/private.pem");
        if file.exists() && std::fs::read(folder.join("own/cert.der"))? == self.der()? {
            return Ok(());
        }
        let key = self.key.to_der().map_err(|error| anyhow::anyhow!("{error}"))?;
        let key = BASE64.encode(key.as_bytes());
        // A file of this form has lines of 64 characters (RFC 7468).
        let lines: Vec<&[u8]> = key.as_bytes().chunks(64).collect();
        let key = String::from_utf8(lines.join(&b"\n"[..]))?;
        for (file, content) in [
            (folder.join("own/cert.der"), self.der()?),
            (
                file,
                format!("-----BEGIN PRIVATE KEY-----\n{key}\n-----END PRIVATE KEY-----\n").into(),
            ),
        ] {
            std::fs::create_dir_all(file.parent().context("a folder")?)?;
            std::fs::write(file, content)?;
        }
        Ok(())
    }

    /// Returns a request for a channel, signed and encrypted by a policy for the server's key. The message says `uri`
    /// for the policy.
    pub fn opening(
        &self,
        policy: SecurityPolicy,
        uri: &str,
        server: &X509,
    ) -> anyhow::Result<Vec<u8>> {
        self.encrypted(policy, uri, server, true)
    }

    /// Returns the same with a signature that is none.
    pub fn forged(
        &self,
        policy: SecurityPolicy,
        uri: &str,
        server: &X509,
    ) -> anyhow::Result<Vec<u8>> {
        self.encrypted(policy, uri, server, false)
    }

    fn encrypted(
        &self,
        policy: SecurityPolicy,
        uri: &str,
        server: &X509,
        is_signed: bool,
    ) -> anyhow::Result<Vec<u8>> {
        let receiver = server.public_key().context("the server's key")?;
        let mut head = 0_u32.to_le_bytes().to_vec();
        for part in [uri.as_bytes(), &self.der()?, server.thumbprint().value()] {
            head.extend(u32::try_from(part.len())?.to_le_bytes());
            head.extend(part);
        }
        let mut plain = request(&NONCE[..policy.secure_channel_nonce_length()]);
        let (block, signed) =
            (policy.asymmetric_padding_info(&receiver).block_size, self.key.size());
        let rest = (plain.len() + 1 + signed) % block;
        let padding = u8::try_from((block - rest) % block)?;
        plain.extend(std::iter::repeat_n(padding, usize::from(padding) + 1));
        let size = (plain.len() + signed) / block * receiver.size();
        let mut message = framed(b"OPNF", &[&head[..], &vec![0; size]].concat());
        message.truncate(8 + head.len());
        let mut signature = vec![0; signed];
        if is_signed {
            let text = [&message[..], &plain].concat();
            policy.asymmetric_sign(&self.key, &text, &mut signature).context("signing")?;
        }
        let mut cipher = vec![0; size + receiver.size()];
        let written = policy
            .asymmetric_encrypt(&receiver, &[plain, signature].concat(), &mut cipher)
            .context("encrypting")?;
        anyhow::ensure!(written == size, "{written} bytes are encrypted, {size} were meant");
        Ok([&message[..], &cipher[..size]].concat())
    }
}

/// Returns sequence header and body of a request for a signed and encrypted channel.
fn request(nonce: &[u8]) -> Vec<u8> {
    let mut body = Vec::new();
    // Sequence number, request id, then OpenSecureChannelRequest_Encoding_DefaultBinary.
    body.extend(1_u32.to_le_bytes());
    body.extend(1_u32.to_le_bytes());
    body.extend([1, 0, 0xBE, 0x01]);
    // Null token, time, handle, diagnostics, null audit id, timeout, no additional header.
    body.extend([0, 0]);
    body.extend(0_i64.to_le_bytes());
    body.extend(1_u32.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend((-1_i32).to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend(NO_HEADER);
    // Version, issue, sign and encrypt, nonce, an hour.
    body.extend(0_u32.to_le_bytes());
    body.extend(0_u32.to_le_bytes());
    body.extend(3_u32.to_le_bytes());
    body.extend(u32::try_from(nonce.len()).expect("few bytes").to_le_bytes());
    body.extend(nonce);
    body.extend(3_600_000_u32.to_le_bytes());
    body
}

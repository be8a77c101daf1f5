//! Pins of certificates: the hash of the one that a client has to be shown, brought to it by another way
//! than the connection.

use std::{fmt, str::FromStr, sync::Arc};

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use rustls::{
    CertificateError, ClientConfig, DigitallySignedStruct, RootCertStore, SignatureScheme,
    client::{
        WebPkiServerVerifier,
        danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier},
    },
    crypto::{CryptoProvider, verify_tls12_signature, verify_tls13_signature},
    pki_types::{CertificateDer, ServerName, UnixTime, pem::PemObject as _},
};
use sha2::{Digest as _, Sha256};

/// SHA-256 of a certificate (DER): the server's own, or that of an authority which it sends along.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct CertificatePin([u8; 32]);

/// A text that is no pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a pin is the SHA-256 of a certificate as unpadded base64url")]
pub struct InvalidPin;

impl CertificatePin {
    /// Returns the pin of a certificate.
    #[must_use]
    pub fn of(certificate: &CertificateDer<'_>) -> Self {
        Self(Sha256::digest(certificate).into())
    }

    /// Returns the pin of the first certificate of a PEM file.
    ///
    /// # Errors
    /// Those of the file, or of one without a certificate.
    pub fn of_pem_file(path: &std::path::Path) -> Result<Self, rustls::pki_types::pem::Error> {
        CertificateDer::from_pem_file(path).map(|certificate| Self::of(&certificate))
    }

    /// Returns a TLS configuration that accepts a server with the pinned certificate, or with one that the
    /// pinned authority made for the server's name, and no other.
    ///
    /// # Errors
    /// [`rustls::Error`] of a provider that lacks what TLS needs.
    pub fn client_config(self) -> Result<ClientConfig, rustls::Error> {
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let verifier = PinVerifier { pin: self, provider: Arc::clone(&provider) };
        let config = ClientConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()?
            .dangerous()
            .with_custom_certificate_verifier(Arc::new(verifier))
            .with_no_client_auth();
        Ok(config)
    }
}

impl fmt::Display for CertificatePin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&URL_SAFE_NO_PAD.encode(self.0))
    }
}

impl fmt::Debug for CertificatePin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "CertificatePin({self})")
    }
}

impl FromStr for CertificatePin {
    type Err = InvalidPin;

    fn from_str(text: &str) -> Result<Self, InvalidPin> {
        let bytes = URL_SAFE_NO_PAD.decode(text).map_err(|_| InvalidPin)?;
        bytes.try_into().map(Self).map_err(|_| InvalidPin)
    }
}

/// Accepts what a pin vouches for. The pin came by a way of its own, so that no authority of the system
/// has a say; that the server has the key of its certificate is checked as ever.
#[derive(Debug)]
struct PinVerifier {
    pin: CertificatePin,
    provider: Arc<CryptoProvider>,
}

impl ServerCertVerifier for PinVerifier {
    fn verify_server_cert(
        &self,
        end_entity: &CertificateDer<'_>,
        intermediates: &[CertificateDer<'_>],
        server_name: &ServerName<'_>,
        ocsp_response: &[u8],
        now: UnixTime,
    ) -> Result<ServerCertVerified, rustls::Error> {
        if CertificatePin::of(end_entity) == self.pin {
            return Ok(ServerCertVerified::assertion());
        }
        let authority = intermediates.iter().find(|sent| CertificatePin::of(sent) == self.pin);
        // A sentence of its own for the common case: the certificate was changed since.
        let authority = authority.ok_or(rustls::Error::InvalidCertificate(
            CertificateError::ApplicationVerificationFailure,
        ))?;
        let mut roots = RootCertStore::empty();
        roots.add(authority.clone().into_owned())?;
        let by_authority = WebPkiServerVerifier::builder_with_provider(
            Arc::new(roots),
            Arc::clone(&self.provider),
        )
        .build()
        .map_err(|error| rustls::Error::General(error.to_string()))?;
        by_authority.verify_server_cert(end_entity, intermediates, server_name, ocsp_response, now)
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        let algorithms = &self.provider.signature_verification_algorithms;
        verify_tls12_signature(message, certificate, signature, algorithms)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        let algorithms = &self.provider.signature_verification_algorithms;
        verify_tls13_signature(message, certificate, signature, algorithms)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.provider.signature_verification_algorithms.supported_schemes()
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use rcgen::{BasicConstraints, CertificateParams, CertifiedIssuer, IsCa, KeyPair};

    use super::*;

    fn authority() -> CertifiedIssuer<'static, KeyPair> {
        let mut params = CertificateParams::new(Vec::new()).expect("no names");
        params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        CertifiedIssuer::self_signed(params, KeyPair::generate().expect("a key")).expect("signed")
    }

    fn issued(by: &CertifiedIssuer<'static, KeyPair>, name: &str) -> CertificateDer<'static> {
        let key = KeyPair::generate().expect("a key");
        let params = CertificateParams::new(vec![name.to_owned()]).expect("a name");
        params.signed_by(&key, by).expect("signed").der().clone()
    }

    fn is_accepted(pin: CertificatePin, chain: &[CertificateDer<'_>], name: &str) -> bool {
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let name = ServerName::try_from(name.to_owned()).expect("a name");
        // 2030-01-01, within the validity that rcgen gives.
        let now = UnixTime::since_unix_epoch(Duration::from_secs(1_893_456_000));
        PinVerifier { pin, provider }
            .verify_server_cert(&chain[0], &chain[1..], &name, &[], now)
            .is_ok()
    }

    #[test]
    fn the_pinned_certificate_is_accepted_and_no_other() {
        let (first, second) = (authority(), authority());
        let own = issued(&first, "verbund.example");
        let pin = CertificatePin::of(&own);
        assert!(is_accepted(pin, std::slice::from_ref(&own), "verbund.example"));
        assert!(
            is_accepted(pin, std::slice::from_ref(&own), "10.0.0.7"),
            "the pin says who it is, not the name"
        );
        let other = issued(&first, "verbund.example");
        assert!(!is_accepted(pin, std::slice::from_ref(&other), "verbund.example"));
        assert!(!is_accepted(pin, &[other, own], "verbund.example"), "sent along proves nothing");
        let strange = issued(&second, "verbund.example");
        assert!(!is_accepted(pin, &[strange, second.der().clone()], "verbund.example"));
    }

    #[test]
    fn a_pinned_authority_vouches_for_the_name_that_is_called() {
        let (first, second) = (authority(), authority());
        let pin = CertificatePin::of(first.der());
        let own = issued(&first, "verbund.example");
        let chain = [own, first.der().clone()];
        assert!(is_accepted(pin, &chain, "verbund.example"));
        assert!(!is_accepted(pin, &chain, "other.example"));
        let strange = issued(&second, "verbund.example");
        assert!(!is_accepted(pin, &[strange, first.der().clone()], "verbund.example"));
    }

    #[test]
    fn a_pin_survives_its_text() {
        let pin = CertificatePin::of(authority().der());
        assert_eq!(pin.to_string().parse(), Ok(pin));
        assert!(!pin.to_string().contains('.'), "a part of a token");
        assert_eq!("AAAA".parse::<CertificatePin>(), Err(InvalidPin));
    }
}

//! TLS configuration for rustls: trusted roots and the client's identity.

use std::sync::Arc;

use rustls::{ClientConfig, RootCertStore};
use rustls_pki_types::{CertificateDer, PrivateKeyDer, ServerName, pem::PemObject};

use crate::config::{LinkError, Roots, TlsConfig};

/// Builds the client side of TLS from the settings.
pub(super) fn client_config(config: &TlsConfig) -> Result<Arc<ClientConfig>, LinkError> {
    let failed = |reason: String| LinkError::Tls { reason };
    let builder =
        ClientConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
            .with_safe_default_protocol_versions()
            .map_err(|e| failed(e.to_string()))?
            .with_root_certificates(roots(&config.roots)?);
    let client = match &config.identity {
        None => builder.with_no_client_auth(),
        Some(identity) => {
            let chain: Vec<_> = CertificateDer::pem_slice_iter(&identity.certificates_pem)
                .collect::<Result<_, _>>()
                .map_err(|e| failed(format!("the client certificate is not PEM: {e}")))?;
            let key = PrivateKeyDer::from_pem_slice(&identity.key_pem)
                .map_err(|e| failed(format!("the client certificate's key is not PEM: {e}")))?;
            builder.with_client_auth_cert(chain, key).map_err(|e| failed(e.to_string()))?
        }
    };
    Ok(Arc::new(client))
}

fn roots(roots: &Roots) -> Result<RootCertStore, LinkError> {
    let failed = |reason: String| LinkError::Tls { reason };
    let mut store = RootCertStore::empty();
    match roots {
        Roots::System => {
            let found = rustls_native_certs::load_native_certs();
            store.add_parsable_certificates(found.certs);
            if store.is_empty() {
                return Err(failed(
                    "the system has no root certificates; install its ca-certificates or configure roots".to_owned(),
                ));
            }
        }
        Roots::Pem(pem) => {
            for certificate in CertificateDer::pem_slice_iter(pem) {
                let certificate = certificate
                    .map_err(|e| failed(format!("the configured roots are not PEM: {e}")))?;
                store
                    .add(certificate)
                    .map_err(|e| failed(format!("a configured root cannot be used: {e}")))?;
            }
            if store.is_empty() {
                return Err(failed("the configured roots contain no certificate".to_owned()));
            }
        }
    }
    Ok(store)
}

/// Returns the name to expect in the broker's certificate.
pub(super) fn server_name(config: &TlsConfig, host: &str) -> Result<ServerName<'static>, String> {
    let name = config.server_name.as_deref().unwrap_or(host);
    ServerName::try_from(name.to_owned())
        .map_err(|_| format!("{name:?} cannot be the name of a TLS server"))
}

//! Registration with a local discovery server (OPC 10000-4 §5.5.5, §5.5.6): repeated, because servers
//! drop registrations that are not renewed, and withdrawn at the end.

use std::{path::PathBuf, sync::Arc, time::Duration};

use opcua_stack::opcua::{
    client::{
        AsyncSecureChannel, Client, ClientBuilder, IdentityToken,
        transport::{ConnectorBuilder, TransportPollResult},
    },
    core::{RequestMessage, ResponseMessage},
    crypto::{SecurityPolicy, X509},
    server::{CertificateBearer, CertificateValidator},
    types::{
        EndpointDescription, Error, MessageSecurityMode, NodeId, RegisterServer2Request,
        RegisterServerRequest, RegisteredServer, RequestHeader, StatusCode,
    },
};
use rand::Rng;
use tokio_util::sync::CancellationToken;

use crate::{
    clock,
    security::{certificate, validation::Validator},
};

/// Time limit of an attempt: two connections, a key exchange and a request.
const ATTEMPT_TIMEOUT: Duration = Duration::from_secs(20);
/// Time limit of the withdrawal. The shutdown waits for it; a registration that is not renewed
/// expires by itself.
const WITHDRAWAL_TIMEOUT: Duration = Duration::from_secs(3);
/// Time limit of the discovery server to close a connection.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(1);
/// Time limit of a request.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(10);
/// First pause after a failure; doubles with each further one up to the interval.
const RETRY_FIRST: Duration = Duration::from_secs(5);

/// Cause for which the twin is not registered.
#[derive(Debug, thiserror::Error)]
enum RegistrationError {
    #[error("it cannot be reached or answers wrongly")]
    Connection(#[source] Error),
    #[error("it offers no endpoint with encryption or signatures, which registering needs")]
    NoSecureEndpoint,
    #[error("its certificate is not trusted; approve it in the list of certificates")]
    Untrusted,
    #[error("it refused with {0}; its own trust list may lack the twin's certificate")]
    Refused(StatusCode),
    #[error("it did not answer in time")]
    Timeout,
}

impl From<Error> for RegistrationError {
    fn from(error: Error) -> Self {
        Self::Connection(error)
    }
}

/// A registration with a discovery server.
pub(super) struct Registration {
    pub url: String,
    pub interval: Duration,
    pub pki_directory: PathBuf,
    pub validator: Arc<Validator>,
    pub server: RegisteredServer,
}

impl Registration {
    /// Registers at each interval until `shutdown`, then withdraws the registration.
    pub async fn run(self, shutdown: &CancellationToken) {
        let (mut failures, mut is_registered) = (0, false);
        loop {
            let attempt = tokio::select! {
                attempt = self.register_within(ATTEMPT_TIMEOUT, true) => attempt,
                () = shutdown.cancelled() => break,
            };
            let pause = match attempt {
                Ok(()) => {
                    if !is_registered || failures > 0 {
                        tracing::info!(discovery.url = %self.url, "The twin is registered with the discovery server.");
                    }
                    (failures, is_registered) = (0, true);
                    self.interval
                }
                Err(error) => {
                    failures += 1;
                    if failures == 1 {
                        self.warn_of(&error);
                    }
                    retry_after(failures, self.interval).mul_f64(rand::rng().random_range(0.8..1.2))
                }
            };
            metrics::gauge!("twin_is_registered").set(if failures == 0 { 1.0 } else { 0.0 });
            tokio::select! {
                () = tokio::time::sleep(pause) => {}
                () = shutdown.cancelled() => break,
            }
        }
        // Also after a failure: an earlier registration may still exist.
        if is_registered && let Err(error) = self.register_within(WITHDRAWAL_TIMEOUT, false).await {
            tracing::warn!(
                error = &error as &dyn std::error::Error,
                discovery.url = %self.url,
                "The twin could not withdraw its registration from the discovery server. It expires by itself."
            );
        }
    }

    fn warn_of(&self, error: &RegistrationError) {
        tracing::warn!(
            error = error as &dyn std::error::Error,
            discovery.url = %self.url,
            "The twin is not registered with the discovery server; it tries again."
        );
    }

    async fn register_within(
        &self,
        limit: Duration,
        is_online: bool,
    ) -> Result<(), RegistrationError> {
        tokio::time::timeout(limit, self.register(is_online))
            .await
            .unwrap_or(Err(RegistrationError::Timeout))
    }

    /// Calls RegisterServer2, or RegisterServer if the discovery server is too old for it.
    async fn register(&self, is_online: bool) -> Result<(), RegistrationError> {
        let mut client = self.client()?;
        let endpoint = strongest(client.get_server_endpoints_from_url(self.url.as_str()).await?)
            .ok_or(RegistrationError::NoSecureEndpoint)?;
        self.check_certificate(&endpoint)?;
        let server = RegisteredServer { is_online, ..self.server.clone() };
        let (session, _) =
            client.connect_to_endpoint_directly(endpoint, IdentityToken::Anonymous)?;
        let channel = session.channel();
        let header = || RequestHeader {
            timeout_hint: u32::try_from(REQUEST_TIMEOUT.as_millis()).unwrap_or(u32::MAX),
            ..RequestHeader::new(&NodeId::null(), &clock::stack_now(), channel.request_handle())
        };
        // The twin announces itself by multicast if that is configured, so the server need not.
        let newer = RegisterServer2Request {
            request_header: header(),
            server: server.clone(),
            discovery_configuration: None,
        };
        match self.exchange(channel, newer.into()).await? {
            StatusCode::BadServiceUnsupported | StatusCode::BadNotImplemented => {}
            status if status.is_good() => return Ok(()),
            status => return Err(RegistrationError::Refused(status)),
        }
        let older = RegisterServerRequest { request_header: header(), server };
        match self.exchange(channel, older.into()).await? {
            status if status.is_good() => Ok(()),
            status => Err(RegistrationError::Refused(status)),
        }
    }

    /// Creates a client with the twin's own certificate: the discovery server compares certificate
    /// and registered application.
    fn client(&self) -> Result<Client, RegistrationError> {
        ClientBuilder::new()
            .application_name("Verbund Twin")
            .application_uri(self.server.server_uri.to_string())
            .pki_dir(&self.pki_directory)
            .certificate_path(certificate::CERTIFICATE_FILE)
            .private_key_path(certificate::KEY_FILE)
            .session_retry_limit(0)
            .request_timeout(REQUEST_TIMEOUT)
            .client()
            .map_err(|faults| {
                Error::new(StatusCode::BadConfigurationError, faults.join(", ")).into()
            })
    }

    fn check_certificate(&self, endpoint: &EndpointDescription) -> Result<(), RegistrationError> {
        let policy = SecurityPolicy::from_uri(endpoint.security_policy_uri.as_ref());
        let certificate = X509::from_byte_string(&endpoint.server_certificate)?;
        let bearer = CertificateBearer { address: None, application: &endpoint.server };
        self.validator
            .validate(&certificate, policy, &bearer)
            .map_err(|_| RegistrationError::Untrusted)
    }

    /// Opens the channel, sends one request, and closes. Returns the status of the answer.
    async fn exchange(
        &self,
        channel: &AsyncSecureChannel,
        request: RequestMessage,
    ) -> Result<StatusCode, RegistrationError> {
        let connector = self.url.as_str().build()?;
        let mut connection = channel.connect_no_retry(&connector).await?;
        let answer = {
            let answer = channel.send(request, REQUEST_TIMEOUT);
            tokio::pin!(answer);
            loop {
                tokio::select! {
                    answer = &mut answer => break answer?,
                    polled = connection.poll() => if let TransportPollResult::Closed(status) = polled {
                        return Err(Error::new(status, "the connection was closed").into());
                    }
                }
            }
        };
        let close = async {
            channel.close_channel().await;
            while !matches!(connection.poll().await, TransportPollResult::Closed(_)) {}
        };
        // Dropping the connection closes it too.
        let _ = tokio::time::timeout(CLOSE_TIMEOUT, close).await;
        Ok(match answer {
            ResponseMessage::RegisterServer(_)
            | ResponseMessage::RegisterServer2(_)
            | ResponseMessage::ServiceFault(_) => answer.response_header().service_result,
            _ => StatusCode::BadUnknownResponse,
        })
    }
}

/// The endpoint that protects best; registering needs the twin's certificate, so one without
/// security is none.
fn strongest(endpoints: Vec<EndpointDescription>) -> Option<EndpointDescription> {
    let is_usable = |endpoint: &EndpointDescription| {
        let policy = SecurityPolicy::from_uri(endpoint.security_policy_uri.as_ref());
        matches!(
            policy,
            SecurityPolicy::Basic256Sha256
                | SecurityPolicy::Aes128Sha256RsaOaep
                | SecurityPolicy::Aes256Sha256RsaPss
        ) && matches!(
            endpoint.security_mode,
            MessageSecurityMode::Sign | MessageSecurityMode::SignAndEncrypt
        )
    };
    let strength = |endpoint: &EndpointDescription| {
        (endpoint.security_mode == MessageSecurityMode::SignAndEncrypt, endpoint.security_level)
    };
    endpoints.into_iter().filter(is_usable).max_by_key(strength)
}

/// Returns the pause after a number of failures in a row.
fn retry_after(failures: u32, interval: Duration) -> Duration {
    RETRY_FIRST.saturating_mul(1 << failures.saturating_sub(1).min(16)).min(interval)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_double_up_to_the_interval() {
        let interval = Duration::from_secs(60);
        let pauses: Vec<u64> =
            (1..=6).map(|failures| retry_after(failures, interval).as_secs()).collect();
        assert_eq!(pauses, [5, 10, 20, 40, 60, 60]);
        assert_eq!(retry_after(u32::MAX, interval), interval);
    }

    #[test]
    fn the_strongest_endpoint_is_chosen_and_none_without_security() {
        let endpoint =
            |policy: SecurityPolicy, security_mode, security_level| EndpointDescription {
                security_policy_uri: policy.to_uri().into(),
                security_mode,
                security_level,
                ..EndpointDescription::default()
            };
        let none = endpoint(SecurityPolicy::None, MessageSecurityMode::None, 200);
        let old = endpoint(SecurityPolicy::Basic256, MessageSecurityMode::SignAndEncrypt, 150);
        let signed = endpoint(SecurityPolicy::Basic256Sha256, MessageSecurityMode::Sign, 100);
        let encrypted =
            endpoint(SecurityPolicy::Basic256Sha256, MessageSecurityMode::SignAndEncrypt, 50);
        assert_eq!(strongest(vec![none.clone(), old.clone()]), None);
        assert_eq!(strongest(vec![none, old, encrypted.clone(), signed]), Some(encrypted));
    }
}

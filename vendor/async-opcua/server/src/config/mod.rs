mod capabilities;
mod endpoint;
mod limits;
mod server;

pub use capabilities::{HistoryServerCapabilities, ServerCapabilities, ServiceCapabilities};
pub use endpoint::{EndpointIdentifier, ServerEndpoint};
pub use limits::{ClientLimits, Limits, OperationalLimits, SubscriptionLimits};
pub use server::{CertificateValidation, TcpConfig};
pub use server::{ServerConfig, ServerUserToken, ANONYMOUS_USER_TOKEN_ID};

//! AMQP 1.0 over fe2o3-amqp. Nothing of that library leaves this module.
//!
//! Its peculiarities, and the answer of this module to each: outcomes in flight hang when a
//! connection dies, until the sender is dropped (senders are dropped with the connection); an
//! attach error at some brokers ends the whole session (one session per link); buffers are large by
//! default (they are set); and it has no reconnection (the supervisor reconnects).

mod codec;
mod error;
mod receiver;
mod sender;
mod terminus;

use async_trait::async_trait;
use fe2o3_amqp::{
    Session,
    connection::{Connection as AmqpConnection, ConnectionHandle},
    sasl_profile::SaslProfile,
    session::SessionHandle,
};
use tokio::{
    sync::{mpsc, oneshot, watch},
    time::timeout,
};

use super::{
    connection::{
        Connection, ConnectionFault, EndpointFault, MessageReceiver, MessageSender, Transport,
    },
    dial::{Dialler, Stream},
};
use crate::{
    config::{BrokerUrl, LinkConfig, LinkLimits, Login},
    profile::Terminus,
};
use error::{end_fault, open_fault};
use receiver::AmqpReceiver;
use sender::AmqpSender;

/// Frames are cut to this size, so that one large message does not block the others.
const FRAME_BYTES_MAX: u32 = 64 * 1024;
/// Frames that may wait between the tasks of a connection.
const FRAMES_BUFFERED: usize = 256;
/// Most sessions that wait to be opened.
const OPENINGS_MAX: usize = 64;
/// Time limit of a close.
const CLOSE_TIMEOUT: std::time::Duration = std::time::Duration::from_secs(2);

/// Connects to AMQP 1.0 brokers.
pub(crate) struct AmqpTransport {
    dialler: Dialler,
    login: watch::Receiver<Login>,
    container_id: String,
    limits: LinkLimits,
}

impl AmqpTransport {
    pub(super) fn new(
        config: &LinkConfig,
        login: watch::Receiver<Login>,
        dialler: Dialler,
    ) -> Self {
        Self { dialler, login, container_id: config.container_id.clone(), limits: config.limits }
    }

    async fn open(
        &self,
        broker: &BrokerUrl,
        stream: Box<dyn Stream>,
    ) -> Result<ConnectionHandle<()>, ConnectionFault> {
        let idle_ms = u32::try_from(self.limits.idle_timeout.as_millis()).unwrap_or(u32::MAX);
        let Login { user_name, password } = self.login.borrow().clone();
        AmqpConnection::builder()
            .container_id(self.container_id.as_str())
            .hostname(broker.host())
            .max_frame_size(FRAME_BYTES_MAX)
            .idle_time_out(idle_ms)
            .buffer_size(FRAMES_BUFFERED)
            .sasl_profile(SaslProfile::Plain {
                username: user_name,
                password: password.to_string(),
            })
            .open_with_stream(stream)
            .await
            .map_err(open_fault)
    }
}

#[async_trait]
impl Transport for AmqpTransport {
    async fn connect(&self, broker: &BrokerUrl) -> Result<Box<dyn Connection>, ConnectionFault> {
        let connecting = async {
            let stream = self.dialler.dial(broker).await?;
            self.open(broker, stream).await
        };
        let handle = timeout(self.limits.connect_timeout, connecting).await.map_err(|_| {
            ConnectionFault::transient(format!("{broker} did not answer in time"))
        })??;
        let (openings, requests) = mpsc::channel(OPENINGS_MAX);
        let (lost, loss) = watch::channel(None);
        let (close, closing) = watch::channel(false);
        tokio::spawn(drive(handle, requests, closing, lost));
        Ok(Box::new(OpenConnection { openings, loss, close, limits: self.limits }))
    }
}

type Opening = oneshot::Sender<Result<SessionHandle<()>, EndpointFault>>;

/// A connection. A task of its own owns the library's handle, because opening sessions needs it
/// exclusively.
struct OpenConnection {
    openings: mpsc::Sender<Opening>,
    loss: watch::Receiver<Option<ConnectionFault>>,
    close: watch::Sender<bool>,
    limits: LinkLimits,
}

impl OpenConnection {
    async fn session(&self) -> Result<SessionHandle<()>, EndpointFault> {
        let broken = || EndpointFault::Broken("the connection is lost".to_owned());
        let (reply, answer) = oneshot::channel();
        self.openings.send(reply).await.map_err(|_| broken())?;
        timeout(self.limits.connect_timeout, answer)
            .await
            .map_err(|_| {
                EndpointFault::Stalled("the broker did not begin a session in time".to_owned())
            })?
            .map_err(|_| broken())?
    }
}

#[async_trait]
impl Connection for OpenConnection {
    async fn sender(&self, terminus: &Terminus) -> Result<Box<dyn MessageSender>, EndpointFault> {
        let session = self.session().await?;
        Ok(Box::new(AmqpSender::attach(session, terminus, &self.limits).await?))
    }

    async fn receiver(
        &self,
        terminus: &Terminus,
    ) -> Result<Box<dyn MessageReceiver>, EndpointFault> {
        let session = self.session().await?;
        Ok(Box::new(AmqpReceiver::attach(session, terminus, &self.limits).await?))
    }

    async fn lost(&self) -> ConnectionFault {
        let mut loss = self.loss.clone();
        let lost = loss.wait_for(Option::is_some).await;
        lost.ok()
            .and_then(|fault| fault.clone())
            .unwrap_or_else(|| ConnectionFault::transient("the connection ended"))
    }

    async fn close(&self) {
        self.close.send_replace(true);
        // Twice, since the task that drives the connection waits once for the peer's close.
        let _ = timeout(CLOSE_TIMEOUT * 2, self.lost()).await;
    }
}

/// Opens sessions and watches the connection until it is lost or closed.
async fn drive(
    mut handle: ConnectionHandle<()>,
    mut requests: mpsc::Receiver<Opening>,
    mut closing: watch::Receiver<bool>,
    lost: watch::Sender<Option<ConnectionFault>>,
) {
    let fault = loop {
        tokio::select! {
            ended = handle.on_close() => break end_fault(ended),
            // Resolves also when the connection is dropped.
            _ = closing.changed() => {
                // Some brokers answer a close in a way that the library calls an error. The
                // connection is closed either way.
                let _ = timeout(CLOSE_TIMEOUT, handle.close()).await;
                break ConnectionFault::transient("closed by this side");
            }
            Some(reply) = requests.recv() => {
                let session = Session::builder().buffer_size(FRAMES_BUFFERED).begin(&mut handle).await;
                let session = session.map_err(|e| EndpointFault::Broken(format!("the broker refused a session: {e}")));
                // A caller that has given up drops the session, which ends it.
                let _ = reply.send(session);
            }
        }
    };
    lost.send_replace(Some(fault));
}

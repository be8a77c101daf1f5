//! AMQP 1.0 over fe2o3-amqp. Nothing of that library leaves this module.
//!
//! What its users must know, and what is done about it here: in-flight outcomes hang when a
//! connection dies, until the sender is dropped (lanes drop theirs with the connection); an attach
//! error at some brokers ends the whole session (one session per lane); buffers are generous by
//! default (set); and it has no reconnection (ours is the supervisor).

mod codec;
mod error;
mod lanes;

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
    connection::{Connection, ConnectionFault, Incoming, LaneFault, Outgoing, Transport},
    dial::{Dialler, Stream},
};
use crate::{
    config::{BrokerUrl, LinkConfig, LinkLimits, Login},
    profile::Terminus,
};
use error::{end_fault, open_fault};

/// Frames are cut to this size, so that one large message does not block the others.
const FRAME_BYTES_MAX: u32 = 64 * 1024;
/// Frames that may wait between the tasks of a connection.
const FRAMES_BUFFERED: usize = 256;
/// Lanes that may wait to be opened.
const OPENINGS_MAX: usize = 64;
/// How long a close may take.
const CLOSE_TIMEOUT: std::time::Duration = std::time::Duration::from_secs(2);

/// Connects to AMQP 1.0 brokers.
pub(crate) struct AmqpTransport {
    dialler: Dialler,
    login: Login,
    container_id: String,
    limits: LinkLimits,
}

impl AmqpTransport {
    pub(super) fn new(config: &LinkConfig, dialler: Dialler) -> Self {
        Self {
            dialler,
            login: config.login.clone(),
            container_id: config.container_id.clone(),
            limits: config.limits,
        }
    }

    async fn open(
        &self,
        broker: &BrokerUrl,
        stream: Box<dyn Stream>,
    ) -> Result<ConnectionHandle<()>, ConnectionFault> {
        let idle_ms = u32::try_from(self.limits.idle_timeout.as_millis()).unwrap_or(u32::MAX);
        AmqpConnection::builder()
            .container_id(self.container_id.as_str())
            .hostname(broker.host())
            .max_frame_size(FRAME_BYTES_MAX)
            .idle_time_out(idle_ms)
            .buffer_size(FRAMES_BUFFERED)
            .sasl_profile(SaslProfile::Plain {
                username: self.login.user_name.clone(),
                password: self.login.password.to_string(),
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
        let handle = timeout(self.limits.connect_timeout, connecting)
            .await
            .map_err(|_| ConnectionFault::passing(format!("{broker} did not answer in time")))??;
        let (openings, requests) = mpsc::channel(OPENINGS_MAX);
        let (lost, loss) = watch::channel(None);
        let (close, closing) = watch::channel(false);
        tokio::spawn(keep(handle, requests, closing, lost));
        Ok(Box::new(Opened { openings, loss, close, limits: self.limits }))
    }
}

type Opening = oneshot::Sender<Result<SessionHandle<()>, LaneFault>>;

/// A connection whose handle is kept by a task of its own, because opening sessions needs it
/// exclusively.
struct Opened {
    openings: mpsc::Sender<Opening>,
    loss: watch::Receiver<Option<ConnectionFault>>,
    close: watch::Sender<bool>,
    limits: LinkLimits,
}

impl Opened {
    async fn session(&self) -> Result<SessionHandle<()>, LaneFault> {
        let broken = || LaneFault::Broken("the connection is lost".to_owned());
        let (reply, answer) = oneshot::channel();
        self.openings.send(reply).await.map_err(|_| broken())?;
        timeout(self.limits.connect_timeout, answer)
            .await
            .map_err(|_| {
                LaneFault::Stalled("the broker did not begin a session in time".to_owned())
            })?
            .map_err(|_| broken())?
    }
}

#[async_trait]
impl Connection for Opened {
    async fn outgoing(&self, terminus: &Terminus) -> Result<Box<dyn Outgoing>, LaneFault> {
        let session = self.session().await?;
        Ok(Box::new(lanes::AmqpOutgoing::attach(session, terminus, &self.limits).await?))
    }

    async fn incoming(&self, terminus: &Terminus) -> Result<Box<dyn Incoming>, LaneFault> {
        let session = self.session().await?;
        Ok(Box::new(lanes::AmqpIncoming::attach(session, terminus, &self.limits).await?))
    }

    async fn lost(&self) -> ConnectionFault {
        let mut loss = self.loss.clone();
        let lost = loss.wait_for(Option::is_some).await;
        lost.ok()
            .and_then(|fault| fault.clone())
            .unwrap_or_else(|| ConnectionFault::passing("the connection ended"))
    }

    async fn close(&self) {
        self.close.send_replace(true);
        let _ = timeout(CLOSE_TIMEOUT * 2, self.lost()).await;
    }
}

/// Begins sessions and watches the connection until it is lost or closed.
async fn keep(
    mut handle: ConnectionHandle<()>,
    mut requests: mpsc::Receiver<Opening>,
    mut closing: watch::Receiver<bool>,
    lost: watch::Sender<Option<ConnectionFault>>,
) {
    let fault = loop {
        tokio::select! {
            ended = handle.on_close() => break end_fault(ended),
            // Also when nobody has the connection any more.
            _ = closing.changed() => {
                // Some brokers answer a close in a way the library calls an error; either way it is
                // over.
                let _ = timeout(CLOSE_TIMEOUT, handle.close()).await;
                break ConnectionFault::passing("closed by this side");
            }
            Some(reply) = requests.recv() => {
                let session = Session::builder().buffer_size(FRAMES_BUFFERED).begin(&mut handle).await;
                let session = session.map_err(|e| LaneFault::Broken(format!("the broker refused a session: {e}")));
                // A caller that has given up drops the session, which ends it.
                let _ = reply.send(session);
            }
        }
    };
    lost.send_replace(Some(fault));
}

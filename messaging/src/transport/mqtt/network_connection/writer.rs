//! The writing half of a connection.

use std::{sync::Arc, time::Duration};

use futures::{SinkExt, stream::SplitSink};
use rumqttc::v5::mqttbytes::{
    Error,
    v5::{Disconnect, DisconnectReasonCode, Packet, PingReq},
};
use tokio::{sync::mpsc, time::timeout};
use tokio_util::sync::CancellationToken;

use super::pings::Pings;
use crate::transport::{
    connection::ConnectionFault,
    mqtt::{config::CLOSE_TIMEOUT, framing::PacketStream},
};

/// Writes packets and pings until the connection ends.
pub(super) async fn write(
    mut sink: SplitSink<PacketStream, Packet>,
    mut waiting: mpsc::Receiver<Packet>,
    stop: CancellationToken,
    keep_alive: Duration,
    pings: Arc<Pings>,
) -> ConnectionFault {
    // Three answers are due within the time after which the reader gives the broker up.
    let mut ping = tokio::time::interval(keep_alive / 3);
    loop {
        let packet = tokio::select! {
            () = stop.cancelled() => {
                let reason = DisconnectReasonCode::NormalDisconnection;
                let disconnect = Packet::Disconnect(Disconnect::new(reason));
                let _ = timeout(CLOSE_TIMEOUT, sink.send(disconnect)).await;
                return ConnectionFault::transient("closed by this side");
            }
            packet = waiting.recv() => match packet {
                Some(packet) => packet,
                None => return ConnectionFault::transient("closed by this side"),
            },
            _ = ping.tick() => Packet::PingReq(PingReq),
        };
        if let Err(e) = feed(&mut sink, packet, &pings).await {
            return ConnectionFault::transient(format!("the connection was lost: {e:?}"));
        }
        // One system call for all packets that wait by now.
        while let Ok(packet) = waiting.try_recv() {
            if let Err(e) = feed(&mut sink, packet, &pings).await {
                return ConnectionFault::transient(format!("the connection was lost: {e:?}"));
            }
        }
        if let Err(e) = sink.flush().await {
            return ConnectionFault::transient(format!("the connection was lost: {e:?}"));
        }
    }
}

async fn feed(
    sink: &mut SplitSink<PacketStream, Packet>,
    packet: Packet,
    pings: &Pings,
) -> Result<(), Error> {
    if matches!(packet, Packet::PingReq(_)) {
        pings.writes();
    }
    sink.feed(packet).await
}

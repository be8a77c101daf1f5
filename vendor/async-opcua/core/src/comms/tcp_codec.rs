// OPCUA for Rust
// SPDX-License-Identifier: MPL-2.0
// Copyright (C) 2017-2024 Adam Lock

//! The codec is an implementation of a tokio Encoder/Decoder which can be used to read
//! data from the socket in terms of frames which in our case are any of the following:
//!
//! * HEL - Hello message
//! * ACK - Acknowledge message
//! * ERR - Error message
//! * MSG - Message chunk
//! * OPN - Open Secure Channel message
//! * CLO - Close Secure Channel message
use std::io;

use bytes::{BufMut, BytesMut};
use tokio_util::codec::{Decoder, Encoder};
use tracing::error;

use opcua_types::{
    encoding::{DecodingOptions, SimpleBinaryDecodable, SimpleBinaryEncodable},
    status_code::StatusCode,
};

use super::{
    message_chunk::MessageChunk,
    tcp_types::{
        AcknowledgeMessage, ErrorMessage, HelloMessage, MessageHeader, MessageType,
        ReverseHelloMessage, MESSAGE_HEADER_LEN,
    },
};

#[derive(Debug)]
/// Message type sent over OPC-UA streams.
pub enum Message {
    /// Hello message, the first part of a connection negotiation.
    Hello(HelloMessage),
    /// Acknowledge message, acceptance of negotiation.
    Acknowledge(AcknowledgeMessage),
    /// Error message, final fatal message describing reason for
    /// why the channel will be closed.
    Error(ErrorMessage),
    /// Part of a general OPC-UA message.
    Chunk(MessageChunk),
    /// Reverse Hello message, sent by the server to the client.
    ReverseHello(ReverseHelloMessage),
}

/// Implements a tokio codec that as close as possible, allows incoming data to be transformed into
/// OPC UA message chunks with no intermediate buffers. Chunks are subsequently transformed into
/// messages so there is still some buffers within message chunks, but not at the raw socket level.
pub struct TcpCodec {
    decoding_options: DecodingOptions,
    max_chunk_size: usize,
}

/// Largest message chunk in bytes that is read, unless [`TcpCodec::with_max_chunk_size`] says otherwise.
pub const DEFAULT_MAX_CHUNK_SIZE: usize = 65_536;

/// Largest message in bytes of those that negotiate a connection or end it (OPC 10000-6 §7.1.2): `HEL` with an URL of
/// 4096 bytes, `ACK`, `ERR` and `RHE`. They come before any sizes are agreed.
pub const MAX_NEGOTIATION_MESSAGE_SIZE: usize = 8192;

impl Decoder for TcpCodec {
    type Item = Message;
    type Error = io::Error;

    fn decode(&mut self, buf: &mut BytesMut) -> Result<Option<Self::Item>, Self::Error> {
        if buf.len() >= MESSAGE_HEADER_LEN {
            // Every OPC UA message has at least 8 bytes of header to be read to see what follows

            // Get the message header
            let message_header = {
                let mut buf = io::Cursor::new(&buf[0..MESSAGE_HEADER_LEN]);
                MessageHeader::decode(&mut buf, &self.decoding_options)?
            };

            // Once we have the header we can infer the message size required to read the rest of
            // the message. The buffer needs to have at least that amount of bytes in it for the
            // whole message to be extracted.
            let message_size = message_header.message_size as usize;
            // Refused by its header: nothing more of such a message is to be buffered.
            self.check_size(&message_header)?;
            if buf.len() >= message_size {
                // Extract the message bytes from the buffer & decode them into a message
                let mut buf = buf.split_to(message_size);
                let message =
                    Self::decode_message(message_header, &mut buf, &self.decoding_options)
                        .map_err(|e| {
                            error!("Codec got an error {} while decoding a message", e);
                            io::Error::from(e)
                        })?;
                Ok(Some(message))
            } else {
                // Not enough bytes
                Ok(None)
            }
        } else {
            Ok(None)
        }
    }
}

impl Encoder<Message> for TcpCodec {
    type Error = io::Error;

    fn encode(&mut self, data: Message, buf: &mut BytesMut) -> Result<(), io::Error> {
        match data {
            Message::Hello(msg) => self.write(msg, buf),
            Message::Acknowledge(msg) => self.write(msg, buf),
            Message::Error(msg) => self.write(msg, buf),
            Message::Chunk(msg) => self.write(msg, buf),
            Message::ReverseHello(msg) => self.write(msg, buf),
        }
    }
}

impl TcpCodec {
    /// Constructs a new TcpCodec. The abort flag is set to terminate the codec even while it is
    /// waiting for a frame to arrive.
    pub fn new(decoding_options: DecodingOptions) -> TcpCodec {
        TcpCodec {
            decoding_options,
            max_chunk_size: DEFAULT_MAX_CHUNK_SIZE,
        }
    }

    /// Set the size of the largest message chunk that is read: the size of the receive buffer that the peer is told.
    pub fn with_max_chunk_size(mut self, max_chunk_size: usize) -> TcpCodec {
        self.max_chunk_size = max_chunk_size;
        self
    }

    /// Get the status code of an error that the codec returned.
    pub fn status_of(error: &io::Error) -> StatusCode {
        error
            .get_ref()
            .and_then(|inner| inner.downcast_ref::<StatusCode>())
            .copied()
            .unwrap_or(StatusCode::BadConnectionClosed)
    }

    fn check_size(&self, header: &MessageHeader) -> Result<(), io::Error> {
        let max_size = match header.message_type {
            MessageType::Chunk => self.max_chunk_size,
            MessageType::Hello
            | MessageType::Acknowledge
            | MessageType::Error
            | MessageType::ReverseHello => MAX_NEGOTIATION_MESSAGE_SIZE,
            MessageType::Invalid => {
                return Err(StatusCode::BadTcpMessageTypeInvalid.into());
            }
        };
        let size = header.message_size as usize;
        if size > max_size {
            error!("Codec got a message of {size} bytes, {max_size} are allowed");
            return Err(StatusCode::BadTcpMessageTooLarge.into());
        }
        if size < MESSAGE_HEADER_LEN {
            return Err(StatusCode::BadDecodingError.into());
        }
        Ok(())
    }

    // Writes the encodable thing into the buffer.
    fn write<T>(&self, msg: T, buf: &mut BytesMut) -> Result<(), io::Error>
    where
        T: SimpleBinaryEncodable + std::fmt::Debug,
    {
        buf.reserve(msg.byte_len());
        msg.encode(&mut buf.writer()).map(|_| ()).map_err(|err| {
            error!("Error writing message {:?}, err = {}", msg, err);
            io::Error::other(format!("Error = {err}"))
        })
    }

    /// Reads a message out of the buffer, which is assumed by now to be the proper length
    fn decode_message(
        message_header: MessageHeader,
        buf: &mut BytesMut,
        decoding_options: &DecodingOptions,
    ) -> Result<Message, StatusCode> {
        let mut buf = io::Cursor::new(&buf[..]);
        match message_header.message_type {
            MessageType::Acknowledge => Ok(Message::Acknowledge(AcknowledgeMessage::decode(
                &mut buf,
                decoding_options,
            )?)),
            MessageType::Hello => Ok(Message::Hello(HelloMessage::decode(
                &mut buf,
                decoding_options,
            )?)),
            MessageType::Error => Ok(Message::Error(ErrorMessage::decode(
                &mut buf,
                decoding_options,
            )?)),
            MessageType::Chunk => Ok(Message::Chunk(MessageChunk::decode(
                &mut buf,
                decoding_options,
            )?)),
            MessageType::ReverseHello => Ok(Message::ReverseHello(ReverseHelloMessage::decode(
                &mut buf,
                decoding_options,
            )?)),
            MessageType::Invalid => {
                error!("Message type for chunk is invalid.");
                Err(StatusCode::BadCommunicationError)
            }
        }
    }
}

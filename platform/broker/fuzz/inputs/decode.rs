//! Decoding of any bytes, for the fuzz target and for the test that replays its corpus.

use fe2o3_amqp_types::{
    messaging::{
        AmqpValue, Body, Message, Source, Target,
        message::__private::{Deserializable, Serializable},
    },
    performatives::Performative,
    sasl::{SaslInit, SaslMechanisms, SaslOutcome, SaslResponse},
};
use serde::de::DeserializeOwned;
use serde_amqp::{Value, lazy::LazyValue};

/// Decodes bytes as everything that a peer may send. What was read can be written, and is read
/// again.
pub fn decode(bytes: &[u8]) {
    both::<SaslInit>(bytes);
    both::<SaslMechanisms>(bytes);
    both::<SaslOutcome>(bytes);
    both::<SaslResponse>(bytes);
    both::<Source>(bytes);
    both::<Target>(bytes);
    both::<LazyValue>(bytes);
    both::<AmqpValue<Value>>(bytes);
    if let Some(performative) = both::<Performative>(bytes) {
        serde_amqp::to_vec(&performative).expect("a performative can be written");
    }
    if let Some(value) = both::<Value>(bytes) {
        serde_amqp::to_vec(&value).expect("a value can be written");
    }
    if let Some(Deserializable(message)) = both::<Deserializable<Message<Body<Value>>>>(bytes) {
        let written = serde_amqp::to_vec(&Serializable(message)).expect("a message can be written");
        // As the broker reads what it has stored.
        let _ = serde_amqp::from_slice::<Deserializable<Message<Body<Value>>>>(&written);
    }
}

/// Decodes by both readers.
fn both<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let _ = serde_amqp::from_reader::<T>(bytes);
    serde_amqp::from_slice(bytes).ok()
}

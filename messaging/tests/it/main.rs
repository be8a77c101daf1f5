//! The link against other people's brokers.

mod mosquitto;
mod rabbitmq;
mod support;

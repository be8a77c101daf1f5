//! The link against foreign brokers.

mod mosquitto;
mod rabbitmq;
mod support;

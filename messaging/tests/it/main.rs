//! The link against foreign brokers.

mod corpus;
mod hostile_mqtt;
mod mosquitto;
mod quota;
mod rabbitmq;
mod support;

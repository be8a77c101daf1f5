//! The link against other people's brokers.

mod rabbitmq;
mod rabbitmq_process;

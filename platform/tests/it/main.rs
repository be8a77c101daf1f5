//! The platform as its users meet it: over HTTP, AMQP and server-sent events, with the real broker
//! and database inside.

#![allow(clippy::disallowed_methods, reason = "tests run by the machine's clock")]

mod accesses;
mod answers;
mod audit;
mod audit_facts;
mod broker_process;
mod chain;
mod commands;
mod connector;
mod corpus;
mod enrolment;
mod entitlement;
mod fair_shares;
mod foreign_requests;
mod harness;
mod isolation;
mod journey;
mod leases;
mod leaving;
mod left_behind;
mod members;
mod migration;
mod opaque_ids;
mod openapi;
mod page_turns;
mod pages;
mod passkeys;
mod past_releases;
mod receipts;
mod removals;
mod retention;
mod revocations;
mod revoked_access;
mod rights;
mod rubbish;
mod schema;
mod second_factor;
mod sessions;
mod sight;
mod signatures;
mod store;
mod story;
mod throughput;
mod tools;
mod witness;

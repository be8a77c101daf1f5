//! Checking a message, and printing what was found.

use std::io::Write;

use anyhow::Context as _;
use asi_model::{
    FactoryId, MessageId, OperationNetworkId,
    messages::{Acknowledgement, AcknowledgementResult, FactoryMessage, Fault, PlatformMessage},
    opcua_json::{Diagnostic, Leniency},
    pubsub::json::{PubSubError, decode_described},
    validation::{self, InvalidMessage},
};
use serde_json::json;

use crate::{
    input::{Input, InputKind},
    outcome::CommandOutcome,
};

/// Findings about one message.
pub struct Check {
    /// The kind of message, for people.
    kind: &'static str,
    faults: Vec<Fault>,
    diagnostics: Vec<Diagnostic>,
    /// The message that an acknowledgement refers to; only messages to factories have one.
    pub message: Option<PlatformMessage>,
    rejection: Option<InvalidMessage>,
}

impl Check {
    /// Checks a message for a factory, or for the factory it names; `strict` makes faults of
    /// deviations that receivers take.
    pub fn of(input: &Input, factory: Option<&FactoryId>, strict: bool) -> Self {
        let mut check = Self {
            kind: input.kind.name(),
            faults: Vec::new(),
            diagnostics: Vec::new(),
            message: None,
            rejection: None,
        };
        match input.kind {
            InputKind::ToFactory | InputKind::NodeSet | InputKind::Unknown => {
                let parsed = match factory {
                    Some(factory) => validation::parse_platform_message(&input.bytes, factory),
                    None => validation::parse_any_platform_message(&input.bytes),
                };
                match parsed {
                    Ok(message) => check.message = Some(message),
                    Err(rejection) => {
                        check.faults.clone_from(&rejection.faults);
                        check.rejection = Some(rejection);
                    }
                }
            }
            InputKind::FromFactory => {
                if let Err(rejection) = validation::parse_factory_message(&input.bytes) {
                    check.faults = rejection.faults;
                }
            }
            InputKind::Network => {
                if let Err(rejection) = validation::parse_network(&input.bytes) {
                    check.faults = rejection.faults;
                }
            }
            InputKind::PubSub => {
                let leniency = if strict { Leniency::Strict } else { Leniency::Lenient };
                match decode_described(&input.bytes, leniency, &()) {
                    Ok(decoded) => check.diagnostics = decoded.diagnostics,
                    Err(error) => check.faults = vec![pubsub_fault(&error)],
                }
                if strict {
                    let deviations =
                        std::mem::take(&mut check.diagnostics).into_iter().map(|diagnostic| {
                            Fault {
                                pointer: diagnostic.pointer,
                                code: "DEVIATION".to_owned(),
                                message: diagnostic.message,
                            }
                        });
                    check.faults.extend(deviations);
                }
            }
        }
        check
    }

    /// Valid where there is no fault; diagnostics do not count.
    pub const fn outcome(&self) -> CommandOutcome {
        if self.faults.is_empty() { CommandOutcome::Valid } else { CommandOutcome::Invalid }
    }

    /// Prints one line per finding, and the result.
    pub fn print(&self, out: &mut dyn Write) -> anyhow::Result<CommandOutcome> {
        for fault in &self.faults {
            let place = if fault.pointer.is_empty() { "(the whole)" } else { &fault.pointer };
            writeln!(out, "{place}: {} [{}]", fault.message, fault.code)?;
        }
        for note in &self.diagnostics {
            writeln!(out, "{}: note: {}", note.pointer, note.message)?;
        }
        match self.faults.len() {
            0 => writeln!(out, "valid: {}", self.kind)?,
            1 => writeln!(out, "not valid: {}, 1 fault", self.kind)?,
            count => writeln!(out, "not valid: {}, {count} faults", self.kind)?,
        }
        Ok(self.outcome())
    }

    /// Prints the acknowledgement that a connector would send.
    pub fn print_acknowledgement(
        &self,
        factory: Option<&FactoryId>,
        out: &mut dyn Write,
    ) -> anyhow::Result<CommandOutcome> {
        #[expect(clippy::disallowed_methods, reason = "the program runs once, by this clock")]
        let new_id = || MessageId::from(uuid::Uuid::now_v7());
        let unnamed = || "unknown".parse::<FactoryId>().context("`unknown` is a factory id");
        let acknowledgement = match (&self.message, self.rejection.clone()) {
            (Some(message), _) => {
                let (factory_id, network_id, revision) = about(message);
                Acknowledgement {
                    message_id: new_id(),
                    factory_id,
                    correlation_id: message.message_id().clone(),
                    operation_network_id: network_id,
                    revision,
                    result: AcknowledgementResult::Accepted,
                    fault_list: Vec::new(),
                }
            }
            // Without a transport there is no id but ours to refer to.
            (None, Some(rejection)) => rejection.into_acknowledgement(
                new_id(),
                factory.cloned().map_or_else(unnamed, Ok)?,
                new_id(),
            ),
            (None, None) => {
                let result = if self.faults.is_empty() { "ACCEPTED" } else { "REJECTED" };
                let text = json!({ "result": result, "faultList": self.faults });
                writeln!(out, "{text:#}")?;
                return Ok(self.outcome());
            }
        };
        let message = FactoryMessage::Acknowledgement(acknowledgement);
        writeln!(out, "{}", serde_json::to_string_pretty(&message)?)?;
        Ok(self.outcome())
    }
}

/// The fault that a connector would report for a PubSub message it cannot read.
pub fn pubsub_fault(error: &PubSubError) -> Fault {
    let (pointer, code, message) = match error {
        PubSubError::Json(cause) => (String::new(), "NOT_JSON", format!("{error}: {cause}")),
        PubSubError::Duplicate { pointer } => {
            (pointer.clone(), "DUPLICATE_MEMBER", "The member occurs twice.".into())
        }
        PubSubError::Malformed { pointer, message } => {
            (pointer.clone(), "INVALID_VALUE", message.clone())
        }
    };
    Fault { pointer, code: code.to_owned(), message }
}

fn about(message: &PlatformMessage) -> (FactoryId, Option<OperationNetworkId>, Option<u64>) {
    match message {
        PlatformMessage::OperationNetwork(m) => (
            m.factory_id.clone(),
            Some(m.operation_network.operation_network_id.clone()),
            Some(m.revision),
        ),
        PlatformMessage::Withdraw(m) => {
            (m.factory_id.clone(), Some(m.operation_network_id.clone()), Some(m.revision))
        }
        PlatformMessage::Comment(m) => {
            (m.factory_id.clone(), Some(m.operation_network_id.clone()), None)
        }
        PlatformMessage::AssetRequest(m) => (m.factory_id.clone(), None, None),
        PlatformMessage::Receipt(m) => (m.factory_id.clone(), None, None),
        PlatformMessage::Lease(m) => (m.factory_id.clone(), None, None),
        PlatformMessage::LedgerCosignature(m) => (m.factory_id.clone(), None, None),
    }
}

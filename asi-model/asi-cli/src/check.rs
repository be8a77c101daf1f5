//! Checking a message, and printing what was found.

use std::io::Write;

use anyhow::Context as _;
use asi_model::{
    FactoryId, MessageId, OperationNetworkId,
    json::Tape,
    messages::{Acknowledgement, AcknowledgementResult, FactoryMessage, Fault, PlatformMessage},
    opcua_json::{Diagnostic, Leniency},
    pubsub::{
        DataSetMetaData,
        json::{PubSubError, decode_described},
    },
    validation::{self, InvalidMessage},
};
use serde_json::json;

use crate::{
    input::{INPUT_LIMITS, Input, InputKind},
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

/// Rules by which a message is checked.
#[derive(Debug, Default)]
pub struct CheckRules {
    /// The factory that receives it; where absent, the one that the message names.
    pub factory: Option<FactoryId>,
    /// True where deviations that receivers take are faults.
    pub is_strict: bool,
    /// True where an object or array without headers is a payload.
    pub takes_payload: bool,
    /// The types of bare values.
    pub meta_data: Option<DataSetMetaData>,
}

impl Check {
    /// Checks a message.
    pub fn of(input: &Input, rules: &CheckRules) -> Self {
        let mut check = Self {
            kind: input.kind.name(),
            faults: Vec::new(),
            diagnostics: Vec::new(),
            message: None,
            rejection: None,
        };
        match input.kind {
            InputKind::PubSub => check.pubsub(input, rules),
            InputKind::PubSubPart | InputKind::Payload if rules.takes_payload => {
                check.pubsub(input, rules);
            }
            InputKind::PubSubPart => check.faults = missing_headers(&input.bytes),
            InputKind::ToFactory | InputKind::NodeSet | InputKind::Unknown | InputKind::Payload => {
                check.platform_message(input, rules)
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
        }
        check
    }

    fn platform_message(&mut self, input: &Input, rules: &CheckRules) {
        let parsed = match &rules.factory {
            Some(factory) => validation::parse_platform_message(&input.bytes, factory),
            None => validation::parse_any_platform_message(&input.bytes),
        };
        match parsed {
            Ok(message) => self.message = Some(message),
            Err(rejection) => {
                self.faults.clone_from(&rejection.faults);
                self.rejection = Some(rejection);
            }
        }
    }

    fn pubsub(&mut self, input: &Input, rules: &CheckRules) {
        let leniency = if rules.is_strict { Leniency::Strict } else { Leniency::Lenient };
        let decoded = match &rules.meta_data {
            Some(known) => decode_described(&input.bytes, leniency, known),
            None => decode_described(&input.bytes, leniency, &()),
        };
        match decoded {
            Ok(decoded) => self.diagnostics = decoded.diagnostics,
            Err(error) => self.faults = vec![pubsub_fault(&error)],
        }
        if rules.is_strict {
            // Bare values keep the standard: their types are in the metadata.
            let (notes, deviations) =
                std::mem::take(&mut self.diagnostics).into_iter().partition(Diagnostic::is_guess);
            self.diagnostics = notes;
            self.faults.extend(deviations.into_iter().map(|deviation: Diagnostic| Fault {
                pointer: deviation.pointer,
                code: "DEVIATION".to_owned(),
                message: deviation.message,
            }));
        }
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

    /// Prints the acknowledgement that a connector would send. A rejection is by the factory that
    /// receives the message, else by the one that it names.
    pub fn print_acknowledgement(
        &self,
        input: &Input,
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
            (None, Some(rejection)) => {
                let named = factory.cloned().or_else(|| validation::named_factory(&input.bytes));
                let factory_id = named.map_or_else(unnamed, Ok)?;
                rejection.into_acknowledgement(new_id(), factory_id, new_id())
            }
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

/// Returns the fault of an input with some members of PubSub, but no header.
fn missing_headers(bytes: &[u8]) -> Vec<Fault> {
    let tape = Tape::read(bytes, INPUT_LIMITS);
    let misspelt = |name: &'static str| {
        let found = tape.as_ref().ok()?.root().misspelt(name)?;
        Some((name, format!("The member {name} is missing; {found} differs from it in capitals.")))
    };
    let (name, message) = ["Messages", "Payload", "MessageType"]
        .into_iter()
        .find_map(misspelt)
        .unwrap_or_else(|| {
            let message = "The message has neither Messages (or MetaData or Status, with its \
                           MessageType) nor an object as Payload; --payload takes it for a \
                           payload itself.";
            ("Messages", message.to_owned())
        });
    vec![Fault { pointer: format!("/{name}"), code: "MISSING_MEMBER".to_owned(), message }]
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

//! The commands.

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, bail};
use asi_model::{
    FactoryId, MessageId, asi_types,
    instance::{self, Instance},
    messages::{Acknowledgement, AcknowledgementResult, Fault, PlatformMessage},
    node_set,
    opcua_json::{Diagnostic, Leniency},
    pubsub::{
        DataSetMetaData, PubSubMessage,
        json::{Encoding, PubSubError, decode_described, encode_described, encode_message},
    },
    schema, validation,
};
use serde_json::json;

use crate::{
    explain,
    input::{Input, Kind},
};

/// What `asi` can do.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Check a message: everything that is wrong with it, each fault with a JSON pointer.
    Validate {
        /// The message; standard input where it is absent or `-`.
        file: Option<PathBuf>,
        /// The factory that receives it; where absent, whichever the message names.
        #[arg(long)]
        factory: Option<FactoryId>,
        /// Print the acknowledgement that a connector would send.
        #[arg(long)]
        json: bool,
        /// Refuse what deviates from the OPC UA standard, even where receivers take it.
        #[arg(long)]
        strict: bool,
    },
    /// Write a PubSub message in another encoding.
    Convert {
        /// The message; standard input where it is absent or `-`.
        file: Option<PathBuf>,
        /// The encoding to write: digicor, 1.05-compact or 1.05-verbose.
        #[arg(long)]
        to: Encoding,
        /// The ua-metadata message that tells the types of bare values.
        #[arg(long, value_name = "FILE")]
        meta_data: Option<PathBuf>,
    },
    /// Write OPC UA nodes as NodeSet2, or read them.
    #[command(subcommand)]
    Nodeset(NodesetCommand),
    /// Tell a message field by field.
    Explain {
        /// The message; standard input where it is absent or `-`.
        file: Option<PathBuf>,
        /// The ua-metadata message with units and meanings of a report's fields.
        #[arg(long, value_name = "FILE")]
        meta_data: Option<PathBuf>,
    },
    /// Write the JSON Schemas of all messages into a folder.
    Schema {
        /// The folder.
        folder: PathBuf,
    },
}

/// What can be done with NodeSet2 documents.
#[derive(Debug, clap::Subcommand)]
pub enum NodesetCommand {
    /// The type model of the Activity Status Interface.
    Types,
    /// The interface that an operation-network message asks for.
    Instance {
        /// The message; standard input where it is absent or `-`.
        file: Option<PathBuf>,
    },
    /// The operation-network message that a NodeSet2 document stands for.
    Read {
        /// The document; standard input where it is absent or `-`.
        file: Option<PathBuf>,
    },
}

/// How a command ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// All is well.
    Valid,
    /// The input is not valid.
    Invalid,
}

/// Carries out a command.
pub fn run(command: Command, out: &mut dyn Write) -> anyhow::Result<Outcome> {
    match command {
        Command::Validate { file, factory, json, strict } => {
            let input = Input::read(file.as_deref())?;
            let verdict = validate(&input, factory.as_ref(), strict);
            if json {
                print_acknowledgement(&verdict, factory.as_ref(), out)
            } else {
                print_verdict(&verdict, out)
            }
        }
        Command::Convert { file, to, meta_data } => {
            let input = Input::read(file.as_deref())?;
            convert(&input, to, meta_data.as_deref(), out)
        }
        Command::Nodeset(command) => nodeset(command, out),
        Command::Explain { file, meta_data } => {
            let input = Input::read(file.as_deref())?;
            explain_message(&input, meta_data.as_deref(), out)
        }
        Command::Schema { folder } => {
            for (name, known) in schema::all() {
                let path = folder.join(name);
                std::fs::write(&path, schema::text(&known))
                    .with_context(|| format!("cannot write {}", path.display()))?;
            }
            Ok(Outcome::Valid)
        }
    }
}

/// What is to be said about a message.
struct Verdict {
    /// What it is, for people.
    what: String,
    faults: Vec<Fault>,
    diagnostics: Vec<Diagnostic>,
    /// What an acknowledgement refers to; only messages to factories are acknowledged.
    message: Option<PlatformMessage>,
    rejection: Option<validation::Rejection>,
}

impl Verdict {
    fn of(what: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            faults: Vec::new(),
            diagnostics: Vec::new(),
            message: None,
            rejection: None,
        }
    }

    const fn outcome(&self) -> Outcome {
        if self.faults.is_empty() { Outcome::Valid } else { Outcome::Invalid }
    }
}

fn validate(input: &Input, factory: Option<&FactoryId>, strict: bool) -> Verdict {
    let mut verdict = Verdict::of(input.kind.name());
    match input.kind {
        Kind::ToFactory | Kind::NodeSet | Kind::Unknown => {
            let parsed = match factory {
                Some(factory) => validation::parse_platform_message(&input.bytes, factory),
                None => validation::parse_any_platform_message(&input.bytes),
            };
            match parsed {
                Ok(message) => verdict.message = Some(message),
                Err(rejection) => {
                    verdict.faults.clone_from(&rejection.faults);
                    verdict.rejection = Some(rejection);
                }
            }
        }
        Kind::FromFactory => {
            if let Err(rejection) = validation::parse_factory_message(&input.bytes) {
                verdict.faults = rejection.faults;
            }
        }
        Kind::Network => {
            if let Err(rejection) = validation::parse_network(&input.bytes) {
                verdict.faults = rejection.faults;
            }
        }
        Kind::PubSub => {
            let leniency = if strict { Leniency::Strict } else { Leniency::Lenient };
            match decode_described(&input.bytes, leniency, &()) {
                Ok(decoded) => verdict.diagnostics = decoded.diagnostics,
                Err(error) => verdict.faults = vec![pubsub_fault(&error)],
            }
            if strict {
                let deviations =
                    std::mem::take(&mut verdict.diagnostics).into_iter().map(|diagnostic| Fault {
                        pointer: diagnostic.pointer,
                        code: "DEVIATION".to_owned(),
                        message: diagnostic.message,
                    });
                verdict.faults.extend(deviations);
            }
        }
    }
    verdict
}

fn pubsub_fault(error: &PubSubError) -> Fault {
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

fn print_verdict(verdict: &Verdict, out: &mut dyn Write) -> anyhow::Result<Outcome> {
    for fault in &verdict.faults {
        let place = if fault.pointer.is_empty() { "(the whole)" } else { &fault.pointer };
        writeln!(out, "{place}: {} [{}]", fault.message, fault.code)?;
    }
    for note in &verdict.diagnostics {
        writeln!(out, "{}: note: {}", note.pointer, note.message)?;
    }
    match verdict.faults.len() {
        0 => writeln!(out, "valid: {}", verdict.what)?,
        1 => writeln!(out, "not valid: {}, 1 fault", verdict.what)?,
        count => writeln!(out, "not valid: {}, {count} faults", verdict.what)?,
    }
    Ok(verdict.outcome())
}

fn print_acknowledgement(
    verdict: &Verdict,
    factory: Option<&FactoryId>,
    out: &mut dyn Write,
) -> anyhow::Result<Outcome> {
    let new_id = || MessageId::from(uuid::Uuid::now_v7());
    let unnamed = || "unknown".parse::<FactoryId>().context("`unknown` is a factory id");
    let acknowledgement = match (&verdict.message, verdict.rejection.clone()) {
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
            let result = if verdict.faults.is_empty() { "ACCEPTED" } else { "REJECTED" };
            let text = json!({ "result": result, "faultList": verdict.faults });
            writeln!(out, "{text:#}")?;
            return Ok(verdict.outcome());
        }
    };
    let message = asi_model::messages::FactoryMessage::Acknowledgement(acknowledgement);
    writeln!(out, "{}", serde_json::to_string_pretty(&message)?)?;
    Ok(verdict.outcome())
}

fn about(
    message: &PlatformMessage,
) -> (FactoryId, Option<asi_model::OperationNetworkId>, Option<u64>) {
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
    }
}

fn read_meta_data(file: Option<&Path>) -> anyhow::Result<Option<DataSetMetaData>> {
    let Some(file) = file else { return Ok(None) };
    let bytes = std::fs::read(file).with_context(|| format!("cannot read {}", file.display()))?;
    let decoded = decode_described(&bytes, Leniency::Lenient, &())
        .with_context(|| format!("{}", file.display()))?;
    match decoded.message {
        PubSubMessage::MetaData(message) => Ok(Some(message.meta_data)),
        other => bail!("{} is not ua-metadata, but {}", file.display(), other.message_type()),
    }
}

/// Notes go to standard error, so that standard output holds nothing but the message.
fn note(diagnostics: &[Diagnostic]) {
    let mut err = std::io::stderr().lock();
    for diagnostic in diagnostics {
        // Notes are a courtesy; that they cannot be written is no reason to fail.
        let _ = writeln!(err, "asi: {}: {}", diagnostic.pointer, diagnostic.message);
    }
}

fn convert(
    input: &Input,
    encoding: Encoding,
    meta_data: Option<&Path>,
    out: &mut dyn Write,
) -> anyhow::Result<Outcome> {
    let meta_data = read_meta_data(meta_data)?;
    let decoded = match &meta_data {
        Some(known) => decode_described(&input.bytes, Leniency::Lenient, known),
        None => decode_described(&input.bytes, Leniency::Lenient, &()),
    };
    let decoded = match decoded {
        Ok(decoded) => decoded,
        Err(error) => {
            let fault = pubsub_fault(&error);
            bail_invalid(&fault);
            return Ok(Outcome::Invalid);
        }
    };
    note(&decoded.diagnostics);
    let bytes = match (&decoded.message, &meta_data) {
        (PubSubMessage::Data(message), Some(known)) => encode_described(message, encoding, known),
        (message, _) => encode_message(message, encoding),
    };
    out.write_all(&bytes)?;
    writeln!(out)?;
    Ok(Outcome::Valid)
}

fn bail_invalid(fault: &Fault) {
    note(&[Diagnostic { pointer: fault.pointer.clone(), message: fault.message.clone() }]);
}

fn nodeset(command: NodesetCommand, out: &mut dyn Write) -> anyhow::Result<Outcome> {
    let (file, as_nodes) = match command {
        NodesetCommand::Types => {
            out.write_all(node_set::write(&asi_types::node_set()).as_bytes())?;
            return Ok(Outcome::Valid);
        }
        NodesetCommand::Instance { file } => (file, true),
        NodesetCommand::Read { file } => (file, false),
    };
    let input = Input::read(file.as_deref())?;
    match validation::parse_any_platform_message(&input.bytes) {
        Ok(PlatformMessage::OperationNetwork(message)) if as_nodes => {
            out.write_all(
                node_set::write(&instance::node_set(&Instance::new(&message))).as_bytes(),
            )?;
            Ok(Outcome::Valid)
        }
        Ok(message) if !as_nodes => {
            writeln!(out, "{}", serde_json::to_string_pretty(&message)?)?;
            Ok(Outcome::Valid)
        }
        Ok(other) => bail!("an operation-network message is needed, not {}", other.message_type()),
        Err(rejection) => rejected(&rejection),
    }
}

fn rejected(rejection: &validation::Rejection) -> anyhow::Result<Outcome> {
    rejection.faults.iter().for_each(bail_invalid);
    Ok(Outcome::Invalid)
}

fn explain_message(
    input: &Input,
    meta_data: Option<&Path>,
    out: &mut dyn Write,
) -> anyhow::Result<Outcome> {
    let meta_data = read_meta_data(meta_data)?;
    let verdict = validate(input, None, false);
    if verdict.outcome() == Outcome::Invalid {
        return print_verdict(&verdict, out);
    }
    match (&verdict.message, input.kind) {
        (Some(message), _) => explain::platform_message(message, out)?,
        (None, Kind::PubSub) => {
            let decoded = match &meta_data {
                Some(known) => decode_described(&input.bytes, Leniency::Lenient, known),
                None => decode_described(&input.bytes, Leniency::Lenient, &()),
            };
            let decoded = decoded.context("the message was valid a moment ago")?;
            explain::pubsub_message(&decoded.message, meta_data.as_ref(), out)?;
            for diagnostic in &decoded.diagnostics {
                writeln!(out, "note: {}: {}", diagnostic.pointer, diagnostic.message)?;
            }
        }
        (None, _) => explain::members(&serde_json::from_slice(&input.bytes)?, out)?,
    }
    Ok(Outcome::Valid)
}

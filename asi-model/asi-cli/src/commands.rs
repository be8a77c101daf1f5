//! The commands.

use std::{
    io::Write,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, bail};
use asi_model::{
    FactoryId, asi_types,
    instance::{self, Instance},
    messages::{Fault, PlatformMessage},
    node_set,
    opcua_json::{Diagnostic, Leniency},
    pubsub::{
        DataSetMetaData, PubSubMessage,
        json::{Encoding, decode_described, encode_described, encode_message},
    },
    schema, validation,
};

use crate::{
    access::{self, AccessCommand},
    check::{Check, CheckRules, pubsub_fault},
    explain,
    input::{Input, InputKind},
    ledger::{self, LedgerCommand},
    outcome::CommandOutcome,
};

/// Subcommands, each a call that reads files and ends.
#[derive(Debug, clap::Subcommand)]
pub enum AsiCommand {
    /// Check a message: everything that is wrong with it, each fault with a JSON pointer.
    Validate {
        /// The message; standard input where it is absent or `-`.
        file: Option<PathBuf>,
        /// The factory that receives it; where absent, the one that the message names.
        #[arg(long)]
        factory: Option<FactoryId>,
        /// Print the acknowledgement that a connector would send.
        #[arg(long)]
        json: bool,
        /// Refuse what deviates from the OPC UA standard, even where receivers take it.
        #[arg(long)]
        strict: bool,
        /// Take an object or array without headers for the payload of a PubSub message.
        #[arg(long)]
        payload: bool,
        /// The ua-metadata message with the types of bare values.
        #[arg(long, value_name = "FILE")]
        meta_data: Option<PathBuf>,
    },
    /// Write a PubSub message in another encoding.
    Convert {
        /// The message; standard input where it is absent or `-`.
        file: Option<PathBuf>,
        /// The encoding to write: digicor, 1.05-compact or 1.05-verbose.
        #[arg(long)]
        to: Encoding,
        /// The ua-metadata message with the types of bare values.
        #[arg(long, value_name = "FILE")]
        meta_data: Option<PathBuf>,
    },
    /// Write OPC UA nodes as NodeSet2, or read them.
    #[command(subcommand)]
    Nodeset(NodesetCommand),
    /// Explain a message field by field.
    Explain {
        /// The message; standard input where it is absent or `-`.
        file: Option<PathBuf>,
        /// The ua-metadata message with units and meanings of a report's fields.
        #[arg(long, value_name = "FILE")]
        meta_data: Option<PathBuf>,
        /// Take an object or array without headers for the payload of a PubSub message.
        #[arg(long)]
        payload: bool,
    },
    /// Check the account of what a factory disclosed.
    #[command(subcommand)]
    Ledger(LedgerCommand),
    /// Check the account of who read a factory's values at the platform.
    #[command(subcommand)]
    Access(AccessCommand),
    /// Write the JSON Schemas of all messages into a folder.
    Schema {
        /// Folder of the schema files; existing ones are replaced.
        folder: PathBuf,
    },
}

/// Commands on NodeSet2 documents.
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

/// Carries out a command.
pub fn run(command: AsiCommand, out: &mut dyn Write) -> anyhow::Result<CommandOutcome> {
    match command {
        AsiCommand::Validate { file, factory, json, strict, payload, meta_data } => {
            let input = Input::read(file.as_deref())?;
            let rules = CheckRules {
                factory,
                is_strict: strict,
                takes_payload: payload,
                meta_data: read_meta_data(meta_data.as_deref())?,
            };
            let check = Check::of(&input, &rules);
            if json {
                check.print_acknowledgement(&input, rules.factory.as_ref(), out)
            } else {
                check.print(out)
            }
        }
        AsiCommand::Convert { file, to, meta_data } => {
            let input = Input::read(file.as_deref())?;
            convert(&input, to, meta_data.as_deref(), out)
        }
        AsiCommand::Nodeset(command) => nodeset(command, out),
        AsiCommand::Explain { file, meta_data, payload } => {
            let input = Input::read(file.as_deref())?;
            let rules = CheckRules {
                takes_payload: payload,
                meta_data: read_meta_data(meta_data.as_deref())?,
                ..CheckRules::default()
            };
            explain_message(&input, &rules, out)
        }
        AsiCommand::Ledger(command) => ledger::run(command, out),
        AsiCommand::Access(command) => access::run(command, out),
        AsiCommand::Schema { folder } => {
            for (name, known) in schema::all() {
                let path = folder.join(name);
                std::fs::write(&path, schema::text(&known))
                    .with_context(|| format!("cannot write {}", path.display()))?;
            }
            Ok(CommandOutcome::Valid)
        }
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
) -> anyhow::Result<CommandOutcome> {
    let meta_data = read_meta_data(meta_data)?;
    let decoded = match &meta_data {
        Some(known) => decode_described(&input.bytes, Leniency::Lenient, known),
        None => decode_described(&input.bytes, Leniency::Lenient, &()),
    };
    let decoded = match decoded {
        Ok(decoded) => decoded,
        Err(error) => {
            let fault = pubsub_fault(&error);
            note_fault(&fault);
            return Ok(CommandOutcome::Invalid);
        }
    };
    note(&decoded.diagnostics);
    let bytes = match (&decoded.message, &meta_data) {
        (PubSubMessage::Data(message), Some(known)) => encode_described(message, encoding, known),
        (message, _) => encode_message(message, encoding),
    };
    out.write_all(&bytes)?;
    writeln!(out)?;
    Ok(CommandOutcome::Valid)
}

fn note_fault(fault: &Fault) {
    note(&[Diagnostic { pointer: fault.pointer.clone(), message: fault.message.clone() }]);
}

fn nodeset(command: NodesetCommand, out: &mut dyn Write) -> anyhow::Result<CommandOutcome> {
    let (file, as_nodes) = match command {
        NodesetCommand::Types => {
            out.write_all(node_set::write(&asi_types::node_set()).as_bytes())?;
            return Ok(CommandOutcome::Valid);
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
            Ok(CommandOutcome::Valid)
        }
        Ok(message) if !as_nodes => {
            writeln!(out, "{}", serde_json::to_string_pretty(&message)?)?;
            Ok(CommandOutcome::Valid)
        }
        Ok(other) => bail!("an operation-network message is needed, not {}", other.message_type()),
        Err(rejection) => rejected(&rejection),
    }
}

fn rejected(rejection: &validation::InvalidMessage) -> anyhow::Result<CommandOutcome> {
    rejection.faults.iter().for_each(note_fault);
    Ok(CommandOutcome::Invalid)
}

fn explain_message(
    input: &Input,
    rules: &CheckRules,
    out: &mut dyn Write,
) -> anyhow::Result<CommandOutcome> {
    let check = Check::of(input, rules);
    if check.outcome() == CommandOutcome::Invalid {
        return check.print(out);
    }
    match (&check.message, input.kind) {
        (Some(message), _) => explain::platform_message(message, out)?,
        (None, InputKind::PubSub | InputKind::PubSubPart | InputKind::Payload) => {
            let decoded = match &rules.meta_data {
                Some(known) => decode_described(&input.bytes, Leniency::Lenient, known),
                None => decode_described(&input.bytes, Leniency::Lenient, &()),
            };
            let decoded = decoded.context("the message was valid a moment ago")?;
            explain::pubsub_message(&decoded.message, rules.meta_data.as_ref(), out)?;
            for diagnostic in &decoded.diagnostics {
                writeln!(out, "note: {}: {}", diagnostic.pointer, diagnostic.message)?;
            }
        }
        (None, _) => explain::members(&serde_json::from_slice(&input.bytes)?, out)?,
    }
    Ok(CommandOutcome::Valid)
}

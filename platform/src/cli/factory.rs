//! `platform factory`.

use asi_model::FactoryId;
use clap::Subcommand;
use platform::{
    config::PlatformConfig,
    store::{Leaver, Scope},
};

use super::{
    administration::{self, open},
    output::print,
    removal,
};

#[derive(Debug, Subcommand)]
pub(super) enum FactoryCommand {
    /// List the factories: id, organisation, name, and whether a connector has enrolled.
    List,
    /// Add a factory and print a token with which its connector enrols.
    Add {
        /// Its id: letters, digits, `_` and `-`.
        factory: String,
        /// The organisation it belongs to; made where it is not known.
        #[arg(long)]
        organisation: String,
        /// Name for people; the id by default.
        #[arg(long)]
        name: Option<String>,
    },
    /// Print a new enrolment token for a factory.
    Token {
        /// Id of the factory.
        factory: String,
    },
    /// Remove a factory that is in no collaboration any more.
    Remove {
        factory: FactoryId,
        /// Say what would end and what is in force, and remove nothing.
        #[arg(long)]
        dry_run: bool,
    },
}

pub(super) async fn run(command: FactoryCommand, config: &PlatformConfig) -> anyhow::Result<()> {
    match command {
        FactoryCommand::List => list(config).await,
        FactoryCommand::Add { factory, organisation, name } => {
            administration::add_factory(config, &factory, &organisation, name).await
        }
        FactoryCommand::Token { factory } => administration::print_token(config, &factory).await,
        FactoryCommand::Remove { factory, dry_run } => {
            removal::remove(config, "removeFactory", &Leaver::Factory(factory), dry_run).await
        }
    }
}

async fn list(config: &PlatformConfig) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.read().await?;
    for each in work.factories().list(&Scope::Platform).await? {
        let state = if each.enrolled_at.is_some() { "enrolled" } else { "not enrolled" };
        print(&format!("{}\t{}\t{}\t{state}", each.factory_id, each.organisation_id, each.name))?;
    }
    Ok(())
}

//! `platform organisation`.

use asi_model::OrganisationId;
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
pub(super) enum OrganisationCommand {
    /// List the organisations: id and name.
    List,
    /// Add an organisation.
    Add {
        /// Its id: letters, digits, `_` and `-`.
        organisation: String,
        /// Name for people; the id by default.
        #[arg(long)]
        name: Option<String>,
    },
    /// Remove an organisation of which nothing is left in force, with its people.
    Remove {
        organisation: OrganisationId,
        /// Say what would end and what is in force, and remove nothing.
        #[arg(long)]
        dry_run: bool,
    },
}

pub(super) async fn run(
    command: OrganisationCommand,
    config: &PlatformConfig,
) -> anyhow::Result<()> {
    match command {
        OrganisationCommand::List => list(config).await,
        OrganisationCommand::Add { organisation, name } => {
            administration::add_organisation(config, &organisation, name).await?;
            print(&format!("organisations/{organisation} is added."))
        }
        OrganisationCommand::Remove { organisation, dry_run } => {
            let leaver = Leaver::Organisation(organisation);
            removal::remove(config, "removeOrganisation", &leaver, dry_run).await
        }
    }
}

async fn list(config: &PlatformConfig) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.read().await?;
    for each in work.organisations().list(&Scope::Platform).await? {
        print(&format!("{}\t{}", each.organisation_id, each.name))?;
    }
    Ok(())
}

//! `platform user`.

use asi_model::OrganisationId;
use clap::{Args, Subcommand};
use platform::{
    config::PlatformConfig,
    store::{Leaver, Role},
};

use super::{
    administration::{self, open},
    output::print,
    removal,
};

#[derive(Debug, Subcommand)]
pub(super) enum UserCommand {
    /// List the people who may sign in: name, role and organisation.
    List,
    /// Add or change a user; the password is read from standard input.
    Set(SetUser),
    /// Remove a person: the sessions end. The last administrator stays.
    Remove {
        /// The name that the person signs in with.
        user: String,
        /// Say what would end and what is in force, and remove nothing.
        #[arg(long)]
        dry_run: bool,
    },
}

/// A user to add or change.
#[derive(Debug, Args)]
pub(super) struct SetUser {
    /// The name to sign in with.
    user: String,
    /// ADMINISTRATOR, PLANNER or VIEWER.
    #[arg(long)]
    role: Role,
    /// Organisation for which the user looks and acts; made where it is not known.
    #[arg(long)]
    organisation: Option<String>,
}

pub(super) async fn run(command: UserCommand, config: &PlatformConfig) -> anyhow::Result<()> {
    match command {
        UserCommand::List => list(config).await,
        UserCommand::Set(user) => {
            administration::set_user(config, user.user, user.role, user.organisation).await
        }
        UserCommand::Remove { user, dry_run } => {
            removal::remove(config, "removeUser", &Leaver::User(user), dry_run).await
        }
    }
}

async fn list(config: &PlatformConfig) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.read().await?;
    for each in work.users().list().await? {
        let organisation = each.organisation_id.as_ref().map_or("-", OrganisationId::as_str);
        print(&format!("{}\t{}\t{organisation}", each.user_name, each.role))?;
    }
    Ok(())
}

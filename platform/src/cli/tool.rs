//! `platform tool`.

use anyhow::Context;
use asi_model::{OrganisationId, ToolId};
use clap::Subcommand;
use platform::{
    audit::MachineUser,
    clock::Clock,
    config::PlatformConfig,
    enrolment::make_tool_credential,
    store::{AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Leaver, Scope, Tool},
};

use super::{
    administration::open,
    output::{note, print},
    removal,
};

#[derive(Debug, Subcommand)]
pub(super) enum ToolCommand {
    /// List the tools: id, organisation and name.
    List,
    /// Add a tool of an organisation and print its password at the broker.
    Add {
        /// Its id: letters, digits, `_` and `-`.
        tool: ToolId,
        /// The organisation it belongs to.
        #[arg(long)]
        organisation: OrganisationId,
        /// Name for people; the id by default.
        #[arg(long)]
        name: Option<String>,
    },
    /// Print a new password for a tool at the broker; the newest two are alive.
    Credential { tool: ToolId },
    /// Remove a tool: its credentials end, and it gets no more reports.
    Remove {
        tool: ToolId,
        /// Say what would end and what is in force, and remove nothing.
        #[arg(long)]
        dry_run: bool,
    },
}

pub(super) async fn run(command: ToolCommand, config: &PlatformConfig) -> anyhow::Result<()> {
    match command {
        ToolCommand::List => list(config).await,
        ToolCommand::Add { tool, organisation, name } => {
            add(config, tool.clone(), organisation, name).await?;
            print_credential(config, tool).await
        }
        ToolCommand::Credential { tool } => print_credential(config, tool).await,
        ToolCommand::Remove { tool, dry_run } => {
            removal::remove(config, "removeTool", &Leaver::Tool(tool), dry_run).await
        }
    }
}

async fn list(config: &PlatformConfig) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.read().await?;
    for each in work.tools().list(&Scope::Platform).await? {
        print(&format!("{}\t{}\t{}", each.tool_id, each.organisation_id, each.name))?;
    }
    Ok(())
}

async fn add(
    config: &PlatformConfig,
    tool_id: ToolId,
    organisation_id: OrganisationId,
    name: Option<String>,
) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.begin(MachineUser::of_process(), "addTool").await?;
    anyhow::ensure!(
        work.organisations().exists(&organisation_id).await?,
        "there is no organisation {organisation_id}; `platform organisation add` adds one"
    );
    let name = name.unwrap_or_else(|| tool_id.to_string());
    let tool = Tool { tool_id, organisation_id, name, created_at: Clock::system().now() };
    anyhow::ensure!(work.tools().add(&tool).await?, "the id {} is in use, or was", tool.tool_id);
    work.describe([AuditFact::new(AuditFactKind::Organisation, &tool.organisation_id)]);
    Ok(work.commit(subject(&tool), AuditOutcome::Done).await?)
}

async fn print_credential(config: &PlatformConfig, id: ToolId) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.begin(MachineUser::of_process(), "makeToolCredential").await?;
    let known = work.tools().lookup(&Scope::Platform, &id).await?;
    let known =
        known.with_context(|| format!("there is no tool {id}; `platform tool add` adds one"))?;
    let made = make_tool_credential(&mut work, config, id, Clock::system().now()).await?;
    work.commit(subject(&known), AuditOutcome::Done).await?;
    print(made.secret.expose())?;
    note(&format!(
        "This is the password of {} at the broker, shown this once. A platform that runs lets it in when it is started \
         again.",
        made.holder.user_name()
    ))
}

fn subject(tool: &Tool) -> AuditSubject {
    AuditSubject::of(&tool.organisation_id, format!("tools/{}", tool.tool_id))
}

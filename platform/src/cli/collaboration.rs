//! `platform collaboration`.

use anyhow::Context;
use asi_model::{CollaborationId, FactoryId, OrganisationId};
use clap::Subcommand;
use platform::{
    audit::MachineUser,
    clock::Clock,
    config::PlatformConfig,
    store::{
        AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Collaboration, Factory, Leaver,
        Scope, Work,
    },
};

use super::{administration::open, output::print, removal};

#[derive(Debug, Subcommand)]
pub(super) enum CollaborationCommand {
    /// List the collaborations: id, name, members and factories.
    List,
    /// Add a collaboration of organisations and their factories.
    Add {
        /// Its id: letters, digits, `_` and `-`.
        collaboration: CollaborationId,
        /// Name for people; the id by default.
        #[arg(long)]
        name: Option<String>,
        /// An organisation that takes part; once for each.
        #[arg(long = "member")]
        members: Vec<OrganisationId>,
        /// A factory that takes part; once for each.
        #[arg(long = "factory")]
        factories: Vec<FactoryId>,
    },
    /// Remove a collaboration of which every network is withdrawn.
    Remove {
        collaboration: CollaborationId,
        /// Say what would end and what is in force, and remove nothing.
        #[arg(long)]
        dry_run: bool,
    },
    /// Let an organisation take part.
    AddMember { collaboration: CollaborationId, organisation: OrganisationId },
    /// Let a factory take part.
    AddFactory { collaboration: CollaborationId, factory: FactoryId },
    /// Take a member out of which nothing is in force there.
    RemoveMember {
        collaboration: CollaborationId,
        organisation: OrganisationId,
        /// Say what would end and what is in force, and remove nothing.
        #[arg(long)]
        dry_run: bool,
    },
    /// Take a factory out that performs nothing there.
    RemoveFactory {
        collaboration: CollaborationId,
        factory: FactoryId,
        /// Say what would end and what is in force, and remove nothing.
        #[arg(long)]
        dry_run: bool,
    },
}

pub(super) async fn run(
    command: CollaborationCommand,
    config: &PlatformConfig,
) -> anyhow::Result<()> {
    match command {
        CollaborationCommand::List => list(config).await,
        CollaborationCommand::Add { collaboration, name, members, factories } => {
            let name = name.unwrap_or_else(|| collaboration.to_string());
            let created_at = Clock::system().now();
            let collaboration_id = collaboration;
            add(config, Collaboration { collaboration_id, name, created_at, members, factories })
                .await
        }
        CollaborationCommand::Remove { collaboration, dry_run } => {
            let leaver = Leaver::Collaboration(collaboration);
            removal::remove(config, "removeCollaboration", &leaver, dry_run).await
        }
        CollaborationCommand::AddMember { collaboration, organisation } => {
            add_member(config, &collaboration, &organisation).await
        }
        CollaborationCommand::AddFactory { collaboration, factory } => {
            add_factory(config, &collaboration, &factory).await
        }
        CollaborationCommand::RemoveMember { collaboration, organisation, dry_run } => {
            let leaver = Leaver::Member(collaboration, organisation);
            removal::remove(config, "removeMember", &leaver, dry_run).await
        }
        CollaborationCommand::RemoveFactory { collaboration, factory, dry_run } => {
            let leaver = Leaver::CollaborationFactory(collaboration, factory);
            removal::remove(config, "removeCollaborationFactory", &leaver, dry_run).await
        }
    }
}

async fn list(config: &PlatformConfig) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.read().await?;
    for each in work.collaborations().list(&Scope::Platform).await? {
        let (members, factories) = (joined(&each.members), joined(&each.factories));
        print(&format!("{}\t{}\t{members}\t{factories}", each.collaboration_id, each.name))?;
    }
    Ok(())
}

fn joined(ids: &[impl ToString]) -> String {
    ids.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

async fn add(config: &PlatformConfig, collaboration: Collaboration) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.begin(MachineUser::of_process(), "addCollaboration").await?;
    for member in &collaboration.members {
        check_organisation(&mut work, member).await?;
    }
    for factory in &collaboration.factories {
        lookup_factory(&mut work, factory).await?;
    }
    let id = &collaboration.collaboration_id;
    anyhow::ensure!(
        work.collaborations().add(&collaboration).await?,
        "the id {id} is in use, or was"
    );
    let member = |id| AuditFact::new(AuditFactKind::Member, id);
    work.describe(collaboration.members.iter().map(member));
    let factory = |id| AuditFact::new(AuditFactKind::Factory, id);
    work.describe(collaboration.factories.iter().map(factory));
    let path = format!("collaborations/{id}");
    work.commit(AuditSubject::shared(&path), AuditOutcome::Done).await?;
    print(&format!("{path} is added."))
}

async fn add_member(
    config: &PlatformConfig,
    id: &CollaborationId,
    member: &OrganisationId,
) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.begin(MachineUser::of_process(), "addMember").await?;
    let is_new = !lookup(&mut work, id).await?.members.contains(member);
    check_organisation(&mut work, member).await?;
    work.collaborations().add_member(id, member).await?;
    let path = format!("collaborations/{id}/members/{member}");
    work.commit(AuditSubject::of(member, &path), AuditOutcome::of(is_new)).await?;
    print(&format!("{path} is added."))
}

async fn add_factory(
    config: &PlatformConfig,
    id: &CollaborationId,
    factory: &FactoryId,
) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.begin(MachineUser::of_process(), "addCollaborationFactory").await?;
    let is_new = !lookup(&mut work, id).await?.factories.contains(factory);
    let known = lookup_factory(&mut work, factory).await?;
    work.collaborations().add_factory(id, factory).await?;
    let path = format!("collaborations/{id}/factories/{factory}");
    let subject = AuditSubject::of(&known.organisation_id, &path);
    work.commit(subject, AuditOutcome::of(is_new)).await?;
    print(&format!("{path} is added."))
}

async fn lookup(work: &mut Work, id: &CollaborationId) -> anyhow::Result<Collaboration> {
    let known = work.collaborations().lookup(&Scope::Platform, id).await?;
    known.with_context(|| {
        format!("there is no collaboration {id}; `platform collaboration add` adds one")
    })
}

async fn check_organisation(work: &mut Work, id: &OrganisationId) -> anyhow::Result<()> {
    anyhow::ensure!(
        work.organisations().exists(id).await?,
        "there is no organisation {id}; `platform organisation add` adds one"
    );
    Ok(())
}

async fn lookup_factory(work: &mut Work, id: &FactoryId) -> anyhow::Result<Factory> {
    let known = work.factories().lookup(&Scope::Platform, id).await?;
    known.with_context(|| format!("there is no factory {id}; `platform factory add` adds one"))
}

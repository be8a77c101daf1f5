//! Commands on the platform's database. Run them while the platform is stopped, or restart it
//! afterwards: a running one learns of new factories through its API.

use std::{
    io::{BufRead, IsTerminal, Write},
    time::Duration,
};

use anyhow::Context;
use asi_model::{FactoryId, OrganisationId};
use daemon::{
    Confidential, data_directory,
    web::session::{PasswordHashing, PasswordPolicy},
};
use platform::{
    administrator,
    audit::{MachineUser, RecordingStore},
    clock::Clock,
    config::PlatformConfig,
    enrolment::{self, EnrolmentAddress},
    store::{
        AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Organisation, Role, Scope, Store,
        User, Work,
    },
};

use super::output::note;

/// Adds an organisation.
pub async fn add_organisation(
    config: &PlatformConfig,
    id: &str,
    name: Option<String>,
) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.begin(MachineUser::of_process(), "addOrganisation").await?;
    let is_new = put_organisation(&mut work, id, name).await?;
    let subject = AuditSubject::of(&id.parse()?, format!("organisations/{id}"));
    work.commit(subject, AuditOutcome::of(is_new)).await?;
    anyhow::ensure!(is_new, "there is an organisation {id} already");
    Ok(())
}

/// Adds a factory and prints a token.
pub async fn add_factory(
    config: &PlatformConfig,
    id: &str,
    organisation: &str,
    name: Option<String>,
) -> anyhow::Result<()> {
    let store = open(config).await?;
    let factory: FactoryId = id.parse()?;
    let mut work = store.begin(MachineUser::of_process(), "addFactory").await?;
    let is_new_organisation = put_organisation(&mut work, organisation, None).await?;
    let name = name.unwrap_or_else(|| id.to_owned());
    let is_new = work
        .factories()
        .add(&factory, &organisation.parse()?, &name, Clock::system().now())
        .await?;
    // Nothing is committed then, nor an organisation made for it.
    anyhow::ensure!(
        is_new,
        "there is a factory {id} already; `platform factory token {id}` makes a token for it"
    );
    if is_new_organisation {
        let made =
            AuditSubject::of(&organisation.parse()?, format!("organisations/{organisation}"));
        work.record_also(&made, &[]).await?;
    }
    work.describe([AuditFact::new(AuditFactKind::Organisation, organisation)]);
    let subject = AuditSubject::of(&organisation.parse()?, format!("factories/{id}"));
    work.commit(subject, AuditOutcome::Done).await?;
    print_token(config, id).await
}

/// Prints a new enrolment token.
pub async fn print_token(config: &PlatformConfig, id: &str) -> anyhow::Result<()> {
    let store = open(config).await?;
    let factory: FactoryId = id.parse()?;
    let mut work = store.begin(MachineUser::of_process(), "makeEnrolmentToken").await?;
    let known = work.factories().lookup(&Scope::Platform, &factory).await?;
    let known = known
        .with_context(|| format!("there is no factory {id}; `platform factory add` adds one"))?;
    let public_url = config.web.public_url.clone().unwrap_or_else(|| {
        let scheme = if config.web.tls.is_some() { "https" } else { "http" };
        format!("{scheme}://{}", config.web.listen)
    });
    let lifetime = Duration::from_secs(u64::from(config.retention.enrolment_token_hours) * 3600);
    let address = EnrolmentAddress::new(&config.web, public_url)?;
    let now = Clock::system().now();
    let token = enrolment::make_token(&mut work, &factory, &address, now, lifetime).await?;
    let subject = AuditSubject::of(&known.organisation_id, format!("factories/{id}"));
    work.commit(subject, AuditOutcome::Done).await?;
    let mut out = std::io::stdout();
    writeln!(out, "{}", token.token.expose())?;
    writeln!(
        std::io::stderr(),
        "Give this token to `factory-connector enrol` on standard input before {}.",
        token.expires_at
    )?;
    if let Some(note) = config.web.unpinned_tokens() {
        writeln!(std::io::stderr(), "{note}")?;
    }
    Ok(())
}

/// Adds or changes a user; the password is one line of standard input. A second factor is removed, passkeys
/// included: this is the way back for an administrator who has lost it.
pub async fn set_user(
    config: &PlatformConfig,
    user_name: String,
    role: Role,
    organisation: Option<String>,
) -> anyhow::Result<()> {
    let store = open(config).await?;
    if std::io::stdin().is_terminal() {
        note("type the password and press Enter; it is shown as you type")?;
    }
    let mut line = String::new();
    std::io::stdin()
        .lock()
        .read_line(&mut line)
        .context("reading the password from standard input")?;
    let password: Confidential<String> = line.trim_end_matches(['\r', '\n']).into();
    let organisation_id: Option<OrganisationId> = organisation.map(|id| id.parse()).transpose()?;
    let user = User { user_name, role, organisation_id };
    let hash = PasswordHashing::default().hash(password, PasswordPolicy::default()).await?;
    let mut work = store.begin(MachineUser::of_process(), "putUser").await?;
    administrator::put(&mut work, &user, &hash, Clock::system().now()).await?;
    let had_codes = work.second_factors().remove(&user.user_name).await?;
    if work.passkeys().remove_all(&user.user_name).await? || had_codes {
        work.describe([AuditFact::new(AuditFactKind::SecondFactor, "REMOVED")]);
    }
    Ok(work.commit(administrator::subject(&user), AuditOutcome::Done).await?)
}

/// Opens the database, whose changes go on record.
pub(super) async fn open(config: &PlatformConfig) -> anyhow::Result<RecordingStore> {
    data_directory::create(&config.data_directory, config.allow_shared_data_directory)?;
    let store = Store::open(&config.database_path()).await?;
    Ok(RecordingStore::new(store, Clock::system()))
}

async fn put_organisation(work: &mut Work, id: &str, name: Option<String>) -> anyhow::Result<bool> {
    let organisation = Organisation {
        organisation_id: id.parse()?,
        name: name.unwrap_or_else(|| id.to_owned()),
        created_at: Clock::system().now(),
    };
    Ok(work.organisations().add(&organisation).await?)
}

#[cfg(test)]
mod tests {
    use platform::store::AuditAgent;

    use super::*;

    #[tokio::test]
    async fn a_factory_that_is_refused_leaves_no_organisation_behind() {
        let folder = tempfile::tempdir().expect("a folder");
        let data_directory = folder.path().join("data");
        let config = PlatformConfig { data_directory, ..PlatformConfig::default() };
        add_factory(&config, "F1", "first", None).await.expect("added");
        let refusal = add_factory(&config, "F1", "second", None).await.expect_err("refused");
        assert!(refusal.to_string().contains("platform factory token F1"), "{refusal}");

        let store = open(&config).await.expect("a store");
        let mut work = store.read().await.expect("begun");
        let is_made = work.organisations().exists(&"second".parse().expect("an id")).await;
        assert!(!is_made.expect("read"));
        let entries = work.audit().list_after(&Scope::Platform, 0, 100).await.expect("listed");
        let lines = entries.iter().map(|entry| format!("{} {}", entry.operation, entry.subject));
        assert_eq!(
            lines.collect::<Vec<_>>(),
            [
                "addFactory organisations/first",
                "addFactory factories/F1",
                "makeEnrolmentToken factories/F1"
            ]
        );
        let uid = AuditAgent::from(MachineUser::of_process()).name;
        assert!(entries.iter().all(|entry| entry.agent_name.as_ref() == Some(&uid)));
    }
}

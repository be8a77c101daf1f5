//! Commands on the platform's database. Run them while the platform is stopped, or restart it
//! afterwards: a running one learns of new factories through its API.

use std::{
    io::{BufRead, Write},
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
    audit::{CommandLine, RecordingStore},
    clock::Clock,
    config::PlatformConfig,
    enrolment::{self, EnrolmentAddress},
    store::{
        AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Organisation, Role, Scope, Store,
        User, Work,
    },
};

/// Adds an organisation.
pub async fn add_organisation(
    config: &PlatformConfig,
    id: &str,
    name: Option<String>,
) -> anyhow::Result<()> {
    let store = open(config).await?;
    let mut work = store.begin(CommandLine, "addOrganisation").await?;
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
    let mut work = store.begin(CommandLine, "addFactory").await?;
    put_organisation(&mut work, organisation, None).await?;
    let name = name.unwrap_or_else(|| id.to_owned());
    let is_new = work
        .factories()
        .add(&factory, &organisation.parse()?, &name, Clock::system().now())
        .await?;
    let subject = AuditSubject::of(&organisation.parse()?, format!("factories/{id}"));
    if is_new {
        work.describe([AuditFact::new(AuditFactKind::Organisation, organisation)]);
    }
    work.commit(subject, AuditOutcome::of(is_new)).await?;
    anyhow::ensure!(
        is_new,
        "there is a factory {id} already; `platform factory token {id}` makes a token for it"
    );
    print_token(config, id).await
}

/// Prints a new enrolment token.
pub async fn print_token(config: &PlatformConfig, id: &str) -> anyhow::Result<()> {
    let store = open(config).await?;
    let factory: FactoryId = id.parse()?;
    let mut work = store.begin(CommandLine, "makeEnrolmentToken").await?;
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
    let mut line = String::new();
    std::io::stdin()
        .lock()
        .read_line(&mut line)
        .context("reading the password from standard input")?;
    let password: Confidential<String> = line.trim_end_matches(['\r', '\n']).into();
    let organisation_id: Option<OrganisationId> = organisation.map(|id| id.parse()).transpose()?;
    let user = User { user_name, role, organisation_id };
    let hash = PasswordHashing::default().hash(password, PasswordPolicy::default()).await?;
    let mut work = store.begin(CommandLine, "putUser").await?;
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

//! The first administrator, with the configured password or a generated one; there is no default
//! password.

use std::path::PathBuf;

use asi_model::{DateTime, OrganisationId};
use daemon::{
    Confidential,
    web::session::{HashingError, PasswordHash, PasswordHashing, PasswordPolicy, random_token},
};

use crate::{
    audit::{CommandLine, RecordedWork, RecordingStore},
    certificates::{CertificateError, write},
    config::{AdminConfig, PlatformConfig},
    store::{
        AuditFact, AuditFactKind, AuditOutcome, AuditSubject, Organisation, Role, StoreError, User,
    },
};

/// Failure to create the administrator.
#[derive(Debug, thiserror::Error)]
pub enum AdministratorError {
    /// The name was that of a person who has left; the record of who did what names people by it.
    #[error("a person who has left had the name {0}, which is never given again: choose another")]
    NameWasUsed(String),
    /// The password is refused.
    #[error("the password is not taken")]
    Password(#[from] HashingError),
    /// The password cannot be written down.
    #[error("the password cannot be written down")]
    Write(#[from] CertificateError),
    /// The administrator could not be looked up or stored.
    #[error("the store failed")]
    Store(#[from] StoreError),
}

/// Returns the path of the file with the generated password.
#[must_use]
pub fn password_path(config: &PlatformConfig) -> PathBuf {
    config.data_directory.join("admin-password.txt")
}

/// Creates the configured administrator where it differs from the one stored, or one with a made-up
/// password where there is no user at all.
///
/// # Errors
/// [`AdministratorError`].
pub async fn ensure(
    store: &RecordingStore,
    config: &PlatformConfig,
    hashing: &PasswordHashing,
    now: DateTime,
) -> Result<(), AdministratorError> {
    let admin = &config.admin;
    let (count, known, has_left) = {
        let mut work = store.read().await?;
        let name = &admin.user_name;
        let known = work.users().lookup(name).await?;
        (work.users().count().await?, known, work.users().has_left(name).await?)
    };
    if has_left {
        if is_missed(admin, count) {
            tracing::warn!(
                user = admin.user_name,
                "The configured administrator has left and is not made again: name another one in the configuration, or \
                 remove it there."
            );
        }
        return Ok(());
    }
    let user = User {
        user_name: admin.user_name.clone(),
        role: Role::Administrator,
        organisation_id: admin.organisation_id.clone(),
    };
    let password = match (&admin.password, count) {
        // The configured password is the one in force; storing it again would end all
        // sessions for nothing.
        (Some(password), _) => {
            if let Some((stored, hash)) = known
                && stored == user
                && hashing.verify(Some(hash), password.clone()).await?
            {
                return Ok(());
            }
            password.clone()
        }
        (None, 0) => {
            let generated: Confidential<String> = random_token().into();
            let path = password_path(config);
            write(&path, format!("{}\n", generated.expose()).as_bytes(), 0o600)?;
            tracing::warn!(
                path = %path.display(), user = admin.user_name,
                "The first administrator has a generated password; read it in this file, set another one, remove the file."
            );
            generated
        }
        (None, _) => return Ok(()),
    };
    let hash = hashing.hash(password, PasswordPolicy::default()).await?;
    let mut work = store.begin(CommandLine, "putUser").await?;
    put(&mut work, &user, &hash, now).await?;
    Ok(work.commit(subject(&user), AuditOutcome::Done).await?)
}

/// Returns true where an administrator who has left would have been made: with a password that is configured, or where
/// there is no user at all. The default name alone names nobody.
const fn is_missed(admin: &AdminConfig, users: i64) -> bool {
    admin.password.is_some() || users == 0
}

/// Returns a user as the subject of a change.
#[must_use]
pub fn subject(user: &User) -> AuditSubject {
    let path = format!("users/{}", user.user_name);
    AuditSubject { path, concerned: user.organisation_id.clone() }
}

/// Adds or changes a user; an organisation that is not known yet is made. The entry says what the user was and is.
///
/// # Errors
/// [`AdministratorError`].
pub async fn put(
    work: &mut RecordedWork,
    user: &User,
    hash: &PasswordHash,
    now: DateTime,
) -> Result<(), AdministratorError> {
    if let Some(id) = &user.organisation_id {
        let organisation =
            Organisation { organisation_id: id.clone(), name: name_of(id), created_at: now };
        work.organisations().add(&organisation).await?;
    }
    let former = work.users().lookup(&user.user_name).await?.map(|(former, _)| former);
    if work.users().has_left(&user.user_name).await? {
        return Err(AdministratorError::NameWasUsed(user.user_name.clone()));
    }
    work.users().put(user, hash, now).await?;
    work.describe(facts(former.as_ref(), user));
    if let Some(former) = former
        && former.organisation_id.is_some()
        && former.organisation_id != user.organisation_id
    {
        // The organisation that it leaves sees so, and not where it goes.
        let role = AuditFact::ended(AuditFactKind::Role, former.role);
        work.record_also(&subject(&former), &[role]).await?;
    }
    Ok(())
}

fn facts(former: Option<&User>, user: &User) -> impl Iterator<Item = AuditFact> + use<> {
    let role =
        AuditFact::changed(AuditFactKind::Role, former.map(|former| former.role), Some(user.role));
    let organisation = AuditFact::changed(
        AuditFactKind::Organisation,
        former.and_then(|former| former.organisation_id.as_ref()),
        user.organisation_id.as_ref(),
    );
    let password = AuditFact::new(AuditFactKind::Password, "SET");
    [role, organisation, Some(password)].into_iter().flatten()
}

fn name_of(id: &OrganisationId) -> String {
    id.as_str().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_default_administrator_who_has_left_is_missed_where_nobody_else_signs_in() {
        let default = AdminConfig::default();
        let configured = AdminConfig {
            password: Some("a long password".to_owned().into()),
            ..AdminConfig::default()
        };
        assert!(!is_missed(&default, 3), "nothing in the configuration names it");
        assert!(is_missed(&default, 0));
        assert!(is_missed(&configured, 3), "the configuration wants it back");
    }
}

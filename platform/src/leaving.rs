//! The end of people, programs, plants, organisations and collaborations on the platform, with what the record says of it.

use asi_model::DateTime;

use crate::{
    audit::RecordedWork,
    store::{
        AuditFact, AuditFactKind, AuditSubject, Leaver, RemovalEffects, Scope, StoreError, Work,
    },
};

/// Lets it leave within a unit of work, whose entry says what was and what ends. What is in force was
/// refused before.
///
/// # Errors
/// [`StoreError`].
pub async fn leave(
    work: &mut RecordedWork,
    leaver: &Leaver,
    subject: &AuditSubject,
    effects: &RemovalEffects,
    now: DateTime,
) -> Result<(), StoreError> {
    let facts = facts(work, leaver, subject, effects).await?;
    work.describe(facts);
    work.removals().leave(leaver, now).await
}

/// Returns what of a removal its path does not say.
async fn facts(
    work: &mut Work,
    leaver: &Leaver,
    subject: &AuditSubject,
    removal: &RemovalEffects,
) -> Result<Vec<AuditFact>, StoreError> {
    let mut facts = Vec::new();
    match leaver {
        Leaver::User(name) => {
            let user = work.users().lookup(name).await?;
            facts.extend(user.map(|(user, _)| AuditFact::ended(AuditFactKind::Role, user.role)));
        }
        Leaver::Organisation(_) => {
            let person = |name| AuditFact::ended(AuditFactKind::Person, name);
            facts.extend(removal.people.iter().map(person));
        }
        Leaver::Tool(_) | Leaver::Factory(_) => {
            facts.push(AuditFact::ended(AuditFactKind::Credentials, removal.credentials));
        }
        Leaver::Collaboration(id) => {
            if let Some(ended) = work.collaborations().lookup(&Scope::Platform, id).await? {
                let member = |id| AuditFact::ended(AuditFactKind::Member, id);
                facts.extend(ended.members.iter().map(member));
                let factory = |id| AuditFact::ended(AuditFactKind::Factory, id);
                facts.extend(ended.factories.iter().map(factory));
            }
        }
        Leaver::Member(..) | Leaver::CollaborationFactory(..) => {}
    }
    let organisation = |id| AuditFact::ended(AuditFactKind::Organisation, id);
    facts.extend(subject.concerned.as_ref().map(organisation));
    Ok(facts)
}

//! Dead letters: of our own ingest, and of the embedded broker.

use asi_model::DateTime;
use axum::{Json, extract::State};
use bytes::Bytes;
use daemon::web::{ApiPath, ApiQuery, Problem, session::SignedIn};
use messaging::{ContentEncoding, Delivery, Envelope, LogicalAddress};
use serde::Serialize;
use utoipa::ToSchema;

use super::{
    administrator_only,
    page::{Page, PageQuery},
    problems::{ChangeProblems, ReadProblems},
};
use crate::{
    application::Application,
    principal::Principal,
    store::{AuditFact, AuditFactKind, AuditOutcome, AuditSubject},
};

/// A message that could not be used.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct DeadLetterView {
    /// `ingest-<number>` or `broker-<number>`.
    id: String,
    /// Logical address it was sent to.
    address: String,
    message_id: Option<String>,
    subject: Option<String>,
    /// A stable code, as `FORGED_PUBLISHER`.
    code: String,
    /// Reason in a sentence for people.
    reason: String,
    /// Time of the dead-lettering.
    at: DateTime,
    /// Size of the body.
    bytes: u64,
    /// Time of the last replay; absent before the first.
    replayed_at: Option<DateTime>,
}

/// Result of a replay.
#[derive(Serialize, ToSchema)]
#[serde(rename_all = "camelCase")]
pub struct Replayed {
    /// True if ingest accepted it this time, or if it waits in its queue again.
    is_taken: bool,
}

/// Lists dead letters, newest first; those of the embedded broker come with the first page. For
/// administrators.
#[utoipa::path(get, operation_id = "listDeadLetters", path = "/dead-letters", tag = "dead letters", security(("session" = [])), params(PageQuery),
    responses((status = 200, body = Page<DeadLetterView>), ReadProblems))]
pub async fn list(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiQuery(page): ApiQuery<PageQuery>,
) -> Result<Json<Page<DeadLetterView>>, Problem> {
    administrator_only::check(&who)?;
    let letters = app.store.read().await?.dead_letters().list(page.after(), page.limit()).await?;
    let own = letters.into_iter().map(|letter| DeadLetterView {
        id: format!("ingest-{}", letter.dead_letter_id),
        address: letter.address,
        message_id: letter.message_id,
        subject: Some(letter.subject),
        code: letter.code,
        reason: letter.reason,
        at: letter.received_at,
        bytes: letter.bytes,
        replayed_at: letter.replayed_at,
    });
    let mut view = Page::new(own.collect(), page.limit(), |letter| {
        letter.id.trim_start_matches("ingest-").to_owned()
    });
    if page.cursor.is_none()
        && let Some(broker) = app.broker_access.broker()
    {
        let letters = broker
            .dead_letters(0, page.limit())
            .await
            .map_err(|error| Problem::internal(&error))?;
        view.items.extend(letters.into_iter().map(|letter| DeadLetterView {
            id: format!("broker-{}", letter.id),
            address: letter.queue.to_string(),
            message_id: letter.message_id,
            subject: letter.subject,
            code: letter.code,
            reason: letter.reason,
            at: letter.at.into(),
            bytes: letter.bytes,
            replayed_at: None,
        }));
        view.items.sort_by_key(|letter| std::cmp::Reverse(letter.at));
    }
    Ok(Json(view))
}

/// Tries a dead letter again: one of ingest is taken as if it arrived now, one of the broker goes
/// back to its queue. One that a broker of another make set aside (`dead-letters`) stays as it is: that broker does not
/// say whose it was.
#[utoipa::path(post, operation_id = "replayDeadLetter", path = "/dead-letters/{deadLetterId}/replay", tag = "dead letters", security(("session" = [])),
    params(("deadLetterId" = String, Path)), responses((status = 200, body = Replayed), ChangeProblems))]
pub async fn replay(
    State(app): State<Application>,
    who: SignedIn<Principal>,
    ApiPath(id): ApiPath<String>,
) -> Result<Json<Replayed>, Problem> {
    administrator_only::check(&who)?;
    let not_found = || Problem::not_found(format_args!("dead letter {id}"));
    let (kind, number) = id.split_once('-').ok_or_else(not_found)?;
    let is_taken = match (kind, app.broker_access.broker()) {
        ("broker", Some(broker)) => {
            let number = number.parse().map_err(|_| not_found())?;
            // The broker's own store has it: what is on record here is that it was tried, before it is.
            let work = app.store.begin(&who.principal, "replayDeadLetter").await?;
            work.commit(subject_of(&id), AuditOutcome::Done).await?;
            let count = broker
                .replay_dead_letters(&[number])
                .await
                .map_err(|error| Problem::internal(&error))?;
            if count == 0 {
                return Err(not_found());
            }
            true
        }
        ("ingest", _) => replay_own(&app, &who.principal, number.parse().map_err(|_| not_found())?)
            .await?
            .ok_or_else(not_found)?,
        _ => return Err(not_found()),
    };
    Ok(Json(Replayed { is_taken }))
}

fn subject_of(id: &str) -> AuditSubject {
    AuditSubject::shared(format!("dead-letters/{id}"))
}

async fn replay_own(app: &Application, who: &Principal, id: u64) -> Result<Option<bool>, Problem> {
    let content = app.store.read().await?.dead_letters().content(id).await?;
    let Some(content) = content else { return Ok(None) };
    let Ok(address) = content.address.parse::<LogicalAddress>() else { return Ok(None) };
    if address == LogicalAddress::DeadLetters {
        return Ok(Some(false));
    }
    // It was seen before; without this it would be discarded as a repeat.
    let mut work = app.store.begin(who, "replayDeadLetter").await?;
    work.inbox()
        .forget_one(&address.to_string(), content.message_id.as_deref().unwrap_or_default())
        .await?;
    work.dead_letters().replayed(id, app.clock.now()).await?;
    work.describe([AuditFact::new(AuditFactKind::Address, &address)]);
    work.commit(subject_of(&format!("ingest-{id}")), AuditOutcome::Done).await?;
    let envelope = Envelope {
        message_id: content.message_id.and_then(|id| id.parse().ok()),
        subject: content.subject,
        content_type: "application/json".to_owned(),
        content_encoding: content
            .content_encoding
            .filter(|name| name == "gzip")
            .map(|_| ContentEncoding::Gzip),
        correlation_id: None,
        creation_time: None,
        ttl: None,
        replay: true,
        lease: None,
        signature: content.signature,
        body: Bytes::from(content.body),
    };
    let delivery = Delivery {
        envelope,
        is_redelivered: true,
        delivery_count: 0,
        received_at: app.clock.now().into(),
    };
    Ok(Some(app.ingest.replay(&address, delivery).await))
}

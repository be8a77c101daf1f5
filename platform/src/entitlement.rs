//! Entitlement: who may read a report is settled when it leaves the plant, and widened by the
//! factory alone.
//!
//! The factory says in the report to whom it released it; the platform's own list of recipients
//! narrows that, and nothing widens it. Reports of connectors that never named recipients are for those
//! to whom the factory had consented by then; once one did, a report without them is for nobody. A release of the past, which names reports of the
//! factory and one recipient, is the only thing that adds a reader afterwards.

use std::collections::{BTreeSet, HashMap};

use asi_model::{
    DateTime, FactoryId, OperationId, OrganisationId,
    difference::{ConsentEffect, difference},
    network::OperationNetwork,
};

use crate::store::{NetworkRow, Recipient, Scope, StoreError, Work};

/// Returns the organisations that may read a report: of the recipients in effect those that
/// `released_to` names, or, where the report names none, those whose consent is not younger than
/// the report.
#[must_use]
pub(crate) fn entitled(
    recipients: &[Recipient],
    released_to: Option<&[OrganisationId]>,
    reported_at: Option<DateTime>,
) -> BTreeSet<OrganisationId> {
    let is_entitled = |recipient: &&Recipient| match (released_to, reported_at) {
        (Some(list), _) => list.contains(&recipient.organisation_id),
        (None, Some(at)) => recipient.consented_at.is_some_and(|consented| consented <= at),
        (None, None) => false,
    };
    let entitled = recipients.iter().filter(is_entitled);
    entitled.map(|recipient| recipient.organisation_id.clone()).collect()
}

/// Prepares a revision that is about to replace the one in effect: notes which factory is asked for
/// what, and sets the fields that need a new consent back to pending.
///
/// # Errors
/// [`StoreError`].
pub(crate) async fn prepare_revision(work: &mut Work, row: &NetworkRow) -> Result<(), StoreError> {
    if row.withdrawn_at.is_some() {
        return Ok(());
    }
    let new = &row.network;
    let asked = owners(new);
    for (request, ..) in new.requests() {
        if let Some(factory) = asked.get(&request.operation_id) {
            work.asked_requests().add(&request, factory).await?;
        }
    }
    let before = work.networks().lookup(&Scope::Platform, &new.operation_network_id).await?;
    let Some(before) = before.filter(|before| before.withdrawn_at.is_none()) else { return Ok(()) };
    for field in difference(&before.network, new).fields {
        if field.consent == ConsentEffect::BackToPending {
            work.fields().reopen(&field.key).await?;
        }
    }
    // Another factory has decided about nothing yet.
    let were_asked = owners(&before.network);
    for (key, ..) in new.fields() {
        let operation = &key.request.operation_id;
        if were_asked.get(operation) != asked.get(operation) {
            work.fields().reopen(&key).await?;
        }
    }
    Ok(())
}

fn owners(network: &OperationNetwork) -> HashMap<&OperationId, &FactoryId> {
    let operations = network.operation_list.iter();
    operations
        .filter_map(|operation| {
            Some((&operation.operation_id, operation.owning_factory_id.as_ref()?))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: i64) -> DateTime {
        DateTime::from_unix_micros(seconds * 1_000_000)
    }

    fn organisations(ids: &[&str]) -> Vec<OrganisationId> {
        ids.iter().map(|id| id.parse().expect("an id")).collect()
    }

    fn check(released_to: Option<&[&str]>, reported_at: Option<i64>, expected: &[&str]) {
        let recipients: Vec<Recipient> = [("a", Some(1)), ("b", Some(5)), ("c", None)]
            .map(|(id, consented_at)| Recipient {
                organisation_id: id.parse().expect("an id"),
                consented_at: consented_at.map(at),
            })
            .to_vec();
        let released_to = released_to.map(organisations);
        let found = entitled(&recipients, released_to.as_deref(), reported_at.map(at));
        assert_eq!(found, organisations(expected).into_iter().collect());
    }

    #[test]
    fn what_a_report_says_is_narrowed_and_never_widened() {
        check(Some(&["a", "c", "former"]), Some(0), &["a", "c"]);
        check(Some(&[]), Some(9), &[]);
        check(Some(&["b"]), None, &["b"]);
    }

    #[test]
    fn a_report_that_names_nobody_is_for_those_of_an_older_consent() {
        check(None, Some(0), &[]);
        check(None, Some(4), &["a"]);
        check(None, Some(5), &["a", "b"]);
        check(None, None, &[]);
    }
}

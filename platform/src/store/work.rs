//! Units of work: one transaction, and the repositories that borrow it.

use sqlx::Transaction;

use super::{
    accesses::Accesses,
    asked_requests::AskedRequests,
    audit::AuditEntries,
    collaborations::Collaborations,
    comments::Comments,
    credentials::Credentials,
    database::{Connection, Database},
    dead_letters::DeadLetters,
    error::StoreError,
    factories::Factories,
    fields::Fields,
    inbox::InboxMessages,
    leases::Leases,
    ledger_logs::LedgerLogs,
    meta_data::MetaData,
    networks::Networks,
    organisations::Organisations,
    outgoing::OutgoingMessages,
    ownership::Ownership,
    parts::Parts,
    passkeys::Passkeys,
    past_releases::PastReleases,
    quotas::Quotas,
    recipient_sets::RecipientSets,
    recipients::Recipients,
    removals::Removals,
    reports::Reports,
    revocations::Revocations,
    revoked_access::RevokedAccess,
    second_factors::SecondFactors,
    signing_keys::SigningKeys,
    tools::Tools,
    users::Users,
    writers::Writers,
};

/// A unit of work. Dropped without [`Work::commit`], it has no effect.
#[derive(Debug)]
pub struct Work(Transaction<'static, Database>);

impl Work {
    pub(super) const fn new(transaction: Transaction<'static, Database>) -> Self {
        Self(transaction)
    }

    /// Makes the work permanent.
    ///
    /// # Errors
    /// [`StoreError::Statement`]; then the work has no effect.
    pub async fn commit(self) -> Result<(), StoreError> {
        self.0.commit().await.map_err(StoreError::during("commit"))
    }

    /// Returns the repository of what is kept, to hold it against quotas.
    pub fn quotas(&mut self) -> Quotas<'_> {
        Quotas(self.connection())
    }

    /// Returns the repository of access logs.
    pub fn accesses(&mut self) -> Accesses<'_> {
        Accesses(self.connection())
    }

    /// Returns the repository of requests with the factories that were asked.
    pub fn asked_requests(&mut self) -> AskedRequests<'_> {
        AskedRequests(self.connection())
    }

    /// Returns the repository of entries of who changed what.
    pub fn audit(&mut self) -> AuditEntries<'_> {
        AuditEntries(self.connection())
    }

    /// Returns the repository of collaborations and their members.
    pub fn collaborations(&mut self) -> Collaborations<'_> {
        Collaborations(self.connection())
    }

    /// Returns the repository of comments between partners.
    pub fn comments(&mut self) -> Comments<'_> {
        Comments(self.connection())
    }

    /// Returns the repository of signed receipts of revocations.
    pub fn revocations(&mut self) -> Revocations<'_> {
        Revocations(self.connection())
    }

    /// Enrolment tokens and broker credentials.
    pub fn credentials(&mut self) -> Credentials<'_> {
        Credentials(self.connection())
    }

    /// Dead letters of ingest.
    pub fn dead_letters(&mut self) -> DeadLetters<'_> {
        DeadLetters(self.connection())
    }

    /// Returns the repository of removals.
    pub fn removals(&mut self) -> Removals<'_> {
        Removals(self.connection())
    }

    /// Returns the repository of factories.
    pub fn factories(&mut self) -> Factories<'_> {
        Factories(self.connection())
    }

    /// Requested fields with decisions and current values.
    pub fn fields(&mut self) -> Fields<'_> {
        Fields(self.connection())
    }

    /// Received messages, for deduplication.
    pub fn inbox(&mut self) -> InboxMessages<'_> {
        InboxMessages(self.connection())
    }

    /// Leases on factories' identities.
    pub fn leases(&mut self) -> Leases<'_> {
        Leases(self.connection())
    }

    /// Returns the repository of the logs of factories' ledgers.
    pub fn ledger_logs(&mut self) -> LedgerLogs<'_> {
        LedgerLogs(self.connection())
    }

    /// Metadata of data set writers, and asset offers.
    pub fn meta_data(&mut self) -> MetaData<'_> {
        MetaData(self.connection())
    }

    /// Returns the repository of operation networks with their revisions.
    pub fn networks(&mut self) -> Networks<'_> {
        Networks(self.connection())
    }

    /// Returns the repository of organisations.
    pub fn organisations(&mut self) -> Organisations<'_> {
        Organisations(self.connection())
    }

    /// Returns the repository of messages that wait to be sent.
    pub fn outgoing(&mut self) -> OutgoingMessages<'_> {
        OutgoingMessages(self.connection())
    }

    /// Owners of networks and of what is in them.
    pub fn ownership(&mut self) -> Ownership<'_> {
        Ownership(self.connection())
    }

    /// Parts of networks, as sent to factories.
    pub fn parts(&mut self) -> Parts<'_> {
        Parts(self.connection())
    }

    /// Returns the repository of passkeys.
    pub fn passkeys(&mut self) -> Passkeys<'_> {
        Passkeys(self.connection())
    }

    /// Releases of reports to recipients that were added later.
    pub fn past_releases(&mut self) -> PastReleases<'_> {
        PastReleases(self.connection())
    }

    /// Returns the repository of the sets of organisations to whom reports were released.
    pub fn recipient_sets(&mut self) -> RecipientSets<'_> {
        RecipientSets(self.connection())
    }

    /// Returns the repository of recipients of requests.
    pub fn recipients(&mut self) -> Recipients<'_> {
        Recipients(self.connection())
    }

    /// Returns the repository of received reports.
    pub fn reports(&mut self) -> Reports<'_> {
        Reports(self.connection())
    }

    /// Returns the repository of planning tools.
    pub fn tools(&mut self) -> Tools<'_> {
        Tools(self.connection())
    }

    /// Returns the repository of second factors.
    pub fn second_factors(&mut self) -> SecondFactors<'_> {
        SecondFactors(self.connection())
    }

    /// Returns the repository of revoked access.
    pub fn revoked_access(&mut self) -> RevokedAccess<'_> {
        RevokedAccess(self.connection())
    }

    /// Returns the repository of the keys that sign for factories.
    pub fn signing_keys(&mut self) -> SigningKeys<'_> {
        SigningKeys(self.connection())
    }

    /// Returns the repository of users and their sessions.
    pub fn users(&mut self) -> Users<'_> {
        Users(self.connection())
    }

    /// Data set writers with received sequence numbers.
    pub fn writers(&mut self) -> Writers<'_> {
        Writers(self.connection())
    }

    pub(super) fn connection(&mut self) -> &mut Connection {
        &mut self.0
    }
}

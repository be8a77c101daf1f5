//! Bodies of requests, read as each operation reads its own, and judged by a state and the files of certificates: what
//! anybody with a session can send. For the fuzz target, and the test that replays its inputs.

use std::sync::Arc;

use asi_model::{DataValue, FieldKey, OrganisationId};
use axum::{
    body::Body,
    extract::{FromRequest as _, Request},
    http::header::CONTENT_TYPE,
};
use connector_state::{
    ConnectorState, DocumentError, queries,
    use_cases::{
        alliances, caps,
        decide::decide_as_shown,
        enter::{enter, enter_all},
        policies,
        revoke::{Revocation, revoke},
        rules,
    },
};
use daemon::web::{
    ApiJson, Problem,
    session::{
        NewPasskey, PasskeyBegin, PasskeyRemoval, PasswordChange, SecondFactorBegin,
        SecondFactorCode, SecondFactorRemoval, SignIn,
    },
};
use disclosure::{Alliance, Cap, DocumentId, GateOutcome, NamedPolicy, Rule, Statement};
use mapping_engine::{
    Mapping, Severity, exchange::MappingTemplate, mapping::LateValues, mapping::transform::compile,
};
use serde::de::DeserializeOwned;
use shop_floor::SourceConfig;
use twin::{ApplicationCertificate, TrustList};

use super::{
    application_certificate::{CertificateRequestBody, IssuedCertificateBody},
    client_certificates::{ClientTrustBody, TrustFileBody, blocking},
    comments::NewComment,
    documents::document_problem,
    dry_runs::DryRunBody,
    exchange::read_file,
    fields::{DecisionBody, EnteredValue, MappingDraft, complete, draft_text},
    ledger::logs::NewLogBody,
    mapping_import::nothing_imported,
    operator::entries::EntryDelivery,
    past::PastDecisionBody,
    policies::RecipientBody,
    preview::Draft,
    problems::{decision_problem, mapping_faults},
    revocations::RevocationBody,
    source_inquiry::DiscoveryBody,
    sources::{TrustBody, VariablesBody},
    templates::{self, Series, TemplateDraft},
    users::UserBody,
};
use crate::clock::now;

/// Ids of the operations with a body.
pub const OPERATIONS: [&str; 41] = [
    "signIn",
    "changePassword",
    "beginSecondFactor",
    "confirmSecondFactor",
    "removeSecondFactor",
    "beginPasskey",
    "addPasskey",
    "removePasskey",
    "putUser",
    "putAlliance",
    "putCap",
    "previewCap",
    "putPolicy",
    "previewPolicy",
    "putRecipientPolicy",
    "putRule",
    "previewRule",
    "installApplicationCertificate",
    "requestApplicationCertificate",
    "addClientCertificate",
    "trustClientCertificate",
    "trustSourceCertificate",
    "addSource",
    "changeSource",
    "decideField",
    "previewDecision",
    "startShadowMapping",
    "dryRunMapping",
    "makeMappingTemplate",
    "enterValue",
    "putMappingTemplate",
    "fillMappingTemplate",
    "importMappings",
    "addComment",
    "deliverOperatorEntries",
    "decidePast",
    "revokeConsents",
    "beginLedgerLog",
    "discoverSource",
    "testSource",
    "readSourceValues",
];

/// Person in whose name bodies are judged.
const PERSON: &str = "eva";

/// Reads bodies, and judges them by the parts of a connector that have no store.
pub struct BodyReader<'c> {
    pub state: &'c mut ConnectorState,
    /// Field that paths name.
    pub field: FieldKey,
    pub trust_list: &'c TrustList,
    pub certificate: &'c ApplicationCertificate,
}

impl BodyReader<'_> {
    /// Reads a body as an operation does; none for an operation without a body.
    pub async fn read(mut self, operation: &str, body: Vec<u8>) -> Option<Result<(), Problem>> {
        Some(match operation {
            "signIn" => of::<SignIn>(body).await.map(drop),
            "changePassword" => of::<PasswordChange>(body).await.map(drop),
            "beginSecondFactor" => of::<SecondFactorBegin>(body).await.map(drop),
            "confirmSecondFactor" => of::<SecondFactorCode>(body).await.map(drop),
            "removeSecondFactor" => of::<SecondFactorRemoval>(body).await.map(drop),
            "beginPasskey" => of::<PasskeyBegin>(body).await.map(drop),
            "addPasskey" => of::<NewPasskey>(body).await.and_then(|body| body.check_form()),
            "removePasskey" => of::<PasskeyRemoval>(body).await.map(drop),
            "putUser" => of::<UserBody>(body).await.map(drop),
            "putAlliance" | "putCap" | "previewCap" | "putPolicy" | "previewPolicy"
            | "putRecipientPolicy" | "putRule" | "previewRule" => {
                self.document(operation, body).await
            }
            "installApplicationCertificate"
            | "requestApplicationCertificate"
            | "addClientCertificate" => self.certificate(operation, body).await,
            "trustClientCertificate" => of::<ClientTrustBody>(body).await.map(drop),
            "trustSourceCertificate" => of::<TrustBody>(body).await.map(drop),
            "discoverSource" => of::<DiscoveryBody>(body).await.map(drop),
            "readSourceValues" => of::<VariablesBody>(body).await.and_then(|body| body.check()),
            "addSource" | "changeSource" | "testSource" => {
                of::<SourceConfig>(body).await.and_then(|source| {
                    serde_json::to_string(&source)
                        .map(drop)
                        .map_err(|error| Problem::internal(&error))
                })
            }
            "decideField"
            | "previewDecision"
            | "startShadowMapping"
            | "dryRunMapping"
            | "makeMappingTemplate"
            | "enterValue" => self.of_field(operation, body).await,
            "putMappingTemplate" => {
                of::<MappingTemplate>(body).await.and_then(|template| templates::check(&template))
            }
            "fillMappingTemplate" => {
                of::<Series>(body).await.and_then(|series| templates::members(series).map(drop))
            }
            "importMappings" => self.import(&body),
            "addComment" => of::<NewComment>(body).await.and_then(|new| new.check()),
            "deliverOperatorEntries" => {
                of::<EntryDelivery>(body).await.and_then(|delivery| self.deliver(delivery))
            }
            "decidePast" => of::<PastDecisionBody>(body).await.and_then(|it| it.root().map(drop)),
            "revokeConsents" => of::<RevocationBody>(body).await.and_then(|it| self.revoke(it)),
            "beginLedgerLog" => of::<NewLogBody>(body).await.and_then(|it| it.reason().map(drop)),
            _ => return None,
        })
    }

    /// Judges a policy, rule, alliance or cap.
    async fn document(&mut self, operation: &str, body: Vec<u8>) -> Result<(), Problem> {
        let id: DocumentId = "document".parse().expect("an id");
        let (state, at) = (&mut *self.state, now());
        match operation {
            "putAlliance" => {
                let alliance: Alliance = of(body).await?;
                alliances::put_alliance(state, &id, alliance, None, PERSON, at).map(drop)
            }
            "putCap" => {
                caps::put_cap(state, &id, of::<Cap>(body).await?, None, PERSON, at).map(drop)
            }
            "previewCap" => queries::cap_preview(state, &id, of::<Cap>(body).await?, at).map(drop),
            "putPolicy" => {
                let policy: NamedPolicy = of(body).await?;
                policies::put_policy(state, &id, policy, None, PERSON, at).map(drop)
            }
            "previewPolicy" => {
                let policy: NamedPolicy = of(body).await?;
                drop(queries::policy_changes(state, &id, &policy.disclosure));
                Ok(())
            }
            "putRecipientPolicy" => {
                let body: RecipientBody = of(body).await?;
                let recipient: OrganisationId = "acme".parse().expect("an id");
                let (policy, set) = (body.policy_id, policies::set_recipient_policy);
                set(state, &recipient, policy, None, PERSON, at).map(drop)
            }
            "putRule" => {
                rules::put_rule(state, &id, of::<Rule>(body).await?, None, PERSON, at).map(drop)
            }
            _ => {
                let rule: Rule = of(body).await?;
                let faults = rule.faults();
                if faults.is_empty() {
                    drop(queries::rule_preview(state, &rule, at));
                    Ok(())
                } else {
                    Err(DocumentError::Faults(faults))
                }
            }
        }
        .map_err(document_problem)
    }

    /// Judges a certificate, or a revocation list.
    async fn certificate(&self, operation: &str, body: Vec<u8>) -> Result<(), Problem> {
        match operation {
            "installApplicationCertificate" => {
                let content = of::<IssuedCertificateBody>(body).await?.content()?;
                let own = self.certificate.clone();
                blocking(move || own.install(&content, PERSON)).await.map(drop)
            }
            "requestApplicationCertificate" => {
                of::<CertificateRequestBody>(body).await?.check_names()
            }
            _ => {
                let list = self.trust_list.clone();
                of::<TrustFileBody>(body).await?.add_to(list, PERSON.to_owned()).await
            }
        }
    }

    /// Judges what is said of a field.
    async fn of_field(&mut self, operation: &str, body: Vec<u8>) -> Result<(), Problem> {
        match operation {
            "decideField" => {
                let mut body: DecisionBody = of(body).await?;
                let mapping = body.take_draft().map(|draft| self.checked(draft)).transpose()?;
                let request = body.request(mapping.map(Box::new), None, PERSON)?;
                let decided = decide_as_shown(self.state, &self.field, None, request, now());
                decided.map(drop).map_err(decision_problem)
            }
            "previewDecision" => self.preview(of(body).await?),
            "startShadowMapping" => self.checked(of(body).await?).map(drop),
            "dryRunMapping" => self.checked(of::<DryRunBody>(body).await?.mapping).map(drop),
            "makeMappingTemplate" => {
                let draft: TemplateDraft = of(body).await?;
                draft.check()?;
                let mapping = MappingDraft {
                    inputs: Vec::new(),
                    steps: Vec::new(),
                    late_values: LateValues::default(),
                };
                let mapping = complete(self.state, &self.field, mapping)?;
                let id = &draft.template_id;
                let made = MappingTemplate::from_mapping(id, &mapping, &draft.parameters);
                templates::check(&made)
            }
            _ => {
                let entry = of::<EnteredValue>(body).await?.entry(&self.field, PERSON);
                drop(enter(self.state, entry, now()));
                Ok(())
            }
        }
    }

    /// Runs a draft's policy over a value, as a preview does.
    fn preview(&self, draft: Draft) -> Result<(), Problem> {
        let Draft { value_source, mapping, disclosure, policy_id } = draft;
        drop(draft_text(value_source, mapping.as_ref(), &disclosure, policy_id.as_ref()));
        let field =
            self.state.field(&self.field).ok_or_else(|| Problem::not_found("such field"))?;
        let (policy, _) =
            queries::effective_policy(self.state, field, &disclosure, policy_id.as_ref());
        drop(Statement::of(&policy, field.definition().unit.as_deref()));
        let at = now();
        if let Some(mut gate) = queries::draft_gate(self.state, &self.field, policy, at) {
            let outcome = gate.on(at, DataValue::good(4711_u64, at));
            if outcome != GateOutcome::Suppressed {
                while let Some(due) = gate.due().filter(|_| gate.shown().is_none()) {
                    gate.on_time(due);
                }
            }
        }
        mapping.map_or(Ok(()), |mapping| self.checked(mapping).map(drop))
    }

    /// Completes a draft; a problem if it has errors.
    fn checked(&self, draft: MappingDraft) -> Result<Mapping, Problem> {
        let mapping = Arc::new(complete(self.state, &self.field, draft)?);
        compiles(&mapping)?;
        Ok(Arc::unwrap_or_clone(mapping))
    }

    /// Judges the mappings and templates of a file: a table unless it looks like JSON.
    fn import(&self, body: &[u8]) -> Result<(), Problem> {
        let file = read_file(body, !body.trim_ascii_start().starts_with(b"{"))?;
        let faults = templates::faults(&file.templates);
        if !faults.is_empty() {
            return Err(nothing_imported(faults));
        }
        for mapping in file.mappings {
            compiles(&Arc::new(mapping.clone()))?;
            if let Ok(mapping) = queries::validate_for_field(self.state, mapping)
                && queries::import_effect(self.state, &mapping).is_none()
            {
                return Err(Problem::not_found("such field"));
            }
        }
        Ok(())
    }

    fn deliver(&mut self, delivery: EntryDelivery) -> Result<(), Problem> {
        let entries = delivery.read(PERSON, now())?.entries;
        drop(enter_all(self.state, entries, now()));
        Ok(())
    }

    fn revoke(&mut self, body: RevocationBody) -> Result<(), Problem> {
        let (command, reason) = (body.command()?, body.reason.clone());
        let fields = body.fields_in(self.state);
        let revocation = Revocation { fields, command, reason, revoked_by: PERSON.to_owned() };
        revoke(self.state, &revocation, now()).map(drop).map_err(decision_problem)
    }
}

/// Extracts a body as a handler does.
async fn of<T: DeserializeOwned>(body: Vec<u8>) -> Result<T, Problem> {
    let request = Request::post("/").header(CONTENT_TYPE, "application/json");
    let request = request.body(Body::from(body)).map_err(|error| Problem::internal(&error))?;
    ApiJson::from_request(request, &()).await.map(|ApiJson(body)| body)
}

/// Returns the problem of a mapping that has errors.
fn compiles(mapping: &Arc<Mapping>) -> Result<(), Problem> {
    let (_, diagnostics) = compile(mapping);
    if diagnostics.iter().any(|found| found.severity == Severity::Error) {
        return Err(mapping_faults(diagnostics));
    }
    Ok(())
}

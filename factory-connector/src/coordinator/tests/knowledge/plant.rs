//! A plant with a clock of its own: state, store, spool and link adapter, as the coordinator's loop
//! runs them.

use asi_model::Variant;
use connector_state::{
    transaction,
    use_cases::{
        import_mappings::{MappingImport, import_mappings},
        keep_alive::keep_alives,
        policies::{put_policy, set_recipient_policy},
        revise::receive_network,
        validity,
        values::{self, FieldCandidate},
    },
};
use disclosure::{DocumentId, GateOutcome};

use super::{
    acts::{Act, Coming},
    below::differing,
    fields::{FIELDS, PARTNERS, network},
    knower::Knower,
    *,
};
use crate::coordinator::delivery_progress;

/// Salt of all reports, so that two plants make the same hashes.
const SALT: [u8; ::ledger::SALT_BYTES] = [7; ::ledger::SALT_BYTES];

/// Monday, 2027-01-11, 00:00 UTC.
pub(super) fn start() -> DateTime {
    DateTime::from_unix_micros(1_799_625_600_000_000)
}

/// Makes a twin that is never run: the plants only need its handle.
pub(super) fn twin(folder: &Path) -> (twin::Twin, twin::TwinHandle) {
    let config = twin::TwinConfig {
        listen: "127.0.0.1:0".parse().expect("an address"),
        pki_directory: folder.join("pki"),
        ..twin::TwinConfig::default()
    };
    let factory_id = "F".parse().expect("an id");
    twin::Twin::new(factory_id, config, Arc::new(Nobody), Arc::new(Nobody)).expect("a twin")
}

/// Amount of what an act did.
#[derive(Debug, Default)]
pub(super) struct Varied {
    /// Values for the other plant, which differ below the policy.
    pub(super) values: Vec<DataValue>,
    /// Number of those that differ.
    pub(super) count: usize,
    /// Number of reports that left.
    pub(super) reports: usize,
}

pub(super) struct Plant {
    pub(super) folder: TempDir,
    pub(super) work: UnitOfWork,
    pub(super) spool: ConnectorSpool,
    pub(super) now: DateTime,
    pub(super) revision: u64,
    /// Number of messages that the platform sent.
    pub(super) received: u128,
    pub(super) versions: [Option<u32>; 2],
    pub(super) recipient_versions: [Option<u32>; 3],
    pub(super) seen: Vec<String>,
}

impl Plant {
    pub(super) async fn open(twin: twin::TwinHandle) -> Self {
        let folder = file::folder();
        let (work, spool) = file::open(folder.path(), twin, start(), 0).await;
        let mut plant = Self {
            folder,
            work,
            spool,
            now: start(),
            revision: 0,
            received: 0,
            versions: [None; 2],
            recipient_versions: [None; 3],
            seen: Vec::new(),
        };
        plant.commit().await;
        plant.revise(0b11);
        plant.commit().await;
        plant
    }

    pub(super) async fn close(self) {
        self.work.store.close().await;
    }

    /// Takes everything that was to be seen since the last call.
    pub(super) fn take_seen(&mut self) -> Vec<String> {
        std::mem::take(&mut self.seen)
    }

    /// Plays an act. Values come as they are in it, or as given.
    pub(super) async fn act(
        mut self,
        act: &Act,
        knower: &mut Knower,
        values: Option<&[DataValue]>,
    ) -> (Self, Varied) {
        let mut varied = Varied::default();
        match act {
            Act::Values(coming) => varied = self.offer(coming, knower, values),
            Act::Send { is_receipted } => varied.reports = self.send(*is_receipted, knower).await,
            Act::Restart => {
                self = self.restarted().await;
                knower.restart();
            }
            Act::Wait(ms) => self.wait(*ms).await,
            Act::SetClockBack(ms) => {
                let former = self.now;
                self.now = earlier(former, *ms);
                knower.set_clock_back(former, self.now);
                values::set_clock_back(&mut self.work.state, self.now);
            }
            decision => self.decide(decision, knower),
        }
        self.commit().await;
        self.look();
        (self, varied)
    }

    fn offer(
        &mut self,
        coming: &[Coming],
        knower: &mut Knower,
        values: Option<&[DataValue]>,
    ) -> Varied {
        let values: Vec<DataValue> = match values {
            Some(values) => values.to_vec(),
            None => coming.iter().map(|coming| self.value(coming)).collect(),
        };
        let state = &self.work.state;
        let fields = coming.iter().map(|coming| state.field(&FIELDS[coming.field].key()));
        let fields: Vec<_> = fields.map(|field| field.expect("a field")).collect();
        let policies: Vec<_> =
            fields.iter().map(|field| Arc::clone(field.gate().policy())).collect();
        let candidates = fields.iter().zip(&values).map(|(field, value)| {
            let source = field.decision().value_source.unwrap_or(ValueSource::Manual);
            let version = field.target_key().version;
            FieldCandidate {
                field: field.id(),
                source,
                mapping_version: (source == ValueSource::Mapping).then_some(version),
                value: value.clone(),
                transform: None,
            }
        });
        let candidates = candidates.collect();
        knower.offer(coming.iter().map(|coming| coming.field).zip(&values), self.now);
        let outcomes = values::receive_candidates(&mut self.work.state, candidates, self.now);
        let mut varied = Varied::default();
        for (place, outcome) in outcomes.into_iter().enumerate() {
            let value = &values[place];
            let other = differing(coming[place].field, value, &policies[place], outcome);
            varied.count += usize::from(other.value != value.value || other.status != value.status);
            varied.values.push(other);
            self.seen.push(format!("outcome {}", outcome.is_some_and(is_released)));
        }
        varied
    }

    fn value(&self, coming: &Coming) -> DataValue {
        let other = FIELDS.len() - 1 - coming.field;
        let field = if coming.is_of_other_type { other } else { coming.field };
        DataValue {
            status: coming.status,
            ..DataValue::good(
                Variant::Scalar(FIELDS[field].scalar(coming.number)),
                earlier(self.now, coming.age_ms),
            )
        }
    }

    fn decide(&mut self, act: &Act, knower: &mut Knower) {
        let now = self.now;
        match act {
            Act::Open { field, source, policy } => {
                let of = &FIELDS[*field];
                let policy = policy.fitted_to(of.field_type, false);
                let (value_source, mapping) = match source {
                    0 => (ValueSource::Manual, None),
                    1 => (ValueSource::External, None),
                    number => (ValueSource::Mapping, Some(Box::new(mapping(*field, *number)))),
                };
                let command =
                    DecisionCommand::Map { value_source, mapping, policy: policy.clone() };
                if self.take(*field, command) {
                    knower.open(*field, *source, policy);
                }
            }
            Act::Close(field) => {
                if self.take(*field, DecisionCommand::LeavePending) {
                    knower.close(*field);
                }
            }
            Act::Import { field, mapping: number } => {
                let mapping = mapping(*field, number + 2);
                let import = MappingImport { mapping, author: "eve".to_owned(), note: None };
                let changes = import_mappings(&mut self.work.state, vec![import], now);
                self.work.pending.merge(changes.expect("there is no cap"));
                knower.import(*field, number + 2);
            }
            Act::Revise(bits) => {
                self.revise(*bits);
                let is_mapped = |field: &fields::FieldOf| {
                    let field = self.work.state.field(&field.key());
                    field.is_some_and(|field| field.decision().is_mapped())
                };
                knower.revise(*bits, FIELDS.each_ref().map(is_mapped));
            }
            other => self.set(other, knower),
        }
    }

    fn set(&mut self, act: &Act, knower: &mut Knower) {
        let now = self.now;
        match act {
            Act::Policy { name, policy } => {
                let document = json!({ "name": "n", "disclosure": policy });
                let document = serde_json::from_value(document).expect("a policy");
                let (id, expected) = (id_of(*name), self.versions[*name]);
                let put = put_policy(&mut self.work.state, &id, document, expected, "eve", now);
                if let Ok((version, changes)) = put {
                    self.versions[*name] = Some(version.version);
                    self.work.pending.merge(changes);
                    knower.name_policy(*name, policy);
                }
            }
            Act::Recipient { partner, name } => {
                let recipient = PARTNERS[*partner].parse().expect("an id");
                let (id, expected) = (name.map(id_of), self.recipient_versions[*partner]);
                let state = &mut self.work.state;
                let set = set_recipient_policy(state, &recipient, id, expected, "eve", now);
                if let Ok((version, changes)) = set {
                    self.recipient_versions[*partner] = Some(version);
                    self.work.pending.merge(changes);
                    knower.set_recipient(*partner, *name);
                }
            }
            _ => unreachable!("no decision: {act:?}"),
        }
    }

    fn take(&mut self, field: usize, command: DecisionCommand) -> bool {
        let (decided_by, basis) = ("eve".to_owned(), DecisionBasis::default());
        let request = DecisionRequest { command, reason: None, decided_by, basis };
        let decided = decide(&mut self.work.state, &FIELDS[field].key(), request, self.now);
        decided.map(|changes| self.work.pending.merge(changes)).is_ok()
    }

    fn revise(&mut self, bits: u8) {
        self.revision += 1;
        let json = network(self.revision, bits);
        let message = serde_json::from_value(json.clone()).expect("a network");
        let changes = receive_network(&mut self.work.state, message, json.to_string(), self.now);
        self.work.pending.merge(changes);
    }

    /// Waits. Whatever falls due is released in time.
    async fn wait(&mut self, ms: u32) {
        let end = self.now.after(Duration::from_millis(ms.into()));
        while let Some(due) = self.work.state.fields().next_deadline().filter(|due| *due <= end) {
            self.pass(due.max(self.now)).await;
        }
        self.pass(end).await;
        for message in keep_alives(&mut self.work.state, end) {
            let body = String::from_utf8_lossy(&message.body);
            self.seen.push(format!("keep-alive {} {body}", message.message_id));
        }
    }

    async fn pass(&mut self, at: DateTime) {
        self.now = at;
        let work = &mut self.work;
        validity::begin_requests(&mut work.state, at);
        work.pending.merge(validity::end_requests(&mut work.state, at));
        values::release_due(&mut work.state, at);
        self.commit().await;
    }

    async fn restarted(self) -> Self {
        let Self { folder, work, now, received, .. } = &self;
        let (twin, path) = (work.outputs.twin.clone(), folder.path().to_owned());
        let starts = u8::try_from((received + 1) % 251).expect("small");
        let now = *now;
        let Self { work, folder, revision, received, versions, recipient_versions, seen, .. } =
            self;
        work.store.close().await;
        let (work, spool) = file::open(&path, twin, now, starts).await;
        let received = received + 1;
        Self { folder, work, spool, now, revision, received, versions, recipient_versions, seen }
    }

    /// Commits as [`Coordinator::commit`] does.
    pub(super) async fn commit(&mut self) {
        let (now, work) = (self.now, &mut self.work);
        let refreshed = transaction::refresh(&mut work.state, std::mem::take(&mut work.pending));
        let delivery = delivery_progress::delivery_state(&mut work.store, &refreshed).await;
        let delivery = delivery.expect("the store is read");
        let waiting = delivery.purged.values().flatten();
        let waiting = waiting.filter(|report| report.row.sent_at.is_none());
        work.outputs.in_flight.recall(waiting.map(|report| report.row.id.0));
        let (writes, mut effects) = refreshed
            .take_back(&mut work.state, delivery, &work.key, now)
            .report(&mut work.state, now, || SALT)
            .sign(&mut work.state, &work.key);
        if !writes.is_empty() {
            work.store.commit(writes).await.expect("committed");
        }
        work.outputs.in_flight.confirm_recalls();
        self.seen.extend(effects.values.iter().map(|value| format!("node {value:?}")));
        self.seen.push(format!("{:?} {}", effects.decisions, effects.resent_report_count));
        self.seen.push(format!("twin {:?} {:?}", effects.twin, effects.link));
        let events = effects.take_events();
        self.seen.extend(events.iter().map(|event| format!("event {event:?}")));
        // Log and metrics of it are noted, too. Events have been taken: nobody listens.
        publish_effects::publish_effects(&work.outputs, &work.state, effects).await;
    }

    /// Looks at all fields, as nodes and pages show them.
    fn look(&mut self) {
        for field in FIELDS.iter().map(fields::FieldOf::key) {
            let field = self.work.state.field(&field).expect("a field");
            // All that any role of the twin reads in the field's nodes.
            let nodes = publish_effects::field_record(field);
            self.seen.push(format!("{} {nodes:?} {}", field.key(), field.gate().is_withheld()));
        }
    }
}

fn mapping(field: usize, number: usize) -> mapping_engine::Mapping {
    let key = FIELDS[field].key();
    let json = json!({ "mappingId": "m", "target": key,
        "targetType": FIELDS[field].field_type.name(), "targetUnit": format!("m{number}"),
        "inputs": [], "steps": [] });
    serde_json::from_value(json).expect("a mapping")
}

fn id_of(name: usize) -> DocumentId {
    format!("policy-{name}").parse().expect("an id")
}

fn earlier(at: DateTime, ms: u32) -> DateTime {
    DateTime::from_unix_micros(at.unix_micros() - i64::from(ms) * 1_000)
}

const fn is_released(outcome: GateOutcome) -> bool {
    matches!(outcome, GateOutcome::Disclosed { .. })
}

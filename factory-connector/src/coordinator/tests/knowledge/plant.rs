//! A plant with a clock of its own: state, store, spool and link adapter, as the coordinator's loop
//! runs them.

use std::collections::BTreeMap;

use connector_state::{
    Effects, transaction,
    use_cases::{
        import_mappings::{MappingImport, import_mappings},
        keep_alive::keep_alives,
        policies::{put_policy, set_recipient_policy},
        revise::receive_network,
        validity, values,
    },
};
use disclosure::DocumentId;

use super::{
    acts::Act,
    fields::{FIELDS, PARTNERS, network},
    knower::Knower,
    offers::Varied,
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
    /// Reports that left, by writer, epoch and sequence number.
    pub(super) left: BTreeMap<(u64, u64, u64), Value>,
    /// Fields by their places, with the times of their releases.
    pub(super) releases: Vec<(usize, DateTime)>,
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
            left: BTreeMap::new(),
            releases: Vec::new(),
        };
        plant.commit().await;
        plant.revise(0b11, None);
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
        of_other: Option<&Varied>,
    ) -> (Self, Varied) {
        let mut varied = Varied::default();
        knower.set_time(self.now);
        match act {
            Act::Values(coming, later_ms) => {
                varied = self.offer(coming, *later_ms, knower, of_other).await;
            }
            Act::Send { is_receipted } => varied.reports = self.send(*is_receipted, knower).await,
            Act::Restart => {
                self = self.restarted().await;
                knower.restart();
            }
            Act::Wait(ms) => self.wait(*ms).await,
            Act::SetClockForward(ms) => self.pass(later(self.now, *ms)).await,
            Act::SetClockBack(ms) => {
                let former = self.now;
                self.now = earlier(former, *ms);
                knower.set_clock_back(former, self.now);
                values::set_clock_back(&mut self.work.state, self.now);
            }
            Act::DecidePast { partner, is_released } => {
                varied.past_reports = self.decide_past(*partner, *is_released, knower).await;
            }
            decision => self.decide(decision, knower),
        }
        self.commit().await;
        let is_decision = !matches!(
            act,
            Act::Values(..)
                | Act::Wait(_)
                | Act::SetClockForward(_)
                | Act::Send { .. }
                | Act::DecidePast { .. }
        );
        for (field, at) in std::mem::take(&mut self.releases) {
            // A decision coarsens what is shown at once; intervals are for what comes.
            if !is_decision {
                knower.check_release(field, at);
            }
        }
        self.look();
        (self, varied)
    }

    fn decide(&mut self, act: &Act, knower: &mut Knower) {
        let now = self.now;
        match act {
            Act::Open { field, source, policy } => {
                let of = &FIELDS[*field];
                let policy = policy.fitted_to(of.field_type, of.is_array);
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
            Act::Close(field) | Act::Refuse(field) => {
                let is_refused = matches!(act, Act::Refuse(_));
                let command = if is_refused {
                    DecisionCommand::Refuse
                } else {
                    DecisionCommand::LeavePending
                };
                if self.take(*field, command) {
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
            Act::Revise { bits, begin_ms } => {
                let begins_at = begin_ms.map(|ms| later(now, ms));
                self.revise(*bits, begins_at);
                let is_mapped = |field: &fields::FieldOf| {
                    let field = self.work.state.field(&field.key());
                    field.is_some_and(|field| field.decision().is_mapped())
                };
                knower.revise(*bits, begins_at, FIELDS.each_ref().map(is_mapped));
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
        let is_refused = matches!(command, DecisionCommand::Refuse);
        let reason = is_refused.then(|| "A trade secret.".to_owned());
        let request = DecisionRequest { command, reason, decided_by, basis, preview: None };
        let decided = decide(&mut self.work.state, &FIELDS[field].key(), request, self.now);
        decided.map(|changes| self.work.pending.merge(changes)).is_ok()
    }

    fn revise(&mut self, bits: u8, begins_at: Option<DateTime>) {
        self.revision += 1;
        let json = network(self.revision, bits, begins_at);
        let message = serde_json::from_value(json.clone()).expect("a network");
        let changes = receive_network(&mut self.work.state, message, json.to_string(), self.now);
        self.work.pending.merge(changes);
    }

    /// Waits. Whatever falls due is released in time.
    pub(super) async fn wait(&mut self, ms: u32) {
        let end = later(self.now, ms);
        while let Some(due) = self.work.state.fields().next_deadline().filter(|due| *due <= end) {
            self.pass(due.max(self.now)).await;
        }
        self.pass(end).await;
        for message in keep_alives(&mut self.work.state, end) {
            let body = String::from_utf8(message.body.into_bytes()).expect("UTF-8");
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
        let received = self.received + 1;
        let starts = u8::try_from(received % 251).expect("small");
        let Self {
            folder,
            work,
            now,
            revision,
            versions,
            recipient_versions,
            seen,
            left,
            releases,
            ..
        } = self;
        let twin = work.outputs.twin.clone();
        work.store.close().await;
        let (work, spool) = file::open(folder.path(), twin, now, starts).await;
        Self {
            folder,
            work,
            spool,
            now,
            revision,
            received,
            versions,
            recipient_versions,
            seen,
            left,
            releases,
        }
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
        for (key, _) in &effects.values {
            let place = FIELDS.iter().position(|field| field.key() == *key).expect("a field");
            self.releases.push((place, now));
        }
        // A transaction without an effect is seen by nobody.
        let counts =
            |effects: &Effects| format!("{:?} {}", effects.decisions, effects.resent_report_count);
        let signals = |effects: &Effects| format!("twin {:?} {:?}", effects.twin, effects.link);
        let nothing = Effects::default();
        let had = [(counts(&effects), counts(&nothing)), (signals(&effects), signals(&nothing))];
        self.seen.extend(had.into_iter().filter_map(|(had, none)| (had != none).then_some(had)));
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
            self.seen.push(format!("{} {nodes:?}", field.key()));
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

fn later(at: DateTime, ms: u32) -> DateTime {
    at.after(Duration::from_millis(ms.into()))
}

pub(super) fn earlier(at: DateTime, ms: u32) -> DateTime {
    DateTime::from_unix_micros(at.unix_micros() - i64::from(ms) * 1_000)
}

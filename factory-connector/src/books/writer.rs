//! DataSetWriters: one per dynamic data request.

use std::{collections::BTreeSet, sync::Arc, time::Duration};

use asi_model::{
    BuiltInType, DateTime, FieldName, OrganisationId, RequestKey,
    pubsub::{
        DataSetMetaData, FieldMetaData, MetaDataMessage, MetaDataVersion, ReportHeader,
        json::encode_meta_data, unit_member,
    },
};
use uuid::Uuid;

use super::{Books, new_message_id};
use crate::store::{ControlRow, WriterRow};

/// How long the id of a retired writer rests before another request gets it.
const REST: Duration = Duration::from_secs(30 * 86_400);

/// A DataSetWriter.
#[derive(Debug, Clone)]
pub struct Writer {
    /// The request it reports about.
    pub request: RequestKey,
    /// MajorVersion.
    pub epoch: u32,
    /// MinorVersion.
    pub minor_version: u32,
    /// The next report's number.
    pub next_sequence: u32,
    /// The mapped fields, in payload order, as the metadata in force describes them.
    pub fields: Vec<FieldName>,
    /// Those that reports of this epoch have carried, as far as this run of the connector knows.
    pub carried: BTreeSet<FieldName>,
    /// When it was retired.
    pub retired_at: Option<DateTime>,
    /// When it last reported or kept alive, as far as this run of the connector knows.
    pub last_sign_at: DateTime,
}

impl Writer {
    fn row(&self) -> WriterRow {
        WriterRow {
            request: self.request.clone(),
            epoch: self.epoch,
            minor_version: self.minor_version,
            next_sequence: self.next_sequence,
            fields: self.fields.clone(),
            retired_at: self.retired_at,
        }
    }

    /// The version that reports carry.
    #[must_use]
    pub const fn version(&self) -> MetaDataVersion {
        MetaDataVersion { major: self.epoch, minor: self.minor_version }
    }
}

impl Books {
    pub(super) fn load_writer(&mut self, id: u16, row: WriterRow) {
        if row.retired_at.is_none() {
            self.writer_of.insert(row.request.clone(), id);
        }
        let writer = Writer {
            request: row.request,
            epoch: row.epoch,
            minor_version: row.minor_version,
            next_sequence: row.next_sequence,
            fields: row.fields,
            carried: BTreeSet::new(),
            retired_at: row.retired_at,
            last_sign_at: DateTime::MIN,
        };
        self.writers.insert(id, writer);
    }

    /// Gives a request its writer. `None` where all 65 535 are taken.
    pub(crate) fn add_writer(&mut self, request: &RequestKey, now: DateTime) -> Option<u16> {
        if let Some(id) = self.writer_of.get(request) {
            return Some(*id);
        }
        let has_rested =
            |writer: &Writer| writer.retired_at.is_some_and(|at| now.since(at) >= REST);
        let id = (1..=u16::MAX).find(|id| self.writers.get(id).is_none_or(has_rested))?;
        let last_epoch = self.writers.get(&id).map_or(0, |writer| writer.epoch);
        let epoch = now.version_time().max(last_epoch.saturating_add(1));
        let writer = Writer {
            request: request.clone(),
            epoch,
            minor_version: epoch,
            next_sequence: 0,
            fields: Vec::new(),
            carried: BTreeSet::new(),
            retired_at: None,
            last_sign_at: now,
        };
        self.changes.writers.insert(id, writer.row());
        self.writers.insert(id, writer);
        self.writer_of.insert(request.clone(), id);
        Some(id)
    }

    /// Retires a request's writer and takes back what waits.
    pub(crate) fn retire_writer(
        &mut self,
        request: &RequestKey,
        cause: asi_model::messages::GapCause,
        now: DateTime,
    ) {
        let Some(id) = self.writer_of.remove(request) else { return };
        self.purges.insert(id, cause);
        self.dirty_writers.remove(&id);
        if let Some(writer) = self.writers.get_mut(&id) {
            writer.retired_at = Some(now);
            writer.fields.clear();
        }
        self.store_writer(id);
    }

    pub(crate) fn store_writer(&mut self, id: u16) {
        if let Some(writer) = self.writers.get(&id) {
            self.changes.writers.insert(id, writer.row());
        }
    }

    /// Begins a new epoch: sequence numbers start again, and everything is described and reported
    /// anew.
    pub(crate) fn begin_epoch(&mut self, id: u16, now: DateTime) {
        if let Some(writer) = self.writers.get_mut(&id) {
            writer.epoch = now.version_time().max(writer.epoch.saturating_add(1));
            writer.minor_version = writer.epoch;
            writer.next_sequence = 0;
            writer.carried.clear();
        }
        self.describe(id, now);
    }

    /// After decisions about a request's fields: its writer's data set is to be brought up to date.
    /// That is done once for all decisions of a transaction, so that a partner gets one description
    /// and not one per field.
    pub(crate) fn refresh_writer(&mut self, id: u16, now: DateTime) {
        if self.writers.contains_key(&id) {
            self.changed_writers.insert(id, now);
        }
    }

    /// Brings the data sets up to date about whose fields something was decided: to be called
    /// before what waits of them is taken back, and before they report.
    pub(crate) fn refresh_writers(&mut self) {
        for (id, now) in std::mem::take(&mut self.changed_writers) {
            self.refresh_now(id, now);
        }
    }

    /// Appended fields change the minor version only; anything else begins a new epoch.
    fn refresh_now(&mut self, id: u16, now: DateTime) {
        let Some(writer) = self.writers.get(&id).filter(|writer| writer.retired_at.is_none())
        else {
            return;
        };
        let request = writer.request.clone();
        let fields: Vec<FieldName> = self
            .fields_of(&request)
            .filter(|(_, field)| field.decision.is_mapped())
            .map(|(key, _)| key.field_name)
            .collect();
        // A consent that ended and was given anew within one transaction ended all the same.
        let is_ended = self.purges.contains_key(&id);
        let Some(writer) = self.writers.get_mut(&id) else { return };
        let is_appended = !is_ended && fields.starts_with(&writer.fields);
        writer.fields = fields;
        if is_appended {
            writer.minor_version = now.version_time().max(writer.minor_version.saturating_add(1));
            self.describe(id, now);
        } else {
            self.begin_epoch(id, now);
        }
    }

    /// Sends the metadata of a writer; it precedes the data that it describes. Reports what is
    /// disclosed already.
    fn describe(&mut self, id: u16, now: DateTime) {
        self.store_writer(id);
        let Some(writer) = self.writers.get(&id).filter(|writer| !writer.fields.is_empty()) else {
            return;
        };
        let request = writer.request.clone();
        let Some(meta_data) = self.meta_data(id) else { return };
        let message_id = new_message_id();
        let message = MetaDataMessage {
            message_id: Some(message_id.clone()),
            publisher_id: Some(Arc::from(self.config.factory_id.as_str())),
            data_set_writer_id: id,
            timestamp: Some(now),
            meta_data,
            ..MetaDataMessage::default()
        };
        let body = String::from_utf8(encode_meta_data(&message, self.config.encoding))
            .expect("the encoder writes UTF-8");
        let row = ControlRow {
            id: self.next_row(),
            message_id,
            subject: "ua-metadata".to_owned(),
            correlation_id: None,
            body,
            created_at: now,
            ttl_ms: None,
        };
        self.changes.controls.push(row);
        self.aftermath.is_spool_filled = true;
        if self
            .fields_of(&request)
            .any(|(_, field)| field.decision.is_mapped() && field.gate.disclosed().is_some())
        {
            self.dirty_writers.insert(id);
        }
    }

    /// The metadata of a writer, in the payload's order.
    pub(crate) fn meta_data(&self, id: u16) -> Option<DataSetMetaData> {
        let writer = self.writers.get(&id)?;
        let (_, document) = self.request(&writer.request)?;
        let field_id = |name: &str| field_id(&writer.request, name);
        let mut fields = Vec::from(ReportHeader::meta_data(field_id));
        for name in &writer.fields {
            let Some(field) = self.fields.get(&writer.request.field(name.clone())) else {
                continue;
            };
            let statement = field.statement();
            fields.push(FieldMetaData::of_report_field(
                &field.definition,
                statement.as_ref(),
                field_id(name.as_str()),
            ));
            if field.definition.unit.is_some() {
                let unit = unit_member(name.as_str());
                let unit_id = field_id(&unit);
                fields.push(FieldMetaData::new(unit, BuiltInType::String, unit_id));
            }
        }
        Some(DataSetMetaData {
            name: Arc::from(document.report_data_format.report_name.as_str()),
            fields,
            configuration_version: writer.version(),
            ..DataSetMetaData::default()
        })
    }

    /// Who may see a request's answers.
    pub(crate) fn recipients(&self, request: &RequestKey) -> Vec<OrganisationId> {
        self.request(request)
            .map(|(_, document)| document.recipient_list.clone())
            .unwrap_or_default()
    }
}

/// The id of a field over renames: derived from its key, so that it is the same after every
/// restart.
fn field_id(request: &RequestKey, name: &str) -> Uuid {
    use sha2::{Digest, Sha256};
    let digest = Sha256::digest(format!("{request}/{name}"));
    let mut bytes = [0_u8; 16];
    bytes.copy_from_slice(&digest[..16]);
    uuid::Builder::from_custom_bytes(bytes).into_uuid()
}

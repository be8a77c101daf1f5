//! Values that mappings can be tried on, over a restart: a file beside the store, written again each minute. It is lost
//! without harm, and so is its last minute.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, Read as _, Write as _},
    os::unix::fs::OpenOptionsExt as _,
    path::{Path, PathBuf},
    time::Duration,
};

use asi_model::{
    DataValue, DateTime, NodeId,
    opcua_json::{DataEncoding, Leniency, decode_value, encode_data_value},
};
use mapping_engine::{MappingEngine, MappingEngineHandle, VariableRecording};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use shop_floor::{MonitorOptions, SourceId};
use tokio_util::sync::CancellationToken;

use crate::config::ConnectorConfig;

/// Name of the file in the data directory.
const FILE: &str = "recorded-values.jsonl";
/// Pause between two writings; what comes after the last one is lost with a crash.
const INTERVAL: Duration = Duration::from_secs(60);
/// Longest file that is written and read; variables beyond are left out.
const FILE_BYTES_MAX: u64 = 64 * 1024 * 1024;

/// Line of the file: a variable with its values.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct RecordingLine {
    source_id: SourceId,
    node_id: NodeId,
    #[serde(default)]
    monitor: MonitorOptions,
    /// Microseconds of arrival, and the value in the encoding of OPC UA.
    values: Vec<(i64, String)>,
}

/// File of recorded values.
pub(super) struct RecordedValues {
    path: PathBuf,
    most: usize,
}

impl RecordedValues {
    /// Returns the file of a configured connector, after giving the engine what was recorded before this start.
    pub(super) async fn resume(config: &ConnectorConfig, engine: &mut MappingEngine) -> Self {
        let values = Self::new(&config.data_directory, config.mapping.history.kept_values_max);
        let read = Self { path: values.path.clone(), most: values.most };
        if let Ok(former) = tokio::task::spawn_blocking(move || read.load()).await {
            engine.resume(former);
        }
        values
    }

    /// Returns the file of a data directory, for at most so many values; none where 0.
    fn new(directory: &Path, most: usize) -> Self {
        Self { path: directory.join(FILE), most }
    }

    /// Reads what was recorded before this start. What cannot be read is left out.
    fn load(&self) -> Vec<VariableRecording> {
        if self.most == 0 {
            // They are turned off: former ones go, too.
            for file in [self.path.clone(), self.path.with_extension("new")] {
                if let Err(error) = fs::remove_file(&file)
                    && error.kind() != io::ErrorKind::NotFound
                {
                    tracing::warn!(file = %file.display(), %error, "No values are recorded any more, but the file with those of before cannot be removed; remove it by hand.");
                }
            }
            return Vec::new();
        }
        match read(&self.path) {
            Ok(text) => text.lines().filter_map(recording_of).collect(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
            Err(error) => {
                tracing::warn!(file = %self.path.display(), %error, "Recorded values cannot be read; dry runs start without.");
                Vec::new()
            }
        }
    }

    /// Stores them each minute until shutdown.
    pub(super) async fn run(self, engine: MappingEngineHandle, shutdown: CancellationToken) {
        if self.most == 0 {
            return shutdown.cancelled().await;
        }
        let mut stored = None;
        let pause = || shutdown.run_until_cancelled(tokio::time::sleep(INTERVAL));
        while pause().await.is_some() {
            let Ok(recordings) = engine.recordings(self.most).await else { return };
            let path = self.path.clone();
            let written =
                tokio::task::spawn_blocking(move || store(&path, &recordings, stored)).await;
            match written {
                Ok(Ok(digest)) => stored = Some(digest),
                Ok(Err(error)) => {
                    tracing::warn!(file = %self.path.display(), %error, "Recorded values cannot be stored.");
                }
                Err(_) => {}
            }
        }
    }
}

fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    File::open(path)?.take(FILE_BYTES_MAX).read_to_string(&mut text)?;
    Ok(text)
}

fn recording_of(line: &str) -> Option<VariableRecording> {
    let RecordingLine { source_id, node_id, monitor, values } = serde_json::from_str(line).ok()?;
    let values = values.into_iter().filter_map(|(at, value)| {
        let decoded = decode_value(value.as_bytes(), Leniency::Lenient, &[], &[]).ok()?.0;
        Some((DateTime::from_unix_micros(at), decoded.into_data_value()))
    });
    Some(VariableRecording { source_id, node_id, monitor, values: values.collect() })
}

fn line_of(recording: &VariableRecording) -> Option<String> {
    let text_of = |value: &DataValue| {
        String::from_utf8(encode_data_value(value, DataEncoding::Reversible104)).ok()
    };
    let values = recording.values.iter();
    let line = RecordingLine {
        source_id: recording.source_id.clone(),
        node_id: recording.node_id.clone(),
        monitor: recording.monitor.clone(),
        values: values
            .filter_map(|(at, value)| Some((at.unix_micros(), text_of(value)?)))
            .collect(),
    };
    serde_json::to_string(&line).ok()
}

/// Writes the file unless it has this content; returns the digest of the content.
fn store(
    path: &Path,
    recordings: &[VariableRecording],
    stored: Option<[u8; 32]>,
) -> io::Result<[u8; 32]> {
    let mut lines: Vec<String> = recordings.iter().filter_map(line_of).collect();
    lines.sort_unstable();
    let mut left = FILE_BYTES_MAX;
    lines.retain(|line| {
        let bytes = line.len() as u64 + 1;
        let fits = bytes <= left;
        left -= if fits { bytes } else { 0 };
        fits
    });
    let text = lines.join("\n");
    let digest = Sha256::digest(text.as_bytes()).into();
    if stored != Some(digest) {
        // Renamed into its place: a crash leaves the former one.
        let aside = path.with_extension("new");
        let mut options = OpenOptions::new();
        options.write(true).create(true).truncate(true).mode(0o600);
        options.open(&aside)?.write_all(text.as_bytes())?;
        fs::rename(&aside, path)?;
    }
    Ok(digest)
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use asi_model::{StatusCode, Variant};

    use super::*;

    fn recording(node: &str, values: Vec<DataValue>) -> VariableRecording {
        let at = |number: i64| DateTime::from_unix_micros(1_767_225_600_000_000 + number);
        VariableRecording {
            source_id: "Mill1".parse().expect("an id"),
            node_id: node.parse().expect("a node"),
            monitor: MonitorOptions {
                sampling_interval_ms: Some(250.0),
                ..MonitorOptions::default()
            },
            values: (0..).map(at).zip(values).collect(),
        }
    }

    #[test]
    fn recorded_values_outlast_a_restart_for_their_user_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let now = DateTime::from_unix_micros(1_767_225_600_123_456);
        let good = |value: Variant| DataValue::good(value, now);
        let uncertain = DataValue { status: StatusCode::UNCERTAIN, ..good(7_u64.into()) };
        let recordings = [
            recording("nsu=urn:x;s=a", vec![good(1.5_f64.into()), uncertain]),
            recording("nsu=urn:x;s=b", vec![good("text".into()), good(true.into())]),
        ];
        let values = RecordedValues::new(folder.path(), 10);
        assert!(values.load().is_empty());
        let digest = store(&values.path, &recordings, None).expect("stored");
        assert_eq!(values.load(), recordings);
        let mode = fs::metadata(&values.path).expect("a file").permissions().mode();
        assert_eq!(mode & 0o777, 0o600);

        // What is stored already is not written again.
        fs::remove_file(&values.path).expect("removed");
        assert_eq!(store(&values.path, &recordings, Some(digest)).expect("the same"), digest);
        assert!(values.load().is_empty());
        store(&values.path, &recordings[..1], Some(digest)).expect("stored");

        // A line that a crash or a hand broke costs the others nothing.
        let text = fs::read_to_string(&values.path).expect("a file") + "\n{\"sourceId\":";
        fs::write(&values.path, text).expect("written");
        assert_eq!(values.load(), recordings[..1]);
        assert!(RecordedValues::new(folder.path(), 0).load().is_empty());
        assert!(!values.path.exists(), "turned off");
    }
}

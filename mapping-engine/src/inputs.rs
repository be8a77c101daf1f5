//! Where values come from: the seam to the shop floor.

use std::{fmt, sync::Arc};

use asi_model::{DataValue, NodeId};
use async_trait::async_trait;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

/// A variable as the engine monitors it; chosen by the engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct InputKey(pub u64);

/// A change of a monitored variable.
#[derive(Debug, Clone, PartialEq)]
pub struct InputChange {
    /// Which variable.
    pub input: InputKey,
    /// Its new value, status and times.
    pub value: DataValue,
}

/// A local server.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(transparent)]
pub struct SourceId(Arc<str>);

impl SourceId {
    /// Takes a text of 1 to 64 letters, digits, `_` or `-`.
    #[must_use]
    pub fn new(text: &str) -> Option<Self> {
        let ok = |b: u8| b.is_ascii_alphanumeric() || b == b'_' || b == b'-';
        ((1..=64).contains(&text.len()) && text.bytes().all(ok)).then(|| Self(text.into()))
    }
}

impl fmt::Display for SourceId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for SourceId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Self::new(&text).ok_or_else(|| serde::de::Error::custom("not a source id"))
    }
}

/// What the engine asks of the shop floor: to monitor a variable under a key, and to stop.
///
/// Both only announce the wish; values, and the status of a source that is away, arrive as [`InputChange`]s.
#[async_trait]
pub trait Inputs: Send + Sync + 'static {
    /// Monitors a variable. Again with the same key replaces.
    async fn monitor(&self, input: InputKey, source: SourceId, node: NodeId, sampling_interval_ms: Option<u32>);
    /// Stops monitoring.
    async fn unmonitor(&self, input: InputKey);
}

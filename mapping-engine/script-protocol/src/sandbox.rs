//! Walls around a worker, as it reports them to its host.

use crate::codec::{DecodeError, MessageDecoder, MessageEncoder};

/// Walls that hold once a worker has entered its sandbox.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sandbox {
    /// True where the kernel filters the worker's system calls.
    pub is_filtered: bool,
    /// Access to files, network and other processes by their names.
    pub landlock: Landlock,
    /// User that the worker runs as.
    pub user_id: u32,
    /// True where the bounds on memory, files and processes read back as they were set.
    pub has_limits: bool,
}

/// Rules of Landlock against all of that which the kernel knows of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Landlock {
    /// The kernel has none.
    None = 0,
    /// An older kernel enforces a part of the rules.
    Partial = 1,
    /// All rules hold.
    Full = 2,
}

impl Sandbox {
    pub(crate) fn encode(&self, to: &mut MessageEncoder) {
        to.u8(self.is_filtered.into());
        to.u8(self.landlock as u8);
        to.u32(self.user_id);
        to.u8(self.has_limits.into());
    }

    pub(crate) fn decode(from: &mut MessageDecoder<'_>) -> Result<Self, DecodeError> {
        Ok(Self {
            is_filtered: from.u8()? == 1,
            landlock: match from.u8()? {
                0 => Landlock::None,
                1 => Landlock::Partial,
                2 => Landlock::Full,
                tag => return Err(DecodeError::UnknownTag { what: "Landlock", tag }),
            },
            user_id: from.u32()?,
            has_limits: from.u8()? == 1,
        })
    }
}

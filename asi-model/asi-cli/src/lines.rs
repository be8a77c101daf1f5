//! Files of audits: a checkpoint, and lines of bounded length.

use std::{
    fs::File,
    io::{BufRead, BufReader, Read as _},
    path::Path,
};

use anyhow::{Context as _, bail};

/// Bytes that are read from a file at once.
const BUFFER_BYTES: usize = 1 << 20;
/// Longest line that is read: an entry with its report, in bytes.
const LINE_BYTES_MAX: u64 = 16 * 1024 * 1024;
/// Longest checkpoint that is read, in bytes.
const CHECKPOINT_BYTES_MAX: u64 = 64 * 1024;

/// Opens a file to read it line by line.
pub fn open(path: &Path) -> anyhow::Result<BufReader<File>> {
    let file = File::open(path).with_context(|| format!("cannot read {}", path.display()))?;
    Ok(BufReader::with_capacity(BUFFER_BYTES, file))
}

/// Reads a checkpoint.
pub fn checkpoint(path: &Path) -> anyhow::Result<String> {
    let mut note = String::new();
    open(path)?.take(CHECKPOINT_BYTES_MAX).read_to_string(&mut note)?;
    Ok(note)
}

/// Reads the next line; `None` at the end. What is no UTF-8 fails in the check of its line.
pub fn next_line(lines: &mut impl BufRead) -> anyhow::Result<Option<String>> {
    let mut line = Vec::new();
    let length = lines.by_ref().take(LINE_BYTES_MAX).read_until(b'\n', &mut line)?;
    if length as u64 == LINE_BYTES_MAX {
        bail!("a line is longer than {LINE_BYTES_MAX} bytes");
    }
    if length == 0 {
        return Ok(None);
    }
    if line.last() == Some(&b'\n') {
        line.pop();
    }
    let line = String::from_utf8(line)
        .unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned());
    Ok(Some(line))
}

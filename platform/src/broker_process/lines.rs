//! Lines of bounded length: what one end of the pipe makes of a request must not fill the other's memory.

use std::io;

use tokio::io::{AsyncBufRead, AsyncBufReadExt as _, AsyncReadExt as _};

/// Longest line. All users or queues of a large platform are in one.
pub(super) const LINE_BYTES_MAX: usize = 64 * 1024 * 1024;

/// Lines of a reader.
pub(super) struct BoundedLines<R> {
    reader: R,
    bytes_max: usize,
    /// Beginning of the next line, kept where waiting for its end is given up.
    begun: Vec<u8>,
}

impl<R: AsyncBufRead + Unpin + Send> BoundedLines<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, bytes_max: LINE_BYTES_MAX, begun: Vec::new() }
    }

    /// Returns the next line without its end; none after the last one. Can be given up and called again.
    ///
    /// # Errors
    /// Those of the reader, and one for a line that is too long or no text.
    pub(super) async fn next_line(&mut self) -> io::Result<Option<String>> {
        let left = (self.bytes_max + 1).saturating_sub(self.begun.len());
        let mut rest = (&mut self.reader).take(left as u64);
        rest.read_until(b'\n', &mut self.begun).await?;
        if self.begun.is_empty() {
            return Ok(None);
        }
        if self.begun.pop_if(|last| *last == b'\n').is_none() && self.begun.len() > self.bytes_max {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "a line is too long"));
        }
        let line = String::from_utf8(std::mem::take(&mut self.begun));
        line.map(Some).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &[u8]) -> BoundedLines<&[u8]> {
        BoundedLines { bytes_max: 5, ..BoundedLines::new(text) }
    }

    #[tokio::test]
    async fn a_line_without_end_is_an_error_and_not_kept() {
        let mut some = lines(b"one\n12345\n\nend");
        for expected in ["one", "12345", "", "end"] {
            assert_eq!(some.next_line().await.expect("a line").as_deref(), Some(expected));
        }
        assert!(some.next_line().await.expect("the end").is_none());
        let text = b"x".repeat(1_000);
        let mut long = lines(&text);
        assert!(long.next_line().await.is_err());
        assert!(long.begun.len() <= 6, "{} bytes", long.begun.len());
    }
}

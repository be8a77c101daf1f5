//! Frames: four bytes of length, little endian, and so many bytes of body.

use std::io::{self, Read, Write};

/// Longest body, in bytes.
pub const FRAME_BYTES_MAX: usize = 8 << 20;
/// Bytes before the body.
pub const HEADER_BYTES: usize = 4;

/// A length that no frame has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a frame announces {announced} bytes; at most {FRAME_BYTES_MAX} are allowed")]
pub struct FrameTooLong {
    /// Length in the header.
    pub announced: usize,
}

/// The length of the body that a header announces.
///
/// # Errors
/// [`FrameTooLong`] beyond [`FRAME_BYTES_MAX`].
pub fn body_length(header: [u8; HEADER_BYTES]) -> Result<usize, FrameTooLong> {
    let announced = usize::try_from(u32::from_le_bytes(header)).unwrap_or(usize::MAX);
    if announced > FRAME_BYTES_MAX { Err(FrameTooLong { announced }) } else { Ok(announced) }
}

/// Header and body as the bytes to send.
///
/// # Errors
/// [`FrameTooLong`] beyond [`FRAME_BYTES_MAX`].
pub fn framed(body: &[u8]) -> Result<Vec<u8>, FrameTooLong> {
    let announced = body.len();
    let length = u32::try_from(announced).ok().filter(|_| announced <= FRAME_BYTES_MAX);
    let length = length.ok_or(FrameTooLong { announced })?;
    let mut bytes = Vec::with_capacity(HEADER_BYTES + announced);
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(body);
    Ok(bytes)
}

/// Writes one frame and flushes.
///
/// # Errors
/// Those of the writer; `InvalidData` for a body that is too long.
pub fn write(writer: &mut impl Write, body: &[u8]) -> io::Result<()> {
    let bytes = framed(body).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
    writer.write_all(&bytes)?;
    writer.flush()
}

/// Reads one frame; `None` at the end of the stream.
///
/// # Errors
/// Those of the reader; `InvalidData` for a length that no frame has, `UnexpectedEof` for a frame
/// cut short.
pub fn read(reader: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    let mut header = [0; HEADER_BYTES];
    match reader.read(&mut header[..1])? {
        0 => return Ok(None),
        _ => reader.read_exact(&mut header[1..])?,
    }
    let length =
        body_length(header).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    Ok(Some(body))
}

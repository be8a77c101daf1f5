//! Lines of an audit file, checked on all processors and taken in their order.

use std::{io::BufRead, num::NonZero, thread};

use ::ledger::audit::{Auditor, CheckedLine};

use crate::lines::next_line;

/// Bytes of lines that are read before they are checked together. Bounds memory, and is enough to
/// keep all processors busy.
const BLOCK_BYTES: usize = 8 * 1024 * 1024;

/// Takes all further lines.
///
/// # Errors
/// When the file cannot be read, or a line is too long.
pub(super) fn take_all(
    auditor: &mut Auditor,
    lines: &mut (impl BufRead + Send),
) -> anyhow::Result<()> {
    let mut block = next_block(lines)?;
    while !block.is_empty() {
        // The next block is read while this one is checked.
        let (checked, next) = thread::scope(|scope| {
            let reading = scope.spawn(|| next_block(lines));
            let checked = check(auditor, &block);
            (checked, reading.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        });
        checked.into_iter().for_each(|line| auditor.take_checked(line));
        block = next?;
    }
    Ok(())
}

fn next_block(lines: &mut impl BufRead) -> anyhow::Result<Vec<String>> {
    let (mut block, mut bytes) = (Vec::new(), 0);
    while bytes < BLOCK_BYTES
        && let Some(line) = next_line(lines)?
    {
        bytes += line.len();
        block.push(line);
    }
    Ok(block)
}

/// Checks each line for itself, and returns the results in the order of the lines.
fn check(auditor: &Auditor, lines: &[String]) -> Vec<CheckedLine> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let share = lines.len().div_ceil(threads).max(1);
    thread::scope(|scope| {
        let check = |part| {
            move || -> Vec<CheckedLine> {
                let part: &[String] = part;
                part.iter().map(|line| auditor.check(line)).collect()
            }
        };
        let parts: Vec<_> = lines.chunks(share).map(|part| scope.spawn(check(part))).collect();
        parts
            .into_iter()
            .flat_map(|part| part.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}

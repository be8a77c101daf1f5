//! Lines of a ledger's audit file, checked on all processors and taken in their order.

use std::{io::BufRead, num::NonZero, thread};

use ::ledger::audit::{Auditor, CheckedLine};

use crate::lines::next_line;

/// Bytes of lines that are read before they are checked together. Bounds memory, and is enough to
/// keep all processors busy.
const BLOCK_BYTES: usize = 8 * 1024 * 1024;

/// Takes all further lines. Each is also read by `read`, for itself, and handed to `take` in its order
/// where a signature covers it.
///
/// # Errors
/// When the file cannot be read, or a line is too long.
pub fn take_all<T: Send>(
    auditor: &mut Auditor,
    lines: &mut (impl BufRead + Send),
    read: &(dyn Fn(&str) -> T + Sync),
    mut take: impl FnMut(T),
) -> anyhow::Result<()> {
    let mut block = next_block(lines)?;
    while !block.is_empty() {
        // The next block is read while this one is checked.
        let (checked, next) = thread::scope(|scope| {
            let reading = scope.spawn(|| next_block(lines));
            let checked = check(auditor, read, &block);
            (checked, reading.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        });
        for (line, read) in checked {
            if auditor.take_checked(line) {
                take(read);
            }
        }
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
fn check<T: Send>(
    auditor: &Auditor,
    read: &(dyn Fn(&str) -> T + Sync),
    lines: &[String],
) -> Vec<(CheckedLine, T)> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let share = lines.len().div_ceil(threads).max(1);
    thread::scope(|scope| {
        let check = |part| {
            move || -> Vec<(CheckedLine, T)> {
                let part: &[String] = part;
                part.iter().map(|line| (auditor.check(line), read(line))).collect()
            }
        };
        let parts: Vec<_> = lines.chunks(share).map(|part| scope.spawn(check(part))).collect();
        parts
            .into_iter()
            .flat_map(|part| part.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}

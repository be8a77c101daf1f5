//! Lines removed, repeated, exchanged, moved and cut off, at each place.

use crate::{file::AuditFile, kinds::Kinds};

pub(crate) fn try_all(file: &AuditFile, kinds: &mut Kinds<'_>) {
    for place in 0..file.lines.len() {
        let kind = file.kind(place);
        let mut attempt = |name: &str, change: &dyn Fn(&mut Vec<String>)| {
            let mut lines = file.lines.clone();
            change(&mut lines);
            kinds.attempt(&format!("{kind}: {name}"), &lines, &file.checkpoint);
        };
        attempt("line removed", &|lines| drop(lines.remove(place)));
        attempt("line repeated", &|lines| lines.insert(place, lines[place].clone()));
        attempt("line repeated at the end", &|lines| lines.push(lines[place].clone()));
        attempt("line and all after it cut off", &|lines| lines.truncate(place));
        attempt("line replaced by rubbish", &|lines| "rubbish".clone_into(&mut lines[place]));
        attempt("rubbish before the line", &|lines| lines.insert(place, "rubbish".to_owned()));
        if place > 1 {
            attempt("line exchanged with the one before", &|lines| lines.swap(place - 1, place));
            attempt("line moved to the front", &|lines| {
                let line = lines.remove(place);
                lines.insert(1, line);
            });
        }
        if place > 0 && place + 1 < file.lines.len() {
            attempt("line moved to the end", &|lines| {
                let line = lines.remove(place);
                lines.push(line);
            });
        }
        let foreign = file.foreign.get(place).filter(|line| **line != file.lines[place]);
        if let Some(foreign) = foreign {
            attempt("line of another history", &|lines| lines[place].clone_from(foreign));
            attempt("all lines from here on of another history", &|lines| {
                lines.truncate(place);
                lines.extend_from_slice(&file.foreign[place..]);
            });
        }
    }
    if !file.foreign.is_empty() {
        kinds.attempt("another history", &file.foreign, &file.checkpoint);
    }
}

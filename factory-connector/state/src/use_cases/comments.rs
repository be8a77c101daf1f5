//! Comments of partners and of this factory's people.

use asi_model::{
    DateTime,
    messages::{Comment, FactoryMessage},
};

use crate::{ChangeSet, ConnectorState, effects::ConnectorEvent, writes::CommentRow};

/// Stores a partner's comment.
#[must_use]
pub fn receive_comment(comment: Comment, now: DateTime) -> ChangeSet {
    let mut changes = ChangeSet::default();
    store(&mut changes, comment, false, now);
    changes
}

/// Stores a comment of this factory, and sends it to the partners.
pub fn write_comment(state: &mut ConnectorState, comment: Comment, now: DateTime) -> ChangeSet {
    let mut changes = ChangeSet::default();
    state.send(&mut changes, &FactoryMessage::Comment(comment.clone()), None, now);
    store(&mut changes, comment, true, now);
    changes
}

fn store(changes: &mut ChangeSet, comment: Comment, is_own: bool, now: DateTime) {
    let network = comment.operation_network_id.clone();
    changes.effects.events.push(ConnectorEvent::Comment(network));
    changes.writes.messages.comments.push(CommentRow { comment, is_own, written_at: now });
}

use futures::FutureExt;

use super::*;

fn entry(id: i64) -> QueueEntry {
    QueueEntry { id, bytes: 10, expires_at_ms: None, delivery_count: 0, is_redelivered: false }
}

fn queue(options: QueueOptions) -> Arc<Queue> {
    Arc::new(Queue::new(1, "q".parse().expect("a name"), options))
}

fn now(subscription: &Subscription) -> Option<i64> {
    match subscription.next().now_or_never()? {
        Next::Lease(entry) => Some(entry.id),
        Next::Deleted => None,
    }
}

#[test]
fn consumers_compete_in_order() {
    let queue = queue(QueueOptions::default());
    let (a, b) = (Subscription::new(Arc::clone(&queue)), Subscription::new(Arc::clone(&queue)));
    assert_eq!(now(&a), None);
    for id in 1..=3 {
        queue.adopt(entry(id));
    }
    assert_eq!(now(&a), Some(1));
    assert_eq!(now(&b), Some(2));
    assert_eq!(now(&a), Some(3));
    assert_eq!(now(&b), None);
    queue.requeue(entry(2));
    assert_eq!(now(&b), Some(2));
    assert_eq!((queue.status().ready, queue.status().unsettled), (0, 3));
    queue.settle(&entry(1));
    assert_eq!((queue.status().bytes, queue.status().unsettled), (20, 2));
}

#[test]
fn only_the_active_consumer_receives() {
    let queue = queue(QueueOptions { is_single_active_consumer: true, ..QueueOptions::default() });
    let (a, b) = (Subscription::new(Arc::clone(&queue)), Subscription::new(Arc::clone(&queue)));
    queue.adopt(entry(1));
    queue.adopt(entry(2));
    assert_eq!((now(&b), now(&a)), (None, Some(1)));
    drop(a);
    assert_eq!(now(&b), Some(2));
}

#[test]
fn a_consumer_that_follows_gets_nothing_before_what_the_active_one_gives_back() {
    let queue = queue(QueueOptions { is_single_active_consumer: true, ..QueueOptions::default() });
    let (a, b) = (Subscription::new(Arc::clone(&queue)), Subscription::new(Arc::clone(&queue)));
    for id in 1..=3 {
        queue.adopt(entry(id));
    }
    assert_eq!((now(&a), now(&a)), (Some(1), Some(2)));
    assert_eq!(now(&b), None);
    a.pause();
    queue.requeue(entry(2));
    assert_eq!(now(&b), None, "the first one is not back yet");
    queue.requeue(entry(1));
    assert_eq!(now(&b), None);
    drop(a);
    assert!(b.is_woken());
    for id in 1..=3 {
        assert_eq!(now(&b), Some(id));
    }
}

#[test]
fn a_consumer_without_credit_gives_way_to_one_that_waits() {
    let queue = queue(QueueOptions::default());
    let (a, b) = (Subscription::new(Arc::clone(&queue)), Subscription::new(Arc::clone(&queue)));
    queue.adopt(entry(1));
    assert_eq!(now(&a), Some(1));
    a.hold();
    assert!(a.give_way_requested().now_or_never().is_none());
    assert_eq!(now(&b), None);
    assert!(a.give_way_requested().now_or_never().is_some());
    a.release_hold();
    queue.requeue(entry(1));
    assert_eq!(now(&b), Some(1));
}

#[test]
fn pausing_wakes_another_consumer() {
    let queue = queue(QueueOptions::default());
    let (a, b) = (Subscription::new(Arc::clone(&queue)), Subscription::new(Arc::clone(&queue)));
    assert_eq!((now(&a), now(&b)), (None, None));
    queue.adopt(entry(1));
    a.pause();
    assert!(b.is_woken());
}

#[test]
fn reservations_respect_both_bounds() {
    let queue = queue(QueueOptions { messages_max: 2, bytes_max: 25, ..QueueOptions::default() });
    assert_eq!(queue.reserve(20), Ok(()));
    assert_eq!(queue.reserve(10), Err(QueueRefusal::Full));
    assert_eq!(queue.reserve(5), Ok(()));
    assert_eq!(queue.reserve(0), Err(QueueRefusal::Full));
    queue.release_reservation(20);
    assert_eq!(queue.reserve(0), Ok(()));
    queue.delete();
    assert_eq!(queue.reserve(0), Err(QueueRefusal::Deleted));
}

#[test]
fn expired_messages_are_withdrawn() {
    let queue = queue(QueueOptions::default());
    queue.adopt(entry(1));
    queue.adopt(QueueEntry { expires_at_ms: Some(5), ..entry(2) });
    assert_eq!(queue.withdraw_expired(4), []);
    assert_eq!(queue.withdraw_expired(5).len(), 1);
    assert_eq!(queue.status().ready, 1);
}

#[test]
fn what_was_forgotten_while_a_consumer_had_it_does_not_come_back() {
    let queue = queue(QueueOptions::default());
    let consumer = Subscription::new(Arc::clone(&queue));
    for id in 1..=4 {
        queue.adopt(entry(id));
    }
    assert_eq!((now(&consumer), now(&consumer)), (Some(1), Some(2)));
    for id in 1..=3 {
        queue.forget(id);
    }
    queue.requeue(entry(1));
    queue.settle(&entry(2));
    assert_eq!(now(&consumer), Some(4), "neither the leased ones nor the ready one");
    queue.requeue(entry(4));
    let status = queue.status();
    assert_eq!((status.ready, status.unsettled), (1, 0));
    assert_eq!(status.bytes, 10);
    assert!(queue.state.lock().forgotten.is_empty());
}

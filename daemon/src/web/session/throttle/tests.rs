use super::*;

const CLIENT: IpAddr = IpAddr::V4(std::net::Ipv4Addr::LOCALHOST);

fn throttle() -> LoginThrottle {
    LoginThrottle::new(ThrottleConfig::default())
}

fn fail(throttle: &mut LoginThrottle, client: IpAddr, user: &str, now: Instant) {
    let attempt = throttle.begin(client, user, now).expect("allowed");
    throttle.failed(attempt, now);
}

/// Address number `n` of one /64.
fn neighbour(n: u16) -> IpAddr {
    IpAddr::from([0x2001, 0xdb8, 0, 1, 0, 0, 0, n])
}

#[test]
fn waits_grow_and_end() {
    let mut throttle = throttle();
    let start = Instant::now();
    for _ in 0..5 {
        fail(&mut throttle, CLIENT, "eve", start);
    }
    let wait = |seconds| Hindrance::Wait(Duration::from_secs(seconds));
    assert_eq!(throttle.begin(CLIENT, "eve", start).err(), Some(wait(1)));
    let other = throttle.begin(CLIENT, "ann", start).expect("others are not held up");
    throttle.withdrawn(other);
    let later = start + Duration::from_secs(1);
    fail(&mut throttle, CLIENT, "eve", later);
    assert_eq!(throttle.begin(CLIENT, "eve", later).err(), Some(wait(2)));
    let right = throttle.begin(CLIENT, "eve", later + Duration::from_secs(2)).expect("waited");
    throttle.succeeded(right, later);
    assert!(throttle.begin(CLIENT, "eve", later).is_ok());
}

#[test]
fn what_is_under_way_counts_and_what_was_right_is_given_back() {
    let mut throttle = throttle();
    let now = Instant::now();
    let begin = |throttle: &mut LoginThrottle| throttle.begin(CLIENT, "eve", now);
    let open: Vec<_> = (0..5).map(|_| begin(&mut throttle).expect("free")).collect();
    assert_eq!(begin(&mut throttle).err(), Some(Hindrance::Undecided));
    throttle.withdrawn(open[0]);
    let sixth = begin(&mut throttle).expect("one was given back");
    for attempt in open[1..].iter().chain([&sixth]) {
        throttle.failed(*attempt, now);
    }
    assert!(matches!(begin(&mut throttle), Err(Hindrance::Wait(_))));

    let later = now + Duration::from_secs(1);
    throttle.begin(CLIENT, "eve", later).expect("waited");
    let beside = throttle.begin(CLIENT, "eve", later).err();
    assert_eq!(beside, Some(Hindrance::Undecided), "beyond the free ones one at a time");
}

#[test]
fn a_user_is_counted_over_all_places() {
    let mut throttle = throttle();
    let now = Instant::now();
    for number in 0..5_u8 {
        fail(&mut throttle, IpAddr::from([192, 0, 2, number]), "ann", now);
    }
    let far = IpAddr::from([198, 51, 100, 1]);
    assert!(throttle.begin(far, "ann", now).is_err());
    assert!(throttle.begin(far, "bob", now).is_ok());
}

#[test]
fn strangers_lock_nobody_out_at_the_usual_place() {
    let mut throttle = throttle();
    let now = Instant::now();
    let right = throttle.begin(CLIENT, "ann", now).expect("free");
    throttle.succeeded(right, now);
    for number in 0..5_u8 {
        fail(&mut throttle, IpAddr::from([192, 0, 2, number]), "ann", now);
    }
    assert!(throttle.begin(IpAddr::from([192, 0, 2, 9]), "ann", now).is_err());
    for _ in 0..5 {
        fail(&mut throttle, CLIENT, "ann", now);
    }
    assert!(throttle.begin(CLIENT, "ann", now).is_err(), "guesses are slowed there, too");
}

#[test]
fn trying_many_names_from_one_place_is_slowed_too() {
    let now = Instant::now();
    let same: fn(u16) -> IpAddr = |_| CLIENT;
    for client in [same, neighbour] {
        let mut throttle = throttle();
        for number in 0..50 {
            fail(&mut throttle, client(number), &format!("user{number}"), now);
        }
        assert!(throttle.begin(client(50), "other", now).is_err());
    }
}

#[test]
fn memory_is_bounded_and_freed_by_time() {
    let mut throttle = throttle();
    let now = Instant::now();
    for _ in 0..3 {
        fail(&mut throttle, CLIENT, "wanted", now);
    }
    for number in 0..6_000_u32 {
        let client = IpAddr::from((0x0100_0000 + number).to_be_bytes());
        fail(&mut throttle, client, &format!("{number}{}", "x".repeat(100)), now);
    }
    assert_eq!(throttle.counts.len(), COUNTS_MAX);
    fail(&mut throttle, CLIENT, "wanted", now);
    fail(&mut throttle, CLIENT, "wanted", now);
    assert!(throttle.begin(CLIENT, "wanted", now).is_err(), "made-up names displace made-up names");
    let later = now + Duration::from_secs(301);
    fail(&mut throttle, CLIENT, "ann", later);
    assert_eq!(throttle.counts.len(), 2, "the user and the place of the last one");
}

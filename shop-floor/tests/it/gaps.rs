//! Values that were missed while a connection was away, read from the server's history.

use asi_model::{Scalar, StatusCode};
use simulator::MachineFault;
use tokio::{
    io::copy_bidirectional,
    net::{TcpListener, TcpStream},
    sync::watch,
};

use crate::{
    peer::{Peer, Stack},
    support::{Simulation, TestShopFloor, node, until},
};

const COUNTER: &str = "Production.PartCounter";

/// The whole numbers that were heard of an input, from a first one on.
fn numbers(floor: &TestShopFloor, input: u64, first: i128) -> Vec<i128> {
    let heard = floor.heard(input).into_iter();
    let numbers = heard.filter_map(|value| value.value.as_scalar().and_then(Scalar::as_i128));
    numbers.filter(|number| *number >= first).collect()
}

#[tokio::test]
async fn values_that_were_missed_come_in_order_before_those_of_now() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect_with_silence(&cell, 1000).await;
    floor.monitor(1, &source, node(&cell, COUNTER));
    // A variable without a history.
    floor.monitor(2, &source, node(&cell, "Production.GoodCounter"));
    until("the nodes are looked at", || floor.status(&source).findable == 2).await;
    // The session takes up another input after that, and then knows which of the first have a history.
    floor.monitor(3, &source, node(&cell, "Status.StateText"));
    until("all are live", || floor.status(&source).live == 3).await;
    let since = cell.set(COUNTER, 1000_u32).await.expect("set");
    cell.set("Production.GoodCounter", 1000_u32).await.expect("set");
    floor.until_value(1, 1000_u32).await;
    floor.until_value(2, 1000_u32).await;

    cell.inject(MachineFault::HangNetwork).await.expect("injected");
    floor.until_status(1, StatusCode::BAD_NOT_CONNECTED).await;
    // More than the machine says in one answer.
    for number in 1001..=1120_u32 {
        cell.set(COUNTER, number).await.expect("set");
        cell.set("Production.GoodCounter", number).await.expect("set");
    }
    cell.inject(MachineFault::None).await.expect("healed");
    floor.until_value(1, 1120_u32).await;
    floor.until_value(2, 1120_u32).await;
    assert_eq!(numbers(&floor, 1, 1000), (1000..=1120).collect::<Vec<_>>());
    assert_eq!(numbers(&floor, 2, 1000), [1000, 1120]);
    let times: Vec<_> = floor.heard(1).into_iter().filter(|value| value.status.is_good()).collect();
    assert!(times.is_sorted_by_key(|value| value.source_timestamp), "with their own times");

    let filled = floor.status(&source).filled;
    assert_eq!(filled.len(), 1, "{filled:?}");
    assert_eq!((filled[0].input.0, filled[0].values), (1, 119));
    assert_eq!((filled[0].since, filled[0].is_complete), (since, true));
    // What comes next comes at once.
    cell.set(COUNTER, 2000_u32).await.expect("set");
    floor.until_value(1, 2000_u32).await;
}

#[tokio::test]
async fn of_many_values_that_were_missed_the_oldest_are_read_and_the_rest_is_said_to_be_missing() {
    let simulation = Simulation::milling_cell().await;
    let cell = simulation.machine("Cell");
    let floor = TestShopFloor::start();
    let source = floor.connect_with_silence(&cell, 1000).await;
    floor.monitor(1, &source, node(&cell, COUNTER));
    until("the node is looked at", || floor.status(&source).findable == 1).await;
    floor.monitor(2, &source, node(&cell, "Status.StateText"));
    until("all are live", || floor.status(&source).live == 2).await;
    cell.set(COUNTER, 10_000_u32).await.expect("set");
    floor.until_value(1, 10_000_u32).await;
    cell.inject(MachineFault::HangNetwork).await.expect("injected");
    floor.until_status(1, StatusCode::BAD_NOT_CONNECTED).await;
    for number in 10_001..=11_500_u32 {
        cell.set(COUNTER, number).await.expect("set");
    }
    cell.inject(MachineFault::None).await.expect("healed");
    floor.until_value(1, 11_500_u32).await;
    let heard = numbers(&floor, 1, 10_000);
    assert!(heard.is_sorted() && heard.len() < 1100, "{} values", heard.len());
    let filled = floor.status(&source).filled;
    assert_eq!((filled.len(), filled[0].is_complete), (1, false));
}

/// A way to a server that is cut, and closed, while it is not open.
struct Way {
    port: u16,
    is_open: watch::Sender<bool>,
}

impl Way {
    async fn to(port: u16) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let own = listener.local_addr().expect("it is bound").port();
        let (is_open, changes) = watch::channel(true);
        tokio::spawn(async move {
            while let Ok((mut client, _)) = listener.accept().await {
                let mut changes = changes.clone();
                if !*changes.borrow_and_update() {
                    continue;
                }
                tokio::spawn(async move {
                    let server = TcpStream::connect(("127.0.0.1", port)).await;
                    let Ok(mut server) = server else { return };
                    tokio::select! {
                        _ = copy_bidirectional(&mut client, &mut server) => {}
                        _ = changes.changed() => {}
                    }
                });
            }
        });
        Self { port: own, is_open }
    }
}

#[tokio::test]
async fn asyncua_values_that_were_missed_are_read_from_its_history() {
    let mut peer = Peer::start(Stack::Asyncua, false).await;
    let way = Way::to(peer.port).await;
    let floor = TestShopFloor::start();
    let mut source = peer.source();
    source.endpoint_url = format!("opc.tcp://127.0.0.1:{}/machine", way.port);
    let source = floor.connect_to(source).await;
    floor.monitor(1, &source, peer.node(1));
    until("the node is looked at", || floor.status(&source).findable == 1).await;
    floor.monitor(2, &source, peer.node(3));
    until("both are live", || floor.status(&source).live == 2).await;
    // Another client, whose way stays open, sees what the server has.
    let witness = TestShopFloor::start();
    let direct = witness.connect_to(peer.source()).await;
    witness.monitor(1, &direct, peer.node(1));
    peer.set(r#"{"counter": 1000}"#).await;
    floor.until_value(1, 1000_i32).await;

    way.is_open.send_replace(false);
    floor.until_status(1, StatusCode::BAD_NOT_CONNECTED).await;
    for number in 1001..=1040 {
        peer.set(&format!(r#"{{"counter": {number}}}"#)).await;
    }
    witness.until_value(1, 1040_i32).await;
    way.is_open.send_replace(true);
    floor.until_value(1, 1040_i32).await;
    assert_eq!(numbers(&floor, 1, 1000), (1000..=1040).collect::<Vec<_>>());
    let filled = floor.status(&source).filled;
    assert_eq!((filled.len(), filled[0].values), (1, 39));
    assert!(filled[0].is_complete);
}

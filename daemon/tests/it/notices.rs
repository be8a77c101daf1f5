//! Third-party notices, served beside the pages.

use crate::harness::Harness;

#[tokio::test]
async fn notices_are_served_without_a_session() {
    let harness = Harness::start().await;
    let answer = harness.get("/third-party-notices.txt").await;
    assert_eq!(answer.status().as_u16(), 200);
    assert_eq!(answer.headers()["content-type"], "text/plain; charset=utf-8");
    assert_eq!(answer.text().await.expect("a text"), daemon::notices::NOTICES);
}

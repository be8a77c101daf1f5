//! The demo for people, as they start it.

use verbund_tests::demo;

#[tokio::test(flavor = "multi_thread")]
async fn the_demo_shows_an_order_from_its_first_frame_to_the_next_order() {
    rustls::crypto::ring::default_provider().install_default().ok();
    demo::watch(false).await.unwrap();
}

//! The frame order from end to end, with the real programs and other people's clients.

#[tokio::test(flavor = "multi_thread")]
async fn the_whole_story_holds() {
    rustls::crypto::ring::default_provider().install_default().ok();
    verbund_tests::demo::check(false).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_newcomer_maps_the_first_field_in_few_clicks() {
    rustls::crypto::ring::default_provider().install_default().ok();
    verbund_tests::demo::newcomer(false).await.unwrap();
}

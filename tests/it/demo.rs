//! The frame order from end to end, with the real programs and other people's clients.

use verbund_tests::{demo, world::BrokerKind};

#[tokio::test(flavor = "multi_thread")]
async fn the_whole_story_holds() {
    rustls::crypto::ring::default_provider().install_default().ok();
    demo::check(false).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_story_holds_with_rabbitmq_and_its_crash() {
    rustls::crypto::ring::default_provider().install_default().ok();
    demo::check_with(BrokerKind::RabbitMq, false).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_story_holds_with_mosquitto_and_its_crash() {
    rustls::crypto::ring::default_provider().install_default().ok();
    demo::check_with(BrokerKind::Mosquitto, false).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_newcomer_maps_the_first_field_in_few_clicks() {
    rustls::crypto::ring::default_provider().install_default().ok();
    demo::newcomer(false).await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_readme_leads_from_empty_folders_to_the_first_value() {
    rustls::crypto::ring::default_provider().install_default().ok();
    demo::by_the_readme().await.unwrap();
}

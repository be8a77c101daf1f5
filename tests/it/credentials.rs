//! Credentials at brokers of other makes: rotated beside running programs, and revoked by a platform that
//! cannot remove the account itself.

use std::{path::Path, process::Command, time::Duration};

use serde_json::{Value, json};
use verbund_tests::{
    demo::{Cast, play},
    frame_order::MUNICH,
    harness::{Api, Steps, binary, eventually},
    world::{BrokerKind, ExternalBroker, Places, World},
};

const PATIENCE: Duration = Duration::from_secs(90);
const FACTORY_USER: &str = "factory.FOR_MUC";

/// Enrols the running connector once more.
async fn enrol_again(folder: &Path, platform: &Api) {
    let path = format!("/api/v1/factories/{MUNICH}/enrolment-tokens");
    let token: Value = platform.post(&path, &json!({})).await.unwrap();
    let file = folder.join("token-again");
    std::fs::write(&file, token["token"].as_str().unwrap()).unwrap();
    let output = Command::new(binary("factory-connector").unwrap())
        .args(["enrol", "--token-file", &file.display().to_string(), "--config"])
        .arg(folder.join(format!("connector-{MUNICH}.toml")))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Returns how many reports of the factory arrived, and how many numbers before them are missing.
async fn arrived(platform: &Api) -> Result<(u64, u64), String> {
    let path = format!("/api/v1/factories/{MUNICH}/writers");
    let writers = platform.list(&path).await.map_err(|error| format!("{error:#}"))?;
    let sum = |key: &str| writers.iter().filter_map(|writer| writer[key].as_u64()).sum();
    Ok((sum("received"), sum("missingCount")))
}

/// Waits until more reports arrive and none is missing.
async fn values_flow(platform: &Api) {
    let (before, _) = arrived(platform).await.unwrap();
    eventually("values flow and none is missing", PATIENCE, || async {
        match arrived(platform).await? {
            (now, 0) if now > before + 3 => Ok(()),
            other => Err(format!("{other:?}, {before} before")),
        }
    })
    .await
    .unwrap();
}

/// Waits until the connector's page says that the broker refuses its sign-in.
async fn is_refused(connector: &Api) {
    eventually("the page says that the sign-in is refused", PATIENCE, || async {
        let status: Value = connector.get("/api/v1/status").await.map_err(|e| e.to_string())?;
        let link = &status["link"];
        let reason = link["reason"].as_str().unwrap_or_default();
        if link["state"] != "up" && reason.contains("password") {
            Ok(())
        } else {
            Err(link.to_string())
        }
    })
    .await
    .unwrap();
}

/// Waits until the connector's page says that the platform does not answer it.
async fn is_unanswered(connector: &Api) {
    eventually("the page says that the platform does not answer", PATIENCE, || async {
        let status: Value = connector.get("/api/v1/status").await.map_err(|e| e.to_string())?;
        let (link, lease) = (&status["link"]["state"], &status["lease"]["state"]);
        if *link == "up" && *lease == "UNANSWERED" {
            Ok(())
        } else {
            Err(format!("{link}, {lease}"))
        }
    })
    .await
    .unwrap();
}

fn broker(world: &mut World) -> &mut ExternalBroker {
    world.external.as_mut().expect("a broker of another make")
}

/// Makes a new password at the broker and in the platform's file, and ends all connections.
async fn rotate(world: &mut World, user_name: &str) {
    let folder = world.places.folder.clone();
    broker(world).rotate(user_name);
    broker(world).write_passwords(&folder).unwrap();
    broker(world).restart().await;
}

/// Waits until no password is in plain text in the platform's file.
async fn are_sealed(world: &World) {
    let file = world.places.folder.join("broker-passwords");
    eventually("the passwords are sealed", PATIENCE, || async {
        let text = std::fs::read_to_string(&file).map_err(|error| error.to_string())?;
        let plain: Vec<&str> = text.lines().filter(|line| !line.contains(" v1.")).collect();
        if plain.is_empty() { Ok(()) } else { Err(format!("{} in plain text", plain.len())) }
    })
    .await
    .unwrap();
}

/// Number of messages that were set aside since their sender's access was revoked.
async fn set_aside(platform: &Api) -> Result<usize, String> {
    let answer: Value =
        platform.get("/api/v1/dead-letters?limit=1000").await.map_err(|e| format!("{e:#}"))?;
    let letters = answer["items"].as_array().cloned().unwrap_or_default();
    Ok(letters.iter().filter(|letter| letter["code"] == "ACCESS_REVOKED").count())
}

async fn credentials_are_answered_with_the_truth(kind: BrokerKind) {
    rustls::crypto::ring::default_provider().install_default().ok();
    let folder = tempfile::tempdir().unwrap();
    let places = Places::anywhere(folder.path().to_owned()).unwrap();
    let external = ExternalBroker::start(kind).await;
    let mut world = World::start_beside(places, external).unwrap();
    let cast = play(&mut world, &mut Steps::default()).await.unwrap();
    let Cast { platform, munich, .. } = &cast;

    // The platform's own password, changed in its file beside it, which is sealed then.
    rotate(&mut world, "platform").await;
    values_flow(platform).await;
    are_sealed(&world).await;

    // A connector's: its page says what is wrong, and enrolling again mends it.
    rotate(&mut world, FACTORY_USER).await;
    is_refused(munich).await;
    are_sealed(&world).await;
    enrol_again(folder.path(), platform).await;
    values_flow(platform).await;

    // Revoked: the platform cannot remove the account, says so, and takes nothing of it.
    let path = format!("/api/v1/factories/{MUNICH}/credentials");
    let revoked: Value = platform.delete(&path).await.unwrap();
    assert_eq!(revoked["brokerAccount"], FACTORY_USER);
    eventually("what it sends is set aside", PATIENCE, || async {
        let count = set_aside(platform).await?;
        if count > 2 { Ok(()) } else { Err(format!("{count}")) }
    })
    .await
    .unwrap();
    is_unanswered(munich).await;
    let before = arrived(platform).await.unwrap();
    let count = set_aside(platform).await.unwrap();
    eventually("more is set aside", PATIENCE, || async {
        let now = set_aside(platform).await?;
        if now > count { Ok(()) } else { Err(format!("{now}")) }
    })
    .await
    .unwrap();
    assert_eq!(arrived(platform).await.unwrap(), before, "nothing of it counts");
    broker(&mut world).remove_account(FACTORY_USER);
    broker(&mut world).restart().await;
    is_refused(munich).await;

    // Enrolled again it goes on, and nothing of the time between is lost.
    rotate(&mut world, FACTORY_USER).await;
    enrol_again(folder.path(), platform).await;
    values_flow(platform).await;
    world.stop().unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn rotated_and_revoked_credentials_are_what_pages_say_with_rabbitmq() {
    credentials_are_answered_with_the_truth(BrokerKind::RabbitMq).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn rotated_and_revoked_credentials_are_what_pages_say_with_mosquitto() {
    credentials_are_answered_with_the_truth(BrokerKind::Mosquitto).await;
}

use super::*;

fn parse(text: &str) -> PlatformConfig {
    daemon::configuration::parse(None, text, "VERBUND", []).expect("valid")
}

#[test]
fn the_example_shows_the_defaults() {
    assert_eq!(format!("{:#?}", parse(EXAMPLE)), format!("{:#?}", PlatformConfig::default()));
}

#[test]
fn what_the_example_shows_as_comments_is_valid() {
    let shown: String = EXAMPLE
        .lines()
        .map(|line| line.strip_prefix("#: ").unwrap_or(line))
        .flat_map(|line| [line, "\n"])
        .collect();
    // The file that it names is another machine's.
    let shown: String = shown
        .lines()
        .filter(|line| !line.starts_with("password_file"))
        .flat_map(|line| [line, "\n"])
        .collect();
    let config = parse(&shown);
    assert_eq!(config.faults(), Vec::<String>::new());
    assert!(
        config.broker.external.is_some()
            && !config.broker.users.is_empty()
            && config.web.tls.is_some()
    );
}

#[test]
fn an_untested_broker_is_called_so_where_it_is_configured() {
    let external = |profile: &str| {
        parse(&format!(
            "[broker.external]\nurls = [\"amqps://b.example\"]\nprofile = \"{profile}\"\nuser_name = \"p\"\n\
             password = \"sixteen characters\"\n"
        ))
    };
    for profile in ["rabbitmq-4", "activemq"] {
        let note = external(profile).untested_broker().expect("a note");
        assert!(note.contains(profile) && note.contains("untested"), "{note}");
    }
    assert_eq!(external("rabbitmq-3").untested_broker(), None);
    assert_eq!(PlatformConfig::default().untested_broker(), None);
}

#[test]
fn an_mqtt_broker_is_said_to_drop_messages_where_it_is_configured() {
    let external = |url: &str, profile: &str| {
        parse(&format!(
            "[broker.external]\nurls = [\"{url}\"]\nprofile = \"{profile}\"\nuser_name = \"p\"\n\
             password = \"sixteen characters\"\n"
        ))
    };
    let note = external("mqtts://b.example", "mqtt").dropping_broker().expect("a note");
    assert!(note.contains("comments") && note.contains("definitions mosquitto"), "{note}");
    assert_eq!(external("amqps://b.example", "rabbitmq-3").dropping_broker(), None);
    assert_eq!(PlatformConfig::default().dropping_broker(), None);
}

#[test]
fn unsafe_settings_are_named() {
    let config =
        parse("[web]\nlisten = \"0.0.0.0:80\"\n[broker]\nplain_listen = \"0.0.0.0:5672\"\n");
    let faults = config.faults();
    assert_eq!(faults.len(), 2, "{faults:?}");
    assert!(faults[0].starts_with("broker.plain_listen") && faults[1].starts_with("web.listen"));
}

#[test]
fn an_address_that_leads_nowhere_is_named() {
    for (text, words) in [
        ("public_url = \"amqp+wss://a.example\"\n", Some("set broker.websocket_listen")),
        ("public_url = \"amqp+wss://a.example\"\nwebsocket_listen = \"0.0.0.0:443\"\n", None),
        ("public_url = \"mqtts://a.example\"\n", Some("speaks AMQP")),
        ("public_url = \"amqps://a.example\"\n", None),
    ] {
        let faults = parse(&format!("[broker]\n{text}")).faults();
        assert_eq!(faults.len(), usize::from(words.is_some()), "{text}: {faults:?}");
        assert!(words.is_none_or(|words| faults[0].contains(words)), "{text}: {faults:?}");
    }
}

#[test]
fn tokens_that_name_no_certificate_are_called_so_where_a_proxy_speaks_tls() {
    let notes = |web: &str| parse(&format!("[web]\n{web}")).notes();
    let behind_a_proxy = "public_url = \"https://verbund.example\"\n";
    let found = notes(behind_a_proxy);
    assert!(matches!(&found[..], [note] if note.contains("web.public_certificate")), "{found:?}");
    let of_the_proxy = format!("{behind_a_proxy}public_certificate = \"shown.pem\"\n");
    assert_eq!(notes(&of_the_proxy), [""; 0]);
    let own = format!("{behind_a_proxy}tls = {{ certificate = \"c.pem\", key = \"k.pem\" }}\n");
    assert_eq!(notes(&own), [""; 0]);
    assert_eq!(notes("public_url = \"http://127.0.0.1:8080\"\n"), [""; 0], "it shows none");
}

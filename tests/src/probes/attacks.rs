//! List of the attacks, in the order in which they are played.

use futures::future::BoxFuture;

use super::{
    accounts, amqp, behind_proxy, files, http, impostors, members, opcua, plant,
    route::Route,
    scene::{Scene, Target},
    strangers,
};
use crate::{frame_order::MUNICH, harness::Api};

/// An attack on a program.
pub(super) struct Attack {
    pub(super) target: Target,
    pub(super) name: &'static str,
    /// The attack itself. It says how it was answered, or fails where that is not as it should be.
    pub(super) course: BoxFuture<'static, anyhow::Result<String>>,
}

fn attack(
    target: Target,
    name: &'static str,
    course: impl Future<Output = anyhow::Result<String>> + Send + 'static,
) -> Attack {
    Attack { target, name, course: Box::pin(course) }
}

/// Returns all attacks. Guesses of passwords come last: they slow each sign-in of this machine down.
pub(super) fn attacks(scene: &Scene) -> Vec<Attack> {
    let mut all = of_the_broker(scene);
    all.extend(of_the_twin(scene));
    all.extend(of_members(scene));
    all.extend(of_strangers(scene));
    all.extend(of_files(scene));
    all.extend(of_the_plant(scene));
    all.extend(of_accounts(scene));
    all.extend(of_the_web(scene));
    all
}

fn of_the_broker(scene: &Scene) -> Vec<Attack> {
    let route = Route::hostile(scene.world.places.broker_plain);
    let log = scene.world.platform.log().to_owned();
    let of = Target::Broker;
    vec![
        attack(of, "lengths that strangers claim", amqp::claimed_lengths(route)),
        attack(of, "frames shorter than their header", amqp::short_frames(route, log)),
        attack(of, "frames nested 30 000 levels deep", amqp::nested(route)),
        attack(of, "messages nested 30 000 levels deep", amqp::nested_message(route)),
        attack(of, "a delivery that never ends", amqp::endless(route)),
        attack(of, "more links than one user may have", amqp::links(route)),
    ]
}

fn of_the_twin(scene: &Scene) -> Vec<Attack> {
    let twin = scene.world.places.munich.twin;
    let (route, engineer) = (Route::hostile(twin), || scene.cast.munich.clone());
    let honest = Route::honest(twin);
    let log = scene.world.factories[0].connector.as_ref().map(|it| it.log().to_owned());
    let log = log.unwrap_or_default();
    let of = Target::Twin;
    vec![
        attack(of, "messages that claim sizes", opcua::claimed_sizes(route)),
        attack(of, "chunks without end before a sign-in", opcua::endless_chunks(route)),
        attack(
            of,
            "policies that no endpoint offers",
            opcua::deprecated_policies(engineer(), route),
        ),
        attack(of, "paddings that are sound or broken", opcua::paddings(engineer(), route)),
        attack(
            of,
            "220 unknown certificates after one that was denied",
            opcua::denied_certificate(engineer(), route),
        ),
        attack(
            of,
            "certificates that came while all were trusted",
            opcua::trusted_in_development(scene.newcomer.clone(), honest),
        ),
        attack(of, "values nested in the header of a request", opcua::nested_headers(route)),
        attack(of, "ranks claimed in the header of a request", opcua::claimed_ranks(route)),
        attack(
            of,
            "guesses beside an engineer who signs in",
            opcua::guesses_beside_an_honest_sign_in(engineer(), honest, route),
        ),
        attack(
            of,
            "a password in the field of the name",
            opcua::names_typed_by_mistake(engineer(), route, log),
        ),
    ]
}

fn of_members(scene: &Scene) -> Vec<Attack> {
    let (platform, maker) = (scene.cast.platform.clone(), scene.maker.clone());
    let inspector = scene.inspector.clone();
    let of = Target::Platform;
    vec![
        attack(
            of,
            "another member's request under one's own name",
            members::takes_a_request_over(platform.clone(), maker.clone()),
        ),
        attack(of, "the end of another member's network", members::withdraws_the_network(maker)),
        attack(
            of,
            "reading what was released to another member",
            members::reads_of_others(platform.clone(), inspector),
        ),
        attack(of, "ids of another collaboration's networks", members::ids_of_others(platform)),
    ]
}

fn of_strangers(scene: &Scene) -> Vec<Attack> {
    let platform = || scene.cast.platform.clone();
    let broker = Route::hostile(scene.world.places.broker_plain);
    let of = Target::Platform;
    vec![
        attack(
            of,
            "reports of a foreign factory",
            strangers::reports_to_requests_of_others(platform()),
        ),
        attack(
            of,
            "a factory's rubbish, and what was set aside of another one",
            strangers::floods_dead_letters(platform()),
        ),
        attack(
            Target::Broker,
            "links to the addresses of another factory",
            strangers::addresses_of_others(platform(), broker),
        ),
        attack(
            of,
            "a comment under the name of a partner's planner",
            plant::borrowed_names(platform(), scene.cast.munich.clone()),
        ),
    ]
}

fn of_files(scene: &Scene) -> Vec<Attack> {
    let folder = &scene.world.places.folder;
    let connector = folder.join(format!("connector-{MUNICH}"));
    let name = "files that other users of the machine read";
    vec![
        attack(Target::Platform, name, files::of_the_user_alone(folder.join("platform"))),
        attack(Target::Connector, name, files::of_the_user_alone(connector)),
        attack(
            Target::Platform,
            "addresses without encryption",
            files::plaintext_addresses(folder.clone()),
        ),
        attack(
            Target::Connector,
            "an enrolment without encryption",
            files::plaintext_enrolment(folder.clone()),
        ),
    ]
}

fn of_the_plant(scene: &Scene) -> Vec<Attack> {
    let engineer = || scene.cast.munich.clone();
    let folder = || scene.world.places.folder.clone();
    let of = Target::Connector;
    vec![
        attack(of, "a machine that claims sizes", impostors::claims_of_a_machine(engineer())),
        attack(
            of,
            "a machine that nobody approved",
            impostors::unapproved_machine(engineer(), folder()),
        ),
        attack(
            of,
            "a broker that claims lengths and nests",
            impostors::broker_that_means_harm(folder()),
        ),
        attack(of, "live values for those who only look", plant::live_values(engineer())),
        attack(of, "verifications of the ledger at once", plant::verifications(engineer())),
        attack(of, "texts that a spreadsheet runs", plant::formulas(engineer())),
    ]
}

fn of_accounts(scene: &Scene) -> Vec<Attack> {
    let (platform, munich) = (&scene.cast.platform, &scene.cast.munich);
    let folder = || scene.world.places.folder.clone();
    let places = &scene.world.places;
    let pages = [places.platform_web, places.munich.connector_web];
    let mut all = vec![
        attack(Target::Platform, "a person who has left", accounts::leaver(platform.clone())),
        attack(
            Target::Platform,
            "the cookie of another daemon or without encryption",
            behind_proxy::cookies(folder(), pages),
        ),
        attack(
            Target::Platform,
            "guesses from many places at once, or through a proxy",
            behind_proxy::places(folder()),
        ),
    ];
    for (of, api, role) in [
        (Target::Platform, platform, accounts::planner()),
        (Target::Connector, munich, accounts::viewer()),
    ] {
        let api: &Api = api;
        let session = accounts::open_session(api.clone(), role.clone());
        all.push(attack(of, "the open session of another", session));
        all.push(attack(of, "sessions without number", accounts::sessions(api.clone(), role)));
    }
    all
}

fn of_the_web(scene: &Scene) -> Vec<Attack> {
    let places = &scene.world.places;
    let mut all = Vec::new();
    let (networks, policies) = ("/api/v1/operation-networks/n", "/api/v1/policies/p");
    for (of, port, api, document) in [
        (Target::Platform, places.platform_web, &scene.cast.platform, networks),
        (Target::Connector, places.munich.connector_web, &scene.cast.munich, policies),
    ] {
        all.extend([
            attack(of, "documents that nest", http::nested_documents(api.clone(), document)),
            attack(of, "metrics through a proxy", http::metrics_from_elsewhere(port)),
            attack(of, "heads without end", http::endless_heads(port)),
            attack(of, "bodies without end", http::endless_bodies(port)),
            attack(of, "user names of half a megabyte", http::long_names(port)),
            attack(of, "60 guesses of a password at once", http::guesses(port)),
        ]);
    }
    all
}

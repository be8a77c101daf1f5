//! List of the attacks, in the order in which they are played.

use futures::future::BoxFuture;

use super::{
    amqp, files, http, members, opcua,
    route::Route,
    scene::{Scene, Target},
    strangers,
};
use crate::frame_order::MUNICH;

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
    all.extend(of_the_web(scene));
    all
}

fn of_the_broker(scene: &Scene) -> Vec<Attack> {
    let route = Route::hostile(scene.world.places.broker_plain);
    let of = Target::Broker;
    vec![
        attack(of, "lengths that strangers claim", amqp::claimed_lengths(route)),
        attack(of, "frames nested 30 000 levels deep", amqp::nested(route)),
        attack(of, "messages nested 30 000 levels deep", amqp::nested_message(route)),
        attack(of, "a delivery that never ends", amqp::endless(route)),
    ]
}

fn of_the_twin(scene: &Scene) -> Vec<Attack> {
    let route = Route::hostile(scene.world.places.munich.twin);
    let of = Target::Connector;
    vec![
        attack(of, "messages that claim sizes", opcua::claimed_sizes(route)),
        attack(of, "chunks without end before a sign-in", opcua::endless_chunks(route)),
        attack(
            of,
            "policies that no endpoint offers",
            opcua::deprecated_policies(scene.cast.munich.clone(), route),
        ),
        attack(
            of,
            "220 unknown certificates after one that was denied",
            opcua::denied_certificate(scene.cast.munich.clone(), route),
        ),
        attack(of, "values nested in the header of a request", opcua::nested_headers(route)),
        attack(of, "ranks claimed in the header of a request", opcua::claimed_ranks(route)),
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
            members::reads_of_others(platform, inspector),
        ),
    ]
}

fn of_strangers(scene: &Scene) -> Vec<Attack> {
    let platform = &scene.cast.platform;
    let of = Target::Platform;
    vec![
        attack(
            of,
            "reports of a foreign factory",
            strangers::reports_to_requests_of_others(platform.clone()),
        ),
        attack(
            of,
            "a factory's rubbish, and what was set aside of another one",
            strangers::floods_dead_letters(platform.clone()),
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

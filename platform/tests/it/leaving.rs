//! People and organisations leave by themselves: each what is its own, shortly after a sign-in, and nobody else's.

use serde_json::{Value, json};

use crate::{
    audit_facts::newest,
    harness::{ADMIN, Api, PASSWORD, World},
    story::{self, network_path},
};

const TOOL: &str = "/tools/Scheduling";
const FACTORY: &str = "/factories/FOR_MUC";
const MEMBER: &str = "/collaborations/order/members/frames-munich";
const FACTORY_OF_COLLABORATION: &str = "/collaborations/order/factories/FOR_MUC";

/// Makes all sessions older than the time in which one's own leaves.
async fn age(world: &World) {
    let address = format!("sqlite://{}", world.database().display());
    let pool = sqlx::SqlitePool::connect(&address).await.expect("open");
    let sql = "UPDATE session SET started_at = started_at - 601 * 10000000";
    sqlx::query(sql).execute(&pool).await.expect("older");
    pool.close().await;
}

async fn refused_to(api: &Api, paths: &[&str]) {
    for path in paths {
        for query in ["?dryRun=true", ""] {
            api.delete(&format!("{path}{query}")).await.expect_problem(403, "FORBIDDEN");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_person_ends_its_own_account_shortly_after_a_sign_in_and_no_other_one() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let viewer = world.sign_in("acme-aero-viewer", PASSWORD).await;
    let own = "/users/acme-aero-viewer";
    let planner = story::planner(&world, "acme-aero").await;
    refused_to(&viewer, &["/users/acme-aero-planner", "/users/nobody", "/users/admin"]).await;
    refused_to(&planner, &[own, "/users/nobody"]).await;

    age(&world).await;
    let shown = viewer.delete(&format!("{own}?dryRun=true")).await.expect_ok();
    assert_eq!((&shown["sessions"], &shown["isDone"]), (&json!(1), &json!(false)));
    viewer.delete(own).await.expect_problem(403, "SIGN_IN_AGAIN");
    assert_eq!(viewer.get("/session").await.status, 200, "the account is there");

    let again = world.sign_in("acme-aero-viewer", PASSWORD).await;
    assert_eq!(again.delete(own).await.expect_ok()["isDone"], true);
    for left in [&viewer, &again] {
        assert_eq!(left.get("/session").await.status, 401);
    }
    let entry = newest(&planner, "removeUser").await;
    let who = (&entry["agentName"], &entry["subject"]);
    assert_eq!(who, (&json!("acme-aero-viewer"), &json!("users/acme-aero-viewer")));

    // Of an administrator as well; the last one stays.
    let body = json!({ "password": PASSWORD, "role": "ADMINISTRATOR", "organisationId": null });
    admin.put("/users/second", body).await.expect_ok();
    let second = world.sign_in("second", PASSWORD).await;
    age(&world).await;
    second.delete("/users/second").await.expect_problem(403, "SIGN_IN_AGAIN");
    let second = world.sign_in("second", PASSWORD).await;
    second.delete("/users/second").await.expect_ok();
    world.admin().await.delete("/users/admin").await.expect_problem(409, "IN_FORCE");
}

#[tokio::test(flavor = "multi_thread")]
async fn planners_let_what_is_their_organisations_leave_and_nothing_else() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let tool =
        json!({ "toolId": "Scheduling", "organisationId": "frames-munich", "name": "Scheduling" });
    admin.post("/tools", tool).await.expect_ok();
    let maker = story::planner(&world, "frames-munich").await;
    let buyer = story::planner(&world, "acme-aero").await;
    let viewer = world.sign_in("frames-munich-viewer", PASSWORD).await;
    let all = [TOOL, FACTORY, MEMBER, FACTORY_OF_COLLABORATION, "/organisations/frames-munich"];
    refused_to(&buyer, &all).await;
    refused_to(&viewer, &all).await;
    // What never was is refused alike, so that a refusal says nothing.
    refused_to(&buyer, &["/tools/None", "/factories/NONE", "/collaborations/none/members/none"])
        .await;
    refused_to(&maker, &["/organisations/frames-munich", "/factories/INS_HAM"]).await;

    story::put_network(&buyer, story::network()).await;
    for path in [FACTORY_OF_COLLABORATION, MEMBER, FACTORY] {
        maker.delete(path).await.expect_problem(409, "IN_FORCE");
    }
    buyer.delete(&network_path()).await.expect_ok();
    let shown = maker.delete(&format!("{MEMBER}?dryRun=true")).await.expect_ok();
    let own = json!(["collaborations/order/factories/FOR_MUC"]);
    assert_eq!(shown["inForce"], own, "its factory first");

    age(&world).await;
    let in_order = [FACTORY_OF_COLLABORATION, MEMBER, FACTORY, TOOL];
    for path in in_order {
        maker.delete(path).await.expect_problem(403, "SIGN_IN_AGAIN");
    }
    let maker = story::planner(&world, "frames-munich").await;
    for path in in_order {
        assert_eq!(maker.delete(path).await.expect_ok()["isDone"], true, "{path}");
        maker.delete(path).await.expect_problem(403, "FORBIDDEN");
    }
    let entry = newest(&maker, "removeMember").await;
    assert_eq!(entry["agentName"], "frames-munich-planner");
    let left = |list: Value| !list.to_string().contains("FOR_MUC");
    assert!(left(admin.get("/factories").await.expect_ok()));
    assert_eq!(admin.get("/tools").await.expect_ok()["items"], json!([]));
    assert_eq!(maker.get("/collaborations").await.expect_ok()["items"], json!([]));
}

#[tokio::test(flavor = "multi_thread")]
async fn names_of_people_are_never_given_again() {
    let mut world = World::start().await;
    let admin = story::set_up(&world).await;
    let body = |role: &str| json!({ "password": PASSWORD, "role": role, "organisationId": null });
    admin.delete("/users/acme-aero-viewer").await.expect_ok();
    // Also of people who left with their organisation.
    admin.delete("/organisations/stranger").await.expect_ok();
    for name in ["acme-aero-viewer", "stranger-planner"] {
        let put = admin.put(&format!("/users/{name}"), body("ADMINISTRATOR")).await;
        put.expect_problem(409, "NAME_WAS_USED");
    }
    // A start makes no administrator again that has left, and goes on.
    admin.put("/users/second", body("ADMINISTRATOR")).await.expect_ok();
    admin.delete(&format!("/users/{ADMIN}")).await.expect_ok();
    world.restart().await;
    let attempt = json!({ "userName": ADMIN, "password": PASSWORD });
    assert_eq!(world.anonymous().post("/session", attempt).await.status, 401);
    let second = world.sign_in("second", PASSWORD).await;
    second
        .put(&format!("/users/{ADMIN}"), body("VIEWER"))
        .await
        .expect_problem(409, "NAME_WAS_USED");
}

#[tokio::test(flavor = "multi_thread")]
async fn an_organisation_takes_the_last_administrators_not_with_it() {
    let world = World::start().await;
    let admin = story::set_up(&world).await;
    let body =
        json!({ "password": PASSWORD, "role": "ADMINISTRATOR", "organisationId": "stranger" });
    admin.put("/users/second", body).await.expect_ok();
    let second = world.sign_in("second", PASSWORD).await;
    second.delete(&format!("/users/{ADMIN}")).await.expect_ok();
    let organisation = "/organisations/stranger";
    let shown = second.delete(&format!("{organisation}?dryRun=true")).await.expect_ok();
    assert_eq!(shown["inForce"], json!(["users/second"]));
    second.delete(organisation).await.expect_problem(409, "IN_FORCE");
}

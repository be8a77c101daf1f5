//! Every operation that changes something, by a planner of each member, against what belongs to each
//! other member. Of a document every change of every place is tried.

use serde_json::Value;

use super::{
    Member,
    attempts::attempts,
    members,
    owners::{DRAWER, Owner},
    places::{Change, Known, changes},
    refusals::Refusals,
};
use crate::{
    chain::{self, MEMBERS, body, seen},
    harness::{Answer, Api, World},
    isolation::{OPEN, is_own, operations},
    story::{NETWORK, network_path},
};

/// Everything that could be changed, as administrators and owners see it.
async fn state(admin: &Api, members: &[Member]) -> Value {
    let mut state = Vec::new();
    for path in ["/organisations", "/collaborations", "/tools", "/operation-networks", "/factories"]
    {
        state.push(admin.get(path).await.expect_ok());
    }
    for id in members.iter().map(Member::network).chain([NETWORK.to_owned()]) {
        state.push(
            admin.get(&format!("/operation-networks/{id}")).await.expect_ok()["network"].clone(),
        );
    }
    for member in members {
        for id in [member.network(), NETWORK.to_owned()] {
            let path = format!("/operation-networks/{id}/comments");
            state.push(member.api.get(&path).await.expect_ok());
        }
    }
    Value::Array(state)
}

/// Numbers of what was tried.
#[derive(Debug, Default)]
pub struct Tried {
    pub attempts: usize,
    /// Attempts that were compared with the same ones on what never existed.
    pub compared: usize,
    /// Changes of places in documents that are not the author's to make.
    pub changes: usize,
    /// Number of these that were refused for the author's rights, and not for the form alone.
    pub by_right: usize,
}

/// Returns the changes of the chain's document as a member sees it.
fn changes_of(author: &Member, members: &[Member], shown: &Value, requester: &str) -> Vec<Change> {
    // The first factory is another's.
    let mut factories: Vec<String> =
        members.iter().map(|member| member.factory.to_owned()).collect();
    factories.sort_by_key(|factory| factory == author.factory);
    let organisations = MEMBERS.map(str::to_owned).to_vec();
    let known = Known { factories, organisations, requester: requester.to_owned() };
    changes(shown, &known)
}

async fn put(author: &Member, document: &Value) -> Answer {
    author.api.put(&network_path(), body(document.clone())).await
}

/// Lets each member try everything, and asserts that nothing changed and nothing was told.
pub async fn attack(stage: &str, admin: &Api, members: &[Member]) -> Tried {
    let before = state(admin, members).await;
    let chain = seen(admin).await;
    let mut tried = Tried::default();
    for author in members {
        let shown = seen(&author.api).await;
        for owner in members.iter().filter(|owner| owner.id != author.id) {
            against(stage, (author, owner), (&chain, &shown), members, &mut tried).await;
        }
        let owner = Owner { author: author.id, shown: &shown };
        let another = MEMBERS.into_iter().find(|id| *id != author.id).expect("another");
        for requester in [author.id, another] {
            let all = changes_of(author, members, &shown, requester);
            for change in all.iter().filter(|change| !owner.may(change)) {
                let answer = put(author, &change.document).await;
                tried.by_right += usize::from(owner.assert_refused(change, &answer));
                assert_untold(author, members, &answer);
                tried.changes += 1;
            }
        }
    }
    assert_eq!(state(admin, members).await, before, "{stage}");
    tried
}

fn assert_untold(author: &Member, members: &[Member], answer: &Answer) {
    let text = answer.body.to_string();
    for other in members.iter().filter(|other| other.id != author.id) {
        assert!(!text.contains(&other.secret()), "{text}");
    }
}

/// Lets one member try every operation against what is one other's.
async fn against(
    stage: &str,
    (author, owner): (&Member, &Member),
    (chain, shown): (&Value, &Value),
    members: &[Member],
    tried: &mut Tried,
) {
    for (method, path) in operations() {
        let key = format!("{method} {path}");
        if method == "GET" || is_own(&path) || OPEN.contains(&key.as_str()) {
            continue;
        }
        for (path, body) in attempts(&key, author, owner, chain, shown) {
            let answer =
                author.api.call(method.parse().expect("a method"), &path, body.clone()).await;
            // A document without what is hidden is the one that the author sees.
            let is_unchanged = answer.body["isChanged"] == false;
            assert!(
                is_unchanged || [403, 404, 409, 422].contains(&answer.status),
                "{stage}: {} against {}: {method} {path} {body:?} gives {answer:?}",
                author.id,
                owner.id
            );
            assert_untold(author, members, &answer);
            let hidden = Refusals::new(author, owner, chain, shown);
            let attempt = (&*path, body.as_ref());
            tried.compared += hidden.assert_as_never_existed(&key, attempt, &answer).await;
            tried.attempts += 1;
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn no_member_changes_what_belongs_to_another() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let members = members(&world, &admin).await;
    let tried = attack("drawn", &admin, &members).await;
    assert!(tried.attempts > 200, "only {tried:?}");
    assert!(tried.compared > 50, "only {tried:?}");
    assert!(tried.changes > 500 && tried.by_right > 400, "only {tried:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn each_member_changes_what_is_its_own() {
    let world = World::start().await;
    let admin = chain::drawn(&world).await;
    let members = members(&world, &admin).await;
    for author in &members {
        let shown = seen(&author.api).await;
        let owner = Owner { author: author.id, shown: &shown };
        let (mut taken, mut tried) = (0, 0);
        let all = changes_of(author, &members, &shown, author.id);
        for change in all.iter().filter(|change| owner.may(change)) {
            let answer = put(author, &change.document).await;
            owner.assert_taken_for_own(change, &answer);
            tried += 1;
            if answer.body["isChanged"] == true {
                taken += 1;
                put(author, &shown).await.expect_ok();
            }
        }
        let least = if author.id == DRAWER { 40 } else { 8 };
        assert!(taken >= least, "{}: only {taken} of {tried}", author.id);
    }
}

//! Every operation that changes something, by a planner of each member, against what belongs to each
//! other member. Of a document every change of every place is tried.

use std::collections::BTreeMap;

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

/// Places whose changes make a document that is no network, or another one, so that nobody's rights are
/// looked at. What is within them is changed, too.
const REFUSED_FOR_FORM: [&str; 6] = [
    "/operationList",
    "/operationList/#/dynamicDataRequestList/#/recipientList",
    "/operationList/#/dynamicDataRequestList/#/reportDataFormat",
    "/operationList/#/dynamicDataRequestList/#/reportDataFormat/reportFieldList",
    "/operationNetworkId",
    "/operationRelationList/#/conditionList",
];

/// Amount of what was tried.
#[derive(Debug, Default)]
pub struct Tried {
    pub attempts: usize,
    /// Attempts that were compared with the same ones on what never existed.
    pub compared: usize,
    /// Changes of places in documents that are not the author's to make.
    pub changes: usize,
    /// Number of these that were refused for the author's rights, and not for the form alone, by
    /// place in the schema.
    pub by_right: BTreeMap<String, usize>,
}

impl Tried {
    fn add(&mut self, change: &Change, is_by_right: bool) {
        self.changes += 1;
        let steps = change.pointer.split('/');
        let is_number = |step: &str| step.parse::<usize>().is_ok();
        let steps = steps.map(|step| if is_number(step) { "#" } else { step });
        let place = steps.collect::<Vec<_>>().join("/");
        *self.by_right.entry(place).or_default() += usize::from(is_by_right);
    }

    /// Asserts that at each place of the schema a change was refused for rights.
    pub fn assert_every_place(&self) {
        let never = self.by_right.iter().filter(|(_, count)| **count == 0);
        let never: Vec<_> = never.map(|(place, _)| place.as_str()).collect();
        assert_eq!(never, REFUSED_FOR_FORM, "refused for its form alone");
        assert!(self.by_right.len() > 50, "only {} places", self.by_right.len());
    }
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
                tried.add(change, owner.assert_refused(change, &answer));
                assert_untold(author, members, &answer);
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
    assert!(tried.changes > 500, "only {tried:?}");
    tried.assert_every_place();
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

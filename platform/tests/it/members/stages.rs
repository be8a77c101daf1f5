//! Every reading of every member before, during and after revisions, refusals, releases of the past,
//! revocations and consents that are given again; and every change before, during and after them.

use super::{
    oracle::{Door, Subject},
    play::{ADMINISTRATOR, ALL, BUYER, INSPECTOR, MAKER, OF_THE_BUYER, Play, path},
};
use crate::{harness::World, story::NETWORK};

#[tokio::test(flavor = "multi_thread")]
async fn at_each_stage_each_member_reads_what_is_for_it_and_nothing_else() {
    let world = World::start().await;
    let mut play = Play::begin(&world).await;
    play.answer().await;
    play.check("asked").await;
    play.decide(&ALL, "MAPPED").await;
    let first = play.report(&[BUYER], &ALL, &ALL).await;
    play.check("consented to the buyer").await;
    play.attack("consented to the buyer").await;

    let both = [BUYER, INSPECTOR];
    play.revise(&both).await;
    let purpose = play.oracle.allowed(ADMINISTRATOR, Door::Present).pop_first().expect("a purpose");
    let readers = [BUYER, MAKER, ADMINISTRATOR, INSPECTOR];
    play.oracle.show(Subject::Purpose, purpose, &readers);
    play.report(&[BUYER], &[3], &ALL).await;
    play.check("a revision adds the inspector").await;
    play.attack("a revision adds the inspector").await;
    play.answer().await;
    play.check("the revision is answered").await;
    play.decide(&OF_THE_BUYER, "MAPPED").await;
    play.report(&both, &ALL, &ALL).await;
    play.check("consented to both").await;
    play.release_the_past();
    play.oracle.give(Door::History, first[2], &[INSPECTOR]);
    play.report(&both, &ALL, &ALL).await;
    play.check("the past is shown in the second network alone").await;

    play.revise(&[INSPECTOR]).await;
    play.report(&both, &[3], &ALL).await;
    play.check("a revision removes the buyer").await;
    play.attack("a revision removes the buyer").await;
    play.answer().await;
    play.decide(&OF_THE_BUYER, "MAPPED").await;
    play.report(&[INSPECTOR], &ALL, &ALL).await;
    play.check("consented to the inspector").await;

    play.revoke().await;
    play.decide(&OF_THE_BUYER, "PENDING").await;
    play.report(&[INSPECTOR], &[3], &ALL).await;
    play.check("revoked").await;
    play.attack("revoked").await;
    play.decide(&OF_THE_BUYER, "MAPPED").await;
    play.report(&[INSPECTOR], &ALL, &ALL).await;
    play.check("consented again").await;
    play.attack("consented again").await;
    play.revise(&both).await;
    play.answer().await;
    play.decide(&OF_THE_BUYER, "MAPPED").await;
    play.report(&both, &ALL, &ALL).await;
    play.check("the buyer is back").await;

    play.api(BUYER).delete(&path(NETWORK)).await.expect_ok();
    [0, 1, 3].into_iter().for_each(|number| play.close(number));
    play.report(&both, &[2], &[2]).await;
    play.check("withdrawn").await;
}

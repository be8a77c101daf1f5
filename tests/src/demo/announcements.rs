//! Announcements of the demo: what happens when, and where it is seen.

use crate::{
    course::Course,
    frame_order::{MUNICH, NETWORK},
    world::Places,
};

/// Announcements of this many seconds are shown beforehand: what a newcomer waits for.
pub(super) const FORETOLD: u32 = 180;

/// Event of a round, with the pages that show it.
#[derive(Debug)]
pub(super) struct Announcement {
    /// Seconds from the begin of the round.
    pub at: u32,
    pub what: String,
    /// Pages, each with what is seen there.
    pub look: Vec<String>,
    /// True where the demo itself lets it happen, by `kill -9` of Munich's connector.
    pub kills: bool,
}

impl Announcement {
    /// Returns its lines, with the time in front.
    pub(super) fn lines(&self, time: &str) -> String {
        let look = self.look.iter().map(|place| format!("\n{:9}{place}", ""));
        format!("{time:>7}  {}{}", self.what, look.collect::<String>())
    }
}

/// Seconds as people read them: `1:05`.
pub(super) fn minutes(seconds: u32) -> String {
    format!("{}:{:02}", seconds / 60, seconds % 60)
}

fn announcement(at: u32, what: String, look: Vec<String>) -> Announcement {
    Announcement { at, what, look, kills: false }
}

/// Returns what happens in a round, in the order of time. The kill is part of the first one.
pub(super) fn of_round(course: &Course, round: u32, places: &Places) -> Vec<Announcement> {
    let mut all = of_making(course, round, places);
    if round == 0 {
        all.push(of_kill(course, places));
    }
    all.extend(of_what_follows(course, round));
    all.sort_by_key(|announcement| announcement.at);
    all
}

fn network_page(places: &Places) -> String {
    format!("http://127.0.0.1:{}/#/networks/{NETWORK}", places.platform_web)
}

fn of_making(course: &Course, round: u32, places: &Places) -> Vec<Announcement> {
    let pace = course.pace;
    let (make, network) = (pace.make, network_page(places));
    let munich = format!("http://127.0.0.1:{}/#", places.munich.connector_web);
    let planned = (make.planned.1 - make.planned.0) / make.quantity;
    let (fails, lasts) = pace.failure;
    let field = format!("{NETWORK}/MakeFrame1/ReqResponse1/operationState");
    vec![
        announcement(
            make.start,
            format!(
                "Munich begins order {}: {} frames, {} s each at the mill, {planned} s planned.",
                course.order_id(round),
                make.quantity,
                make.cycle,
            ),
            vec![format!(
                "Partners: {network} - counted from 0; \"late\", and what waits is \"Held up\""
            )],
        ),
        announcement(
            make.start + fails,
            format!("The milling cell fails for {lasts} s: tool life exceeded."),
            vec![
                format!(
                    "Partners: {network}/MakeFrame1 - \"Interrupted\", and the expected end moves"
                ),
                format!("Munich:   {munich}/fields/{field} - the same, before it leaves"),
                format!("Munich:   {munich}/sources/MillingCell1 - the machine: Status, AlarmText"),
            ],
        ),
        announcement(
            make.start + fails + lasts,
            "The milling cell works again: \"Running\", and it counts on from where it was."
                .to_owned(),
            Vec::new(),
        ),
        announcement(
            pace.made_after(),
            format!(
                "{0} of {0} frames are made, {1} min late. The cell is idle until the next order.",
                make.quantity,
                minutes(pace.late()),
            ),
            vec![format!(
                "Partners: {network}/MakeFrame1 - \"Ended\", and nothing beyond the plan"
            )],
        ),
    ]
}

fn of_kill(course: &Course, places: &Places) -> Announcement {
    let (at, away) = course.pace.kill;
    let (network, munich) = (network_page(places), places.munich.connector_web);
    let factory = format!("http://127.0.0.1:{}/#/factories/{MUNICH}", places.platform_web);
    Announcement {
        at,
        what: format!(
            "The demo kills Munich's connector (kill -9), and starts it again after {away} s."
        ),
        look: vec![
            format!("Munich:   http://127.0.0.1:{munich} - no connection; then sign in again"),
            format!("Partners: {network}/MakeFrame1 - values grow old, then go on"),
            format!("Partners: {factory} - every writer \"Complete\": nothing was lost"),
        ],
        kills: true,
    }
}

fn of_what_follows(course: &Course, round: u32) -> Vec<Announcement> {
    let pace = course.pace;
    let (shipped, inspected, assembled) =
        (pace.actual(pace.ship), pace.actual(pace.inspect), pace.actual(pace.assemble));
    let rest = minutes(pace.every - assembled.1);
    [
        (shipped.0, "The belt in Munich loads the frames, late since it had to wait.".to_owned()),
        (inspected.0, "Hamburg inspects the frames.".to_owned()),
        (assembled.0, "Hamburg assembles the fuselage.".to_owned()),
        (
            assembled.1,
            format!(
                "Order {} is done; the machines are idle. In {rest} min {} begins, newly planned.",
                course.order_id(round),
                course.order_id(round + 1),
            ),
        ),
    ]
    .into_iter()
    .map(|(at, what)| announcement(at, what, Vec::new()))
    .collect()
}

#[cfg(test)]
mod tests {
    use time::OffsetDateTime;

    use super::*;
    use crate::course::UNHURRIED;

    #[test]
    fn a_newcomer_hears_of_delay_failure_recovery_and_kill_before_they_happen() {
        let folder = tempfile::tempdir().expect("a folder");
        let course = Course::begin(&UNHURRIED, folder.path(), OffsetDateTime::UNIX_EPOCH);
        let course = course.expect("a course");
        let places = Places::anywhere(folder.path().to_owned()).expect("free ports");
        let all = of_round(&course, 0, &places);
        let foretold = all.iter().filter(|announcement| announcement.at < FORETOLD);
        let texts: Vec<&str> = foretold.map(|announcement| announcement.what.as_str()).collect();
        let named = |word: &str| texts.iter().any(|text| text.contains(word));
        assert!(["planned", "fails", "works again", "kills"].into_iter().all(named), "{texts:?}");
        assert!(all.is_sorted_by_key(|announcement| announcement.at));
        assert!(of_round(&course, 1, &places).iter().all(|announcement| !announcement.kills));
        assert!(all[1].lines("1:00").starts_with("   1:00  The milling cell fails"));
    }
}

//! The parts of an ActiveMQ Artemis `broker.xml` that Verbund needs. Written after its
//! documentation and not tried against the broker.

use std::fmt::Write;

use super::BrokerPlan;
use crate::address::LogicalAddress;

/// The first line, which says so where it is used.
const UNTESTED: &str = "<!-- Generated. Untested: written after the documentation of ActiveMQ Artemis. Try loss, redelivery and rights before \
     you rely on it. -->\n";

/// `<security-settings>`, `<address-settings>` and `<addresses>`, to be put into `<core>`. Each
/// user's role has the user's name; users and passwords belong into the broker's login module.
#[must_use]
pub fn artemis_broker_xml(plan: &BrokerPlan) -> String {
    let rights = plan.rights();
    let mut xml = format!("{UNTESTED}<security-settings>\n");
    for queue in plan.queues().iter().chain([&LogicalAddress::DeadLetters]) {
        let roles = |list: for<'r> fn(&'r super::Rights<'_>) -> &'r Vec<LogicalAddress>| {
            let names = rights
                .iter()
                .filter(|r| list(r).contains(queue))
                .map(|r| escaped(&r.account.user_name));
            names.collect::<Vec<_>>().join(",")
        };
        let (send, consume) = (roles(|r| &r.produce), roles(|r| &r.consume));
        let _ = write!(
            xml,
            "  <security-setting match=\"{queue}\">\n    <permission type=\"send\" roles=\"{send}\"/>\n    \
             <permission type=\"consume\" roles=\"{consume}\"/>\n  </security-setting>\n"
        );
    }
    let _ = write!(
        xml,
        "</security-settings>\n<address-settings>\n  <address-setting match=\"#\">\n    \
         <dead-letter-address>{}</dead-letter-address>\n    <max-delivery-attempts>{}</max-delivery-attempts>\n    \
         <max-size-bytes>{}</max-size-bytes>\n    <address-full-policy>FAIL</address-full-policy>\n    \
         <auto-create-queues>false</auto-create-queues>\n    <auto-create-addresses>false</auto-create-addresses>\n  \
         </address-setting>\n</address-settings>\n<addresses>\n",
        LogicalAddress::DeadLetters,
        plan.limits.deliveries_max,
        plan.limits.bytes_max
    );
    for queue in plan.queues().iter().chain([&LogicalAddress::DeadLetters]) {
        let _ = writeln!(
            xml,
            "  <address name=\"{queue}\"><anycast><queue name=\"{queue}\"/></anycast></address>"
        );
    }
    xml.push_str("</addresses>\n");
    xml
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definitions::{Account, QueueLimits};

    #[test]
    fn each_address_names_its_writers_and_readers() {
        let account =
            |name: &str| Account { user_name: name.to_owned(), password: String::new().into() };
        let plan = BrokerPlan {
            platform: account("platform"),
            factories: vec![("f1".parse().expect("an id"), account("f1"))],
            tools: vec![("t1".parse().expect("an id"), account("t1"))],
            limits: QueueLimits::default(),
        };
        let xml = artemis_broker_xml(&plan);
        let first = xml.lines().next().expect("a line");
        assert!(
            first.starts_with("<!-- ") && first.contains("Untested") && first.ends_with(" -->")
        );
        assert!(xml.contains(
            "<security-setting match=\"factory.f1.ingress\">\n    <permission type=\"send\" roles=\"f1\"/>\n    <permission type=\"consume\" roles=\"platform\"/>"
        ));
        assert!(xml.contains(
            "<address name=\"tool.t1.reports\"><anycast><queue name=\"tool.t1.reports\"/></anycast></address>"
        ));
    }
}

//! The whole connector in this process, over real machines of the simulator; the platform stays
//! away.

mod account;
mod answers;
mod caps;
mod control;
mod corpus;
mod enrolling;
mod events;
mod killed;
mod ledger;
mod logs;
mod machine_alarms;
mod machine_turns;
mod mappings;
mod plant;
mod previews;
mod roles;
mod shown;
mod source_inquiry;
mod texts_of_scripts;
mod trust;
mod twin_sign_in;

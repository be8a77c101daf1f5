//! Queries that concern more than one registry of the state. None changes it.

mod alike;
mod caps;
mod disclosed;
mod mapping_import;
mod open_fields;
mod operation_fields;
mod past_offer;
mod policies;
mod report_frame;
mod rule_offers;
mod shown_tag;
mod source_fields;
mod suggestion_context;

pub use caps::{
    HeldBack, cap_preview, cap_usage, fields_held_back, import_excesses, opening_excesses,
    variables_of,
};
pub(crate) use caps::{Supposed, exchanges, held_back, opening, use_of};
pub(crate) use disclosed::fields_named_by;
pub use disclosed::{draft_gate, withholding_faults, write_refusal};
pub use mapping_import::{FieldMismatch, ImportEffect, import_effect, validate_for_field};
pub use open_fields::{Supposition, open_fields};
pub use operation_fields::fields_of_operation;
pub use past_offer::past_offer;
pub use policies::{PolicyChange, effective_policy, policy_changes};
pub(crate) use policies::{fields_for_recipient, fields_under_policy};
pub use report_frame::{draft_frame, key_frame, time_step_of};
pub(crate) use report_frame::{fields_of, time_step};
pub use rule_offers::{RuleOffer, rule_offer, rule_preview};
pub use shown_tag::shown_tag;
pub use source_fields::fields_of_source;
pub use suggestion_context::{all_mappings, past_decisions, requested_field};

//! Faults and their stable codes.

use crate::{json::JsonError, messages::Fault};

macro_rules! fault_codes {
    ($($(#[$doc:meta])* $name:ident = $code:literal,)*) => {
        /// Kinds of faults in a message. The codes are part of the wire contract and never
        /// change.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum FaultCode { $($(#[$doc])* $name,)* }

        impl FaultCode {
            /// All codes.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// The code in acknowledgements.
            #[must_use]
            pub const fn as_str(self) -> &'static str {
                match self { $(Self::$name => $code),* }
            }
        }
    };
}

fault_codes! {
    /// The body is not JSON.
    NotJson = "NOT_JSON",
    /// The body begins as XML, but is no NodeSet2 document.
    NotNodeSet = "NOT_NODE_SET",
    /// The NodeSet2 document has no Activity Status Interface.
    NoInterface = "NO_INTERFACE",
    /// The body is too long.
    TooLarge = "TOO_LARGE",
    /// Arrays and objects are nested too deeply.
    TooDeep = "TOO_DEEP",
    /// The body has too many values.
    TooManyValues = "TOO_MANY_VALUES",
    /// A member occurs twice.
    DuplicateMember = "DUPLICATE_MEMBER",
    /// A required member is missing.
    MissingMember = "MISSING_MEMBER",
    /// A member is of another JSON type.
    WrongType = "WRONG_TYPE",
    /// A member's value is not one of those allowed.
    InvalidValue = "INVALID_VALUE",
    /// An identifier does not match its pattern.
    InvalidId = "INVALID_ID",
    /// A text is too long.
    TextTooLong = "TEXT_TOO_LONG",
    /// A list has too many elements.
    TooManyElements = "TOO_MANY_ELEMENTS",
    /// A list that must not be empty is.
    EmptyList = "EMPTY_LIST",
    /// The message type is none that is accepted here.
    UnknownMessageType = "UNKNOWN_MESSAGE_TYPE",
    /// The message is for another factory.
    WrongFactory = "WRONG_FACTORY",
    /// An identifier is used twice.
    DuplicateId = "DUPLICATE_ID",
    /// An operation that is referred to is not in the network.
    UnknownOperation = "UNKNOWN_OPERATION",
    /// A relation or inspection refers to its own operation.
    SelfReference = "SELF_REFERENCE",
    /// The relations form a cycle.
    Cycle = "CYCLE",
    /// An operation that is not a stub belongs to another factory.
    WrongOwner = "WRONG_OWNER",
    /// A stub does not name the factory that owns it.
    OwnerMissing = "OWNER_MISSING",
    /// A stub has members that a stub must not have.
    StubTooDetailed = "STUB_TOO_DETAILED",
    /// A condition has no time although its kind needs one, or a duration although it must not.
    ConditionNeedsTime = "CONDITION_NEEDS_TIME",
    /// A condition has no duration although its kind needs one, or a time although it must not.
    ConditionNeedsDuration = "CONDITION_NEEDS_DURATION",
    /// Two conditions of a relation exclude each other.
    ConditionsContradict = "CONDITIONS_CONTRADICT",
    /// A time frame ends before it begins.
    TimeFrameInverted = "TIME_FRAME_INVERTED",
    /// Relations, conditions and planned times cannot hold together.
    TimeFrameInfeasible = "TIME_FRAME_INFEASIBLE",
    /// A field name occurs twice in a report.
    DuplicateField = "DUPLICATE_FIELD",
    /// A field is called as a payload member that every report has.
    ReservedFieldName = "RESERVED_FIELD_NAME",
    /// A field is called as the unit member of another field.
    UnitFieldCollision = "UNIT_FIELD_COLLISION",
    /// A type is none of the OPC UA built-in types.
    UnknownType = "UNKNOWN_TYPE",
    /// A unit is not known.
    UnknownUnit = "UNKNOWN_UNIT",
    /// A value rank is neither -1 nor a number of dimensions.
    InvalidValueRank = "INVALID_VALUE_RANK",
    /// A field's type cannot carry its semantic.
    SemanticTypeMismatch = "SEMANTIC_TYPE_MISMATCH",
    /// An update frequency without its unit, or the other way round.
    UpdateFrequencyIncomplete = "UPDATE_FREQUENCY_INCOMPLETE",
    /// More faults exist than are listed.
    TooManyFaults = "TOO_MANY_FAULTS",
}

/// Most faults listed in one acknowledgement; an acknowledgement must fit into a message.
pub const FAULTS_MAX: usize = 100;
/// Longest sentence or pointer of a fault, in characters.
const FAULT_CHARS_MAX: usize = 512;

/// The faults found so far.
#[derive(Debug, Default)]
pub(super) struct Faults {
    list: Vec<Fault>,
    unlisted: usize,
}

impl Faults {
    pub(super) fn push(
        &mut self,
        pointer: impl Into<String>,
        code: FaultCode,
        message: impl Into<String>,
    ) {
        if self.list.len() >= FAULTS_MAX {
            self.unlisted += 1;
            return;
        }
        let fault = Fault {
            pointer: cut(pointer.into()),
            code: code.as_str().to_owned(),
            message: cut(message.into()),
        };
        self.list.push(fault);
    }

    /// True where a further fault would only be counted: its sentence need not be made.
    pub(super) fn is_full(&self) -> bool {
        self.list.len() >= FAULTS_MAX
    }

    pub(super) fn count_unlisted(&mut self) {
        self.unlisted += 1;
    }

    /// A body that is not JSON at all.
    pub(super) fn unreadable(&mut self, error: &JsonError) {
        let (code, message) = match error {
            JsonError::TooLarge { bytes, bytes_max } => (
                FaultCode::TooLarge,
                format!("The body has {bytes} bytes; at most {bytes_max} are accepted."),
            ),
            JsonError::TooDeep { depth_max, offset } => (
                FaultCode::TooDeep,
                format!(
                    "Arrays and objects are nested deeper than {depth_max} levels at byte {offset}."
                ),
            ),
            JsonError::TooManyValues { tokens_max } => (
                FaultCode::TooManyValues,
                format!("The body has more than {tokens_max} values and names."),
            ),
            JsonError::NotUtf8 { offset } => {
                (FaultCode::NotJson, format!("The body is not UTF-8 from byte {offset} on."))
            }
            JsonError::Unexpected { expected, offset } => (
                FaultCode::NotJson,
                format!("The body is not JSON: expected {expected} at byte {offset}."),
            ),
        };
        self.push("", code, message);
    }

    /// True where a fault at such a place is listed, or may be among those that are not.
    pub(super) fn concern(&self, is_such: impl Fn(&str) -> bool) -> bool {
        self.unlisted > 0 || self.list.iter().any(|fault| is_such(&fault.pointer))
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub(super) fn into_list(mut self) -> Vec<Fault> {
        if self.unlisted > 0 {
            self.list.push(Fault {
                pointer: String::new(),
                code: FaultCode::TooManyFaults.as_str().to_owned(),
                message: format!(
                    "There are {} more faults; mend the listed ones first.",
                    self.unlisted
                ),
            });
        }
        self.list
    }
}

fn cut(text: String) -> String {
    match text.char_indices().nth(FAULT_CHARS_MAX) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

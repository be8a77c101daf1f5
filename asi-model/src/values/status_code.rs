//! Status codes (OPC 10000-4 §7.38, names from OPC 10000-6 Annex A).

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An OPC UA status code: severity in the two highest bits, sub code below, flag bits at the end.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    PartialOrd,
    Ord,
    Default,
    Serialize,
    Deserialize,
    JsonSchema,
)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(transparent)]
pub struct StatusCode(pub u32);

macro_rules! codes {
    ($($(#[$doc:meta])* $constant:ident $symbol:ident = $value:literal;)*) => {
        impl StatusCode {
            $($(#[$doc])* pub const $constant: Self = Self($value);)*

            /// The standard's symbolic name, where this table knows the code. Flag bits are
            /// ignored.
            #[must_use]
            pub fn symbol(self) -> Option<&'static str> {
                match self.0 & 0xFFFF_0000 {
                    $(x if x == $value & 0xFFFF_0000 => Some(stringify!($symbol)),)*
                    _ => None,
                }
            }

            /// The code with this symbolic name; where this table does not know the name, the code of
            /// its severity alone. `None` for what is no such name.
            #[must_use]
            pub fn from_symbol(name: &str) -> Option<Self> {
                match name {
                    $(stringify!($symbol) => Some(Self::$constant),)*
                    _ if name.starts_with("Bad") => Some(Self::BAD),
                    _ if name.starts_with("Uncertain") => Some(Self::UNCERTAIN),
                    _ if name.starts_with("Good") => Some(Self::GOOD),
                    _ => None,
                }
            }
        }
    };
}

codes! {
    /// All is well.
    GOOD Good = 0x0000_0000;
    /// The operation will finish later.
    GOOD_COMPLETES_ASYNCHRONOUSLY GoodCompletesAsynchronously = 0x002E_0000;
    /// The value was accepted but changed to fit a limit.
    GOOD_CLAMPED GoodClamped = 0x0030_0000;
    /// The value was set by a person or program instead of its source.
    GOOD_LOCAL_OVERRIDE GoodLocalOverride = 0x0096_0000;
    /// Quality is not known to be good.
    UNCERTAIN Uncertain = 0x4000_0000;
    /// The source is not reachable; the value is the last one it gave.
    UNCERTAIN_NO_COMMUNICATION_LAST_USABLE_VALUE UncertainNoCommunicationLastUsableValue = 0x408F_0000;
    /// Whatever updated the value has stopped doing so.
    UNCERTAIN_LAST_USABLE_VALUE UncertainLastUsableValue = 0x4090_0000;
    /// A substitute value.
    UNCERTAIN_SUBSTITUTE_VALUE UncertainSubstituteValue = 0x4091_0000;
    /// The value is an initial one, not yet written.
    UNCERTAIN_INITIAL_VALUE UncertainInitialValue = 0x4092_0000;
    /// The value lies outside the engineering range.
    UNCERTAIN_ENGINEERING_UNITS_EXCEEDED UncertainEngineeringUnitsExceeded = 0x4094_0000;
    /// The value is derived from fewer sources than wanted.
    UNCERTAIN_SUB_NORMAL UncertainSubNormal = 0x4095_0000;
    /// Quality is bad.
    BAD Bad = 0x8000_0000;
    /// An unforeseen event.
    BAD_UNEXPECTED_ERROR BadUnexpectedError = 0x8001_0000;
    /// An internal error.
    BAD_INTERNAL_ERROR BadInternalError = 0x8002_0000;
    /// Lack of memory, disk or another resource.
    BAD_RESOURCE_UNAVAILABLE BadResourceUnavailable = 0x8004_0000;
    /// Communication failed.
    BAD_COMMUNICATION_ERROR BadCommunicationError = 0x8005_0000;
    /// Encoding failed.
    BAD_ENCODING_ERROR BadEncodingError = 0x8006_0000;
    /// Decoding failed.
    BAD_DECODING_ERROR BadDecodingError = 0x8007_0000;
    /// The operation took too long.
    BAD_TIMEOUT BadTimeout = 0x800A_0000;
    /// The server is shutting down.
    BAD_SHUTDOWN BadShutdown = 0x800C_0000;
    /// The user has not the permission.
    BAD_USER_ACCESS_DENIED BadUserAccessDenied = 0x801F_0000;
    /// Waiting for the first value of the source.
    BAD_WAITING_FOR_INITIAL_DATA BadWaitingForInitialData = 0x8032_0000;
    /// The NodeId has no meaning.
    BAD_NODE_ID_INVALID BadNodeIdInvalid = 0x8033_0000;
    /// The node does not exist (any more).
    BAD_NODE_ID_UNKNOWN BadNodeIdUnknown = 0x8034_0000;
    /// The attribute does not exist on this node.
    BAD_ATTRIBUTE_ID_INVALID BadAttributeIdInvalid = 0x8035_0000;
    /// An index range is malformed.
    BAD_INDEX_RANGE_INVALID BadIndexRangeInvalid = 0x8036_0000;
    /// Value that cannot be read.
    BAD_NOT_READABLE BadNotReadable = 0x803A_0000;
    /// Value that cannot be written.
    BAD_NOT_WRITABLE BadNotWritable = 0x803B_0000;
    /// The value is out of range.
    BAD_OUT_OF_RANGE BadOutOfRange = 0x803C_0000;
    /// The operation is not supported; here: the field was refused.
    BAD_NOT_SUPPORTED BadNotSupported = 0x803D_0000;
    /// The thing asked for was not found.
    BAD_NOT_FOUND BadNotFound = 0x803E_0000;
    /// No connection to the source.
    BAD_NOT_CONNECTED BadNotConnected = 0x808A_0000;
    /// Configuration of the source or its mapping is wrong.
    BAD_CONFIGURATION_ERROR BadConfigurationError = 0x8089_0000;
    /// The device reported a failure.
    BAD_DEVICE_FAILURE BadDeviceFailure = 0x808B_0000;
    /// The sensor reported a failure.
    BAD_SENSOR_FAILURE BadSensorFailure = 0x808C_0000;
    /// The source is out of service.
    BAD_OUT_OF_SERVICE BadOutOfService = 0x808D_0000;
    /// The type of a value does not fit.
    BAD_TYPE_MISMATCH BadTypeMismatch = 0x8074_0000;
    /// No data exists for the requested time.
    BAD_NO_DATA BadNoData = 0x809B_0000;
    /// The arguments are invalid.
    BAD_INVALID_ARGUMENT BadInvalidArgument = 0x80AB_0000;
    /// The state does not allow this.
    BAD_INVALID_STATE BadInvalidState = 0x80AF_0000;
    /// A write of this kind is not supported.
    BAD_WRITE_NOT_SUPPORTED BadWriteNotSupported = 0x8073_0000;
}

impl StatusCode {
    /// Severity Good (00).
    #[must_use]
    pub const fn is_good(self) -> bool {
        self.0 >> 30 == 0
    }

    /// Severity Uncertain (01).
    #[must_use]
    pub const fn is_uncertain(self) -> bool {
        self.0 >> 30 == 1
    }

    /// Severity Bad (10 and the reserved 11).
    #[must_use]
    pub const fn is_bad(self) -> bool {
        self.0 >> 31 == 1
    }
}

impl fmt::Display for StatusCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.symbol() {
            Some(symbol) => f.write_str(symbol),
            None => write!(f, "0x{:08X}", self.0),
        }
    }
}

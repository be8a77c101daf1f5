//! The built-in types (OPC 10000-6 §5.1.2).

use std::{fmt, str::FromStr};

macro_rules! built_in_types {
    ($($name:ident = $id:literal),* $(,)?) => {
        /// The 25 built-in types with their standard ids. On the wire an id or a name; we emit the
        /// id.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[repr(u8)]
        pub enum BuiltInType { $($name = $id),* }

        impl BuiltInType {
            /// All types, by id.
            pub const ALL: [Self; 25] = [$(Self::$name),*];

            /// The type with this id (1 to 25).
            #[must_use]
            pub const fn from_id(id: u64) -> Option<Self> {
                match id { $($id => Some(Self::$name),)* _ => None }
            }

            /// The standard's name of the type.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => stringify!($name)),* }
            }
        }

        impl FromStr for BuiltInType {
            type Err = ();
            fn from_str(name: &str) -> Result<Self, ()> {
                match name { $(stringify!($name) => Ok(Self::$name),)* _ => Err(()) }
            }
        }
    };
}

built_in_types! {
    Boolean = 1, SByte = 2, Byte = 3, Int16 = 4, UInt16 = 5, Int32 = 6, UInt32 = 7, Int64 = 8,
    UInt64 = 9, Float = 10, Double = 11, String = 12, DateTime = 13, Guid = 14, ByteString = 15,
    XmlElement = 16, NodeId = 17, ExpandedNodeId = 18, StatusCode = 19, QualifiedName = 20,
    LocalizedText = 21, ExtensionObject = 22, DataValue = 23, Variant = 24, DiagnosticInfo = 25,
}

impl BuiltInType {
    /// The type's id, 1 to 25.
    #[must_use]
    pub const fn id(self) -> u8 {
        self as u8
    }

    /// One of the integer or floating point types: those that may have a unit and be scaled or
    /// rounded.
    #[must_use]
    pub const fn is_numeric(self) -> bool {
        matches!(self.id(), 2..=11)
    }

    /// One of the eight integer types.
    #[must_use]
    pub const fn is_integer(self) -> bool {
        matches!(self.id(), 2..=9)
    }
}

impl fmt::Display for BuiltInType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

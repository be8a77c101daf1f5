//! Blueprint of a machine's address space, independent of namespace indexes.

use std::sync::Arc;

use asi_model::values::{
    BuiltInType, ExpandedNodeId, ExtensionBody, ExtensionObject, LocalizedText, Namespace, NodeId,
    QualifiedName, Scalar, Server, StructureValue, Variant,
};

use crate::signals::Moment;

/// The machine's value at a moment.
pub type Signal = Box<dyn Fn(Moment) -> Variant + Send + Sync>;

/// A time that the machine knows at a moment, in simulated seconds since the epoch.
pub type SimulatedTime = Box<dyn Fn(Moment) -> f64 + Send + Sync>;

/// The nodes of one machine.
pub struct Blueprint {
    /// The namespace of the machine's own nodes.
    pub namespace_uri: String,
    /// Further namespaces that its nodes and types are of.
    pub type_namespaces: Vec<&'static str>,
    /// True for numeric instead of string identifiers.
    pub numbers_nodes: bool,
    /// Types that others than namespace 0 define.
    pub types: Vec<TypePlan>,
    /// Parents before children.
    pub nodes: Vec<NodePlan>,
}

/// An object type, so that type definitions lead somewhere.
pub struct TypePlan {
    pub node_id: NodeId,
    /// Its name; in its own namespace.
    pub name: &'static str,
    pub supertype: NodeId,
}

/// Node to be created in a machine's address space.
pub struct NodePlan {
    /// The machine's own name of it: the browse names from the machine's root on,
    /// `Spindle.Temperature`.
    pub key: String,
    /// A fixed identity; else one is made from the key.
    pub node_id: Option<NodeId>,
    /// Index of the parent; none for a child of the Objects folder.
    pub parent: Option<usize>,
    pub name: QualifiedName,
    /// Text of the Description attribute; none for most nodes.
    pub description: Option<&'static str>,
    /// Node class with its attributes.
    pub class: Class,
}

/// Kinds of nodes.
pub enum Class {
    /// An object of a type.
    Object(NodeId),
    /// A variable that is a component of its parent.
    Variable(VariablePlan),
    /// A variable that is a property of its parent.
    Property(Variant, NodeId),
    /// The method that takes a job: order (String) and quantity (UInt32) to accepted (Boolean).
    StartJob,
}

/// Type and course of the values of a simulated node.
pub struct VariablePlan {
    pub data_type: NodeId,
    pub type_definition: NodeId,
    /// -1 for a scalar, 1 for an array.
    pub value_rank: i32,
    pub source: Source,
    /// True where clients may read past values.
    pub has_history: bool,
}

/// Origin of a variable's value.
pub enum Source {
    /// The machine runs by itself.
    Signal(Signal),
    /// A time, shown by the machine's clock to the second.
    Time(SimulatedTime),
    /// Clients may write it; this is what it begins with.
    Written(Variant),
    /// One of a bank's counters: `update` number `n` changes counter `n % counters`.
    Counter,
}

/// Namespace 0's ids that machines use.
pub mod ids {
    use asi_model::values::NodeId;

    /// Object type that all others specialise; for objects without a type of their own.
    pub const BASE_OBJECT_TYPE: NodeId = NodeId::ua(58);
    /// Object type of folders (OPC 10000-5).
    pub const FOLDER_TYPE: NodeId = NodeId::ua(61);
    /// Variable type of plain data variables.
    pub const BASE_DATA_VARIABLE_TYPE: NodeId = NodeId::ua(63);
    /// Variable type of numbers with an engineering unit (OPC 10000-8).
    pub const ANALOG_UNIT_TYPE: NodeId = NodeId::ua(17497);
    /// Variable type of numbers with a unit and a range (OPC 10000-8).
    pub const ANALOG_UNIT_RANGE_TYPE: NodeId = NodeId::ua(17570);
    /// Data type of a pair of limits, low and high.
    pub const RANGE: NodeId = NodeId::ua(884);
    /// Data type of an engineering unit.
    pub const EU_INFORMATION: NodeId = NodeId::ua(887);
    /// Data type that all structures specialise.
    pub const STRUCTURE: NodeId = NodeId::ua(22);
}

/// The numeric id of the custom structure in each machine's own namespace, and of its binary
/// encoding. Machines do not renumber types.
pub const POWER_AGGREGATE: u32 = 3001;
/// Numeric id of the binary encoding of [`POWER_AGGREGATE`].
pub const POWER_AGGREGATE_BINARY: u32 = 3002;
/// The fields of the custom structure: a UInt32 and three Doubles.
pub const POWER_AGGREGATE_FIELDS: [&str; 4] =
    ["SecondsAggregated", "WattsMin", "WattsMax", "WattsAvg"];

/// A unit with its UNECE code.
#[derive(Debug, Clone, Copy)]
pub struct Unit(pub &'static str, pub &'static str, pub &'static str);

impl Unit {
    /// Degrees Celsius.
    pub const CELSIUS: Self = Self("CEL", "°C", "degree Celsius");
    /// Watt.
    pub const WATT: Self = Self("WTT", "W", "watt");
    /// Watt hour.
    pub const WATT_HOUR: Self = Self("WHR", "W·h", "watt hour");
    /// Revolutions per minute.
    pub const RPM: Self = Self("RPM", "r/min", "revolutions per minute");
    /// Seconds.
    pub const SECOND: Self = Self("SEC", "s", "second [unit of time]");
    /// Metres per minute.
    pub const METRE_PER_MINUTE: Self = Self("2X", "m/min", "metre per minute");
    /// Kilonewton.
    pub const KILONEWTON: Self = Self("B47", "kN", "kilonewton");
    /// Percent.
    pub const PERCENT: Self = Self("P1", "%", "percent");
    /// Degrees of arc.
    pub const DEGREE: Self = Self("DD", "°", "degree [unit of angle]");
    /// Degrees of arc per second.
    pub const DEGREE_PER_SECOND: Self = Self("E96", "°/s", "degree per second");
    /// Joule.
    pub const JOULE: Self = Self("JOU", "J", "joule");

    /// EUInformation (OPC 10000-8 §5.6.4.3): the unit id spells the code.
    #[must_use]
    pub fn to_value(self) -> Variant {
        let id = self.0.bytes().fold(0_i32, |id, byte| id << 8 | i32::from(byte));
        let text = |text: &str| {
            let text = LocalizedText { locale: Some("en".into()), text: Some(text.into()) };
            Variant::Scalar(Scalar::LocalizedText(Box::new(text)))
        };
        structure(
            ids::EU_INFORMATION,
            [
                ("NamespaceUri", "http://www.opcfoundation.org/UA/units/un/cefact".into()),
                ("UnitId", id.into()),
                ("DisplayName", text(self.1)),
                ("Description", text(self.2)),
            ],
        )
    }
}

/// A structure with its fields.
pub fn structure<const N: usize>(data_type: NodeId, fields: [(&str, Variant); N]) -> Variant {
    let fields = fields.into_iter().map(|(name, value)| (Arc::from(name), value)).collect();
    Variant::Scalar(Scalar::ExtensionObject(Box::new(ExtensionObject {
        type_id: ExpandedNodeId { node_id: data_type, server: Server::Local },
        body: ExtensionBody::Structure(StructureValue { fields, ..StructureValue::default() }),
    })))
}

/// A text in English.
#[must_use]
pub fn english(text: &str) -> Variant {
    let text = LocalizedText { locale: Some("en".into()), text: Some(text.into()) };
    Variant::Scalar(Scalar::LocalizedText(Box::new(text)))
}

impl Blueprint {
    /// An empty machine whose nodes are named by texts.
    #[must_use]
    pub fn new(namespace_uri: &str) -> Self {
        Self {
            namespace_uri: namespace_uri.to_owned(),
            type_namespaces: Vec::new(),
            numbers_nodes: false,
            types: Vec::new(),
            nodes: Vec::new(),
        }
    }

    /// A name in the machine's own namespace.
    #[must_use]
    pub fn own(&self, name: &str) -> QualifiedName {
        QualifiedName { namespace: Namespace::uri(&self.namespace_uri), name: Some(name.into()) }
    }

    /// The machine's root object; its key is empty.
    pub fn root(&mut self, name: &str, type_definition: NodeId) -> usize {
        let name = self.own(name);
        self.push(NodePlan {
            key: String::new(),
            node_id: None,
            parent: None,
            name,
            description: None,
            class: Class::Object(type_definition),
        })
    }

    /// A group of variables.
    pub fn group(&mut self, parent: usize, name: &str) -> usize {
        let name = self.own(name);
        self.object(parent, name, ids::BASE_OBJECT_TYPE)
    }

    /// An object of a type.
    pub fn object(&mut self, parent: usize, name: QualifiedName, type_definition: NodeId) -> usize {
        self.child(parent, name, Class::Object(type_definition))
    }

    /// A variable that runs by itself.
    pub fn signal(
        &mut self,
        parent: usize,
        name: &str,
        data_type: BuiltInType,
        signal: impl Fn(Moment) -> Variant + Send + Sync + 'static,
    ) -> usize {
        let name = self.own(name);
        self.variable(parent, name, data_type, Source::Signal(Box::new(signal)))
    }

    /// A variable that clients may write.
    pub fn written(&mut self, parent: usize, name: &str, initial: impl Into<Variant>) -> usize {
        let (name, initial) = (self.own(name), initial.into());
        let data_type = initial.built_in_type().unwrap_or(BuiltInType::Variant);
        self.variable(parent, name, data_type, Source::Written(initial))
    }

    /// A scalar variable with its source.
    pub fn variable(
        &mut self,
        parent: usize,
        name: QualifiedName,
        data_type: BuiltInType,
        source: Source,
    ) -> usize {
        let plan = VariablePlan {
            data_type: NodeId::ua(u32::from(data_type.id())),
            type_definition: ids::BASE_DATA_VARIABLE_TYPE,
            value_rank: -1,
            source,
            has_history: false,
        };
        self.child(parent, name, Class::Variable(plan))
    }

    /// Makes a variable an array.
    pub fn is_array(&mut self, variable: usize) {
        self.plan(variable).value_rank = 1;
    }

    /// Keeps the past values of a variable.
    pub fn keeps_history(&mut self, variable: usize) {
        self.plan(variable).has_history = true;
    }

    /// Gives a variable a data type of its own.
    pub fn has_data_type(&mut self, variable: usize, data_type: NodeId) {
        self.plan(variable).data_type = data_type;
    }

    /// Makes a variable an analog one: with a unit, and a range where given.
    pub fn is_analog(&mut self, variable: usize, unit: Unit, range: Option<(f64, f64)>) {
        self.plan(variable).type_definition =
            if range.is_some() { ids::ANALOG_UNIT_RANGE_TYPE } else { ids::ANALOG_UNIT_TYPE };
        self.property(variable, "EngineeringUnits", unit.to_value(), ids::EU_INFORMATION);
        if let Some((low, high)) = range {
            let range = structure(ids::RANGE, [("Low", low.into()), ("High", high.into())]);
            self.property(variable, "EURange", range, ids::RANGE);
        }
    }

    /// A property in namespace 0.
    pub fn property(
        &mut self,
        parent: usize,
        name: &str,
        value: Variant,
        data_type: NodeId,
    ) -> usize {
        let name = QualifiedName { namespace: Namespace::Ua, name: Some(name.into()) };
        self.child(parent, name, Class::Property(value, data_type))
    }

    /// Says what a node is.
    pub fn describe(&mut self, node: usize, description: &'static str) {
        self.nodes[node].description = Some(description);
    }

    /// Any child.
    pub fn child(&mut self, parent: usize, name: QualifiedName, class: Class) -> usize {
        let text = name.name.as_deref().unwrap_or_default();
        let above = &self.nodes[parent].key;
        let key = if above.is_empty() { text.to_owned() } else { format!("{above}.{text}") };
        self.push(NodePlan {
            key,
            node_id: None,
            parent: Some(parent),
            name,
            description: None,
            class,
        })
    }

    /// A node as it is.
    pub fn push(&mut self, node: NodePlan) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn plan(&mut self, variable: usize) -> &mut VariablePlan {
        match &mut self.nodes[variable].class {
            Class::Variable(plan) => plan,
            _ => panic!("only variables have a value"),
        }
    }
}

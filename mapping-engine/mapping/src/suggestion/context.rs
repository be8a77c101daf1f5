//! Facts that suggestions are made from: the field, the variables, earlier decisions.

use asi_model::{BuiltInType, NodeId, network::Semantic, units as unece};
use shop_floor_model::{BrowsedNode, ListedVariable, SourceId};

/// Field for which variables are suggested, with all that is known of its meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct RequestedField {
    pub name: String,
    pub value_type: BuiltInType,
    /// Its ValueRank: -1 scalar.
    pub value_rank: i32,
    /// UNECE code or alias.
    pub unit: Option<String>,
    /// Semantic id of the request, where it has one.
    pub semantic: Option<Semantic>,
    /// Descriptions of field, request, operation and product.
    pub descriptions: Vec<String>,
    /// The asset that the operation is done with, where the network names one.
    pub asset: Option<String>,
}

/// A variable of a local server.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownVariable {
    /// Source of the variable.
    pub source_id: SourceId,
    /// Node id with its namespace's URI.
    pub node_id: NodeId,
    pub name: String,
    /// The names above it, outermost first.
    pub path: Vec<String>,
    /// Description by the server.
    pub description: Option<String>,
    pub value_type: Option<BuiltInType>,
    /// ValueRank: -1 scalar, 1 or more the number of dimensions.
    pub value_rank: Option<i32>,
    /// UNECE code or alias.
    pub unit: Option<String>,
    /// The names of its type and of the types above it, as companion specifications call them.
    pub type_names: Vec<String>,
    /// A value of it, as number.
    pub value: Option<f64>,
}

impl KnownVariable {
    /// A variable as a list of all of a server's shows it: names and types of what stands above,
    /// nothing of its value.
    #[must_use]
    pub fn listed(source_id: &SourceId, variable: &ListedVariable) -> Self {
        let (_, above) = variable.browse_path.0.split_last().unzip();
        Self {
            source_id: source_id.clone(),
            node_id: variable.node_id.clone(),
            name: variable.display_name.clone(),
            path: above
                .into_iter()
                .flatten()
                .filter_map(|element| element.name.as_deref().map(str::to_owned))
                .collect(),
            description: None,
            value_type: None,
            value_rank: None,
            unit: None,
            type_names: variable.type_names.iter().map(|name| (**name).to_owned()).collect(),
            value: None,
        }
    }

    /// Adds what browsing shows of the variable.
    #[must_use]
    pub fn described(self, node: &BrowsedNode) -> Self {
        Self {
            description: node.description.clone(),
            value_type: node.built_in_type,
            value_rank: node.value_rank,
            unit: node.unit.as_ref().and_then(|unit| unit.code.clone()),
            ..self
        }
    }
}

/// Earlier decision of an engineer of this factory.
#[derive(Debug, Clone, PartialEq)]
pub struct PastDecision {
    pub field_name: String,
    /// Semantic id of the request, where it has one.
    pub semantic: Option<Semantic>,
    /// The server it was mapped to.
    pub source_id: SourceId,
    /// The variable it was mapped to.
    pub node_id: NodeId,
}

/// Returns the unit of measurement with this UNECE code or alias.
pub(super) fn unit(name: Option<&str>) -> Option<unece::EngineeringUnit> {
    unece::lookup(name?)
}

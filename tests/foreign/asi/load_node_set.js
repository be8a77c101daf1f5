// Loads NodeSet2 files with node-opcua and compares nodes and references with what they were written from.
//
// Usage: node load_node_set.js EXPECTED FILE...; prints every difference, exit status 1 where there is one.
"use strict";
const fs = require("fs");
const { AddressSpace, nodesets, NodeClass, BrowseDirection } = require("node-opcua");
const { generateAddressSpace } = require("node-opcua-address-space/nodeJS");

async function main() {
  const [expectedFile, ...files] = process.argv.slice(2);
  const expected = JSON.parse(fs.readFileSync(expectedFile, "utf8"));
  const addressSpace = AddressSpace.create();
  await generateAddressSpace(addressSpace, [nodesets.standard, ...files]);
  const uris = addressSpace.getNamespaceArray().map((namespace) => namespace.namespaceUri);
  const id = (nodeId) => {
    const text = nodeId.toString().replace(/^ns=\d+;/, "");
    return nodeId.namespace === 0 ? text : `nsu=${uris[nodeId.namespace]};${text}`;
  };
  const nodes = new Map();
  const references = new Set();
  for (const uri of expected.namespaces) {
    const namespace = addressSpace.getNamespace(uri);
    if (!namespace) throw new Error(`the namespace ${uri} was not loaded`);
    for (const node of namespace.nodeIterator()) {
      nodes.set(id(node.nodeId), { class: NodeClass[node.nodeClass], browseName: node.browseName.name });
      for (const reference of node.allReferences()) {
        const [from, to] = reference.isForward ? [node.nodeId, reference.nodeId] : [reference.nodeId, node.nodeId];
        references.add(`${id(from)} ${id(reference.referenceType)} ${id(to)}`);
      }
    }
  }
  const problems = [];
  for (const node of expected.nodes) {
    const found = nodes.get(node.id);
    if (!found) problems.push(`missing node ${node.id}`);
    else if (found.class !== node.class) problems.push(`${node.id} is ${found.class}, not ${node.class}`);
    else if (found.browseName !== node.browseName) problems.push(`${node.id} is called ${found.browseName}`);
    nodes.delete(node.id);
  }
  for (const extra of nodes.keys()) problems.push(`additional node ${extra}`);
  const wanted = new Set(expected.references);
  for (const reference of wanted) if (!references.has(reference)) problems.push(`missing reference ${reference}`);
  for (const reference of references) if (!wanted.has(reference)) problems.push(`additional reference ${reference}`);
  for (const problem of problems.slice(0, 30)) console.error(problem);
  console.log(`node-opcua: ${expected.nodes.length} nodes, ${wanted.size} references, ${problems.length} differences`);
  addressSpace.dispose();
  process.exit(problems.length === 0 ? 0 : 1);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});

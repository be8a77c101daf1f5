"""Loads NodeSet2 files with asyncua and compares nodes and references with what they were written from.

Usage: load_node_set.py EXPECTED FILE...; prints every difference, exit status 1 where there is one.
"""

import asyncio
import json
import logging
import sys

from asyncua import Server, ua

logging.disable(logging.CRITICAL)


def text_of(uris, node_id):
    """A NodeId with its namespace's URI."""
    plain = ua.NodeId(node_id.Identifier, 0, node_id.NodeIdType).to_string()
    return plain if node_id.NamespaceIndex == 0 else f"nsu={uris[node_id.NamespaceIndex]};{plain}"


async def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        expected = json.load(file)
    server = Server()
    await server.init()
    for path in sys.argv[2:]:
        await server.import_xml(path)
    uris = await server.get_namespace_array()
    own = {index for index, uri in enumerate(uris) if uri in expected["namespaces"]}
    found, references, metadata = {}, set(), set()
    for node_id in list(server.iserver.aspace._nodes):
        if node_id.NamespaceIndex not in own:
            continue
        node = server.get_node(node_id)
        name = await node.read_browse_name()
        found[text_of(uris, node_id)] = ((await node.read_node_class()).name, name.Name)
        # A server adds an object of NamespaceMetadataType per namespace; those are its own.
        for reference in await node.get_references():
            if reference.IsForward and reference.NodeId == ua.NodeId(11616):
                metadata |= {node_id} | {child.nodeid for child in await node.get_children()}
        for reference in await node.get_references():
            pair = (node_id, reference.NodeId) if reference.IsForward else (reference.NodeId, node_id)
            ends = [text_of(uris, end) for end in pair]
            references.add(f"{ends[0]} {text_of(uris, reference.ReferenceTypeId)} {ends[1]}")
    added = {text_of(uris, node_id) for node_id in metadata}
    found = {node_id: entry for node_id, entry in found.items() if node_id not in added}
    references = {text for text in references if added.isdisjoint(text.split(" "))}
    problems = []
    for node in expected["nodes"]:
        entry = found.pop(node["id"], None)
        if entry is None:
            problems.append(f"missing node {node['id']}")
        elif entry != (node["class"], node["browseName"]):
            problems.append(f"{node['id']} is {entry}")
    problems += [f"additional node {extra}" for extra in found]
    wanted = set(expected["references"])
    problems += [f"missing reference {reference}" for reference in sorted(wanted - references)]
    problems += [f"additional reference {reference}" for reference in sorted(references - wanted)]
    for value in expected["values"]:
        uri, identifier = value["id"].removeprefix("nsu=").split(";", 1)
        node = server.get_node(ua.NodeId.from_string(f"ns={uris.index(uri)};{identifier}"))
        read = await node.read_value()
        # An empty text is None to it.
        if ("" if read is None else str(read)) != value["text"]:
            problems.append(f"{value['id']} has the value {read!r}, not {value['text']!r}")
    for problem in problems[:30]:
        print(problem, file=sys.stderr)
    print(f"asyncua: {len(expected['nodes'])} nodes, {len(wanted)} references, {len(problems)} differences")
    return 1 if problems else 0


sys.exit(asyncio.run(main()))

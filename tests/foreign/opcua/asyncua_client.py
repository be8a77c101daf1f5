"""A foreign OPC UA client (asyncua) as a command: connects with a user, does one thing, prints one line of JSON.

    asyncua_client.py ENDPOINT --user U --password P --pki DIR [--policy Basic256Sha256] [--timeout 20] COMMAND ...

    browse NODE               the forward hierarchical references of a node
    read NODE                 value, status and source time
    write NODE TYPE VALUE     TYPE is a built-in type's name, VALUE is JSON; prints the status
    subscribe NODE COUNT      COUNT changes of a value
    call OBJECT METHOD ARGS   ARGS is a JSON list of [TYPE, VALUE]
    events COUNT [TYPE]       COUNT events of the server of a standard type (name without `Type`) and its subtypes
    batch COMMANDS            a JSON list of [COMMAND, ARGUMENT...]; prints {"results": [...]} in that order

NODE is `nsu=<uri>;s=<id>`, `i=85` or `ns=3;s=<id>`. `subscribe` and `events` write `ready` to the standard error once
they listen. The line is {"ok": true, ...} or {"ok": false, "status": "<symbolic name>"}; the exit status is 0 either way,
and 2 when the command itself is wrong. Without arguments each line of its input is a JSON list of them, done one after the
other, each in a session of its own.
"""

import argparse
import asyncio
import json
import logging
import socket
import sys
from pathlib import Path

from asyncua import Client, ua
from asyncua.crypto import security_policies
from asyncua.crypto.cert_gen import setup_self_signed_certificate
from cryptography.x509.oid import ExtendedKeyUsageOID

APPLICATION_URI = "urn:verbund:test:asyncua"


def arguments(given):
    parser = argparse.ArgumentParser()
    parser.add_argument("endpoint")
    parser.add_argument("--user")
    parser.add_argument("--password", default="")
    parser.add_argument("--pki", required=True, type=Path)
    parser.add_argument("--policy", default="Basic256Sha256")
    parser.add_argument("--timeout", default=20.0, type=float)
    parser.add_argument("command", choices=["browse", "read", "write", "subscribe", "call", "events", "batch"])
    parser.add_argument("rest", nargs="*")
    return parser.parse_args(given)


def plain(value):
    """A value as JSON can say it."""
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, (bool, int, float, str)) or value is None:
        return value
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, ua.NodeId):
        return value.to_string()
    if isinstance(value, ua.LocalizedText):
        return value.Text
    if isinstance(value, ua.QualifiedName):
        return value.Name
    if hasattr(value, "isoformat"):
        return value.isoformat()
    if hasattr(value, "__dataclass_fields__"):
        return {name: plain(getattr(value, name)) for name in value.__dataclass_fields__}
    return str(value)


def shown(data_value):
    status = data_value.StatusCode or ua.StatusCode(0)
    return {
        "value": plain(data_value.Value.Value) if data_value.Value is not None else None,
        "status": status.name,
        "sourceTimestamp": plain(data_value.SourceTimestamp),
    }


def variant(type_name, value):
    kind = ua.VariantType[type_name]
    if kind == ua.VariantType.LocalizedText:
        value = ua.LocalizedText(value)
    return ua.Variant(value, kind)


async def resolve(client, text):
    if text.startswith("nsu="):
        uri, identifier = text[4:].split(";", 1)
        text = f"ns={await client.get_namespace_index(uri)};{identifier}"
    return client.get_node(ua.NodeId.from_string(text))


class Listener:
    """Collects notifications of one kind until there are enough."""

    def __init__(self, wanted, to_events=False):
        self.wanted, self.to_events, self.found, self.enough = wanted, to_events, [], asyncio.Event()

    def add(self, item):
        if len(self.found) < self.wanted:
            self.found.append(item)
        if len(self.found) >= self.wanted:
            self.enough.set()

    def datachange_notification(self, node, value, data):
        if not self.to_events:
            self.add(shown(data.monitored_item.Value))

    def event_notification(self, event):
        fields = event.get_event_props_as_fields_dict()
        self.add({name: plain(variant.Value) for name, variant in fields.items()})

    def status_change_notification(self, status):
        pass



async def listen(client, listener, subscribe):
    subscription = await client.create_subscription(20, listener)
    await subscribe(subscription)
    print("ready", file=sys.stderr, flush=True)
    await listener.enough.wait()
    await subscription.delete()
    return listener.found


async def run(client, command, rest):
    if command == "batch":
        return {"results": [await run(client, one, arguments) for one, *arguments in json.loads(rest[0])]}
    if command == "events":
        count, type_name = int(rest[0]), (rest[1] if len(rest) > 1 else "BaseEvent") + "Type"
        event_type = getattr(ua.ObjectIds, type_name)
        listener = Listener(count, to_events=True)

        async def subscribe(subscription):
            await subscription.subscribe_events(client.nodes.server, [client.get_node(event_type)], queuesize=100)

        return {"events": await listen(client, listener, subscribe)}
    node = await resolve(client, rest[0])
    if command == "browse":
        found = await node.get_children_descriptions()
        names = [
            {"nodeId": d.NodeId.to_string(), "browseName": d.BrowseName.Name, "nodeClass": ua.NodeClass(d.NodeClass).name}
            for d in found
        ]
        return {"children": names}
    if command == "read":
        return shown(await node.read_data_value(raise_on_bad_status=False))
    if command == "write":
        value = ua.DataValue(variant(rest[1], json.loads(rest[2])))
        wanted = ua.WriteValue(NodeId=node.nodeid, AttributeId=ua.AttributeIds.Value, Value=value)
        status = (await client.uaclient.write(ua.WriteParameters(NodesToWrite=[wanted])))[0]
        return {"status": status.name}
    if command == "subscribe":
        listener = Listener(int(rest[1]))

        async def subscribe(subscription):
            await subscription.subscribe_data_change(node, queuesize=100, sampling_interval=0)

        return {"changes": await listen(client, listener, subscribe)}
    method = await resolve(client, rest[1])
    values = [variant(*pair) for pair in json.loads(rest[2])]
    request = ua.CallMethodRequest(ObjectId=node.nodeid, MethodId=method.nodeid, InputArguments=values)
    result = (await client.uaclient.call([request]))[0]
    return {"status": result.StatusCode.name, "outputs": plain([v.Value for v in result.OutputArguments])}


async def connect_and_run(args):
    client = Client(args.endpoint, timeout=args.timeout)
    client.application_uri = APPLICATION_URI
    if args.policy != "None":
        args.pki.mkdir(parents=True, exist_ok=True)
        key, certificate = args.pki / "key.pem", args.pki / "certificate.der"
        usage = [ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH]
        subject = {"commonName": "Verbund asyncua test client", "organizationName": "Verbund"}
        await setup_self_signed_certificate(key, certificate, APPLICATION_URI, socket.gethostname(), usage, subject)
        policy = getattr(security_policies, "SecurityPolicy" + args.policy)
        await client.set_security(policy, str(certificate), str(key), mode=ua.MessageSecurityMode.SignAndEncrypt)
    if args.user:
        client.set_user(args.user)
        client.set_password(args.password)
    async with client:
        return {"ok": True} | await run(client, args.command, args.rest)


async def done(given):
    args = arguments(given)
    try:
        return await asyncio.wait_for(connect_and_run(args), args.timeout)
    except ua.UaStatusCodeError as error:
        return {"ok": False, "status": ua.StatusCode(error.code).name}
    except (ConnectionError, TimeoutError, asyncio.TimeoutError, ua.UaError) as error:
        return {"ok": False, "status": type(error).__name__, "message": str(error)}


def main():
    # Only the results are for the caller.
    logging.disable(logging.CRITICAL)
    for given in [sys.argv[1:]] if len(sys.argv) > 1 else map(json.loads, sys.stdin):
        print(json.dumps(asyncio.run(done(given))), flush=True)


main()

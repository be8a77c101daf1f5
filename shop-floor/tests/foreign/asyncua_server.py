"""A machine on asyncua: a counter, a temperature, a text and a custom structure.

Options: --port N, --address A, --before N (namespaces that come first), --renumber N (node ids shifted by it),
--protected DIR (Basic256Sha256 and a user; certificates are made in DIR),
--small MS (limits of a small controller that publishes no faster, and 24 more variables).
Prints "ready" when clients may come. Each line on standard input is a JSON object of new values:
{"counter": 7}; {"counting": true} counts up every 100 ms; {"event": {"message": "Door open", "severity": 700}} raises an
event of the server. Ends with its standard input.
"""

import argparse
import asyncio
import json
import logging
import sys
from datetime import datetime, timezone
from pathlib import Path

import small_asyncua
from asyncua import Server, ua
from asyncua.common.structures104 import new_struct, new_struct_field
from asyncua.crypto.permission_rules import SimpleRoleRuleset, User, UserRole
from asyncua.server.user_managers import UserManager

NAMESPACE = "urn:verbund:test:asyncua"
MORE_VARIABLES = 24


class OneUser(UserManager):
    def get_user(self, iserver, username=None, password=None, certificate=None):
        if username == "connector" and password == "machine":
            return User(role=UserRole.User, name="connector")
        return None


async def protect(server, directory):
    from cryptography.x509.oid import ExtendedKeyUsageOID
    from asyncua.crypto.cert_gen import setup_self_signed_certificate

    key, certificate = Path(directory, "key.pem"), Path(directory, "certificate.der")
    await setup_self_signed_certificate(
        key,
        certificate,
        server._application_uri,
        "localhost",
        [ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH],
        {"commonName": "asyncua machine", "organizationName": "Verbund tests"},
    )
    await server.load_certificate(str(certificate))
    await server.load_private_key(str(key))
    server.set_security_policy(
        [ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt], permission_ruleset=SimpleRoleRuleset()
    )
    server.set_identity_tokens([ua.UserNameIdentityToken])


async def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--address", default="127.0.0.1")
    parser.add_argument("--before", type=int, default=0)
    parser.add_argument("--renumber", type=int, default=0)
    parser.add_argument("--protected")
    parser.add_argument("--small", type=int)
    options = parser.parse_args()
    logging.basicConfig(level=logging.ERROR)

    if options.small:
        small_asyncua.limit(options.small)
    more = MORE_VARIABLES if options.small else 0
    server = Server(user_manager=OneUser() if options.protected else None)
    await server.init()
    if options.small:
        await small_asyncua.declare(server)
    server.set_endpoint(f"opc.tcp://{options.address}:{options.port}/machine")
    server.set_server_name("asyncua machine")
    await server.set_application_uri("urn:verbund:test:asyncua:server")
    if options.protected:
        await protect(server, options.protected)
    else:
        server.set_security_policy([ua.SecurityPolicyType.NoSecurity])

    for index in range(options.before):
        await server.register_namespace(f"urn:verbund:test:other:{index}")
    namespace = await server.register_namespace(NAMESPACE)

    def node_id(number):
        # All numbers stay in use: an old one names another variable after renumbering.
        return ua.NodeId(2000 + (number + options.renumber) % (5 + more), namespace)

    power_type, _ = await new_struct(
        server,
        namespace,
        "Power",
        [
            new_struct_field("Seconds", ua.VariantType.UInt32),
            new_struct_field("Watts", ua.VariantType.Double),
            new_struct_field("Phases", ua.VariantType.Double, array=True),
        ],
    )
    types = await server.load_data_type_definitions()
    power = types.get("Power") or ua.Power

    def name(text):
        return ua.QualifiedName(text, namespace)

    machine = await server.nodes.objects.add_object(node_id(0), name("Machine"))
    counter = await machine.add_variable(node_id(1), name("Counter"), 0, ua.VariantType.Int32)
    temperature = await machine.add_variable(node_id(2), name("Temperature"), 20.5, ua.VariantType.Double)
    text = await machine.add_variable(node_id(3), name("Text"), "idle", ua.VariantType.String)
    structure = await machine.add_variable(
        node_id(4),
        name("Power"),
        power(Seconds=10, Watts=812.5, Phases=[1.0, 2.0, 3.0]),
        ua.VariantType.ExtensionObject,
        datatype=power_type.nodeid,
    )
    nodes = {
        "counter": (counter, ua.VariantType.Int32),
        "temperature": (temperature, ua.VariantType.Double),
        "text": (text, ua.VariantType.String),
    }
    assert structure is not None
    for number in range(1, 1 + more):
        await machine.add_variable(node_id(4 + number), name(f"Value{number}"), float(number), ua.VariantType.Double)
    events = await server.get_event_generator()
    if not options.small:
        # Its past values can be read. What writes them down is a subscriber, too.
        await server.historize_node_data_change(counter, period=None, count=10_000)

    async def set_value(key, value):
        node, kind = nodes[key]
        now = datetime.now(timezone.utc)
        await node.write_value(ua.DataValue(ua.Variant(value, kind), SourceTimestamp=now))

    async def count():
        while True:
            await asyncio.sleep(0.1)
            await set_value("counter", await counter.read_value() + 1)

    counting = None
    async with server:
        print("ready", flush=True)
        loop = asyncio.get_running_loop()
        while line := await loop.run_in_executor(None, sys.stdin.readline):
            for key, value in json.loads(line).items():
                if key == "event":
                    events.event.Severity = value["severity"]
                    await events.trigger(message=value["message"])
                elif key != "counting":
                    await set_value(key, value)
                elif value:
                    counting = asyncio.create_task(count())
                else:
                    counting.cancel()


asyncio.run(main())

"""Plays single OPC UA services with asyncua: reads lines, writes a line of JSON for each. Between the words is a tab.

    connect URL DIR [USER PASSWORD]   a new session with Basic256Sha256; without a user an anonymous one without security
    play SERVICE REQUEST [TOKEN]      REQUEST is the service's request in the JSON encoding of OPC 10000-6 (1.05) without its
                                      header, TOKEN another authentication token than the session's
    close                             ends the session

A line of the output is {"response": {...}} in the same encoding, but that a status code may be its name, {"fault": NAME} for a
ServiceFault, {"ended": REASON} where the connection ended, or {"unsendable": REASON} where the library does not build it.
"""

import asyncio
import base64
import datetime
import json
import logging
import socket
import sys
import typing
from enum import Enum
from pathlib import Path

from asyncua import Client, ua
from asyncua.crypto import security_policies
from asyncua.crypto.cert_gen import setup_self_signed_certificate
from asyncua.ua.ua_binary import struct_from_binary
from cryptography.x509.oid import ExtendedKeyUsageOID

APPLICATION_URI = "urn:verbund:test:asyncua"
TIMEOUT = 30.0


def qualified_name(text):
    index, colon, name = (text or "").partition(":")
    return ua.QualifiedName(name, int(index)) if colon else ua.QualifiedName(index or None, 0)


def date_time(text):
    return datetime.datetime.fromisoformat(text.replace("Z", "+00:00"))


def variant(value):
    if not value or "UaType" not in value:
        return ua.Variant()
    kind = ua.VariantType(value["UaType"])
    hint = getattr(ua, kind.name, None)
    content = value.get("Value")
    if kind == ua.VariantType.ExtensionObject:
        hint = ua.ExtensionObject
    if isinstance(content, list):
        return ua.Variant([built(hint, one) for one in content], kind, is_array=True)
    return ua.Variant(built(hint, content), kind)


def extension_object(value):
    if not value:
        return ua.ExtensionObject()
    number = ua.NodeId.from_string(value["UaTypeId"]).Identifier
    name = next(name for name, one in vars(ua.ObjectIds).items() if one == number)
    return structure(getattr(ua, name), value["UaBody"])


def structure(hint, value):
    fields = typing.get_type_hints(hint, {"ua": ua})
    made = hint()
    for name, content in value.items():
        setattr(made, name, built(fields[name], content))
    return made


def built(hint, value):
    """An object of the library from a value in JSON."""
    arguments = typing.get_args(hint)
    if typing.get_origin(hint) is list:
        return None if value is None else [built(arguments[0], one) for one in value]
    if arguments:
        hint = next(one for one in arguments if one is not type(None))
    if hint in (ua.NodeId, ua.ExpandedNodeId):
        return ua.NodeId.from_string(value) if value else ua.NodeId()
    if hint is ua.ExtensionObject:
        return extension_object(value)
    if hint is ua.Variant:
        return variant(value)
    if hint is ua.DataValue:
        status = ua.StatusCode(value["StatusCode"]["Code"]) if "StatusCode" in value else None
        return ua.DataValue(variant(value), status)
    if hint is ua.QualifiedName:
        return qualified_name(value)
    if hint is ua.DateTime or hint is datetime.datetime:
        return date_time(value)
    if hint in (ua.ByteString, bytes):
        return None if value is None else base64.b64decode(value)
    if isinstance(hint, type) and issubclass(hint, Enum):
        try:
            return hint(value)
        except ValueError:
            return value
    if isinstance(value, dict):
        return structure(hint, value)
    return value


def plain(value):
    """A value of the library as the JSON encoding has it, but that a status code is its name."""
    if isinstance(value, ua.StatusCode):
        return value.name
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, (bool, int, float, str)) or value is None:
        return value
    if isinstance(value, bytes):
        return base64.b64encode(value).decode()
    if isinstance(value, ua.NodeId):
        return value.to_string()
    if isinstance(value, ua.QualifiedName):
        return f"{value.NamespaceIndex}:{value.Name}" if value.NamespaceIndex else value.Name
    if isinstance(value, datetime.datetime):
        return value.isoformat()
    if isinstance(value, ua.Variant):
        return {"UaType": value.VariantType.value, "Value": plain(value.Value)}
    if isinstance(value, ua.DataValue):
        found = plain(value.Value) if value.Value and value.Value.VariantType != ua.VariantType.Null else {}
        found["StatusCode"] = value.StatusCode.name if value.StatusCode else "Good"
        for name in ("SourceTimestamp", "ServerTimestamp"):
            if getattr(value, name):
                found[name] = plain(getattr(value, name))
        return found
    if hasattr(value, "__dataclass_fields__"):
        return {name: plain(getattr(value, name)) for name in value.__dataclass_fields__ if name != "TypeId"}
    return str(value)


class Player:
    def __init__(self):
        self.client = None

    async def connect(self, url, pki, user=None, password=None):
        client = Client(url, timeout=TIMEOUT)
        client.application_uri = APPLICATION_URI
        # Requests of its own would stand between those of a case.
        client.session_timeout = 3_600_000
        if user:
            folder = Path(pki)
            folder.mkdir(parents=True, exist_ok=True)
            key, certificate = folder / "key.pem", folder / "certificate.der"
            usage = [ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH]
            subject = {"commonName": "Verbund asyncua test client", "organizationName": "Verbund"}
            await setup_self_signed_certificate(key, certificate, APPLICATION_URI, socket.gethostname(), usage, subject)
            policy = security_policies.SecurityPolicyBasic256Sha256
            mode = ua.MessageSecurityMode.SignAndEncrypt
            await client.set_security(policy, str(certificate), str(key), mode=mode)
            client.set_user(user)
            client.set_password(password)
        await client.connect()
        self.client = client
        return {"connected": True}

    async def play(self, service, request, token=None):
        try:
            made = self.request(service, request)
            protocol = self.client.uaclient.protocol
            own = protocol.authentication_token
            if token is not None:
                protocol.authentication_token = ua.NodeId.from_string(token)
            try:
                sent = protocol._send_request(made, TIMEOUT)
            finally:
                protocol.authentication_token = own
        except ConnectionError as error:
            return {"ended": str(error)}
        except Exception as error:  # noqa: BLE001 - whatever the library does not encode
            return {"unsendable": repr(error)}
        try:
            answer = await asyncio.wait_for(sent, TIMEOUT)
        except (ConnectionError, ua.UaError, OSError) as error:
            return {"ended": str(error)}
        return self.response(service, answer)

    @staticmethod
    def request(service, fields):
        kind = getattr(ua, service + "Request")
        made = kind()
        target = made.Parameters if "Parameters" in kind.__dataclass_fields__ else made
        hints = typing.get_type_hints(type(target), {"ua": ua})
        for name, value in fields.items():
            if name == "RequestHeader":
                made.RequestHeader.ReturnDiagnostics = value.get("ReturnDiagnostics", 0)
            else:
                setattr(target, name, built(hints[name], value))
        return made

    @staticmethod
    def response(service, answer):
        type_id = ua.ua_binary.nodeid_from_binary(answer.copy())
        if type_id == ua.FourByteNodeId(ua.ObjectIds.ServiceFault_Encoding_DefaultBinary):
            ua.ua_binary.nodeid_from_binary(answer)
            return {"fault": struct_from_binary(ua.ResponseHeader, answer).ServiceResult.name}
        response = struct_from_binary(getattr(ua, service + "Response"), answer)
        shown = plain(response)
        shown |= shown.pop("Parameters", {})
        return {"response": shown}

    async def close(self):
        if self.client is not None:
            client, self.client = self.client, None
            try:
                await asyncio.wait_for(client.disconnect(), TIMEOUT)
            except (ConnectionError, ua.UaError, OSError, TimeoutError):
                # A case may have ended the session.
                pass
        return {"closed": True}


async def main():
    logging.disable(logging.CRITICAL)
    player = Player()
    lines = asyncio.get_running_loop()
    while line := await lines.run_in_executor(None, sys.stdin.readline):
        command, *words = line.rstrip("\n").split("\t")
        if command == "connect":
            try:
                answer = await player.connect(*words)
            except (ConnectionError, OSError, ua.UaError, asyncio.TimeoutError) as error:
                answer = {"ended": repr(error)}
        elif command == "close":
            answer = await player.close()
        else:
            service, request, *token = words
            answer = await player.play(service, json.loads(request), *token)
        print(json.dumps(answer), flush=True)


asyncio.run(main())

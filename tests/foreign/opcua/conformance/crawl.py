"""Crawls a server with one client and prints what is not as OPC 10000-3, -4 and -5 say: a line of JSON for each kind of
finding with its number and some of its nodes, then {"nodes": N, "variables": N, "notified": N, "calls": N, "findings": N}.

    crawl.py --url URL --pki DIR --user U --password P PLAYER [ARGUMENT...]

All nodes from Root on are browsed in both directions, all attributes of their classes read, all variables subscribed until
each has had its first value, and all methods called without arguments. PLAYER is a program as asyncua_player.py describes it.
"""

import argparse
import json
import sys
from collections import defaultdict

from play import Failed, Played, symbol

CHUNK = 500
# Attributes by node class (OPC 10000-3 §5): those that every node has, and those that it may have.
COMMON = [1, 2, 3, 4]
OPTIONAL_OF_ALL = [5, 6, 7]
MANDATORY = {1: [12], 2: [14, 15, 17, 18, 20], 4: [21, 22], 8: [8], 16: [8, 14, 15], 32: [8, 9], 64: [8], 128: [11, 12]}
OPTIONAL = {2: [13, 16, 19, 27], 16: [13, 16], 32: [10], 64: [23]}
VALUE = 13
HAS_TYPE_DEFINITION, HAS_MODELLING_RULE, HAS_SUBTYPE = "i=40", "i=37", "i=45"
AGGREGATES = {"i=46", "i=47", "i=49"}
# A server need not have the inverses of these (OPC 10000-3 §7.11, §7.13).
ONE_WAY = {HAS_TYPE_DEFINITION, HAS_MODELLING_RULE}
# What a value may be that is known to be none, of an interface or of a field.
WITHOUT_VALUE = {"BadWaitingForInitialData", "BadNoData", "BadNotSupported", "UncertainInitialValue"}
CURRENT_READ = 1
BUILT_IN_MAX = 25


class Crawl:
    def __init__(self, played):
        self.played = played
        self.findings = defaultdict(list)
        self.references = {}
        self.described = {}
        self.attributes = {}

    def service(self, name, request):
        answer = self.played.exchange("play", name, json.dumps(request, separators=(",", ":")))
        if "response" not in answer:
            raise Failed(f"{name}: {answer}")
        return answer["response"]

    def found(self, kind, node):
        self.findings[kind].append(node)

    def browse(self):
        known, waiting = {"i=84"}, ["i=84"]
        while waiting:
            nodes, waiting = waiting[:100], waiting[100:]
            wanted = [
                {"NodeId": node, "BrowseDirection": 2, "ReferenceTypeId": "i=31", "IncludeSubtypes": True, "ResultMask": 63}
                for node in nodes
            ]
            view = {"ViewId": "i=0", "Timestamp": "1601-01-01T00:00:00Z"}
            results = self.service("Browse", {"View": view, "NodesToBrowse": wanted})["Results"]
            for node, result in zip(nodes, results, strict=True):
                references = result.get("References") or []
                while result.get("ContinuationPoint"):
                    points = {"ReleaseContinuationPoints": False, "ContinuationPoints": [result["ContinuationPoint"]]}
                    result = self.service("BrowseNext", points)["Results"][0]
                    references = references + (result.get("References") or [])
                if symbol(result.get("StatusCode")) != "Good":
                    self.found(f"browsed with {symbol(result.get('StatusCode'))}", node)
                self.references[node] = references
                for reference in references:
                    target = reference["NodeId"]
                    self.described.setdefault(target, reference)
                    if target not in known:
                        known.add(target)
                        waiting.append(target)

    def check_references(self):
        ways = {True: set(), False: set()}
        for node, references in self.references.items():
            seen = set()
            for one in references:
                is_forward = bool(one.get("IsForward"))
                key = (one["ReferenceTypeId"], one["NodeId"], is_forward)
                if key in seen:
                    self.found("the same reference twice", node)
                seen.add(key)
                ends = (node, one["NodeId"]) if is_forward else (one["NodeId"], node)
                ways[is_forward].add((one["ReferenceTypeId"], *ends))
        for kind, source, target in ways[True] - ways[False]:
            if kind not in ONE_WAY:
                self.found(f"reference {kind} without its inverse", f"{source} -> {target}")
        for kind, source, target in ways[False] - ways[True]:
            self.found(f"inverse of {kind} without the reference", f"{source} -> {target}")
        for node, one in self.described.items():
            types = [r for r in self.references[node] if r.get("IsForward") and r["ReferenceTypeId"] == HAS_TYPE_DEFINITION]
            if len(types) != (1 if one["NodeClass"] in (1, 2) else 0):
                self.found("not exactly one type definition of an object or variable, or one of another node", node)

    def read(self, wanted):
        values = []
        for start in range(0, len(wanted), CHUNK):
            nodes = [{"NodeId": node, "AttributeId": attribute} for node, attribute in wanted[start : start + CHUNK]]
            results = self.service("Read", {"TimestampsToReturn": 3, "NodesToRead": nodes})["Results"]
            # open62541 leaves out all of a Good value that is null.
            values += [result or {} for result in results]
        return values

    def read_all(self):
        wanted = [
            (node, attribute)
            for node, one in self.described.items()
            for attribute in COMMON
            + OPTIONAL_OF_ALL
            + MANDATORY.get(one["NodeClass"], [])
            + OPTIONAL.get(one["NodeClass"], [])
        ]
        self.attributes = dict(zip(wanted, self.read(wanted), strict=True))

    def status(self, node, attribute):
        value = self.attributes[node, attribute]
        return symbol(value.get("StatusCode", value.get("Status")))

    def value(self, node, attribute):
        return self.attributes[node, attribute].get("Value")

    def check_attributes(self):
        for node, one in self.described.items():
            class_ = one["NodeClass"]
            for attribute in COMMON + MANDATORY.get(class_, []):
                if self.status(node, attribute) != "Good":
                    self.found(f"attribute {attribute} of class {class_} is {self.status(node, attribute)}", node)
                elif "UaType" not in self.attributes[node, attribute]:
                    self.found(f"attribute {attribute} of class {class_} is null", node)
            for attribute in OPTIONAL_OF_ALL + [a for a in OPTIONAL.get(class_, []) if a != VALUE]:
                if self.status(node, attribute) not in ("Good", "BadAttributeIdInvalid"):
                    self.found(f"attribute {attribute} of class {class_} is {self.status(node, attribute)}", node)
            if self.value(node, 1) != node:
                self.found(f"attribute NodeId is {self.value(node, 1)}", node)
            if self.value(node, 2) != class_:
                self.found(f"class {class_} when browsed, {self.value(node, 2)} when read", node)
            if self.value(node, 3) != one["BrowseName"]:
                self.found("one BrowseName when browsed, another when read", node)

    def instances(self):
        """Nodes below the Objects folder: declarations of types need no values."""
        reached, waiting = set(), ["i=85"]
        while waiting:
            for one in self.references[waiting.pop()]:
                is_below = one.get("IsForward") and one["ReferenceTypeId"] in AGGREGATES | {"i=35"}
                if is_below and one["NodeId"] not in reached:
                    reached.add(one["NodeId"])
                    waiting.append(one["NodeId"])
        return reached

    def built_in(self, data_type):
        """The built-in types that a value of a data type may have."""
        types = {one["NodeId"]: node for node, found in self.references.items() for one in found
                 if one.get("IsForward") and one["ReferenceTypeId"] == HAS_SUBTYPE}
        chain = [data_type]
        while chain[-1] in types and not self.is_built_in(chain[-1]):
            chain.append(types[chain[-1]])
        if chain[-1] == "i=24" or data_type == "i=24":
            return set(range(1, BUILT_IN_MAX + 1))
        if "i=29" in chain:
            return {6}
        if data_type in ("i=26", "i=27", "i=28"):
            return set(range(2, 12))
        return {int(chain[-1][2:])} if self.is_built_in(chain[-1]) else set()

    @staticmethod
    def is_built_in(data_type):
        return data_type.startswith("i=") and int(data_type[2:]) <= BUILT_IN_MAX and data_type != "i=24"

    def check_values(self):
        instances, allowed = self.instances(), {}
        for node, one in self.described.items():
            if one["NodeClass"] != 2:
                continue
            status, access, user = (self.status(node, VALUE), self.value(node, 17) or 0, self.value(node, 18) or 0)
            if user & ~access:
                self.found("a user may do more than anybody", node)
            if not access & CURRENT_READ:
                if status != "BadNotReadable":
                    self.found(f"not readable, but {status}", node)
                continue
            if status == "BadUserAccessDenied" and not user & CURRENT_READ:
                continue
            if status not in WITHOUT_VALUE | {"Good", "UncertainSubNormal"}:
                self.found(f"value with {status}", node)
            kind, data_type = self.attributes[node, VALUE].get("UaType"), self.value(node, 14)
            if kind is None:
                if status == "Good" and node in instances:
                    self.found("Good without a value", node)
                continue
            if data_type not in allowed:
                allowed[data_type] = self.built_in(data_type)
            if kind not in allowed[data_type]:
                self.found(f"type {kind} as value of data type {data_type}", node)
            rank, is_array = self.value(node, 15), isinstance(self.value(node, VALUE), list)
            # An empty or null array is shown as null by some clients.
            if rank == -1 and is_array or (rank or 0) >= 1 and not is_array and self.value(node, VALUE) is not None:
                self.found(f"value rank {rank} and {'an array' if is_array else 'no array'}", node)

    def subscribe(self):
        """Monitors all variables, and takes notifications until each has come."""
        limits = {"RequestedPublishingInterval": 50, "RequestedLifetimeCount": 10000, "RequestedMaxKeepAliveCount": 20}
        subscription = self.service("CreateSubscription", limits | {"PublishingEnabled": True})["SubscriptionId"]
        variables = [node for node, one in self.described.items() if one["NodeClass"] == 2]
        waiting, taken = set(), []
        for start in range(0, len(variables), CHUNK):
            items = [
                {
                    "ItemToMonitor": {"NodeId": node, "AttributeId": VALUE},
                    "MonitoringMode": 2,
                    "RequestedParameters": {"ClientHandle": handle, "SamplingInterval": 1000, "QueueSize": 1},
                }
                for handle, node in enumerate(variables[start : start + CHUNK], start + 1)
            ]
            request = {"SubscriptionId": subscription, "TimestampsToReturn": 2, "ItemsToCreate": items}
            results = self.service("CreateMonitoredItems", request)["Results"]
            for item, result in zip(items, results, strict=True):
                node, status = item["ItemToMonitor"]["NodeId"], symbol(result.get("StatusCode"))
                if status == "Good":
                    waiting.add(item["RequestedParameters"]["ClientHandle"])
                elif status != self.status(node, VALUE):
                    self.found(f"monitored with {status}, read with {self.status(node, VALUE)}", node)
        count = len(waiting)
        for _ in range(200):
            if not waiting:
                break
            request = {"SubscriptionAcknowledgements": taken}
            message = self.service("Publish", request)["NotificationMessage"]
            taken = [{"SubscriptionId": subscription, "SequenceNumber": message.get("SequenceNumber", 0)}]
            for data in message.get("NotificationData") or []:
                data = data.get("UaBody", data)
                waiting -= {item["ClientHandle"] for item in data.get("MonitoredItems") or []}
        for handle in waiting:
            self.found("monitored, but no first value came", variables[handle - 1])
        self.service("DeleteSubscriptions", {"SubscriptionIds": [subscription]})
        return len(variables), count - len(waiting)

    def call(self):
        """Calls each method on each object that has it, without arguments."""
        calls = [
            {"ObjectId": node, "MethodId": one["NodeId"], "InputArguments": []}
            for node, references in self.references.items()
            for one in references
            if one.get("IsForward") and one["ReferenceTypeId"] == "i=47" and one["NodeClass"] == 4
        ]
        for start in range(0, len(calls), 20):
            made = calls[start : start + 20]
            for one, result in zip(made, self.service("Call", {"MethodsToCall": made})["Results"], strict=True):
                status, executable = symbol(result.get("StatusCode")), self.value(one["MethodId"], 21)
                is_type = self.described[one["ObjectId"]]["NodeClass"] != 1
                if executable and not is_type:
                    expected = {"Good", "BadArgumentsMissing"}
                else:
                    expected = {"BadNotExecutable", "BadMethodInvalid", "BadNodeIdUnknown"}
                if status not in expected:
                    self.found(f"called without arguments: {status}, executable {executable}", one["MethodId"])
        return len(calls)


def main():
    parser = argparse.ArgumentParser()
    for name in ("url", "pki", "user", "password"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("player", nargs=argparse.REMAINDER)
    arguments = parser.parse_args()
    played = Played(arguments.player, arguments)
    played.connect()
    crawl = Crawl(played)
    crawl.browse()
    crawl.check_references()
    crawl.read_all()
    crawl.check_attributes()
    crawl.check_values()
    variables, notified = crawl.subscribe()
    calls = crawl.call()
    played.close()
    for kind, nodes in sorted(crawl.findings.items()):
        print(json.dumps({"finding": kind, "count": len(nodes), "nodes": nodes[:5]}))
    counts = {"nodes": len(crawl.described), "variables": variables, "notified": notified, "calls": calls}
    print(json.dumps(counts | {"findings": len(crawl.findings)}))
    sys.exit(1 if crawl.findings else 0)


if __name__ == "__main__":
    main()

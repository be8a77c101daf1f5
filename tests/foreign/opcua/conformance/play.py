"""Plays the cases of the conformance suite with one client and prints what went wrong: a line of JSON for each case that
failed, then {"played": N, "failed": N, "skipped": {CASE: REASON}}.

    play.py --url URL --pki DIR --user U --password P --nodes NODES [--only TEXT] PLAYER [ARGUMENT...]
    play.py --table

PLAYER is a program as asyncua_player.py describes it, NODES a JSON object of the nodes that cases name with a dollar sign.

A case (cases/*.json) has a name, the clause that it follows, what the clause says, and steps. A step is a service with its
request, the expected answer and what later steps take of it:

    fault     name of the ServiceFault, or a list of allowed ones
    expect    values by path in the response; an object is a condition: atLeast, atMost, length, not, in
    save      names for values by path
    token     authentication token instead of the session's
    wait      seconds before the step
    second    true: in a second session beside the first one, of the same client and user

In a request, {"repeat": N, "more": M, "of": X} is an array of N + M times X, "$name" a saved value or a node.
"""

import argparse
import base64
import json
import subprocess
import sys
import time
from pathlib import Path

CASES = Path(__file__).parent / "cases"


def cases():
    return [case for file in sorted(CASES.glob("*.json")) for case in json.loads(file.read_text())]


def filled(value, known):
    """A request with its names and repetitions filled in."""
    if isinstance(value, list):
        return [filled(one, known) for one in value]
    if isinstance(value, dict):
        if "repeat" in value:
            return [filled(value["of"], known)] * (filled(value["repeat"], known) + value.get("more", 0))
        return {name: filled(one, known) for name, one in value.items()}
    if isinstance(value, str) and value.startswith("$"):
        return known[value[1:]]
    return value


def symbol(value):
    """The name of a status code, in whichever form a player gives it."""
    if value is None or value == {}:
        return "Good"
    return value.get("Symbol", value) if isinstance(value, dict) else value


def found(response, path):
    value = response
    for name in path.split("."):
        if name.isdigit():
            # What is not there must not be taken for what an encoding leaves out of it.
            if not isinstance(value, list) or int(name) >= len(value):
                raise Failed(f"there is no {name} of {path}: {shortened(response)}")
            value = value[int(name)]
        elif isinstance(value, dict):
            # open62541 calls a DataValue's status as the former encoding did.
            value = value.get(name, value.get("Status") if name == "StatusCode" else None)
        else:
            value = None
    is_status = path.endswith(("Status", "StatusCode", "ServiceResult")) or "Results." in path and path.rsplit(".", 1)[1].isdigit()
    return symbol(value) if is_status and (value is None or isinstance(value, (dict, str))) else value


def fits(value, expected):
    if isinstance(expected, list):
        return any(fits(value, one) for one in expected)
    if not isinstance(expected, dict):
        # Encodings leave out what is 0, false or empty.
        return value == expected or not value and not expected
    checks = {
        "atLeast": lambda bound: (value or 0) >= bound,
        "atMost": lambda bound: (value or 0) <= bound,
        "length": lambda length: len(value or []) == length,
        "longerThan": lambda length: len(value or []) > length,
        "not": lambda unwanted: not fits(value, unwanted),
        "after": lambda earlier: (value or "") > earlier,
    }
    return all(checks[name](one) for name, one in expected.items())


class Failed(Exception):
    """A step was answered in another way than its clause says."""


class Skipped(Exception):
    """The client does not send what the case needs."""


class Played:
    """A client's process with its session."""

    def __init__(self, player, arguments):
        self.process = subprocess.Popen(player, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
        self.player, self.arguments = player, arguments
        self.is_connected = False
        Path(arguments.pki).mkdir(parents=True, exist_ok=True)

    def exchange(self, *words):
        self.process.stdin.write("\t".join(words) + "\n")
        line = self.process.stdout.readline()
        if not line:
            raise Failed(f"the client ended with {self.process.wait()} over {words}")
        return json.loads(line)

    def connect(self):
        given = self.arguments
        answer = self.exchange("connect", given.url, given.pki, given.user, given.password)
        if "connected" not in answer:
            raise Failed(f"no session: {answer}")
        self.is_connected = True

    def close(self):
        if self.is_connected:
            self.exchange("close")
            self.is_connected = False

    def end(self):
        self.close()
        self.process.stdin.close()
        self.process.wait()

    def play(self, step, known):
        request = json.dumps(filled(step["request"], known), separators=(",", ":"))
        token = [filled(step["token"], known)] if "token" in step else []
        answer = self.exchange("play", step["service"], request, *token)
        if "unsendable" in answer:
            raise Skipped(answer["unsendable"])
        wanted = step.get("fault")
        if wanted is not None:
            if not fits(answer.get("fault", answer), wanted):
                raise Failed(f"{step['service']}: {wanted} was expected, {shortened(answer)} came")
            return
        if "response" not in answer:
            raise Failed(f"{step['service']}: a response was expected, {shortened(answer)} came")
        for path, expected in step.get("expect", {}).items():
            value = found(answer["response"], path)
            if not fits(value, filled(expected, known)):
                raise Failed(f"{step['service']}: {path} is {shortened(value)}, not {expected}")
        for name, path in step.get("save", {}).items():
            known[name] = found(answer["response"], path)


def certificate(folder):
    """The client's certificate, from whichever file its library writes, in base64."""
    binary, text = Path(folder) / "certificate.der", Path(folder) / "certificate.pem"
    if binary.exists():
        return base64.b64encode(binary.read_bytes()).decode()
    return text.read_text().split("-----")[2].replace("\n", "")


def shortened(value):
    return json.dumps(value)[:300]


def clean(played, known):
    """Deletes the subscription that a case may have left."""
    if played.is_connected and known.get("subscription"):
        played.exchange("play", "DeleteSubscriptions", json.dumps({"SubscriptionIds": [known["subscription"]]}))


def play(case, played, nodes):
    if not played.is_connected:
        played.connect()
    second = None
    known = {"null": None, "certificate": certificate(played.arguments.pki)} | nodes
    try:
        for step in case["steps"]:
            time.sleep(step.get("wait", 0))
            if step.get("second") and second is None:
                second = Played(played.player, played.arguments)
                second.connect()
            (second if step.get("second") else played).play(step, known)
    finally:
        if second is not None:
            clean(second, known)
            second.end()
        if case.get("endsSession"):
            played.close()
        else:
            clean(played, known)


def table():
    """The rows of docs/conformance.md."""
    return "\n".join(f"| {case['clause']} | {case['name']} | {case['says']} |" for case in cases())


def main():
    if sys.argv[1:] == ["--table"]:
        print(table())
        return
    parser = argparse.ArgumentParser()
    for name in ("url", "pki", "user", "password"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("--nodes", type=json.loads, default={})
    parser.add_argument("--only", default="")
    parser.add_argument("player", nargs=argparse.REMAINDER)
    arguments = parser.parse_args()
    played = Played(arguments.player, arguments)
    count, failed, skipped = 0, 0, {}
    for case in cases():
        if arguments.only not in case["name"]:
            continue
        count += 1
        try:
            play(case, played, {"url": arguments.url} | arguments.nodes)
        except Skipped as reason:
            skipped[case["name"]] = str(reason)
        except (Failed, KeyError) as reason:
            failed += 1
            print(json.dumps({"case": case["name"], "clause": case["clause"], "found": str(reason)}), flush=True)
            played.close()
    played.end()
    print(json.dumps({"played": count, "failed": failed, "skipped": skipped}))
    sys.exit(0 if failed == 0 else 1)


if __name__ == "__main__":
    main()

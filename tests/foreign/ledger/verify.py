"""Computes an audit file of a disclosure ledger again, from docs/audit.md alone and with the standard library only.

verify.py FILE CHECKPOINT KEY: FILE is what `factory-connector ledger audit` wrote, CHECKPOINT a signed note that was kept,
KEY the key of the log as name+id+key. Says what is wrong and ends with 1, or ends with 0. It checks the signatures and the
tree, and each value that is there with its commitment; what the entries say of deliveries and retention it leaves to others.
"""

import base64
import hashlib
import json
import sys

# Ed25519 (RFC 8032, section 5.1): points of the curve as extended coordinates.
P = 2**255 - 19
ORDER = 2**252 + 27742317777372353535851937790883648493
D = -121665 * pow(121666, P - 2, P) % P
ROOT_OF_MINUS_1 = pow(2, (P - 1) // 4, P)


def add(p, q):
    a, b = (p[1] - p[0]) * (q[1] - q[0]) % P, (p[1] + p[0]) * (q[1] + q[0]) % P
    c, d = 2 * p[3] * q[3] * D % P, 2 * p[2] * q[2] % P
    e, f, g, h = b - a, d - c, d + c, b + a
    return (e * f % P, g * h % P, f * g % P, e * h % P)


def times(factor, point):
    total = (0, 1, 1, 0)
    while factor:
        if factor & 1:
            total = add(total, point)
        point, factor = add(point, point), factor >> 1
    return total


def point_of(data):
    y = int.from_bytes(data, "little")
    sign, y = y >> 255, y & (2**255 - 1)
    square = (y * y - 1) * pow(D * y * y + 1, P - 2, P) % P
    x = pow(square, (P + 3) // 8, P)
    if (x * x - square) % P:
        x = x * ROOT_OF_MINUS_1 % P
    if y >= P or (x * x - square) % P or (x == 0 and sign):
        raise ValueError("no point of the curve")
    x = P - x if x & 1 != sign else x
    return (x, y, 1, x * y % P)


BASE = point_of((4 * pow(5, P - 2, P) % P).to_bytes(32, "little"))


def is_signed(key, message, signature):
    r, s = signature[:32], int.from_bytes(signature[32:], "little")
    if len(signature) != 64 or s >= ORDER:
        return False
    digest = hashlib.sha512(r + key + message).digest()
    left, right = times(s, BASE), add(point_of(r), times(int.from_bytes(digest, "little") % ORDER, point_of(key)))
    return (left[0] * right[2] - right[0] * left[2]) % P == 0 == (left[1] * right[2] - right[1] * left[2]) % P


def checkpoint(note, key):
    """Size and root of a checkpoint (C2SP tlog-checkpoint) that this key has signed (C2SP signed-note)."""
    name, _, encoded = key.strip().split("+", 2)
    public = base64.b64decode(encoded)
    key_id = hashlib.sha256(name.encode() + b"\n" + public).digest()[:4]
    text, lines = note.rsplit("\n\n", 1)
    text += "\n"
    for line in lines.splitlines():
        signer, signature = line.removeprefix("\u2014 ").split(" ")
        signature = base64.b64decode(signature, validate=True)
        if signer == name and signature[:4] == key_id and public[0] == 1:
            if not is_signed(public[1:], text.encode(), signature[4:]):
                raise ValueError("the signature is wrong")
            origin, size, root = text.removesuffix("\n").split("\n")
            if origin != name:
                raise ValueError("another log")
            return int(size), base64.b64decode(root, validate=True)
    raise ValueError("not signed with this key")


def sha256(*parts):
    return hashlib.sha256(b"".join(parts)).digest()


class Tree:
    """Perfect subtrees over all leaves so far (RFC 6962, section 2.1), from left to right, each with its size."""

    def __init__(self, size, hashes):
        bits = [1 << bit for bit in reversed(range(size.bit_length())) if size >> bit & 1]
        if len(bits) != len(hashes):
            raise ValueError("the leaves before are not as many as they should be")
        self.size, self.subtrees = size, list(zip(bits, hashes))

    def append(self, text):
        self.size += 1
        node = (1, sha256(b"\x00", text.encode()))
        while self.subtrees and self.subtrees[-1][0] == node[0]:
            size, left = self.subtrees.pop()
            node = (2 * size, sha256(b"\x01", left, node[1]))
        self.subtrees.append(node)

    def root(self):
        root = self.subtrees[-1][1]
        for _, left in reversed(self.subtrees[:-1]):
            root = sha256(b"\x01", left, root)
        return root


def members(report):
    """Names and raw texts of the members of a report, those of its payload one by one."""
    decoder, places = json.JSONDecoder(), []

    def read(at, path):
        at = skip(at + 1)
        while report[at] != "}":
            name, at = decoder.raw_decode(report, at)
            at = skip(skip(at) + 1)
            if not path and name == "Payload":
                at = read(at, name)
            else:
                _, end = decoder.raw_decode(report, at)
                places.append((path, name, report[at:end]))
                at = end
            at = skip(at)
            at = skip(at + 1) if report[at] == "," else at
        return at + 1

    def skip(at):
        while report[at] in " \t\r\n":
            at += 1
        return at

    read(skip(0), "")
    return places


def values_root(report, salt):
    total = hashlib.sha256()
    for index, parts in enumerate(members(report)):
        own = sha256(salt, index.to_bytes(4, "big"))
        encoded = [part.encode() for part in parts]
        total.update(sha256(own, *(len(part).to_bytes(8, "big") + part for part in encoded)))
    return total.hexdigest()


def report_of(line):
    """The report as it stands in the line, byte by byte."""
    _, at = json.JSONDecoder().raw_decode(line, len('{"entry":'))
    at += len(',"report":')
    return line[at : json.JSONDecoder().raw_decode(line, at)[1]]


def verify(path, kept, key):
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    start = json.loads(lines[0])
    begin = json.loads(start["logStart"])
    signed = [checkpoint(kept, key), checkpoint(start["checkpoint"], key)]
    tree = Tree(start["number"] - begin["number"] + 1, [bytes.fromhex(leaf) for leaf in start["leaves"]])
    if tree.size == 1 and tree.root() != sha256(b"\x00", start["logStart"].encode()):
        raise ValueError("the first leaf is another")
    proven = 0
    for number, line in enumerate([None, *lines[1:]], start["number"]):
        if line is not None:
            read = json.loads(line)
            entry = json.loads(read["entry"])
            if (entry["number"], entry["recipient"]) != (number, begin["recipient"]):
                raise ValueError(f"entry {number} stands in another's place")
            if read["report"] is not None:
                root = values_root(report_of(line), bytes.fromhex(read["salt"]))
                if root != entry["values"]:
                    raise ValueError(f"the values of entry {number} are not those that were reported")
            tree.append(read["entry"])
        for size, root in signed:
            if size == tree.size:
                proven += 1
                if root != tree.root():
                    raise ValueError(f"the entries up to {number} are not those of the checkpoint")
    if proven != len(signed):
        raise ValueError("a checkpoint covers entries that the file does not have")
    if tree.size != max(signed)[0]:
        raise ValueError("no signature covers the last entries")


if __name__ == "__main__":
    try:
        with open(sys.argv[2], encoding="utf-8") as file:
            verify(sys.argv[1], file.read(), sys.argv[3])
    except (ValueError, KeyError, IndexError, TypeError) as error:
        sys.exit(f"not proven: {error}")

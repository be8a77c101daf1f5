"""Reads {"signature", "body"} from standard input: a detached, unencoded JWS of ours. Verifies it with joserfc, and signs the
same body with a key of its own. Prints one JSON object: the verified header, and a signature with the same header but that key."""

import base64
import json
import sys

from joserfc import jws
from joserfc.jwk import OKPKey

asked = json.load(sys.stdin)
body = asked["body"].encode()
registry = jws.JWSRegistry(algorithms=["EdDSA"], strict_check_header=False)

encoded = asked["signature"].split("..")[0]
header = json.loads(base64.urlsafe_b64decode(encoded + "=" * (-len(encoded) % 4)))
key = OKPKey.import_key({"kty": "OKP", "crv": "Ed25519", "x": header["kid"]})
verified = jws.deserialize_compact(asked["signature"], key, payload=body, registry=registry)

changed = bytearray(body)
changed[-1] ^= 1
try:
    jws.deserialize_compact(asked["signature"], key, payload=bytes(changed), registry=registry)
    finds_change = False
except Exception:
    finds_change = True

own = OKPKey.generate_key("Ed25519")
own_header = {**verified.headers(), "kid": own.as_dict(private=False)["x"]}
signed = jws.serialize_compact(own_header, body, own, registry=registry)
head, tail = signed.split(".", 1)[0], signed.rsplit(".", 1)[1]
print(json.dumps({"header": verified.headers(), "findsChange": finds_change, "signature": f"{head}..{tail}"}))

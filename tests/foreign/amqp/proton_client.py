"""Qpid Proton against the broker: sends, receives, settles in every way, and is refused where it must be.

Usage: proton_client.py URL USER PASSWORD QUEUE FORBIDDEN_QUEUE [ROOTS.pem]
Prints one JSON object with what it saw; exit status 0 when the conversation could be held at all.
"""

import json
import sys

from proton import ConnectionException, Message, SSLDomain
from proton.utils import BlockingConnection, LinkDetached, SendException

url, user, password, queue, forbidden = sys.argv[1:6]
domain = None
if len(sys.argv) > 6:
    domain = SSLDomain(SSLDomain.MODE_CLIENT)
    domain.set_trusted_ca_db(sys.argv[6])
    domain.set_peer_authentication(SSLDomain.VERIFY_PEER_NAME)


def connect(secret):
    return BlockingConnection(url, timeout=15, user=user, password=secret, allowed_mechs="PLAIN",
                              allow_insecure_mechs=True, ssl_domain=domain, sasl_enabled=True)


seen = {}
connection = connect(password)
sender = connection.create_sender(queue)
for number in range(3):
    message = Message(id=f"p{number}", subject="test", body=b"{}", content_type="application/json", durable=True)
    message.inferred = True  # a data section
    message.annotations = {"x-opt-principal": "mallory"}
    sender.send(message)

# By default Proton names both directions of an address alike, which the broker cannot tell apart in one session.
receiver = connection.create_receiver(queue, credit=10, name="receiver")
first = receiver.receive(timeout=10)
seen["principal"] = first.annotations["x-opt-principal"]
seen["durable"] = first.durable
seen["body"] = bytes(first.body).decode()
receiver.release(delivered=False)
order = []
for _ in range(3):
    message = receiver.receive(timeout=10)
    order.append(message.id)
    if message.id == "p1":
        receiver.reject()
    else:
        receiver.accept()
seen["order"] = sorted(order)

try:
    sender.send(Message(id="large", body=b"x" * 200_000))
    seen["oversize"] = "accepted"
except (SendException, LinkDetached) as refusal:
    seen["oversize"] = str(refusal)

for name, create in (("forbiddenSender", connection.create_sender), ("forbiddenReceiver", connection.create_receiver)):
    try:
        link = create(forbidden, name=name)
        if name == "forbiddenSender":
            link.send(Message(body="x"), timeout=5)
        else:
            link.receive(timeout=5)
        seen[name] = "permitted"
    except (LinkDetached, SendException) as refusal:
        seen[name] = str(refusal)

# The connection has outlived the refusals.
again = connection.create_sender(queue, name="again")
again.send(Message(id="last", body="text"))
connection.close()

try:
    connect("wrong").close()
    seen["badPassword"] = "accepted"
except ConnectionException as refusal:
    seen["badPassword"] = str(refusal)
print(json.dumps(seen))

"""Qpid Proton as a foreign AMQP 1.0 client: sends bodies to one address, then reads another.

    exchange.py --url amqps://127.0.0.1:5671 --user u --password p [--ca root.pem]
                [--send ADDRESS --subject TYPE --body FILE ...] [--receive ADDRESS --count N --seconds S]
                [--leases ADDRESS]

With --leases it answers requests for a factory's lease, as the platform does, and counts them not.

One JSON line per event on standard output: {"sent": id, "outcome": "accepted"|"rejected"|..., "condition": ...} and
{"received": {...properties, "body": text}}. Exit status 0 when everything sent was settled and `count` messages came.
"""
import argparse
import json
import sys
import uuid

from proton import Disposition, Message, SSLDomain
from proton.handlers import MessagingHandler
from proton.reactor import Container


class Exchange(MessagingHandler):
    def __init__(self, options):
        super().__init__(prefetch=100, auto_accept=True)
        self.options = options
        self.waiting = len(options.body)
        self.wanted = options.count
        self.failed = None

    def on_start(self, event):
        domain = None
        if self.options.ca:
            domain = SSLDomain(SSLDomain.MODE_CLIENT)
            domain.set_trusted_ca_db(self.options.ca)
            domain.set_peer_authentication(SSLDomain.VERIFY_PEER_NAME)
        self.connection = event.container.connect(
            self.options.url, user=self.options.user, password=self.options.password, ssl_domain=domain,
            sasl_enabled=True, allowed_mechs="PLAIN", allow_insecure_mechs=True, reconnect=False)
        if self.options.receive:
            event.container.create_receiver(self.connection, self.options.receive)
        self.sender, self.lessor, self.asked = None, None, []
        if self.options.leases:
            self.lessor = event.container.create_sender(self.connection, self.options.leases)
        if self.options.send:
            self.sender = event.container.create_sender(self.connection, self.options.send)
        event.reactor.schedule(self.options.seconds, self)

    def on_sendable(self, event):
        self.grant()
        if event.sender != self.sender:
            return
        while event.sender.credit and self.options.body:
            with open(self.options.body.pop(0), "rb") as file:
                body = file.read()
            message = Message(id=str(uuid.uuid4()), subject=self.options.subject, durable=True,
                              content_type="application/json", body=body, inferred=True)
            delivery = event.sender.send(message)
            delivery.context_id = message.id
            self.say({"sending": message.id, "bytes": len(body)})

    def on_settled(self, event):
        if event.sender is None or event.sender != self.sender:
            return
        names = {Disposition.ACCEPTED: "accepted", Disposition.REJECTED: "rejected",
                 Disposition.RELEASED: "released", Disposition.MODIFIED: "modified"}
        delivery = event.delivery
        condition = delivery.remote.condition
        self.say({"sent": getattr(delivery, "context_id", None),
                  "outcome": names.get(delivery.remote_state, str(delivery.remote_state)),
                  "condition": condition and condition.name, "description": condition and condition.description})
        self.waiting -= 1
        self.finish_when_done()

    def on_message(self, event):
        message = event.message
        body = message.body
        if isinstance(body, memoryview):
            body = bytes(body)
        if isinstance(body, bytes):
            body = body.decode("utf-8", "replace")
        if self.lessor is not None and message.subject == "lease-request":
            self.asked.append(json.loads(body))
            self.grant()
            return
        self.say({"received": {"id": str(message.id), "subject": message.subject,
                               "contentType": message.content_type, "body": body}})
        self.wanted -= 1
        self.finish_when_done()

    def grant(self):
        while self.asked and self.lessor.credit:
            asked = self.asked.pop(0)
            lease = {name: asked[name] for name in ("factoryId", "instanceId", "place", "host")}
            lease |= {"messageType": "lease", "messageId": str(uuid.uuid4()), "correlationId": asked["messageId"],
                      "result": "GRANTED", "leaseNumber": 1, "askAgainMs": 10000}
            self.lessor.send(Message(id=lease["messageId"], subject="lease", content_type="application/json",
                                     body=json.dumps(lease).encode(), inferred=True))

    def on_timer_task(self, event):
        if self.waiting > 0 or self.wanted > 0:
            self.failed = f"after {self.options.seconds} s {self.waiting} unsettled, {max(self.wanted, 0)} not received"
        self.connection.close()

    def on_transport_error(self, event):
        self.failed = f"{event.transport.condition.name}: {event.transport.condition.description}"
        event.reactor.stop()

    def on_link_error(self, event):
        condition = event.link.remote_condition
        self.say({"linkError": condition.name, "description": condition.description})
        self.failed = condition.name
        self.connection.close()

    def on_connection_error(self, event):
        condition = event.connection.remote_condition
        self.say({"connectionError": condition.name, "description": condition.description})
        self.failed = condition.name

    def finish_when_done(self):
        if self.waiting <= 0 and self.wanted <= 0:
            self.connection.close()

    def on_connection_closed(self, event):
        event.reactor.stop()

    @staticmethod
    def say(what):
        print(json.dumps(what), flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--url", required=True)
    parser.add_argument("--user", required=True)
    parser.add_argument("--password", required=True)
    parser.add_argument("--ca")
    parser.add_argument("--send")
    parser.add_argument("--subject")
    parser.add_argument("--body", action="append", default=[])
    parser.add_argument("--receive")
    parser.add_argument("--leases")
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=20)
    exchange = Exchange(parser.parse_args())
    Container(exchange).run()
    if exchange.failed:
        print(json.dumps({"failed": exchange.failed}), flush=True)
        sys.exit(1)


if __name__ == "__main__":
    main()

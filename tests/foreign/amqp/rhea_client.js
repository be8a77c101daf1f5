// rhea against the broker: sends, receives, settles, and is refused where it must be.
// Usage: rhea_client.js PORT|WEBSOCKET_URL USER PASSWORD QUEUE FORBIDDEN_QUEUE [ROOTS.pem]
// Prints one JSON object with what it saw.
'use strict';
const fs = require('fs');
const rhea = require('rhea');

const [address, username, password, queue, forbidden, roots] = process.argv.slice(2);
const seen = { accepted: 0, received: [], refused: {} };
const deadline = setTimeout(() => finish('not in time'), 20000);
const container = rhea.create_container({ id: `rhea-${process.pid}` });
const options = { host: 'localhost', port: Number(address), username, password, reconnect: false, idle_time_out: 4000 };
// Node's own WebSocket; it knows the roots from NODE_EXTRA_CA_CERTS.
if (address.startsWith('ws')) options.connection_details = container.websocket_connect(WebSocket)(address, ['AMQPWSB10', 'amqp']);
else if (roots) Object.assign(options, { transport: 'tls', ca: [fs.readFileSync(roots)], servername: 'localhost' });

function finish(problem) {
  clearTimeout(deadline);
  if (problem) seen.problem = problem;
  process.stdout.write(JSON.stringify(seen) + '\n', () => process.exit(problem ? 1 : 0));
}

const connection = container.connect(options);
connection.on('disconnected', (context) => { if (!seen.done) finish(`disconnected: ${context.error || ''}`); });
connection.on('error', (error) => finish(`error: ${error}`));

const sender = connection.open_sender(queue);
let toSend = 3;
sender.on('sendable', () => {
  while (toSend > 0 && sender.sendable()) {
    sender.send({ message_id: `r${3 - toSend}`, subject: 'test', durable: true,
      body: rhea.message.data_section(Buffer.from('{}')), message_annotations: { 'x-opt-principal': 'mallory' } });
    toSend -= 1;
  }
});
sender.on('accepted', () => { seen.accepted += 1; if (seen.accepted === 3) receive(); });

function receive() {
  const receiver = connection.open_receiver({ source: queue, credit_window: 0, autoaccept: false });
  receiver.on('receiver_open', () => receiver.add_credit(10));
  const released = new Set();
  receiver.on('message', ({ message, delivery }) => {
    seen.principal = message.message_annotations['x-opt-principal'];
    if (message.message_id === 'r1' && !released.has('r1')) {
      released.add('r1');
      // On a tick of its own: rhea joins settlements of one tick into one range with one state.
      setTimeout(() => delivery.release(), 200);
      return;
    }
    seen.received.push(message.message_id);
    setTimeout(() => delivery.accept(), message.message_id === 'r0' ? 0 : 400);
    // Heartbeats are due meanwhile; then the refusals, each on a link of its own.
    if (seen.received.length === 3) setTimeout(() => refusals(receiver), 5500);
  });
}

function refusals(receiver) {
  receiver.close();
  let open = 2;
  const note = (name) => ({ error, ...context }) => {
    const link = context.sender || context.receiver;
    seen.refused[name] = (link && link.error && link.error.condition) || String(error);
    open -= 1;
    if (open === 0) { seen.done = true; connection.close(); setTimeout(() => finish(), 300); }
  };
  const forbiddenSender = connection.open_sender(forbidden);
  forbiddenSender.on('sender_error', note('sender'));
  const forbiddenReceiver = connection.open_receiver(forbidden);
  forbiddenReceiver.on('receiver_error', note('receiver'));
}

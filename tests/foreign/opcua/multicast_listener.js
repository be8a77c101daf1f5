// A foreign listener of multicast DNS: prints one line of JSON for each OPC UA server that comes and goes.
//
//   node multicast_listener.js ADDRESS_OF_INTERFACE [--ask-for PORT] [--timeout 60]
//
// {"event":"listening"}, then {"event":"up" or "down","name":...,"port":...,"host":...,"text":{...},"addresses":[...]}.
// With --ask-for it asks again and again until the server at that port has answered, and says {"event":"answered","port":...}.
// An answer carries the server's address in additional records, an announcement among its answers (RFC 6763 section 12.1).
'use strict';

const { parseArgs } = require('node:util');
const { Bonjour } = require('sterfive-bonjour-service');

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { timeout: { type: 'string', default: '60' }, 'ask-for': { type: 'string' } },
});
setTimeout(() => process.exit(1), 1000 * Number(values.timeout));

function emit(event) {
  process.stdout.write(`${JSON.stringify(event)}\n`);
}

const bonjour = new Bonjour({ interface: positionals[0], bind: '0.0.0.0' }, (error) => emit({ event: 'failed', message: error.message }));
const browser = bonjour.find({ protocol: 'tcp', type: 'opcua-tcp' });
for (const event of ['up', 'down']) {
  browser.on(event, ({ name, port, host, txt, addresses }) => emit({ event, name, port, host, text: txt, addresses }));
}
if (values['ask-for']) {
  const port = Number(values['ask-for']);
  // A server leaves out what it has multicast within the last second (RFC 6762 section 6).
  const asking = setInterval(() => browser.update(), 500);
  const hear = ({ additionals }) => {
    if (additionals.some(({ type, data }) => type === 'SRV' && data.port === port)) {
      clearInterval(asking);
      bonjour.server.mdns.off('response', hear);
      emit({ event: 'answered', port });
    }
  };
  bonjour.server.mdns.on('response', hear);
}
emit({ event: 'listening' });

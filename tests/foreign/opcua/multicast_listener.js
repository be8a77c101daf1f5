// A foreign listener of multicast DNS: prints one line of JSON for each OPC UA server that comes and goes.
//
//   node multicast_listener.js ADDRESS_OF_INTERFACE [--timeout 60]
//
// {"event":"listening"}, then {"event":"up" or "down","name":...,"port":...,"host":...,"text":{...},"addresses":[...]}.
'use strict';

const { parseArgs } = require('node:util');
const { Bonjour } = require('sterfive-bonjour-service');

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { timeout: { type: 'string', default: '60' } },
});
setTimeout(() => process.exit(1), 1000 * Number(values.timeout));

function tell(event) {
  process.stdout.write(`${JSON.stringify(event)}\n`);
}

const bonjour = new Bonjour({ interface: positionals[0], bind: '0.0.0.0' }, (error) => tell({ event: 'failed', message: error.message }));
const browser = bonjour.find({ protocol: 'tcp', type: 'opcua-tcp' });
for (const event of ['up', 'down']) {
  browser.on(event, ({ name, port, host, txt, addresses }) => tell({ event, name, port, host, text: txt, addresses }));
}
tell({ event: 'listening' });

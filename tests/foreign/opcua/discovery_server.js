// A foreign local discovery server (node-opcua) as a command: prints one line of JSON for each thing that happens.
//
//   node discovery_server.js PORT --pki DIR [--old] [--timeout 60]
//
// {"event":"listening"}, {"event":"registered","service":...,"serverUri":...,"discoveryUrls":[...]},
// {"event":"unregistered","serverUri":...}, {"event":"refused","status":...}. With --old it knows RegisterServer only,
// as discovery servers before OPC UA 1.04 do.
'use strict';

const fs = require('node:fs');
const path = require('node:path');
const { parseArgs } = require('node:util');
const opcua = require('node-opcua');

function emit(event) {
  process.stdout.write(`${JSON.stringify(event)}\n`);
}

async function main() {
  const { values, positionals } = parseArgs({
    allowPositionals: true,
    options: { pki: { type: 'string' }, old: { type: 'boolean', default: false }, timeout: { type: 'string', default: '60' } },
  });
  // Only the events are for the caller.
  console.log = console.warn = console.error = console.info = () => {};
  setTimeout(() => process.exit(1), 1000 * Number(values.timeout));
  const rootFolder = path.resolve(values.pki);
  fs.mkdirSync(rootFolder, { recursive: true });
  const certificates = new opcua.OPCUACertificateManager({ rootFolder, automaticallyAcceptUnknownCertificate: true });
  await certificates.initialize();

  let service = null;
  class DiscoveryServer extends opcua.OPCUADiscoveryServer {
    _on_RegisterServer2Request(message, channel) {
      if (values.old) {
        const serviceResult = opcua.StatusCodes.BadServiceUnsupported;
        channel.send_response('MSG', new opcua.ServiceFault({ responseHeader: { serviceResult } }), message);
        return;
      }
      service = 'RegisterServer2';
      super._on_RegisterServer2Request(message, channel);
    }

    _on_RegisterServerRequest(message, channel) {
      service = 'RegisterServer';
      super._on_RegisterServerRequest(message, channel);
    }
  }
  const server = new DiscoveryServer({
    port: Number(positionals[0]),
    hostname: '127.0.0.1',
    serverCertificateManager: certificates,
    serverInfo: { applicationUri: 'urn:verbund:test:discovery' },
  });
  server.on('onRegisterServer', ({ serverUri, discoveryUrls }) => {
    emit({ event: 'registered', service, serverUri, discoveryUrls });
  });
  server.on('onUnregisterServer', ({ serverUri }, isForced) => {
    if (!isForced) emit({ event: 'unregistered', serverUri });
  });
  server.on('onRegistrationRefused', (_server, { statusCode }) => {
    emit({ event: 'refused', status: statusCode.name });
  });
  await server.start();
  emit({ event: 'listening' });
}

main().catch((error) => {
  emit({ event: 'failed', message: error.message });
  process.exit(1);
});

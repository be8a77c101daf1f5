// A server written with node-opcua for comparison: variables that all change again and again, until standard input ends.
//
//   node bench_server.js PORT VARIABLES PERIOD_MS
//
// Prints one line: {"url":...,"nodes":[...]}.
'use strict';

const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const opcua = require('node-opcua');

async function main() {
  const [port, variables, period] = process.argv.slice(2).map(Number);
  const print = (line) => process.stdout.write(`${line}\n`);
  console.log = console.warn = console.info = () => {};
  const rootFolder = fs.mkdtempSync(path.join(os.tmpdir(), 'verbund-bench-node-'));
  const certificates = new opcua.OPCUACertificateManager({ rootFolder, automaticallyAcceptUnknownCertificate: true });
  const server = new opcua.OPCUAServer({
    port,
    hostname: '127.0.0.1',
    serverCertificateManager: certificates,
    userCertificateManager: certificates,
    securityPolicies: [opcua.SecurityPolicy.None],
    securityModes: [opcua.MessageSecurityMode.None],
    allowAnonymous: true,
    serverCapabilities: {
      maxMonitoredItemsPerSubscription: 2 * variables,
      operationLimits: { maxMonitoredItemsPerCall: 2 * variables },
    },
  });
  await server.initialize();
  const addressSpace = server.engine.addressSpace;
  const namespace = addressSpace.getOwnNamespace();
  const folder = namespace.addFolder('ObjectsFolder', { browseName: 'Bench' });
  const all = Array.from({ length: variables }, (_, n) =>
    namespace.addVariable({
      componentOf: folder,
      browseName: `field${n}`,
      nodeId: `s=field${n}`,
      dataType: 'Double',
      minimumSamplingInterval: 0,
      value: { dataType: opcua.DataType.Double, value: 1 },
    }),
  );
  await server.start();
  let value = 1;
  setInterval(() => {
    value += 1;
    const now = new Date();
    for (const variable of all) {
      variable.setValueFromSource({ dataType: opcua.DataType.Double, value }, opcua.StatusCodes.Good, now);
    }
  }, period);
  const nodes = all.map((variable) => variable.nodeId.toString());
  print(JSON.stringify({ url: `opc.tcp://127.0.0.1:${port}`, nodes }));
  process.stdin.resume();
  process.stdin.on('end', () => {
    fs.rmSync(rootFolder, { recursive: true, force: true });
    process.exit(0);
  });
}

main().catch((error) => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});

// The job of a connector's script mappings, done with node-opcua as its users do it: a client subscribes to many
// counters of a server, a JavaScript function scales each value, and the result becomes the value of a variable of an
// OPC UA server of the same process. Prints one line of JSON: values, seconds, CPU seconds.
//
//   node mapping_job.js ENDPOINT NAMESPACE_URI COUNT SECONDS PKI_DIR
'use strict';

const path = require('node:path');
const opcua = require('node-opcua');

const [endpoint, namespaceUri, countText, secondsText, pki] = process.argv.slice(2);
const count = Number(countText);
const seconds = Number(secondsText);
const scale = (value) => value * 0.1 + 1;

const manager = (name) =>
  new opcua.OPCUACertificateManager({ rootFolder: path.join(pki, name), automaticallyAcceptUnknownCertificate: true });

async function serve() {
  const server = new opcua.OPCUAServer({
    port: 0,
    serverCertificateManager: manager('server'),
    securityPolicies: [opcua.SecurityPolicy.None],
    securityModes: [opcua.MessageSecurityMode.None],
  });
  await server.initialize();
  const namespace = server.engine.addressSpace.getOwnNamespace();
  const folder = namespace.addFolder(server.engine.addressSpace.rootFolder.objects, { browseName: 'Fields' });
  const fields = [];
  for (let index = 0; index < count; index += 1) {
    const value = { dataType: opcua.DataType.Double, value: 0 };
    fields.push(namespace.addVariable({ componentOf: folder, browseName: `Field${index}`, dataType: 'Double', value }));
  }
  await server.start();
  return { server, fields };
}

async function main() {
  const { server, fields } = await serve();
  const client = opcua.OPCUAClient.create({ endpointMustExist: false, clientCertificateManager: manager('client') });
  await client.connect(endpoint);
  const session = await client.createSession();
  const index = (await session.readNamespaceArray()).indexOf(namespaceUri);
  const subscription = await session.createSubscription2({
    requestedPublishingInterval: 50,
    requestedLifetimeCount: 1000,
    requestedMaxKeepAliveCount: 20,
    maxNotificationsPerPublish: 0,
    publishingEnabled: true,
    priority: 0,
  });
  let values = 0;
  for (let first = 0; first < count; first += 500) {
    const items = [];
    for (let at = first; at < Math.min(first + 500, count); at += 1) {
      items.push({ nodeId: `ns=${index};s=Counter${at}`, attributeId: opcua.AttributeIds.Value });
    }
    const group = opcua.ClientMonitoredItemGroup.create(
      subscription,
      items,
      { samplingInterval: 0, queueSize: 16, discardOldest: true },
      opcua.TimestampsToReturn.Both,
    );
    group.on('changed', (_item, dataValue, place) => {
      values += 1;
      const [high, low] = dataValue.value.value;
      const value = scale(high * 2 ** 32 + low);
      const variant = new opcua.Variant({ dataType: opcua.DataType.Double, value });
      fields[first + place].setValueFromSource(variant, dataValue.statusCode, dataValue.sourceTimestamp);
    });
    await new Promise((resolve) => group.on('initialized', resolve));
  }
  await new Promise((resolve) => setTimeout(resolve, 2000));
  const before = { values, cpu: process.cpuUsage(), at: process.hrtime.bigint() };
  await new Promise((resolve) => setTimeout(resolve, seconds * 1000));
  const cpu = process.cpuUsage(before.cpu);
  const result = {
    values: values - before.values,
    seconds: Number(process.hrtime.bigint() - before.at) / 1e9,
    cpuSeconds: (cpu.user + cpu.system) / 1e6,
  };
  process.stdout.write(`${JSON.stringify(result)}\n`, () => process.exit(0));
  void server;
}

main().catch((error) => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});

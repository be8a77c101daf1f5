// A foreign OPC UA client (node-opcua): connects with a user, does one thing, prints one line of JSON.
//
// Each line of its input is a JSON list of arguments, done one after the other, each in a session of its own:
//
//   ENDPOINT --user U --password P --pki DIR [--policy Basic256Sha256] [--timeout 20] COMMAND ...
//
// The commands, arguments and results are those of asyncua_client.py in this folder.
'use strict';

const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const readline = require('node:readline');
const { parseArgs } = require('node:util');
const opcua = require('node-opcua');

const APPLICATION_URI = 'urn:verbund:test:node-opcua';

function plain(value) {
  if (value === null || value === undefined) return null;
  if (Array.isArray(value) || ArrayBuffer.isView(value)) {
    return Buffer.isBuffer(value) ? value.toString('hex') : Array.from(value, plain);
  }
  if (value instanceof Date) return value.toISOString();
  if (value instanceof opcua.NodeId) return value.toString();
  if (value instanceof opcua.LocalizedText) return value.text;
  if (value instanceof opcua.QualifiedName) return value.name;
  if (value instanceof opcua.StatusCode) return value.name;
  if (value instanceof opcua.Variant) return plain(value.value);
  if (typeof value === 'object') {
    return Object.fromEntries(Object.entries(value).filter(([key]) => key !== 'schema').map(([k, v]) => [k, plain(v)]));
  }
  return value;
}

// node-opcua says 64-bit integers as [high, low].
function shownValue(variant) {
  if (!variant) return null;
  const is64 = [opcua.DataType.UInt64, opcua.DataType.Int64].includes(variant.dataType);
  if (is64 && variant.arrayType === opcua.VariantArrayType.Scalar && Array.isArray(variant.value)) {
    return variant.value[0] * 2 ** 32 + variant.value[1];
  }
  return plain(variant.value);
}

function shown(dataValue) {
  return {
    value: shownValue(dataValue.value),
    status: dataValue.statusCode.name,
    sourceTimestamp: plain(dataValue.sourceTimestamp),
  };
}

function variant(typeName, value) {
  const dataType = opcua.DataType[typeName];
  const arrayType = Array.isArray(value) ? opcua.VariantArrayType.Array : opcua.VariantArrayType.Scalar;
  if (arrayType === opcua.VariantArrayType.Scalar && ['UInt64', 'Int64'].includes(typeName)) {
    value = [Math.floor(value / 2 ** 32), value % 2 ** 32];
  }
  return new opcua.Variant({ dataType, arrayType, value });
}

async function resolve(session, text) {
  if (text.startsWith('nsu=')) {
    const end = text.indexOf(';');
    const namespaces = await session.readNamespaceArray();
    const index = namespaces.indexOf(text.slice(4, end));
    if (index < 0) throw Object.assign(new Error('no such namespace'), { status: 'BadNodeIdUnknown' });
    text = `ns=${index};${text.slice(end + 1)}`;
  }
  return opcua.resolveNodeId(text);
}

async function listen(session, count, itemToMonitor, parameters, convert) {
  const subscription = await session.createSubscription2({
    requestedPublishingInterval: 20,
    requestedLifetimeCount: 1000,
    requestedMaxKeepAliveCount: 100,
    maxNotificationsPerPublish: 0,
    publishingEnabled: true,
    priority: 0,
  });
  const found = [];
  const item = await subscription.monitor(itemToMonitor, parameters, opcua.TimestampsToReturn.Both);
  await new Promise((done) => {
    item.on('changed', (value) => {
      if (found.length < count) found.push(convert(value));
      if (found.length >= count) done();
    });
    process.stderr.write('ready\n');
  });
  await subscription.terminate();
  return found;
}

const EVENT_FIELDS = [
  'EventType', 'SourceNode', 'SourceName', 'Message', 'Severity', 'ClientUserId', 'Status', 'OldValue', 'NewValue',
  'Changes', 'SessionId', 'SecurityPolicyUri', 'StatusCodeId', 'ClientCertificateThumbprint',
];

async function run(session, command, rest) {
  if (command === 'batch') {
    const results = [];
    for (const [one, ...its] of JSON.parse(rest[0])) results.push(await run(session, one, its));
    return { results };
  }
  if (command === 'events') {
    const eventType = opcua.ObjectTypeIds[`${rest[1] ?? 'BaseEvent'}Type`];
    const filter = opcua.constructEventFilter(EVENT_FIELDS, opcua.ofType(opcua.resolveNodeId(eventType)));
    const item = { nodeId: opcua.resolveNodeId('i=2253'), attributeId: opcua.AttributeIds.EventNotifier };
    const convert = (fields) => Object.fromEntries(EVENT_FIELDS.map((name, i) => [name, shownValue(fields[i])]));
    const parameters = { samplingInterval: 0, queueSize: 100, discardOldest: true, filter };
    return { events: await listen(session, Number(rest[0]), item, parameters, convert) };
  }
  const nodeId = await resolve(session, rest[0]);
  switch (command) {
    case 'browse': {
      const result = await opcua.browseAll(session, {
        nodeId,
        referenceTypeId: 'HierarchicalReferences',
        includeSubtypes: true,
        browseDirection: opcua.BrowseDirection.Forward,
        resultMask: 63,
      });
      const children = result.references.map((r) => ({
        nodeId: r.nodeId.toString(),
        browseName: r.browseName.name,
        nodeClass: opcua.NodeClass[r.nodeClass],
      }));
      return { children };
    }
    case 'read':
      return shown(await session.read({ nodeId, attributeId: opcua.AttributeIds.Value }));
    case 'write': {
      const value = { value: variant(rest[1], JSON.parse(rest[2])) };
      const status = await session.write({ nodeId, attributeId: opcua.AttributeIds.Value, value });
      return { status: status.name };
    }
    case 'subscribe': {
      const item = { nodeId, attributeId: opcua.AttributeIds.Value };
      const parameters = { samplingInterval: 0, queueSize: 100, discardOldest: true };
      return { changes: await listen(session, Number(rest[1]), item, parameters, shown) };
    }
    default: {
      const inputArguments = JSON.parse(rest[2]).map(([type, value]) => variant(type, value));
      const result = await session.call({ objectId: nodeId, methodId: await resolve(session, rest[1]), inputArguments });
      return { status: result.statusCode.name, outputs: (result.outputArguments ?? []).map(shownValue) };
    }
  }
}

async function connectAndRun(endpoint, options, command, rest) {
  const rootFolder = path.resolve(options.pki);
  fs.mkdirSync(rootFolder, { recursive: true });
  const certificates = new opcua.OPCUACertificateManager({ rootFolder, automaticallyAcceptUnknownCertificate: true });
  await certificates.initialize();
  const isSecure = options.policy !== 'None';
  const certificateFile = path.join(rootFolder, 'certificate.pem');
  if (!fs.existsSync(certificateFile)) {
    await certificates.createSelfSignedCertificate({
      applicationUri: APPLICATION_URI,
      dns: [os.hostname()],
      outputFile: certificateFile,
      startDate: new Date(),
      subject: '/CN=Verbund node-opcua test client/O=Verbund',
      validity: 365,
    });
  }
  const client = opcua.OPCUAClient.create({
    applicationName: 'Verbund node-opcua test client',
    applicationUri: APPLICATION_URI,
    clientCertificateManager: certificates,
    certificateFile,
    privateKeyFile: certificates.privateKey,
    connectionStrategy: { maxRetry: 0, initialDelay: 100 },
    endpointMustExist: false,
    securityMode: isSecure ? opcua.MessageSecurityMode.SignAndEncrypt : opcua.MessageSecurityMode.None,
    securityPolicy: opcua.SecurityPolicy[options.policy],
  });
  await client.connect(endpoint);
  try {
    const identity = options.user
      ? { type: opcua.UserTokenType.UserName, userName: options.user, password: options.password }
      : { type: opcua.UserTokenType.Anonymous };
    const session = await client.createSession(identity);
    try {
      return { ok: true, ...(await run(session, command, rest)) };
    } finally {
      await session.close();
    }
  } finally {
    await client.disconnect();
  }
}

async function done(args) {
  const { values, positionals } = parseArgs({
    args,
    allowPositionals: true,
    options: {
      user: { type: 'string' },
      password: { type: 'string', default: '' },
      pki: { type: 'string' },
      policy: { type: 'string', default: 'Basic256Sha256' },
      timeout: { type: 'string', default: '20' },
    },
  });
  const [endpoint, command, ...rest] = positionals;
  let timer;
  const timeout = new Promise((_, reject) => {
    timer = setTimeout(() => reject(Object.assign(new Error('timeout'), { status: 'TimeoutError' })), 1000 * values.timeout);
  });
  try {
    return await Promise.race([connectAndRun(endpoint, values, command, rest), timeout]);
  } catch (error) {
    const named = /\b((?:Bad|Uncertain)[A-Za-z]+)\b/.exec(error.message);
    return { ok: false, status: error.status ?? named?.[1] ?? error.name, message: error.message };
  } finally {
    clearTimeout(timer);
  }
}

async function main() {
  // Only the results are for the caller.
  console.log = console.warn = console.error = console.info = () => {};
  for await (const line of readline.createInterface({ input: process.stdin })) {
    process.stdout.write(`${JSON.stringify(await done(JSON.parse(line)))}\n`);
  }
  process.exit(0);
}

main();

// Plays single OPC UA services with node-opcua: the commands and answers are those of asyncua_player.py in this folder.
'use strict';

const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const readline = require('node:readline');
const opcua = { ...require('node-opcua-types'), ...require('node-opcua') };

const APPLICATION_URI = 'urn:verbund:test:node-opcua';
const TIMEOUT_MS = 30_000;

function extensionObject(value) {
  if (!value) return null;
  const { UaTypeId: typeId, UaBody: fields } = value;
  const found = Object.entries(opcua.DataTypeIds).find(([, number]) => `i=${number}` === typeId);
  return structure(opcua[found[0]], fields);
}

function variant(value) {
  if (value?.UaType === undefined) return new opcua.Variant();
  const fieldType = opcua.DataType[value.UaType];
  const isArray = Array.isArray(value.Value);
  const one = (content) => built({ fieldType, category: 'basic' }, content);
  return new opcua.Variant({
    dataType: value.UaType,
    arrayType: isArray ? opcua.VariantArrayType.Array : opcua.VariantArrayType.Scalar,
    value: isArray ? value.Value.map(one) : one(value.Value),
  });
}

function dataValue(value) {
  const statusCode = value.StatusCode ? opcua.coerceStatusCode(value.StatusCode.Code) : opcua.StatusCodes.Good;
  return new opcua.DataValue({ value: variant(value), statusCode });
}

// An object of the library from a value in JSON.
function built(field, value) {
  if (field.isArray && Array.isArray(value)) return value.map((one) => built({ ...field, isArray: false }, one));
  switch (field.fieldType) {
    case 'NodeId':
      return value ? opcua.resolveNodeId(value) : opcua.NodeId.nullNodeId;
    case 'ExpandedNodeId':
      return opcua.coerceExpandedNodeId(value ?? 'i=0');
    case 'QualifiedName': {
      const [, index, name] = /^(?:(\d+):)?(.*)$/.exec(value ?? '');
      return new opcua.QualifiedName({ namespaceIndex: Number(index ?? 0), name: name || null });
    }
    case 'LocalizedText':
      return new opcua.LocalizedText({ locale: value?.Locale, text: value?.Text });
    case 'ExtensionObject':
      return extensionObject(value);
    case 'Variant':
      return variant(value);
    case 'DataValue':
      return dataValue(value);
    case 'ByteString':
    case 'ContinuationPoint':
      return value === null ? null : Buffer.from(value, 'base64');
    case 'NumericRange':
      // As text, so that it may be malformed.
      return Object.assign(new opcua.NumericRange(), { toEncodeableString: () => value });
    case 'DateTime':
    case 'UtcTime':
      return new Date(value);
    case 'UInt64':
    case 'Int64':
      return [Math.floor(value / 2 ** 32), value % 2 ** 32];
    default:
  }
  if (field.category === 'complex') return structure(opcua[field.fieldType], value);
  return value;
}

function structure(type, value) {
  const made = new type();
  for (const field of type.schema.fields) {
    if (field.originalName in value) made[field.name] = built(field, value[field.originalName]);
  }
  return made;
}

// A value of the library as the JSON encoding has it, but that a status code is its name.
function plain(value) {
  if (value === null || value === undefined) return null;
  if (Buffer.isBuffer(value)) return value.toString('base64');
  if (Array.isArray(value) || ArrayBuffer.isView(value)) return Array.from(value, plain);
  if (value instanceof Date) return value.toISOString();
  if (value instanceof opcua.NodeId) return value.toString().replace(/^ns=0;/, '');
  if (value instanceof opcua.QualifiedName) return value.name === null ? null : value.toString();
  if (value instanceof opcua.StatusCode) return value.name;
  if (value instanceof opcua.Variant) {
    return value.dataType === opcua.DataType.Null ? {} : { UaType: value.dataType, Value: plain(content(value)) };
  }
  if (value instanceof opcua.DataValue) {
    const { statusCode, sourceTimestamp, serverTimestamp } = value;
    return { ...plain(value.value), StatusCode: statusCode.name, ...stamps({ sourceTimestamp, serverTimestamp }) };
  }
  if (value.schema?.fields) {
    return Object.fromEntries(fieldsOf(value.schema).map((field) => [field.originalName, plain(value[field.name])]));
  }
  if (typeof value === 'object') return Object.fromEntries(Object.entries(value).map(([key, one]) => [key, plain(one)]));
  return value;
}

// The library says 64-bit integers as [high, low].
function content({ dataType, arrayType, value }) {
  const is64 = [opcua.DataType.UInt64, opcua.DataType.Int64].includes(dataType);
  const isScalar = arrayType === opcua.VariantArrayType.Scalar;
  return is64 && isScalar && Array.isArray(value) ? value[0] * 2 ** 32 + value[1] : value;
}

function stamps(given) {
  const known = Object.entries(given).filter(([, time]) => time);
  return Object.fromEntries(known.map(([name, time]) => [name[0].toUpperCase() + name.slice(1), time.toISOString()]));
}

function fieldsOf(schema) {
  const base = schema._baseSchema?.fields ? fieldsOf(schema._baseSchema) : [];
  return [...base, ...schema.fields];
}

class Player {
  async connect(url, pki, user, password) {
    const rootFolder = path.resolve(pki);
    fs.mkdirSync(rootFolder, { recursive: true });
    const certificates = new opcua.OPCUACertificateManager({ rootFolder, automaticallyAcceptUnknownCertificate: true });
    await certificates.initialize();
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
    this.client = opcua.OPCUAClient.create({
      applicationName: 'Verbund node-opcua test client',
      applicationUri: APPLICATION_URI,
      clientCertificateManager: certificates,
      certificateFile,
      privateKeyFile: certificates.privateKey,
      connectionStrategy: { maxRetry: 0, initialDelay: 100 },
      endpointMustExist: false,
      requestedSessionTimeout: 3_600_000,
      transactionTimeout: TIMEOUT_MS,
      securityMode: user ? opcua.MessageSecurityMode.SignAndEncrypt : opcua.MessageSecurityMode.None,
      securityPolicy: user ? opcua.SecurityPolicy.Basic256Sha256 : opcua.SecurityPolicy.None,
    });
    await this.client.connect(url);
    const identity = user
      ? { type: opcua.UserTokenType.UserName, userName: user, password }
      : { type: opcua.UserTokenType.Anonymous };
    this.session = await this.client.createSession(identity);
    return { connected: true };
  }

  async play(service, request, token) {
    let made;
    try {
      made = structure(opcua[`${service}Request`], JSON.parse(request));
      made.requestHeader.authenticationToken = token ? opcua.resolveNodeId(token) : this.session.authenticationToken;
      made.requestHeader.returnDiagnostics = 0;
      made.requestHeader.timeoutHint = TIMEOUT_MS;
    } catch (error) {
      return { unsendable: error.message };
    }
    return new Promise((answer) => {
      try {
        this.client.performMessageTransaction(made, (error, response) => answer(shown(error, response)));
      } catch (error) {
        answer({ unsendable: error.message });
      }
    });
  }

  async close() {
    const { client, session } = this;
    this.client = this.session = undefined;
    // A case may have ended the session.
    await session?.close().catch(() => {});
    await client?.disconnect().catch(() => {});
    return { closed: true };
  }
}

function shown(error, response) {
  const fault = error?.response ?? response;
  const result = fault?.responseHeader?.serviceResult;
  if (result && result.isNot(opcua.StatusCodes.Good)) return { fault: result.name };
  if (error) return { ended: error.message };
  return { response: plain(response) };
}

async function main() {
  const player = new Player();
  // Only the answers are for the caller.
  console.log = console.warn = console.error = console.info = () => {};
  for await (const line of readline.createInterface({ input: process.stdin })) {
    const [command, ...words] = line.split('\t');
    let answer;
    try {
      answer = await player[command](...words);
    } catch (error) {
      answer = { ended: error.message };
    }
    process.stdout.write(`${JSON.stringify(answer)}\n`);
  }
  process.exit(0);
}

main();

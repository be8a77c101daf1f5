// A machine on node-opcua: a counter, a temperature, a text and a custom structure.
//
// Options: --port N, --address A, --before N (namespaces that come first), --renumber N (node ids shifted by it),
// --pki DIR (where its certificates are made), --protected (Basic256Sha256 and a user),
// --small MS (limits of a small controller that publishes no faster, and 24 more variables).
// Prints "ready" when clients may come. Each line on standard input is a JSON object of new values:
// {"counter": 7}; {"counting": true} counts up every 100 ms. Above 90 and below 10 the temperature has an alarm. Ends with its
// standard input.
"use strict";
const path = require("node:path");
const readline = require("node:readline");
const {
  DataType, MessageSecurityMode, OPCUACertificateManager, OPCUAServer, SecurityPolicy, StatusCodes, Variant,
  ensureDatatypeExtracted,
} = require("node-opcua");

const NAMESPACE = "urn:verbund:test:node-opcua";
const MORE_VARIABLES = 24;
const OPERATIONS = 10;

// What the options of a server do not set: intervals and queues. Each value of the counter that goes out in a message is
// printed: "kept 7".
function limit(publishingMs) {
  const { MonitoredItem, Subscription } = require("node-opcua-server");
  Subscription.minimumPublishingInterval = publishingMs;
  MonitoredItem.minimumSamplingInterval = 250;
  const { preCreateMonitoredItem } = Subscription.prototype;
  Subscription.prototype.preCreateMonitoredItem = function (addressSpace, timestamps, request) {
    request.requestedParameters.queueSize = 1;
    return preCreateMonitoredItem.call(this, addressSpace, timestamps, request);
  };
  const { extractMonitoredItemNotifications } = MonitoredItem.prototype;
  MonitoredItem.prototype.extractMonitoredItemNotifications = function (...options) {
    const notifications = extractMonitoredItemNotifications.apply(this, options);
    if (this.node?.browseName.name === "Counter") {
      notifications.forEach(({ value }) => console.log(`kept ${value.value.value}`));
    }
    return notifications;
  };
}

// Small limits, as devices have them.
const DEVICE = { operationLimits: { maxMonitoredItemsPerCall: 3, maxNodesPerRead: 10, maxNodesPerBrowse: 20 } };
const SMALL = {
  maxSessions: 3,
  maxSubscriptionsPerSession: 2,
  maxMonitoredItemsPerSubscription: 20,
  maxMonitoredItemsQueueSize: 1,
  minSupportedSampleRate: 250,
  operationLimits: {
    maxMonitoredItemsPerCall: OPERATIONS,
    maxNodesPerRead: OPERATIONS,
    maxNodesPerWrite: OPERATIONS,
    maxNodesPerBrowse: OPERATIONS,
    maxNodesPerTranslateBrowsePathsToNodeIds: OPERATIONS,
  },
};

function option(name, standard) {
  const at = process.argv.indexOf(`--${name}`);
  return at < 0 ? standard : process.argv[at + 1];
}

async function main() {
  const isProtected = process.argv.includes("--protected");
  const pki = option("pki");
  const small = Number(option("small", 0));
  const more = small ? MORE_VARIABLES : 0;
  const address = option("address", "127.0.0.1");
  if (small) limit(small);
  const manager = (folder) =>
    new OPCUACertificateManager({ rootFolder: path.join(pki, folder), automaticallyAcceptUnknownCertificate: true });
  const server = new OPCUAServer({
    port: Number(option("port")),
    resourcePath: "/machine",
    hostname: address,
    alternateHostname: [address],
    host: address,
    buildInfo: { productName: "node-opcua machine" },
    serverCertificateManager: manager("server"),
    userCertificateManager: manager("users"),
    securityPolicies: [isProtected ? SecurityPolicy.Basic256Sha256 : SecurityPolicy.None],
    securityModes: [isProtected ? MessageSecurityMode.SignAndEncrypt : MessageSecurityMode.None],
    allowAnonymous: !isProtected,
    userManager: { isValidUser: (user, password) => user === "connector" && password === "machine" },
    serverCapabilities: small ? SMALL : DEVICE,
  });
  await server.initialize();
  const { addressSpace } = server.engine;
  for (let index = 0; index < Number(option("before", 0)); index++) {
    addressSpace.registerNamespace(`urn:verbund:test:other:${index}`);
  }
  const namespace = addressSpace.registerNamespace(NAMESPACE);
  const renumber = Number(option("renumber", 0));
  // All numbers stay in use: an old one names another variable after renumbering.
  const nodeId = (number) => `ns=${namespace.index};i=${2000 + ((number + renumber) % (5 + more))}`;

  const powerType = namespace.createDataType({
    browseName: "Power",
    isAbstract: false,
    subtypeOf: "Structure",
    partialDefinition: [
      { name: "Seconds", dataType: "i=7", valueRank: -1, description: "Seconds" },
      { name: "Watts", dataType: "i=11", valueRank: -1, description: "Watts" },
    ],
  });
  namespace.addObject({
    nodeId: `ns=${namespace.index};i=3001`,
    browseName: { namespaceIndex: 0, name: "Default Binary" },
    encodingOf: powerType.nodeId,
    typeDefinition: "DataTypeEncodingType",
  });
  await ensureDatatypeExtracted(addressSpace);
  addressSpace.installAlarmsAndConditionsService();
  const machine = namespace.addObject({
    nodeId: nodeId(0), browseName: "Machine", organizedBy: addressSpace.rootFolder.objects, eventNotifier: 1,
    eventSourceOf: addressSpace.rootFolder.objects.server,
  });
  const add = (number, browseName, dataType, value) =>
    namespace.addVariable({
      nodeId: nodeId(number), browseName, componentOf: machine, dataType, value: { dataType, value },
    });
  const nodes = {
    counter: [add(1, "Counter", DataType.Int32, 0), DataType.Int32],
    temperature: [add(2, "Temperature", DataType.Double, 20.5), DataType.Double],
    text: [add(3, "Text", DataType.String, "idle"), DataType.String],
  };
  namespace.instantiateNonExclusiveLimitAlarm("NonExclusiveLimitAlarmType", {
    nodeId: `ns=${namespace.index};s=HeatAlarm`, browseName: "HeatAlarm", componentOf: machine,
    conditionSource: machine, inputNode: nodes.temperature[0], highLimit: 90, lowLimit: 10,
  });
  const power = namespace.addVariable({
    nodeId: nodeId(4), browseName: "Power", componentOf: machine, dataType: powerType.nodeId,
  });
  const value = addressSpace.constructExtensionObject(powerType, { seconds: 10, watts: 812.5 });
  power.setValueFromSource({ dataType: DataType.ExtensionObject, value }, StatusCodes.Good);

  for (let number = 1; number <= more; number++) add(4 + number, `Value${number}`, DataType.Double, number);

  const set = (key, value) => {
    const [node, dataType] = nodes[key];
    node.setValueFromSource(new Variant({ dataType, value }), StatusCodes.Good);
  };
  let counting;
  await server.start();
  console.log("ready");
  for await (const line of readline.createInterface({ input: process.stdin })) {
    for (const [key, value] of Object.entries(JSON.parse(line))) {
      if (key !== "counting") set(key, value);
      else if (value) counting = setInterval(() => set("counter", nodes.counter[0].readValue().value.value + 1), 100);
      else clearInterval(counting);
    }
  }
  await server.shutdown();
  process.exit(0);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});

// A machine on node-opcua: a counter, a temperature, a text and a custom structure.
//
// Options: --port N, --before N (namespaces that come first), --renumber N (node ids shifted by it),
// --pki DIR (where its certificates are made), --protected (Basic256Sha256 and a user).
// Prints "ready" when clients may come. Each line on standard input is a JSON object of new values:
// {"counter": 7}. Above 90 and below 10 the temperature has an alarm. Ends with its standard input.
"use strict";
const path = require("node:path");
const readline = require("node:readline");
const {
  DataType, MessageSecurityMode, OPCUACertificateManager, OPCUAServer, SecurityPolicy, StatusCodes, Variant,
  ensureDatatypeExtracted,
} = require("node-opcua");

const NAMESPACE = "urn:verbund:test:node-opcua";

function option(name, standard) {
  const at = process.argv.indexOf(`--${name}`);
  return at < 0 ? standard : process.argv[at + 1];
}

async function main() {
  const isProtected = process.argv.includes("--protected");
  const pki = option("pki");
  const manager = (folder) =>
    new OPCUACertificateManager({ rootFolder: path.join(pki, folder), automaticallyAcceptUnknownCertificate: true });
  const server = new OPCUAServer({
    port: Number(option("port")),
    resourcePath: "/machine",
    hostname: "127.0.0.1",
    alternateHostname: ["127.0.0.1"],
    buildInfo: { productName: "node-opcua machine" },
    serverCertificateManager: manager("server"),
    userCertificateManager: manager("users"),
    securityPolicies: [isProtected ? SecurityPolicy.Basic256Sha256 : SecurityPolicy.None],
    securityModes: [isProtected ? MessageSecurityMode.SignAndEncrypt : MessageSecurityMode.None],
    allowAnonymous: !isProtected,
    userManager: { isValidUser: (user, password) => user === "connector" && password === "machine" },
    // Small limits, as devices have them.
    serverCapabilities: { operationLimits: { maxMonitoredItemsPerCall: 3, maxNodesPerRead: 10, maxNodesPerBrowse: 20 } },
  });
  await server.initialize();
  const { addressSpace } = server.engine;
  for (let index = 0; index < Number(option("before", 0)); index++) {
    addressSpace.registerNamespace(`urn:verbund:test:other:${index}`);
  }
  const namespace = addressSpace.registerNamespace(NAMESPACE);
  const renumber = Number(option("renumber", 0));
  // All numbers stay in use: an old one names another variable after renumbering.
  const nodeId = (number) => `ns=${namespace.index};i=${2000 + ((number + renumber) % 5)}`;

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

  await server.start();
  console.log("ready");
  for await (const line of readline.createInterface({ input: process.stdin })) {
    for (const [key, value] of Object.entries(JSON.parse(line))) {
      const [node, dataType] = nodes[key];
      node.setValueFromSource(new Variant({ dataType, value }), StatusCodes.Good);
    }
  }
  await server.shutdown();
  process.exit(0);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});

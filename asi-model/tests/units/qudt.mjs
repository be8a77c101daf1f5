// Writes qudt.tsv: units of ../../units/units.tsv as the ontology QUDT has them, against which the
// factors that are written there by hand are tested.
//
//     npm install --no-save @qudtlib/allunits@7.1.0
//     node qudt.mjs
//
// Source: QUDT (https://www.qudt.org), Creative Commons Attribution 4.0, in the npm package
// @qudtlib/allunits, whose maintainers take it from the ontology. Nothing of ours is in a line but
// the code: units are found by their names, or by the names in QUDT below.
//
// Columns, with tabs between them: code, name in QUDT, multiplier, offset, dimensions.
// A value in SI units is (value + offset) * multiplier.
import { readFileSync, writeFileSync } from "node:fs";
import { config } from "@qudtlib/allunits";

// Units that QUDT calls otherwise, or of whose names it has several.
const named = {
  "59": "PPM",
  "61": "PPB",
  A76: "GALILEO",
  BTU: "BTU_IT",
  D44: "V-A_Reactive",
  D46: "V-A",
  D61: "ARCMIN",
  D62: "ARCSEC",
  D70: "CAL_IT",
  E14: "KiloCAL_IT",
  GLL: "GAL_US",
  H87: "NUM",
  HJ: "HP_Metric",
  HM: "MI-PER-HR",
  HN: "MilliM_HG",
  INH: "IN",
  KVA: "KiloV-A",
  KVR: "KiloV-A_Reactive",
  LBR: "LB",
  LTN: "TON_UK",
  MAR: "MegaV-A_Reactive",
  MSK: "M-PER-SEC2",
  MVA: "MegaV-A",
  ONZ: "OZ",
  SMI: "MI",
  STN: "TON_US",
};

const key = (name) =>
  name
    .toLowerCase()
    .replace(/\[.*?\]|\(.*?\)/g, "")
    .replace(/metre/g, "meter")
    .replace(/litre/g, "liter")
    .replace(/[^a-z0-9]+/g, "");
const found = new Map();
for (const unit of config.units.values()) {
  for (const label of unit.labels) {
    const same = found.get(key(label.text)) ?? [];
    found.set(key(label.text), same.includes(unit) ? same : [...same, unit]);
  }
}

const lines = [];
const table = readFileSync(new URL("../../units/units.tsv", import.meta.url), "utf8");
for (const line of table.split("\n").filter(Boolean)) {
  const [code, , name, , quantity] = line.split("\t");
  if (["", "Other", "Packaging"].includes(quantity)) continue;
  const unit = code in named
    ? config.units.get(`http://qudt.org/vocab/unit/${named[code]}`)
    : (found.get(key(name)) ?? []).find((unit, _, all) => all.length === 1);
  const multiplier = unit?.conversionMultiplier;
  if (!multiplier || multiplier.isZero() || !unit.dimensionVectorIri) continue;
  const last = (iri) => iri.split("/").at(-1);
  const columns = [code, last(unit.iri), multiplier, unit.conversionOffset ?? 0];
  lines.push([...columns, last(unit.dimensionVectorIri)].join("\t") + "\n");
}
writeFileSync(new URL("qudt.tsv", import.meta.url), lines.join(""));

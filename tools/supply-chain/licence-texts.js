// Licence texts of packages: which of the offered licences is taken, and where its text is.
import { existsSync, readFileSync, readdirSync } from 'node:fs'
import { ROOT } from './programs.js'

/** Licences in the order in which one is taken where a package offers several. */
const PREFERRED = ['Apache-2.0', 'MIT', 'ISC', 'BSD-3-Clause', 'BSD-2-Clause', 'Zlib', 'BSL-1.0']

/**
 * Folders inside packages whose sources are not part of a program, each with the reason. The rest of
 * a package is searched for licences of what it contains.
 *
 * @type {Record<string, string>}
 */
const NOT_BUILT = {
  'libsqlite3-sys/sqlcipher': 'SQLite is built without encryption',
  'libmimalloc-sys/c_src/mimalloc/v2': 'version 3 is built',
  'rquickjs-sys/vendor/wasi-libc': 'for WebAssembly alone',
}

/**
 * Packages that ship no text of the licence that they name, each with the file of its text. Those of
 * one project have the text in another package of it; for the rest it is the standard one.
 *
 * @type {Record<string, string>}
 */
const ELSEWHERE = {
  'async-opcua': 'vendor/async-opcua/LICENSE',
  'async-opcua-client': 'vendor/async-opcua/LICENSE',
  'async-opcua-core': 'vendor/async-opcua/LICENSE',
  'async-opcua-core-namespace': 'vendor/async-opcua/LICENSE',
  'async-opcua-crypto': 'vendor/async-opcua/LICENSE',
  'async-opcua-nodes': 'vendor/async-opcua/LICENSE',
  'async-opcua-server': 'vendor/async-opcua/LICENSE',
  'async-opcua-types': 'vendor/async-opcua/LICENSE',
  'fe2o3-amqp-types': 'vendor/fe2o3-amqp/LICENSE',
  'precis-core': 'LICENSE-APACHE',
  'precis-profiles': 'LICENSE-APACHE',
  rumqttc: 'LICENSE-APACHE',
  'sqlx-core': 'LICENSE-APACHE',
  'sqlx-sqlite': 'LICENSE-APACHE',
  qrcodegen: 'MIT',
  'rquickjs-core': 'MIT',
  'rquickjs-sys': 'MIT',
}

/** Packages that ship the text of one of the licences that hold, each with the file of the other. */
const BESIDE = { 'metrics-exporter-prometheus': 'LICENSE-APACHE' }

/** Returns the alternatives of an expression, each a list of licences that all hold. */
export function alternatives(/** @type {string} */ expression) {
  const plain = expression.replace(/[()]/g, (bracket) =>
    expression.includes(' AND ') ? bracket : '',
  )
  const parts = plain
    .split(/ AND (?![^(]*\))/)
    .map((part) => part.replace(/^\(|\)$/g, '').split(' OR '))
  /** @type {string[][]} */
  let found = [[]]
  for (const part of parts)
    found = found.flatMap((taken) => part.map((licence) => [...taken, licence.trim()]))
  return found
}

/** What a file's text is, as far as licences that are chosen between go. */
function kindOf(/** @type {string} */ text, /** @type {string} */ file) {
  if (/apache license\s+version 2\.0/i.test(text)) return 'Apache-2.0'
  if (/permission is hereby granted, free of charge/i.test(text)) return 'MIT'
  if (/this is free and unencumbered software/i.test(text)) return 'Unlicense'
  if (/boost software license/i.test(text)) return 'BSL-1.0'
  if (/cc0|creative commons/i.test(text)) return 'CC0-1.0'
  return /apache/i.test(file) ? 'Apache-2.0' : 'other'
}

const isLicence = (/** @type {string} */ file) =>
  /(^|\/)((un)?(licen[sc]e|copying|notice)[^/]*|licenses\/[^/]+)$/i.test(file) &&
  !/\.(rs|js|ts|html)$/.test(file)

/** Returns the licence files of a package's folder, those of what it contains included. */
function filesOf(/** @type {string} */ name, /** @type {string} */ folder) {
  const skipped = Object.keys(NOT_BUILT)
    .filter((place) => place.startsWith(`${name}/`))
    .map((place) => place.slice(name.length + 1) + '/')
  return readdirSync(folder, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => `${entry.parentPath}/${entry.name}`.slice(folder.length + 1))
    .filter((file) => isLicence(file) && !/(^|\/)(node_modules|tests?|target)\//.test(file))
    .filter((file) => !skipped.some((place) => file.startsWith(place)))
    .sort()
}

/**
 * Returns the licence that a package is taken under and all texts that go with it: those of the licence
 * itself, further notices, and those of foreign sources inside.
 *
 * @param {{ name: string, licence: string, folder: string, authors: string[] }} about
 */
export function textsOf({ name, licence, folder, authors }) {
  const rank = (/** @type {string[]} */ taken) =>
    Math.max(
      ...taken.map(
        (one) => (PREFERRED.indexOf(one) + PREFERRED.length + 1) % (PREFERRED.length + 1),
      ),
    )
  const read = filesOf(name, folder).map((file) => {
    const text = readFileSync(`${folder}/${file}`, 'utf8').replaceAll('\r\n', '\n').trim()
    return {
      file,
      text,
      kind: kindOf(text, file),
      isInner: /\//.test(file.replace(/^licenses\//i, '')),
    }
  })
  // A few packages were published with the path of a text in place of it.
  const files = read.filter(
    ({ text }) => text.length > 0 && (text.includes('\n') || /copyright/i.test(text)),
  )
  const offered = alternatives(licence).sort((a, b) => rank(a) - rank(b))
  const own = files.filter(({ isInner }) => !isInner)
  const has = (/** @type {string[]} */ taken) =>
    taken.every((one) => own.some(({ kind }) => kind === one || kind === 'other'))
  const taken = offered.find(has) ?? offered[0] ?? []
  const rest = offered.flat().filter((one) => !taken.includes(one))
  const kept = files.filter(({ kind, isInner }) => isInner || !rest.includes(kind))
  const texts = kept.flatMap(({ text }) => shared(text))
  if (BESIDE[name]) texts.push(readFileSync(`${ROOT}/${BESIDE[name]}`, 'utf8').trim())
  if (!own.length) texts.unshift(elsewhere(name, authors))
  return { licence: taken.join(' AND '), texts }
}

const END_OF_APACHE = /END OF TERMS AND CONDITIONS/i
const letters = (/** @type {string} */ text) => text.toLowerCase().replace(/[^a-z0-9]/g, '')
const APACHE = readFileSync(`${ROOT}/LICENSE-APACHE`, 'utf8').trim()
const APACHE_TERMS = letters(APACHE.split(END_OF_APACHE)[0] ?? '')

/**
 * Parts of a text of which the first is the same for many packages: terms of the Apache licence, which
 * projects set in their own way, and the line on copyright that they add. The packages inside of a
 * build tool are not part of what it writes.
 */
function shared(/** @type {string} */ text) {
  const [terms = '', rest] = text.split(END_OF_APACHE)
  if (rest === undefined || letters(terms) !== APACHE_TERMS)
    return [text.split(/^# Licenses of bundled dependencies/m)[0]?.trim() ?? text]
  const lines = rest.match(/^\s*Copyright (?!\[yyyy\]|\{yyyy\}).*$/gm) ?? []
  return [APACHE, ...lines.map((line) => line.trim())]
}

function elsewhere(/** @type {string} */ name, /** @type {string[]} */ authors) {
  const place = ELSEWHERE[name]
  if (!place) throw new Error(`${name} ships no licence text: say in licence-texts.js where it is`)
  if (existsSync(`${ROOT}/${place}`)) return readFileSync(`${ROOT}/${place}`, 'utf8').trim()
  const owners = authors.length
    ? authors.map((one) => one.replace(/ <.*>/, '')).join(', ')
    : `the authors of ${name}`
  const standard = readFileSync(`${ROOT}/LICENSE-MIT`, 'utf8').trim()
  return standard.replace(/^Copyright.*$/m, `Copyright (c) ${owners}`)
}

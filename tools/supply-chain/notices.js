// Writes what others wrote of the delivered programs and pages, with their licences, to
// THIRD-PARTY-NOTICES.txt: `make notices`. Both daemons print it.
import { createHash } from 'node:crypto'
import { readFileSync, writeFileSync } from 'node:fs'
import { textsOf } from './licence-texts.js'
import { INSTALLED, packagesOf } from './pages.js'
import { PROGRAMS, ROOT, graphOf, sourceFolders } from './programs.js'

export const NOTICES = `${ROOT}/THIRD-PARTY-NOTICES.txt`

const HEAD = `Third-party notices

What others wrote of Verbund's programs and pages, and the licences under which it is used. Written by
\`make notices\`; do not edit.

Sources of what is under MPL-2.0, with our patches, are in the folder vendor/ of Verbund's sources and
in the package registry of Rust. Who wrote parts of Rust's standard library stands in the compiler's
own folder, share/doc/rust/COPYRIGHT-library.html.
`

const RULE = '-'.repeat(72)

/** @typedef {{ name: string, version: string, licence: string, texts: string[] }} Notice */

/** Returns what is linked into the programs: crates, and the standard library. */
function crates() {
  /** @type {Map<string, Notice>} */
  const notices = new Map()
  for (const program of PROGRAMS) {
    const { graph, linked } = graphOf(program)
    const folders = sourceFolders(program.manifest)
    for (const key of linked) {
      const found = graph.packages.get(key)
      const isOurs = found?.folder && !found.folder.startsWith('vendor/')
      if (!found || isOurs || notices.has(key)) continue
      const { name, version, licence } = found
      const { folder = '', authors = [] } = folders.get(key) ?? {}
      notices.set(key, { name, version, ...textsOf({ name, licence, folder, authors }) })
    }
  }
  return [standardLibrary(), ...notices.values()]
}

/** The standard library of Rust, whose version is that of the compiler. */
function standardLibrary() {
  const text = readFileSync(`${ROOT}/LICENSE-APACHE`, 'utf8').trim()
  return { name: 'std', version: 'of Rust', licence: 'Apache-2.0', texts: [text] }
}

/** Returns what the pages contain. */
function pagesNotices() {
  const found = new Map(
    ['engineer', 'partner'].flatMap(packagesOf).map((one) => [`${one.name}@${one.version}`, one]),
  )
  return [...found.values()].map(({ name, version, licence }) => {
    const about = { name, licence, folder: `${INSTALLED}/${name}`, authors: [] }
    return { name, version, ...textsOf(about) }
  })
}

const collapsed = (/** @type {string} */ text) => text.replace(/\s+/g, ' ').toLowerCase()

/**
 * Returns the file's text. Texts that differ in white space alone are one; its name follows
 * from what it says, so that a new package changes no other line. */
export function noticesText(/** @type {Notice[]} */ notices) {
  /** @type {Map<string, string>} */
  const texts = new Map()
  const nameOf = (/** @type {string} */ text) => {
    const name = createHash('sha256').update(collapsed(text)).digest('hex').slice(0, 8)
    if (!texts.has(name)) texts.set(name, text)
    return name
  }
  const sorted = notices.toSorted((a, b) =>
    `${a.name} ${a.version}` < `${b.name} ${b.version}` ? -1 : 1,
  )
  const lines = sorted.map(({ name, version, licence, texts: own }) => {
    const names = [...new Set(own.map(nameOf))]
    return `${name} ${version}: ${licence}; text ${names.join(', ')}`
  })
  const bodies = [...texts]
    .sort(([a], [b]) => (a < b ? -1 : 1))
    .map(([name, text]) => `${RULE}\nText ${name}\n\n${text.replace(/[ \t]+$/gm, '')}\n`)
  return [HEAD, lines.join('\n') + '\n', ...bodies].join('\n')
}

/** Returns what the committed file should be. */
export const notices = () => noticesText([...crates(), ...pagesNotices()])

if (process.argv[1] === new URL(import.meta.url).pathname) writeFileSync(NOTICES, notices())

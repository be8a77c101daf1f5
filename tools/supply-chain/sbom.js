// Writes a bill of materials (CycloneDX 1.6) of each delivered program to target/sbom: `make sbom`.
import { execFileSync } from 'node:child_process'
import { createHash } from 'node:crypto'
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs'
import { dirname } from 'node:path'
import { embeddedIn, isKnown } from './embedded.js'
import { packagesOf } from './pages.js'
import {
  OUTPUT,
  PROGRAMS,
  ROOT,
  checksums,
  folderHash,
  graphOf,
  sourceFolders,
} from './programs.js'

/** @typedef {Record<string, unknown>} Json */

const property = (/** @type {string} */ name, /** @type {string} */ value) => ({
  name: `verbund:${name}`,
  value,
})
const licences = (/** @type {string} */ expression) => [{ expression }]
const cargoUrl = (/** @type {string} */ name, /** @type {string} */ version) =>
  `pkg:cargo/${name}@${encodeURIComponent(version)}`

/**
 * Patches that the table of a README in vendor/ lists, each a row `| number | files | patch | why |`.
 *
 * @returns {Json[]}
 */
export function patchesOf(/** @type {string} */ readme, /** @type {string} */ folder) {
  const inner = readme.startsWith('# Patched parts of') ? `${folder.split('/').at(-1)}/` : ''
  const rows = readme.split('\n').filter((line) => /^\| \d+ \|/.test(line))
  return rows
    .map((row) => row.split(' | ').map((cell) => cell.replace(/^\| | \|$/g, '')))
    .filter(([, files = '']) => !inner || files.includes(`\`${inner}`))
    .map(([number, , patch, why]) => ({
      type: 'unofficial',
      resolves: [{ type: 'defect', id: `patch ${number}`, name: patch, description: why }],
    }))
}

/** Where a crate in vendor/ comes from, and what was changed. */
function pedigree(
  /** @type {string} */ folder,
  /** @type {string} */ name,
  /** @type {string} */ version,
) {
  const readme = `${folder.split('/').slice(0, 2).join('/')}/README.md`
  const patches = patchesOf(readFileSync(`${ROOT}/${readme}`, 'utf8'), folder)
  if (!patches.length) throw new Error(`${readme} lists no patch of ${folder}`)
  const ancestor = { type: 'library', name, version, purl: cargoUrl(name, version) }
  return { ancestors: [ancestor], patches, notes: `${readme} lists the patches.` }
}

/** The component of one crate. */
function crate(
  /** @type {import('./programs.js').Package} */ found,
  /** @type {{ isLinked: boolean, checksum: string | undefined, sources: string }} */ about,
) {
  const { name, version, folder, features, licence } = found
  const isOurs = folder && !folder.startsWith('vendor/')
  const content = about.checksum ?? (folder ? folderHash(folder) : undefined)
  if (!content) throw new Error(`${name} ${version} has no checksum`)
  const inside = about.isLinked ? embeddedIn(name, about.sources) : []
  if (about.isLinked && !folder && hasC(about.sources) && !isKnown(name))
    throw new Error(`${name} has C sources: say in embedded.js what they are`)
  return {
    type: 'library',
    'bom-ref': `${name}@${version}`,
    name,
    version,
    scope: about.isLinked ? 'required' : 'excluded',
    licenses: licences(licence),
    hashes: [{ alg: 'SHA-256', content }],
    ...(isOurs ? {} : { purl: cargoUrl(name, version) }),
    ...(folder && !isOurs ? { pedigree: pedigree(folder, name, version) } : {}),
    ...(inside.length
      ? {
          components: inside.map((one) => ({
            type: 'library',
            'bom-ref': `${name}@${version}/${one.name}`,
            name: one.name,
            version: one.version,
            licenses: licences(one.licence),
          })),
        }
      : {}),
    properties: [
      ...features.map((feature) => property('feature', feature)),
      ...(folder ? [property('folder', folder)] : []),
    ],
  }
}

/** True where a crate's sources have C files. */
function hasC(/** @type {string} */ folder) {
  const files = readdirSync(folder, { recursive: true, encoding: 'utf8' })
  return files.some((file) => /\.(c|cc|cpp)$/.test(file))
}

/** Pages of a program: one component with the packages that it is made of. */
function pages(/** @type {string} */ app) {
  const found = packagesOf(app)
  const ref = (/** @type {string} */ name) => `pages:${app}/${name}`
  const components = found.map(({ name, version, licence, sha512 }) => ({
    type: 'library',
    'bom-ref': ref(name),
    name,
    version,
    licenses: licences(licence),
    hashes: [{ alg: 'SHA-512', content: sha512 }],
    purl: `pkg:npm/${name.replace('@', '%40')}@${version}`,
  }))
  const own = {
    type: 'application',
    'bom-ref': `pages:${app}`,
    name: `verbund-web ${app}`,
    scope: 'required',
    licenses: licences('MIT OR Apache-2.0'),
    hashes: [{ alg: 'SHA-256', content: folderHash('web') }],
    components,
  }
  const needed = found.map(({ name, needs }) => ({ ref: ref(name), dependsOn: needs.map(ref) }))
  const all = { ref: own['bom-ref'], dependsOn: found.map(({ name }) => ref(name)) }
  return { component: own, dependencies: [all, ...needed] }
}

/** The standard library, which is a part of each executable. */
function standardLibrary() {
  const said = execFileSync('rustc', ['-vV'], { cwd: ROOT, encoding: 'utf8' })
  const line = (/** @type {string} */ name) =>
    new RegExp(`^${name}: (.+)$`, 'm').exec(said)?.[1] ?? ''
  return {
    type: 'library',
    'bom-ref': 'rust-std',
    name: 'std',
    version: line('release'),
    scope: 'required',
    licenses: licences('MIT OR Apache-2.0'),
    properties: [property('rustc-commit', line('commit-hash'))],
  }
}

/** Time and name of the commit that the sources are of. */
function commit() {
  const said = execFileSync('git', ['show', '-s', '--format=%H %ct'], {
    cwd: ROOT,
    encoding: 'utf8',
  })
  const [name = '', seconds = '0'] = said.trim().split(' ')
  return { name, time: new Date(Number(seconds) * 1000).toISOString() }
}

/** A number of the bill that follows from what it says. */
function serialNumber(/** @type {unknown} */ content) {
  const hex = createHash('sha256').update(JSON.stringify(content)).digest('hex')
  const variant = ((parseInt(hex.slice(16, 17), 16) & 3) | 8).toString(16)
  const groups = [hex.slice(0, 8), hex.slice(8, 12), `8${hex.slice(13, 16)}`]
  return `urn:uuid:${[...groups, variant + hex.slice(17, 20), hex.slice(20, 32)].join('-')}`
}

/** Returns the bill of materials of one program. */
export function billOf(/** @type {typeof PROGRAMS[number]} */ program) {
  const { root, graph, linked } = graphOf(program)
  const sums = checksums(program.manifest)
  const folders = sourceFolders(program.manifest)
  const components = [...graph.packages].map(([key, found]) =>
    crate(found, {
      isLinked: linked.has(key),
      checksum: sums.get(key),
      sources: folders.get(key)?.folder ?? '',
    }),
  )
  const about = components.find((component) => component['bom-ref'] === root)
  const own = program.pages ? pages(program.pages) : undefined
  const dependencies = [...graph.dependencies].map(([ref, needed]) => ({
    ref,
    dependsOn: [
      ...needed,
      ...(ref === root ? ['rust-std', ...(own ? [own.component['bom-ref']] : [])] : []),
    ],
  }))
  const made = commit()
  const content = {
    metadata: {
      timestamp: made.time,
      component: { ...about, type: 'application', name: program.name, scope: undefined },
      properties: [
        property('commit', made.name),
        property('lock', `${dirname(program.manifest)}/Cargo.lock`),
      ],
    },
    components: [
      ...components.filter((component) => component !== about),
      standardLibrary(),
      ...(own ? [own.component] : []),
    ],
    dependencies: [...dependencies, { ref: 'rust-std' }, ...(own?.dependencies ?? [])],
  }
  return {
    bomFormat: 'CycloneDX',
    specVersion: '1.6',
    serialNumber: serialNumber(content),
    version: 1,
    ...content,
  }
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  mkdirSync(OUTPUT, { recursive: true })
  for (const program of PROGRAMS)
    writeFileSync(
      `${OUTPUT}/${program.name}.cdx.json`,
      JSON.stringify(billOf(program), null, 2) + '\n',
    )
}

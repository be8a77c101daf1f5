// What each delivered program is built from, as Cargo resolves it.
import { execFileSync } from 'node:child_process'
import { createHash } from 'node:crypto'
import { existsSync, readFileSync } from 'node:fs'
import { dirname, relative } from 'node:path'
import { fileURLToPath } from 'node:url'

export const ROOT = fileURLToPath(new URL('../../', import.meta.url)).replace(/\/$/, '')
/** Folder of everything that is written here. */
export const OUTPUT = `${ROOT}/target/sbom`

/** The manifests whose packages are built together, `make programs`. */
const WORKSPACE = 'Cargo.toml'
const TARGET = 'x86_64-unknown-linux-gnu'

/**
 * The delivered programs, each with its package, the manifest that it is built with, and the pages
 * that it has inside. The platform's program runs its broker's process, too.
 */
export const PROGRAMS = [
  { name: 'platform', package: 'platform', manifest: WORKSPACE, pages: 'partner' },
  {
    name: 'factory-connector',
    package: 'factory-connector',
    manifest: WORKSPACE,
    pages: 'engineer',
  },
  { name: 'script-quickjs', package: 'script-quickjs', manifest: WORKSPACE },
  { name: 'script-deno', package: 'script-deno', manifest: WORKSPACE },
  { name: 'asi', package: 'asi-cli', manifest: WORKSPACE },
  { name: 'simulator', package: 'simulator', manifest: WORKSPACE },
]

/** @typedef {{ name: string, version: string, folder?: string, features: string[], licence: string }} Package */
/** @typedef {{ packages: Map<string, Package>, dependencies: Map<string, Set<string>> }} Graph */

function cargo(/** @type {string[]} */ ...parameters) {
  const options = /** @type {const} */ ({ cwd: ROOT, encoding: 'utf8', maxBuffer: 1 << 28 })
  return execFileSync(process.env['CARGO'] ?? 'cargo', parameters, options)
}

/**
 * Reads `cargo tree` with the depth before each line. A package that stands there again has its
 * dependencies at the first place alone.
 *
 * @param {string} text
 * @returns {Graph}
 */
export function parseTree(text) {
  /** @type {Graph} */
  const graph = { packages: new Map(), dependencies: new Map() }
  /** @type {string[]} */
  const path = []
  for (const line of text.split('\n')) {
    const found = /^(\d+) (\S+) v(\S+)([^|]*)\|([^|]*)\|([^|]*)$/.exec(line.replace(/ \(\*\)$/, ''))
    if (!found) continue
    const [, depth = '0', name = '', version = '', places = '', features = '', licence = ''] = found
    const key = `${name}@${version}`
    const folder = /\((\/[^)]*)\)/.exec(places)?.[1]
    const known = graph.packages.get(key)
    const all = new Set([...(known?.features ?? []), ...features.split(',').filter(Boolean)])
    graph.packages.set(key, {
      name,
      version,
      ...(folder ? { folder: relative(ROOT, folder) } : {}),
      features: [...all].sort(),
      licence: licence.replaceAll('/', ' OR '),
    })
    const needed = graph.dependencies.get(key) ?? new Set()
    graph.dependencies.set(key, needed)
    path.length = Number(depth)
    path.push(key)
    const above = path[Number(depth) - 1]
    if (above && above !== key) graph.dependencies.get(above)?.add(key)
  }
  return graph
}

/** @returns {Graph} */
function tree(/** @type {string} */ manifest, /** @type {string} */ edges) {
  const packages = PROGRAMS.filter((program) => program.manifest === manifest)
  return parseTree(
    cargo(
      'tree',
      '--locked',
      ...['--manifest-path', manifest, '--target', TARGET, '--edges', edges],
      ...['--prefix', 'depth', '--format', ' {p}|{f}|{l}'],
      ...packages.flatMap((program) => ['--package', program.package]),
    ),
  )
}

/** Returns the keys of a package and of all that it depends on. */
function reachable(/** @type {Graph} */ graph, /** @type {string} */ from) {
  const found = new Set([from])
  // A set that grows while it is walked yields what was added.
  for (const key of found) for (const next of graph.dependencies.get(key) ?? []) found.add(next)
  return found
}

/**
 * Returns the graph of one program with `linked`, the keys of what its executable contains; the rest
 * runs when it is built. Features are those of the build of all programs together.
 */
export function graphOf(/** @type {typeof PROGRAMS[number]} */ program) {
  const all = tree(program.manifest, 'normal,build')
  const shipped = tree(program.manifest, 'normal,no-proc-macro')
  const key = [...all.packages.values()].find((found) => found.name === program.package)
  if (!key) throw new Error(`${program.package} is not in its own tree`)
  const root = `${key.name}@${key.version}`
  const linked = reachable(shipped, root)
  /** @type {Graph} */
  const graph = { packages: new Map(), dependencies: new Map() }
  for (const one of reachable(all, root)) {
    const found = (linked.has(one) ? shipped : all).packages.get(one)
    if (found) graph.packages.set(one, found)
    graph.dependencies.set(one, all.dependencies.get(one) ?? new Set())
  }
  return { root, graph, linked }
}

/** Returns the checksums of a lock file by `name@version`. */
export function checksums(/** @type {string} */ manifest) {
  const lock = readFileSync(`${ROOT}/${dirname(manifest)}/Cargo.lock`, 'utf8')
  const found = lock.matchAll(
    /name = "(.+)"\nversion = "(.+)"\nsource = ".+"\nchecksum = "([0-9a-f]{64})"/g,
  )
  return new Map([...found].map(([, name, version, sum = '']) => [`${name}@${version}`, sum]))
}

/**
 * SHA-256 over the lines `<SHA-256 of a file>  <path in the folder>` of all committed files of a
 * folder, ordered by path, as `sha256sum` prints them.
 */
export function folderHash(/** @type {string} */ folder) {
  const listed = execFileSync('git', ['ls-files', '-z', '.'], {
    cwd: `${ROOT}/${folder}`,
    encoding: 'utf8',
  })
  const sha256 = (/** @type {string | Buffer} */ bytes) =>
    createHash('sha256').update(bytes).digest('hex')
  const lines = listed
    .split('\0')
    .filter((file) => file && existsSync(`${ROOT}/${folder}/${file}`))
    .sort()
    .map((file) => `${sha256(readFileSync(`${ROOT}/${folder}/${file}`))}  ${file}\n`)
  return sha256(lines.join(''))
}

/** Returns name, manifest and folder of the sources of each package, by `name@version`. */
export function sourceFolders(/** @type {string} */ manifest) {
  const metadata = JSON.parse(
    cargo(
      'metadata',
      '--format-version',
      '1',
      '--locked',
      '--manifest-path',
      manifest,
      '--filter-platform',
      TARGET,
    ),
  )
  return new Map(
    metadata.packages.map(
      (
        /** @type {{ name: string, version: string, manifest_path: string, authors: string[] }} */ one,
      ) => [
        `${one.name}@${one.version}`,
        { folder: dirname(one.manifest_path), authors: one.authors },
      ],
    ),
  )
}

// Asks whether what Verbund is built from has known weaknesses: `make advisories`.
//
//   node advisories.js            ends with 3 where a list of advisories cannot be had
//   node advisories.js --report   says so and ends with 0: for machines that are known to be cut off
//   node advisories.js --manifests   prints the manifests that are asked about, and asks nothing
//
// Where all lists were had, the first writes what they said into asked.json, which is to be committed. Where one cannot be
// had, asked.json stands for it: for some weeks, and for the packages that it names.
//
// 1 means a finding, an exception that has ended or that nothing needs any more, or an asked.json that does not stand
// for the lists any more. RustSec's
// database comes from its repository, or from a clone of it that ADVISORY_DB names; npm's advisories
// from the registry that npm is set up for.
import { execFileSync, spawnSync } from 'node:child_process'
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs'
import { compare, faultsOf } from './exceptions.js'
import { ROOT } from './programs.js'
import { completed, faultsOfSnapshot, packagesOf, readSnapshot, writeSnapshot } from './snapshot.js'

const PLACE = `${ROOT}/target/supply-chain`
/** The program that `make supply-chain` installs. */
const CARGO_DENY = `${ROOT}/target/tools/bin/cargo-deny`
const DATABASE = 'https://github.com/RustSec/advisory-db'
/** Folders with packages of npm. */
export const NPM_FOLDERS = [
  'mapping-engine/script-deno',
  'web',
  'tests/browser',
  'tests/foreign',
  'tools/supply-chain',
]
/** Advisory of no package, in a database that is there for the check of withdrawn versions alone. */
const NO_ADVISORY = `\`\`\`toml
[advisory]
id = "RUSTSEC-1970-0001"
package = "verbund-names-no-package-like-this"
date = "1970-01-01"

[versions]
patched = []
\`\`\`

# Stands for a database that cannot be had
`

/** @typedef {import('./exceptions.js').Finding} Finding */
/** @typedef {{ findings: Finding[], unchecked: string[] }} Answer */
/** @typedef {import('./snapshot.js').Snapshot} Snapshot */

/** What the lists said when they were asked last. */
const SNAPSHOT = new URL('asked.json', import.meta.url)

/**
 * Returns the manifests with a lock file of their own: of what is delivered, and of what runs in tests alone, as fuzz
 * targets, foreign peers and the patched crates' own tests.
 *
 * @returns {string[]}
 */
export function manifests() {
  const locks = execFileSync('git', ['ls-files', '*Cargo.lock'], { cwd: ROOT, encoding: 'utf8' })
  const files = locks.split('\n').filter((file) => file)
  return files.map((file) => file.replace(/\.lock$/, '.toml'))
}

/**
 * Reads what cargo-deny reports: a line of JSON each.
 *
 * @param {string} lines
 * @param {string} where
 * @returns {Finding[]}
 */
export function findingsOfDeny(lines, where) {
  return lines.split('\n').flatMap((line) => {
    if (!line.startsWith('{')) return []
    const { type, fields } = JSON.parse(line)
    if (type !== 'diagnostic' || !['error', 'warning'].includes(fields.severity)) return []
    const span = fields.labels?.[0]?.span?.split(' ') ?? []
    const withdrawn = `YANKED-${span[0]}-${span[1]}`
    const id = fields.advisory?.id ?? (fields.code === 'yanked' ? withdrawn : fields.code)
    const place = span[0] ?? where
    return [
      {
        registry: 'cargo',
        id,
        where: place === where ? where : `${where}, ${place}`,
        text: fields.message,
      },
    ]
  })
}

/**
 * Reads what `npm audit --json` reports.
 *
 * @param {string} text
 * @param {string} where
 * @returns {Finding[] | undefined} undefined where the registry has no advisories
 */
export function findingsOfNpm(text, where) {
  const said = text.trim() ? JSON.parse(text) : {}
  if (!said.vulnerabilities) return undefined
  const all = Object.values(said.vulnerabilities).flatMap(({ via }) =>
    via.flatMap((/** @type {any} */ one) => {
      if (typeof one === 'string') return []
      const id = /GHSA-[\w-]+/.exec(one.url)?.[0] ?? String(one.source)
      return [{ registry: 'npm', id, where, text: `${one.name} ${one.range}: ${one.title}` }]
    }),
  )
  return [...new Map(all.map((finding) => [`${finding.id} ${finding.text}`, finding])).values()]
}

/**
 * Returns the published crates of which the repository has patched copies. cargo-deny passes them over: they come
 * from no registry.
 *
 * @returns {{ name: string, version: string, where: string }[]}
 */
export function vendoredCrates() {
  const files = execFileSync('git', ['ls-files', 'vendor'], { cwd: ROOT, encoding: 'utf8' })
  // But that of all of them together.
  const manifests = files
    .split('\n')
    .filter((file) => file.endsWith('/Cargo.toml') && file !== 'vendor/Cargo.toml')
  return manifests.map((file) => {
    const text = readFileSync(`${ROOT}/${file}`, 'utf8')
    const own = text.slice(text.indexOf('[package]'))
    const of = (/** @type {string} */ key) => new RegExp(`^${key} = "(.*)"`, 'm').exec(own)?.[1]
    return {
      name: of('name') ?? '',
      version: of('version') ?? '',
      where: file.replace('/Cargo.toml', ''),
    }
  })
}

/**
 * Looks for advisories of patched copies. Each one counts, whatever versions it names: whether a patch stands
 * against it has to be looked at, and is the reason of an exception.
 *
 * @param {string} database folder with `crates/NAME/RUSTSEC-*.md`
 * @param {{ name: string, version: string, where: string }[]} crates
 * @returns {Finding[]}
 */
export function findingsOfVendored(database, crates) {
  return crates.flatMap(({ name, version, where }) => {
    const folder = `${database}/crates/${name}`
    const files = existsSync(folder) ? readdirSync(folder) : []
    const ids = files.map((file) => /^(RUSTSEC-\d+-\d+)\.md$/.exec(file)?.[1])
    return ids.flatMap((id) =>
      id
        ? [{ registry: 'cargo', id, where, text: `an advisory of ${name}, copied at ${version}` }]
        : [],
    )
  })
}

/** Returns the published packages of all lock files, and those that were copied to be patched. */
export function lockedPackages() {
  const locks = [
    ...manifests().map((file) => file.replace(/\.toml$/, '.lock')),
    ...NPM_FOLDERS.map((folder) => `${folder}/package-lock.json`),
  ]
  const locked = locks.flatMap((file) => packagesOf(file, readFileSync(`${ROOT}/${file}`, 'utf8')))
  return [...locked, ...vendoredCrates().map(({ name, version }) => `cargo ${name}@${version}`)]
}

/**
 * Judges what the lists said. Where one could not be had, the snapshot stands for it; where there is none, nothing does.
 *
 * @param {{ cargo: Answer, npm: Answer }} answers
 * @param {import('./exceptions.js').Exception[]} exceptions
 * @param {Snapshot | undefined} snapshot
 * @param {string[]} packages of the lock files
 * @param {string} today
 */
export function judge(answers, exceptions, snapshot, packages, today) {
  const unchecked = [...answers.cargo.unchecked, ...answers.npm.unchecked]
  const findings = [...answers.cargo.findings, ...answers.npm.findings]
  const asked = new Set(
    /** @type {const} */ (['cargo', 'npm']).filter((one) => !answers[one].unchecked.length),
  )
  const instead = unchecked.length ? snapshot : undefined
  const known = instead ? new Set(['cargo', 'npm']) : asked
  const faults = [
    ...faultsOf(exceptions, today),
    ...compare(completed(findings, asked, instead), exceptions, known),
    ...(instead ? faultsOfSnapshot(instead, packages, today) : []),
  ]
  if (instead) unchecked.push(`what they said on ${instead.asked} counts instead`)
  else if (unchecked.length)
    unchecked.push(
      'NOTHING stands for these lists, since nobody has asked yet: run `make advisories` on a machine that reaches them, and commit tools/supply-chain/asked.json',
    )
  return { faults, unchecked, findings }
}

/** Makes git fetch the database from another place. */
const fetchedFrom = (/** @type {string} */ place) => ({
  ...process.env,
  GIT_CONFIG_COUNT: '1',
  GIT_CONFIG_KEY_0: `url.${place}.insteadOf`,
  GIT_CONFIG_VALUE_0: DATABASE,
})

function deny(
  /** @type {string} */ manifest,
  /** @type {string} */ folder,
  /** @type {NodeJS.ProcessEnv} */ env,
) {
  const rules = readFileSync(`${ROOT}/deny.toml`, 'utf8')
  const config = `${PLACE}/${folder}.toml`
  writeFileSync(
    config,
    rules.replace('[advisories]', `[advisories]\ndb-path = "${PLACE}/${folder}"`),
  )
  const said = spawnSync(
    CARGO_DENY,
    [
      '--locked',
      '--format',
      'json',
      '--manifest-path',
      manifest,
      '--config',
      config,
      'check',
      'advisories',
    ],
    { cwd: ROOT, encoding: 'utf8', env, maxBuffer: 1 << 28 },
  )
  if (said.error) throw new Error(`cargo-deny does not run: ${said.error.message}`)
  const findings = findingsOfDeny(said.stderr, manifest)
  const isLoaded = !/advisory database/.test(said.stderr)
  if (isLoaded && said.status !== 0 && !findings.length) throw new Error(said.stderr)
  return { isLoaded, findings, said: said.stderr }
}

/** A database without an advisory, for versions that were withdrawn from the registry. */
function emptyDatabase() {
  const place = `${PLACE}/no-advisories`
  rmSync(place, { recursive: true, force: true })
  mkdirSync(`${place}/crates/none`, { recursive: true })
  writeFileSync(`${place}/crates/none/RUSTSEC-1970-0001.md`, NO_ADVISORY)
  const git = (/** @type {string[]} */ ...parameters) =>
    execFileSync('git', parameters, { cwd: place })
  git('init', '--quiet', '--initial-branch', 'main')
  git('add', '.')
  git('-c', 'user.name=make', '-c', 'user.email=make@localhost', 'commit', '--quiet', '-m', 'none')
  return place
}

/** Returns the clone that cargo-deny made below a folder; the folder itself where there is none. */
function databaseIn(/** @type {string} */ folder) {
  const found = existsSync(folder) ? readdirSync(folder) : []
  const clone = found.find((name) => existsSync(`${folder}/${name}/crates`))
  return clone ? `${folder}/${clone}` : folder
}

/** Returns the day of the database's last change: a clone that was brought along may be old. */
function dayOfDatabase() {
  const database = databaseIn(databaseFolder())
  const parameters = ['-C', database, 'log', '-1', '--format=%cs']
  return execFileSync('git', parameters, { encoding: 'utf8' }).trim()
}

/** Returns the folder of the database. What was fetched from one place is no beginning for what another has. */
const databaseFolder = () => `${PLACE}/${process.env['ADVISORY_DB'] ? 'clone' : 'rustsec'}`

/** @returns {Answer} */
function askRustSec() {
  const clone = process.env['ADVISORY_DB']
  const env = clone ? fetchedFrom(clone) : process.env
  /** @type {Answer} */
  const answer = { findings: [], unchecked: [] }
  const folder = clone ? 'clone' : 'rustsec'
  if (clone) rmSync(`${PLACE}/${folder}`, { recursive: true, force: true })
  for (const manifest of manifests()) {
    const first = deny(manifest, folder, env)
    const { isLoaded, findings } = first.isLoaded
      ? first
      : deny(manifest, 'withdrawn', fetchedFrom(emptyDatabase()))
    if (!isLoaded) throw new Error(`withdrawn versions cannot be looked for in ${manifest}`)
    answer.findings.push(...findings)
    if (!first.isLoaded)
      answer.unchecked.push(
        `${manifest}: RustSec's database cannot be fetched; withdrawn versions were looked for`,
      )
  }
  answer.findings.push(...findingsOfVendored(databaseIn(databaseFolder()), vendoredCrates()))
  if (answer.unchecked.length)
    answer.unchecked.push('vendor: advisories of patched copies, for want of the same database')
  return answer
}

/** @returns {Answer} */
function askNpm() {
  /** @type {Answer} */
  const answer = { findings: [], unchecked: [] }
  for (const folder of NPM_FOLDERS) {
    const parameters = ['audit', '--json', '--package-lock-only', '--audit=true']
    const said = spawnSync('npm', parameters, { cwd: `${ROOT}/${folder}`, encoding: 'utf8' })
    const findings = findingsOfNpm(said.stdout, folder)
    if (findings) answer.findings.push(...findings)
    else answer.unchecked.push(`${folder}: the registry that npm is set up for has no advisories`)
  }
  return answer
}

const isProgram = process.argv[1] === new URL(import.meta.url).pathname
if (isProgram && process.argv.includes('--manifests')) {
  console.log(manifests().join('\n'))
} else if (isProgram) {
  mkdirSync(PLACE, { recursive: true })
  const { exceptions } = JSON.parse(
    readFileSync(new URL('advisories.json', import.meta.url), 'utf8'),
  )
  const answers = { cargo: askRustSec(), npm: askNpm() }
  const today = new Date().toISOString().slice(0, 10)
  const isReport = process.argv.includes('--report')
  const packages = lockedPackages()
  const snapshot = readSnapshot(SNAPSHOT)
  const { faults, unchecked, findings } = judge(answers, exceptions, snapshot, packages, today)
  if (!unchecked.length && !isReport) {
    const day = [today, dayOfDatabase()].sort()[0] ?? today
    writeSnapshot(SNAPSHOT, { asked: day, packages, findings })
    console.log('What the lists said is in tools/supply-chain/asked.json: commit it.')
  }
  for (const fault of faults) console.error(`ADVISORY: ${fault}`)
  for (const one of unchecked) console.error(`NOT CHECKED for advisories: ${one}.`)
  if (!faults.length && !unchecked.length) console.log('No advisory is open.')
  process.exitCode = faults.length ? 1 : unchecked.length && !isReport ? 3 : 0
}

// Findings, exceptions and lists that cannot be had are never passed over in silence.
import assert from 'node:assert/strict'
import { execFileSync, spawnSync } from 'node:child_process'
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { test } from 'node:test'
import {
  NPM_FOLDERS,
  findingsOfDeny,
  findingsOfNpm,
  findingsOfVendored,
  manifests,
  vendoredCrates,
} from './advisories.js'
import { compare, faultsOf } from './exceptions.js'
import { ROOT } from './programs.js'

const TODAY = '2026-11-25'
/** @type {import('./exceptions.js').Exception} */
const EXCEPTION = {
  registry: 'npm',
  id: 'GHSA-aaaa-bbbb-cccc',
  reason: 'a tool of the build alone, which reads our own files',
  until: '2027-01-31',
}
const FINDING = {
  registry: /** @type {const} */ ('npm'),
  id: EXCEPTION.id,
  where: 'web',
  text: 'x',
}

test('the committed exceptions hold today', () => {
  const file = JSON.parse(readFileSync(new URL('advisories.json', import.meta.url), 'utf8'))
  assert.deepEqual(faultsOf(file.exceptions, new Date().toISOString().slice(0, 10)), [])
})

test('an exception has an advisory, a reason and an end', () => {
  const check = (/** @type {object} */ change, /** @type {RegExp | undefined} */ expected) => {
    const [fault] = faultsOf([{ ...EXCEPTION, ...change }], TODAY)
    if (expected) assert.match(fault ?? '', expected)
    else assert.equal(fault, undefined)
  }
  check({}, undefined)
  check({ registry: 'pip' }, /registry/)
  check({ id: 'all' }, /names no advisory/)
  check({ reason: 'later' }, /no reason/)
  check({ until: undefined }, /no day/)
  check({ until: '2026-11-24' }, /held until/)
  check({ until: '2028-01-01' }, /more than 180 days/)
})

test('what no exception covers and what no finding needs is reported', () => {
  const npm = new Set(['npm'])
  assert.deepEqual(compare([FINDING], [EXCEPTION], npm), [])
  assert.match(compare([FINDING], [], npm)[0] ?? '', /GHSA-aaaa-bbbb-cccc in web/)
  assert.match(compare([], [EXCEPTION], npm)[0] ?? '', /nothing needs it/)
  assert.deepEqual(compare([], [EXCEPTION], new Set()), [], 'a registry that was not asked')
  assert.equal(compare([{ ...FINDING, registry: 'cargo' }], [EXCEPTION], new Set()).length, 1)
})

test('reports of npm are read, and none is no report', () => {
  const via = { source: 7, name: 'x', range: '<2', title: 'bad', url: 'a/GHSA-aaaa-bbbb-cccc' }
  const report = { vulnerabilities: { x: { via: [via] }, y: { via: ['x'] } } }
  assert.deepEqual(findingsOfNpm(JSON.stringify(report), 'web'), [
    { registry: 'npm', id: 'GHSA-aaaa-bbbb-cccc', where: 'web', text: 'x <2: bad' },
  ])
  assert.deepEqual(findingsOfNpm('{"vulnerabilities":{}}', 'web'), [])
  for (const refused of ['', '{"error":{"code":"E405"}}', '{"message":"405"}'])
    assert.equal(findingsOfNpm(refused, 'web'), undefined, refused)
})

test('reports of cargo-deny are read', () => {
  const line = (/** @type {object} */ fields) => JSON.stringify({ type: 'diagnostic', fields })
  const labels = [{ span: 'a 1.0.0 registry' }]
  const advisory = { id: 'RUSTSEC-2026-0001' }
  const lines = [
    line({ severity: 'error', code: 'vulnerability', message: 'bad', labels, advisory }),
    line({ severity: 'error', code: 'yanked', message: 'gone', labels }),
    line({ severity: 'note', code: 'other', message: 'fine', labels }),
    'no json',
  ]
  const ids = findingsOfDeny(lines.join('\n'), 'Cargo.toml').map(({ id, where }) => [id, where])
  assert.deepEqual(ids, [
    ['RUSTSEC-2026-0001', 'Cargo.toml, a'],
    ['YANKED-a-1.0.0', 'Cargo.toml, a'],
  ])
})

/** Runs the program with a database that was made up. */
function run(/** @type {string} */ database, /** @type {string[]} */ ...parameters) {
  const program = new URL('advisories.js', import.meta.url).pathname
  const env = { ...process.env, ADVISORY_DB: database }
  return spawnSync(process.execPath, [program, ...parameters], { encoding: 'utf8', env })
}

/** Returns the committed files of a name. */
function committed(/** @type {string} */ name) {
  const files = execFileSync('git', ['ls-files', `*${name}`], { cwd: ROOT, encoding: 'utf8' })
  return files.split('\n').filter((file) => file)
}

test('each workspace has a lock file, and is asked about', () => {
  const isRoot = (/** @type {string} */ file) =>
    /^\[workspace\]/m.test(readFileSync(`${ROOT}/${file}`, 'utf8'))
  const roots = committed('Cargo.toml').filter(isRoot)
  assert.deepEqual(manifests().sort(), roots.sort())
  for (const one of ['Cargo.toml', 'vendor/Cargo.toml', 'platform/fuzz/Cargo.toml'])
    assert.ok(roots.includes(one), one)
  const folders = committed('package-lock.json').map((file) => file.replace('/package-lock.json', ''))
  assert.deepEqual([...NPM_FOLDERS].sort(), folders.sort())
})

test('licences, sources and bans are checked for the same manifests', () => {
  const said = run('/nowhere/at/all', '--manifests')
  assert.deepEqual(said.stdout.trim().split('\n'), manifests())
  const [, after = ''] = readFileSync(`${ROOT}/Makefile`, 'utf8').split('\nsupply-chain:')
  const [recipe = ''] = after.split('\n\n')
  const loop = 'manifests=$$(node tools/supply-chain/advisories.js --manifests); for manifest in $$manifests;'
  assert.ok(recipe.includes(loop), recipe)
  assert.match(recipe, /--manifest-path \$\$manifest .* check bans licenses sources/)
})

test('an advisory about a crate of ours ends with an error', () => {
  const place = mkdtempSync(`${tmpdir()}/advisories-`)
  try {
    mkdirSync(`${place}/crates/serde`, { recursive: true })
    const head = '[advisory]\nid = "RUSTSEC-2026-9999"\npackage = "serde"\ndate = "2026-01-01"\n'
    const text = `\`\`\`toml\n${head}\n[versions]\npatched = []\n\`\`\`\n\n# Made up\n`
    writeFileSync(`${place}/crates/serde/RUSTSEC-2026-9999.md`, text)
    const git = (/** @type {string[]} */ ...words) => execFileSync('git', words, { cwd: place })
    git('init', '--quiet', '--initial-branch', 'main')
    git('add', '.')
    git('-c', 'user.name=a', '-c', 'user.email=a@localhost', 'commit', '--quiet', '-m', 'one')
    const said = run(place, '--report')
    assert.match(said.stderr, /ADVISORY: RUSTSEC-2026-9999 in Cargo.toml, serde/)
    assert.equal(said.status, 1)
  } finally {
    rmSync(place, { recursive: true })
  }
})

test('a database that cannot be had is said, and no success', () => {
  const said = run('/nowhere/at/all')
  assert.match(said.stderr, /NOT CHECKED for advisories: Cargo.toml/)
  assert.ok(said.status === 3 || /^ADVISORY/m.test(said.stderr), said.stderr)
  assert.notEqual(said.status, 0)
})

test('patched copies of published crates are looked up, too', () => {
  const crates = vendoredCrates()
  const names = crates.map(({ name }) => name).sort()
  assert.deepEqual(names, [
    'async-opcua-client',
    'async-opcua-core',
    'async-opcua-crypto',
    'async-opcua-nodes',
    'async-opcua-server',
    'async-opcua-types',
    'fe2o3-amqp',
    'serde_amqp',
  ])
  assert.ok(crates.every(({ version }) => /^\d+\.\d+\.\d+$/.test(version)))
  const database = mkdtempSync(`${tmpdir()}/advisories-`)
  try {
    assert.deepEqual(findingsOfVendored(database, crates), [])
    mkdirSync(`${database}/crates/serde_amqp`, { recursive: true })
    writeFileSync(`${database}/crates/serde_amqp/RUSTSEC-2026-0001.md`, 'x')
    const [finding, ...more] = findingsOfVendored(database, crates)
    assert.deepEqual(more, [])
    assert.equal(finding?.id, 'RUSTSEC-2026-0001')
    assert.equal(finding?.where, 'vendor/serde_amqp')
  } finally {
    rmSync(database, { recursive: true })
  }
})

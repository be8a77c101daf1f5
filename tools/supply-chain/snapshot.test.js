// What was asked elsewhere stands for lists that cannot be had, for a while and for the same packages alone.
import assert from 'node:assert/strict'
import { mkdtempSync, rmSync } from 'node:fs'
import { tmpdir } from 'node:os'
import { test } from 'node:test'
import { judge, lockedPackages } from './advisories.js'
import {
  DAYS_MAX,
  completed,
  faultsOfSnapshot,
  packagesOf,
  readSnapshot,
  writeSnapshot,
} from './snapshot.js'

const TODAY = '2026-11-25'
/** @type {import('./exceptions.js').Finding} */
const FINDING = { registry: 'cargo', id: 'RUSTSEC-2026-0001', where: 'Cargo.toml', text: 'bad' }
/** @type {import('./snapshot.js').Snapshot} */
const SNAPSHOT = {
  asked: '2026-11-01',
  packages: ['cargo serde@1.0.0', 'npm vite@7.0.0'],
  findings: [FINDING],
}

test('published packages of both kinds of lock file are read', () => {
  const cargo = `version = 4

[[package]]
name = "own"
version = "0.1.0"

[[package]]
name = "serde"
version = "1.0.0"
source = "registry+https://registry.example/index"
`
  assert.deepEqual(packagesOf('Cargo.lock', cargo), ['cargo serde@1.0.0'])
  const npm = {
    packages: {
      '': { version: '0.1.0' },
      'node_modules/@a/b': { version: '2.0.0' },
      'node_modules/x/node_modules/y': { version: '3.0.0' },
      'node_modules/near': { link: true },
    },
  }
  const found = packagesOf('web/package-lock.json', JSON.stringify(npm))
  assert.deepEqual(found, ['npm @a/b@2.0.0', 'npm y@3.0.0'])
  const all = lockedPackages()
  for (const expected of [/^cargo tokio@/, /^npm svelte@/, /^cargo serde_amqp@/])
    assert.ok(
      all.some((one) => expected.test(one)),
      String(expected),
    )
})

test('a snapshot stands for a while, and for the packages that were asked about', () => {
  const check = (
    /** @type {object} */ change,
    /** @type {string[]} */ packages,
    /** @type {RegExp | undefined} */ expected,
  ) => {
    const faults = faultsOfSnapshot({ ...SNAPSHOT, ...change }, packages, TODAY)
    if (expected) assert.match(faults.join('\n'), expected)
    else assert.deepEqual(faults, [])
  }
  check({}, SNAPSHOT.packages, undefined)
  check({}, ['cargo serde@1.0.0'], undefined)
  check({ asked: '2026-10-11' }, [], undefined)
  check({ asked: '2026-10-10' }, [], new RegExp(`46 days ago, more than ${DAYS_MAX}`))
  check({ asked: '2026-11-26' }, [], /a day to come/)
  check({ asked: undefined }, [], /says no day/)
  check({}, ['cargo serde@1.0.1'], /never asked about cargo serde@1\.0\.1:/)
  const many = Array.from({ length: 12 }, (_, number) => `npm p${number}@1.0.0`)
  check({}, many, /and 2 more: run `make advisories`/)
})

test('findings of the snapshot count where the list cannot be had now', () => {
  const other = { ...FINDING, id: 'YANKED-serde-1.0.0' }
  assert.deepEqual(completed([other], new Set(['npm']), SNAPSHOT), [FINDING, other])
  assert.deepEqual(completed([other], new Set(['cargo', 'npm']), SNAPSHOT), [other])
  assert.deepEqual(completed([FINDING], new Set(), SNAPSHOT), [FINDING], 'once')
  assert.deepEqual(completed([other], new Set(), undefined), [other])
})

test('a missing snapshot is said; an old one, a new package and what it found are faults', () => {
  const had = { findings: [], unchecked: [] }
  const none = { findings: [], unchecked: ['Cargo.toml: no database'] }
  const judged = (
    /** @type {import('./snapshot.js').Snapshot | undefined} */ snapshot,
    packages = SNAPSHOT.packages,
    today = TODAY,
  ) => judge({ cargo: none, npm: had }, [], snapshot, packages, today)
  const missing = judged(undefined)
  assert.deepEqual(missing.faults, [])
  assert.match(missing.unchecked.join('\n'), /no database\nNOTHING stands for .*asked\.json/)

  const clean = { ...SNAPSHOT, findings: [] }
  assert.deepEqual(judged(clean).faults, [])
  assert.match(judged(clean).unchecked.join('\n'), /no database\n.*2026-11-01 counts instead/)
  assert.match(judged(clean, undefined, '2027-01-01').faults.join(), /61 days ago/)
  assert.match(judged(clean, ['npm new@1.0.0']).faults.join(), /npm new@1\.0\.0/)
  assert.match(judged(SNAPSHOT).faults.join(), /RUSTSEC-2026-0001 in Cargo\.toml/)
  // Where all lists are had, nothing has to stand for them.
  const all = judge({ cargo: had, npm: had }, [], SNAPSHOT, ['npm new@1.0.0'], '2027-01-01')
  assert.deepEqual(all, { faults: [], unchecked: [], findings: [] })
})

test('a snapshot is written in order and read again', () => {
  const folder = mkdtempSync(`${tmpdir()}/asked-`)
  try {
    const file = `${folder}/asked.json`
    assert.equal(readSnapshot(file), undefined)
    writeSnapshot(file, { ...SNAPSHOT, packages: ['npm b@1', 'cargo a@1', 'npm b@1'] })
    assert.deepEqual(readSnapshot(file), { ...SNAPSHOT, packages: ['cargo a@1', 'npm b@1'] })
  } finally {
    rmSync(folder, { recursive: true })
  }
})

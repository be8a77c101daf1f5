// The bills of materials are what Cargo builds and what the schema of CycloneDX asks for.
import assert from 'node:assert/strict'
import { execFileSync } from 'node:child_process'
import { readFileSync } from 'node:fs'
import { createRequire } from 'node:module'
import { dirname } from 'node:path'
import { test } from 'node:test'
import Ajv from 'ajv'
import addFormats from 'ajv-formats'
import addFurtherFormats from 'ajv-formats-draft2019'
import { packagesOf } from './pages.js'
import { PROGRAMS, ROOT, checksums, parseTree } from './programs.js'
import { billOf, patchesOf } from './sbom.js'

const bills = new Map(PROGRAMS.map((program) => [program.name, billOf(program)]))

/** Returns the schema of a file that CycloneDX publishes. */
function schema(/** @type {string} */ name) {
  const library = createRequire(import.meta.url).resolve('@cyclonedx/cyclonedx-library')
  const root = library.slice(0, library.indexOf('cyclonedx-library') + 'cyclonedx-library'.length)
  return JSON.parse(readFileSync(`${root}/res/schema/${name}.SNAPSHOT.schema.json`, 'utf8'))
}

test('each bill is valid by the schema of CycloneDX 1.6', () => {
  const ajv = new Ajv({ strict: false, allErrors: true })
  for (const part of ['spdx', 'jsf-0.82'])
    ajv.addSchema(schema(part), `http://cyclonedx.org/schema/${part}.SNAPSHOT.schema.json`)
  addFormats(ajv)
  addFurtherFormats(ajv, { formats: ['idn-email'] })
  ajv.addFormat('iri-reference', true)
  const isValid = ajv.compile(schema('bom-1.6'))
  const broken = { ...bills.get('asi'), components: [{ type: 'library' }] }
  assert.equal(isValid(broken), false, 'the schema finds a component without a name')
  for (const [name, bill] of bills)
    assert.ok(
      isValid(JSON.parse(JSON.stringify(bill))),
      `${name}: ${ajv.errorsText(isValid.errors)}`,
    )
})

/**
 * Packages with features that Cargo would build, from its own plan: `build`, or `link` for those that
 * no build script or macro needs alone.
 */
function planned(/** @type {typeof PROGRAMS[number]} */ program) {
  const together = PROGRAMS.filter(({ manifest }) => manifest === program.manifest)
  const plan = JSON.parse(
    execFileSync(
      process.env['CARGO'] ?? 'cargo',
      [
        ...['build', '--release', '--locked', '--manifest-path', program.manifest],
        ...together.flatMap((one) => ['--package', one.package]),
        ...['--unit-graph', '-Z', 'unstable-options'],
      ],
      // The plan is an unstable output of the stable Cargo.
      {
        cwd: ROOT,
        encoding: 'utf8',
        maxBuffer: 1 << 28,
        env: { ...process.env, RUSTC_BOOTSTRAP: '1' },
      },
    ),
  )
  const isOf = (/** @type {string} */ id) =>
    id.includes(`/${program.package}#`) || id.includes(`#${program.package}@`)
  const roots = plan.roots.filter((/** @type {number} */ at) => {
    const unit = plan.units[at]
    return isOf(unit.pkg_id) && unit.target.kind[0] === 'bin'
  })
  assert.ok(roots.length, `the plan has ${program.package}`)
  const isMacro = (/** @type {number} */ at) => plan.units[at].target.kind[0] === 'proc-macro'
  const isScript = (/** @type {number} */ at) => plan.units[at].target.kind[0] === 'custom-build'
  const walk = (/** @type {(at: number) => boolean} */ isFollowed) => {
    const found = new Set(roots)
    for (const at of found)
      for (const { index } of plan.units[at].dependencies) if (isFollowed(index)) found.add(index)
    return [...found].map((at) => plan.units[at])
  }
  return { build: walk(() => true), link: walk((at) => !isMacro(at) && !isScript(at)) }
}

/** `name@version` of a package id of Cargo. */
function keyOf(/** @type {string} */ id) {
  const [place = '', fragment = ''] = id.split('#')
  return fragment.includes('@')
    ? fragment
    : `${dirname(`${place}/x`).split('/').at(-1)}@${fragment}`
}

for (const program of PROGRAMS)
  test(`the bill of ${program.name} has what Cargo builds, with features, licence and hash`, () => {
    const bill = bills.get(program.name)
    assert.ok(bill)
    const { build, link } = planned(program)
    const all = [bill.metadata.component, ...bill.components]
    const components = new Map(all.map((component) => [component['bom-ref'], component]))
    const built = new Set(build.map(({ pkg_id }) => keyOf(pkg_id)))
    const crates = [...components.keys()].filter((ref) => /@/.test(ref) && !/[:]/.test(ref))
    assert.deepEqual(crates.sort(), [...built].sort())

    const linked = new Map(link.map(({ pkg_id, features }) => [keyOf(pkg_id), features]))
    const sums = checksums(program.manifest)
    for (const ref of crates) {
      const component = components.get(ref)
      const isRoot = component === bill.metadata.component
      assert.equal(isRoot || component.scope === 'required', linked.has(ref), `${ref} is linked`)
      assert.ok(component.licenses[0].expression, `${ref} has a licence`)
      assert.match(component.hashes[0].content, /^[0-9a-f]{64}$/, `${ref} has a hash`)
      if (sums.has(ref)) assert.equal(component.hashes[0].content, sums.get(ref))
      if (!linked.has(ref)) continue
      const features = component.properties
        .filter((/** @type {{ name: string }} */ one) => one.name === 'verbund:feature')
        .map((/** @type {{ value: string }} */ one) => one.value)
      assert.deepEqual(features, linked.get(ref).sort(), `features of ${ref}`)
    }
  })

test('dependencies name components that are there', () => {
  for (const [name, bill] of bills) {
    const refs = new Set([bill.metadata.component['bom-ref']])
    const add = (/** @type {any} */ component) => {
      refs.add(component['bom-ref'])
      component.components?.forEach(add)
    }
    bill.components.forEach(add)
    for (const { ref, dependsOn = [] } of bill.dependencies)
      for (const one of [ref, ...dependsOn]) assert.ok(refs.has(one), `${name}: ${one}`)
  }
})

test('each patched crate says what it was and what was changed', () => {
  const connector = bills.get('factory-connector')
  const vendored = connector?.components.filter(({ pedigree }) => pedigree) ?? []
  const names = vendored.map(({ name }) => name).sort()
  const opcua = ['client', 'core', 'crypto', 'nodes', 'server', 'types'].map((part) => `async-opcua-${part}`)
  assert.deepEqual(names, [...opcua, 'fe2o3-amqp', 'serde_amqp'])
  for (const { name, pedigree } of vendored) {
    assert.equal(pedigree.ancestors[0].purl.includes(name), true)
    assert.ok(pedigree.patches.length > 0, name)
  }
})

test('a table of patches is read by folder where it is of several', () => {
  const row =
    '| 1 | `core/src/a.rs`, `b.rs` | what | why |\n| 2 | `types/src/c.rs` | other | because |'
  const readme = `# Patched parts of x\n\n| # | File | Patch | Why |\n|---|---|---|---|\n${row}\n`
  const ids = patchesOf(readme, 'vendor/x/core').map((patch) => patch.resolves[0].id)
  assert.deepEqual(ids, ['patch 1'])
})

test('SQLite, the script engine and the allocator are named with their versions', () => {
  const inside = (/** @type {string} */ program) =>
    bills
      .get(program)
      ?.components.flatMap(({ components = [], name }) =>
        name.startsWith('verbund-web') ? [] : components.map((one) => one.name),
      )
  assert.deepEqual(inside('factory-connector')?.sort(), ['mimalloc', 'sqlite'])
  assert.deepEqual(inside('platform'), ['sqlite'])
  assert.deepEqual(inside('script-quickjs'), ['quickjs-ng'])
})

test('the packages of the pages are all that their sources import', () => {
  const imported = new Map([
    ['engineer', new Set()],
    ['partner', new Set()],
  ])
  const isOfApp = (/** @type {string} */ file, /** @type {string} */ app) =>
    file.startsWith(`${app}/`)
  const files = execFileSync('git', ['ls-files', '*.ts', '*.svelte', '*.css'], {
    cwd: `${ROOT}/web`,
    encoding: 'utf8',
  })
  for (const file of files
    .split('\n')
    .filter((one) => one.includes('/') && !/\.test\.ts$/.test(one)))
    for (const [, name = ''] of readFileSync(`${ROOT}/web/${file}`, 'utf8').matchAll(
      /^\s*(?:import|export|@import)\s(?!type\b)(?:[^'"]*?from\s)?['"]((?:@[\w-]+\/)?[\w-]+)/gm,
    ))
      for (const [app, names] of imported) if (isOfApp(file, app)) names.add(name)
  for (const [app, names] of imported) {
    const packages = packagesOf(app).map(({ name }) => name)
    const missing = [...names].filter(
      (name) => name !== '@' && !name.startsWith('@/') && !packages.includes(name),
    )
    assert.deepEqual(missing, [], app)
    assert.ok(packages.includes('svelte') && packages.some((name) => name.includes('font')), app)
  }
})

test('a tree is read with its repeated packages', () => {
  const text =
    '0 a v1.0.0 (/x/a)|f|MIT\n1 b v2.0.0|g,h|MIT/Apache-2.0\n2 c v3.0.0 (proc-macro)||MIT\n1 b v2.0.0|g,h|MIT/Apache-2.0 (*)\n'
  const { packages, dependencies } = parseTree(text)
  assert.deepEqual(packages.get('b@2.0.0')?.licence, 'MIT OR Apache-2.0')
  assert.deepEqual([...(dependencies.get('a@1.0.0') ?? [])], ['b@2.0.0'])
  assert.deepEqual([...(dependencies.get('b@2.0.0') ?? [])], ['c@3.0.0'])
})

// Everything that is delivered has the text of its licence in THIRD-PARTY-NOTICES.txt.
import assert from 'node:assert/strict'
import { readFileSync } from 'node:fs'
import { test } from 'node:test'
import { alternatives } from './licence-texts.js'
import { NOTICES, notices, noticesText } from './notices.js'
import { packagesOf } from './pages.js'
import { PROGRAMS, ROOT, graphOf } from './programs.js'

/** Words that the text of a licence has. */
const WORDS = {
  'Apache-2.0': /apache license/i,
  MIT: /permission is hereby granted, free of charge/i,
  'MPL-2.0': /mozilla public license/i,
  'Unicode-3.0': /unicode (license|, inc)/i,
  'BSD-3-Clause': /redistribution and use in source and binary forms/i,
  'BSD-2-Clause': /redistribution and use in source and binary forms/i,
  ISC: /permission to use, copy, modify,? and\/or distribute/i,
  Zlib: /provided 'as-is'/i,
  'OFL-1.1': /sil open font license/i,
}

/** Licences of the fonts in the pages, beside those that deny.toml allows for crates. */
const OF_FONTS = { 'OFL-1.1': /^@fontsource/ }

const committed = readFileSync(NOTICES, 'utf8')

/** Returns the packages of the file, each with its licences and texts. */
function parsed(/** @type {string} */ file) {
  const [head = '', ...bodies] = file.split(/^-{72}\nText /m)
  const texts = new Map(bodies.map((body) => [body.slice(0, 8), body.slice(9).trim()]))
  const found = [...head.matchAll(/^(\S+ .+): (.+); text ([0-9a-f, ]+)$/gm)]
  return new Map(
    found.map(([, key = '', licence = '', names = '']) => [
      key,
      { licences: licence.split(' AND '), texts: names.split(', ').map((name) => texts.get(name)) },
    ]),
  )
}

test('the committed notices are those of the lock files', () => {
  assert.ok(committed === notices(), 'THIRD-PARTY-NOTICES.txt is stale: `make notices`')
})

test('no package of a program or of the pages is without its text', () => {
  const known = parsed(committed)
  const shipped = PROGRAMS.flatMap((program) => {
    const { graph, linked } = graphOf(program)
    const crates = [...linked].flatMap((key) => graph.packages.get(key) ?? [])
    return crates.filter(({ folder }) => !folder || folder.startsWith('vendor/'))
  })
  const all = [...shipped, ...['engineer', 'partner'].flatMap(packagesOf)]
  assert.ok(all.length > 300, `${all.length} packages were read`)
  for (const { name, version } of all) {
    const notice = known.get(`${name} ${version}`)
    assert.ok(notice, `${name} ${version} is not in the notices`)
    for (const licence of notice.licences) {
      const words = WORDS[licence]
      assert.ok(words, `${name}: say in this test what a text of ${licence} has`)
      assert.ok(
        notice.texts.some((text) => text && words.test(text)),
        `${name} ${version} has no text of ${licence}`,
      )
    }
  }
})

test('what is taken under a licence is allowed by deny.toml, and fonts by the list above', () => {
  const rules = readFileSync(`${ROOT}/deny.toml`, 'utf8')
  const list = /allow = \[([^\]]*)\]/.exec(rules)?.[1] ?? ''
  const allowed = new Set([...list.matchAll(/"([^"]+)"/g)].map(([, licence]) => licence))
  for (const [key, { licences }] of parsed(committed))
    for (const licence of licences)
      assert.ok(allowed.has(licence) || OF_FONTS[licence]?.test(key), `${key}: ${licence}`)
})

test('a package without a text is found, and a new one changes no other line', () => {
  const one = { name: 'a', version: '1.0.0', licence: 'MIT', texts: ['Text of a\n  licence'] }
  const other = {
    name: 'b',
    version: '2.0.0',
    licence: 'ISC',
    texts: ['text of a licence', 'More'],
  }
  const both = parsed(noticesText([other, one]))
  assert.deepEqual([...both.keys()], ['a 1.0.0', 'b 2.0.0'])
  assert.equal(both.get('a 1.0.0')?.texts[0], both.get('b 2.0.0')?.texts[0])
  const lines = new Set(noticesText([one]).split('\n'))
  for (const line of noticesText([one, other]).split('\n')) lines.delete(line)
  assert.deepEqual([...lines], [])
  const empty = parsed(noticesText([{ ...one, texts: [] }]))
  assert.equal(empty.get('a 1.0.0'), undefined)
})

test('expressions are read', () => {
  assert.deepEqual(alternatives('MIT OR Apache-2.0'), [['MIT'], ['Apache-2.0']])
  assert.deepEqual(alternatives('(MIT OR ISC) AND Unicode-3.0'), [
    ['MIT', 'Unicode-3.0'],
    ['ISC', 'Unicode-3.0'],
  ])
  assert.deepEqual(alternatives('Apache-2.0 AND ISC'), [['Apache-2.0', 'ISC']])
})

import { readFileSync } from 'node:fs'
import path from 'node:path'
import { describe, expect, it } from 'vitest'
import { de as engineerDe } from '@/engineer/language/de'
import { en as engineerEn } from '@/engineer/language/en'
import { de as partnerDe } from '@/partner/language/de'
import { en as partnerEn } from '@/partner/language/en'
import { de } from './de'
import { en } from './en'
import { language } from './language.svelte'
import { words } from './words'

/** All paths of a catalogue that lead to a text. */
function paths(node: unknown, at = ''): string[] {
  if (node === null || typeof node !== 'object') return [at]
  return Object.entries(node).flatMap(([name, child]) => paths(child, `${at}/${name}`))
}

describe.each([
  ['shared', en, de],
  ['engineer', engineerEn, engineerDe],
  ['partner', partnerEn, partnerDe],
])('the %s catalogue', (_, english, german) => {
  // The types see to named texts; tables by code are open to them.
  it('has every text in both languages', () => {
    expect(paths(german)).toEqual(paths(english))
  })
  it('has no empty text', () => {
    const values = (node: unknown): unknown[] =>
      node !== null && typeof node === 'object' ? Object.values(node).flatMap(values) : [node]
    expect(
      [...values(english), ...values(german)].filter(
        (text) => typeof text === 'string' && text.trim() === '',
      ),
    ).toEqual([])
  })
})

it('follows the language that is chosen', () => {
  expect(words.session.signIn).toBe('Sign in')
  language.choose('de')
  expect(words.session.signIn).toBe('Anmelden')
  expect(document.documentElement.lang).toBe('de')
})

it('says in both languages what each key of the connector’s configuration means', () => {
  const example = readFileSync(
    path.resolve(import.meta.dirname, '../../factory-connector/factory-connector.example.toml'),
    'utf8',
  )
  let section = ''
  const keys = example.split('\n').flatMap((line) => {
    section = /^(?:#: )?\[([\w.]+)\]$/.exec(line)?.[1] ?? section
    const key = /^(?:#: )?(\w+) = /.exec(line)?.[1]
    return key === undefined ? [] : [section === '' ? key : `${section}.${key}`]
  })
  expect(keys.length).toBeGreaterThan(30)
  for (const { settings } of [engineerEn, engineerDe])
    expect(keys.filter((key) => !(key in settings.meaning))).toEqual([])
})

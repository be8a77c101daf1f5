import { readdirSync, readFileSync, statSync } from 'node:fs'
import path from 'node:path'
import { describe, expect, it } from 'vitest'
import { Problem } from '@/transport/problem'
import { de } from './de'
import { en } from './en'
import { language } from './language.svelte'
import { firstFaultText, problemText, said } from './said'

const ROOT = path.resolve(import.meta.dirname, '../..')
/** Files and folders in which all upper-case texts are codes, or values of the API. */
const PLACES = [
  'asi-model/src/validation/faults.rs',
  'daemon/src/web',
  'factory-connector/src/api',
  'factory-connector/src/coordinator',
  'factory-connector/state/src/operator/entry.rs',
  'factory-connector/state/src/use_cases',
  'factory-connector/twin/src/security',
  'platform/src',
]
/** Upper-case texts that are neither: names of the environment, of serialization and of headers. */
const NO_CODES = [
  'ABCDEFGHIJKLMNOPQRSTUVWXYZ234567',
  'CARGO_PKG_VERSION',
  'DENY',
  'DISCLOSED',
  'REQUEST',
  'SCREAMING_SNAKE_CASE',
  'SUPPRESSED',
  'VERBUND',
  'VERBUND_CONFIG',
]

/** All values of enumerations in a description of an API. */
function valuesOf(node: unknown): string[] {
  if (node === null || typeof node !== 'object') return []
  return Object.entries(node).flatMap(([name, child]) =>
    name === 'enum' && Array.isArray(child) ? child.map(String) : valuesOf(child),
  )
}

function codesIn(source: string): string[] {
  const [code = ''] = source.split('#[cfg(test)]')
  return [...code.matchAll(/"([A-Z][A-Z0-9]{3,}(?:_[A-Z0-9]+)*|[A-Z]{2,3}_[A-Z0-9_]+)"/g)].map(
    (match) => match[1] ?? '',
  )
}

/** Codes of the sources of both servers that have no text. */
function unsaid(sources: readonly string[], texts: Record<string, string>): string[] {
  const descriptions = ['platform', 'factory-connector'].map((daemon) =>
    readFileSync(path.join(ROOT, daemon, 'openapi.json'), 'utf8'),
  )
  const others = new Set([
    ...NO_CODES,
    ...descriptions.flatMap((text) => valuesOf(JSON.parse(text))),
  ])
  const codes = new Set(sources.flatMap(codesIn))
  return [...codes].filter((code) => !others.has(code) && !(code in texts)).sort()
}

const sources = PLACES.map((place) => path.join(ROOT, place))
  .flatMap((place) =>
    statSync(place).isFile()
      ? [place]
      : readdirSync(place, { recursive: true, encoding: 'utf8' }).map((file) =>
          path.join(place, file),
        ),
  )
  .filter((file) => file.endsWith('.rs') && !/tests?(\/|\.rs$)/.test(file))
  .map((file) => readFileSync(file, 'utf8'))

describe.each([
  ['English', en.code],
  ['German', de.code],
])('the %s texts of codes', (_, texts) => {
  it('say each code of both servers', () => {
    expect(sources.length).toBeGreaterThan(150)
    expect(unsaid(sources, texts)).toEqual([])
  })
  it('are missed where a code is added', () => {
    const added = 'Problem::conflict("TOO_LATE_NOW", "It is too late.")'
    expect(unsaid([...sources, added], texts)).toEqual(['TOO_LATE_NOW'])
  })
  it('are of codes that exist', () => {
    const codes = new Set(sources.flatMap(codesIn))
    // A page makes it for an answer that has no document.
    codes.add('NO_DOCUMENT')
    expect(Object.keys(texts).filter((code) => !codes.has(code))).toEqual([])
  })
})

it('names the same parameters in both languages', () => {
  const parameters = (text = ''): string[] => [...text.matchAll(/\{\w+\}/g)].map(([it]) => it)
  for (const [code, text] of Object.entries(en.code))
    expect([code, parameters(de.code[code])]).toEqual([code, parameters(text)])
})

describe('a problem', () => {
  const problem = (members: object): Problem =>
    new Problem({
      type: '',
      title: 'Conflict',
      status: 409,
      code: 'REVISION_CONFLICT',
      detail: 'The revision in effect is 7.',
      ...members,
    })
  it('is said in the language of the page, with its parameters', () => {
    const known = problem({ parameters: { revision: '7' } })
    expect(problemText(known)).toContain('revision 7 is in effect')
    language.choose('de')
    expect(problemText(known)).toContain('Fassung 7 gilt')
    expect(problemText(problem({ code: 'TOO_MANY_REQUESTS', retryAfterSeconds: 3 }))).toContain(
      'in 3 s',
    )
    language.choose('en')
  })
  it('is said in the server’s words where a parameter or the text is missing', () => {
    expect(problemText(problem({}))).toBe('The revision in effect is 7.')
    expect(said('OF_TOMORROW', 'It is so.')).toBe('It is so.')
    expect(said('constructor', 'It is so.')).toBe('It is so.')
  })
  it('is said by its first fault', () => {
    const faults = [{ pointer: '/unit', code: 'UNKNOWN_UNIT', message: 'FURLONG is none.' }]
    expect(firstFaultText(problem({ faults }))).toBe(en.code.UNKNOWN_UNIT)
    expect(problemText(Problem.unreached())).toBe(en.resource.offlineTitle)
  })
})

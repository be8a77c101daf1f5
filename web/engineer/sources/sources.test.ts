import { readFileSync } from 'node:fs'
import path from 'node:path'
import { describe, expect, it } from 'vitest'
import { de } from '../language/de'
import { en } from '../language/en'
import { awaited, grouped } from './certificates.svelte'
import { suggestedId } from './source-id'

describe('the id of a new source', () => {
  it.each([
    ['opc.tcp://press-1.hall2.example:4840/UA', 'press-1'],
    ['opc.tcp://127.0.0.1:50001', '127-0-0-1-50001'],
    ['opc.tcp://[fe80::1]:4841', 'fe80-1-4841'],
    ['opc.tcp://press', 'press-2'],
    ['opc.tcp://', ''],
    ['http://x', ''],
  ])('of %s is %s', (url, id) => {
    expect(suggestedId(url, ['press'])).toBe(id)
  })
})

describe('certificates', () => {
  const certificate = {
    thumbprint: 'ab12cd34',
    fingerprint: 'fe98dc76',
    subject: 'CN=Press',
    isTrusted: false,
  }
  it('are found by the fingerprint that the problem names', () => {
    const problem = (kind: 'serverCertificateUntrusted' | 'unreachable') => ({
      problem: { kind, message: 'CN=Press, fingerprint FE98DC76.', remedy: '' },
    })
    expect(awaited(problem('serverCertificateUntrusted'), [certificate])).toBe(certificate)
    expect(awaited(problem('unreachable'), [certificate])).toBeUndefined()
  })
  it('are compared in groups', () => {
    expect(grouped('ab12cd34ef')).toBe('AB12 CD34 EF')
  })
})

it('has words, and what to do, for each kind of problem of a source', () => {
  const file = path.resolve(import.meta.dirname, '../../../factory-connector/openapi.json')
  const { components } = JSON.parse(readFileSync(file, 'utf8')) as {
    components: { schemas: { SourceProblemKind: { enum: string[] } } }
  }
  const kinds = components.schemas.SourceProblemKind.enum
  for (const { sources } of [en, de]) expect(Object.keys(sources.problems)).toEqual(kinds)
})

import { render, screen } from '@testing-library/svelte'
import { readFileSync } from 'node:fs'
import path from 'node:path'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { serve } from '../../vitest.server'
import { texts } from '../language/texts'
import TokenDialog from './TokenDialog.svelte'
import { enrolmentCommand, isLocalOnly, partsOf } from './enrolment'

const encoded = (address: string): string => Buffer.from(address).toString('base64url')
const PUBLIC = `${encoded('https://verbund.example')}.cGlu.c2VjcmV0`
const LOCAL = `${encoded('http://127.0.0.1:8080')}.c2VjcmV0`

/** Options of `factory-connector enrol`, and its arguments by position, of the source of the command. */
function usage(): { options: string[]; positions: string[] } {
  const source = readFileSync(
    path.resolve(import.meta.dirname, '../../../factory-connector/src/cli.rs'),
    'utf8',
  )
  const variant = /\n {4}Enrol \{\n([\s\S]*?)\n {4}\},/.exec(source)?.[1] ?? ''
  const members = variant.split('\n').filter((line) => !line.trim().startsWith('///'))
  const names = members.flatMap((line, index) => {
    const name = /^\s+(\w+): /.exec(line)?.[1]
    const isOption = members[index - 1]?.includes('#[arg(long') === true
    return name === undefined ? [] : [{ name: name.replaceAll('_', '-'), isOption }]
  })
  return {
    options: names.filter(({ isOption }) => isOption).map(({ name }) => `--${name}`),
    positions: names.filter(({ isOption }) => !isOption).map(({ name }) => name),
  }
}

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the line that enrols a connector', () => {
  it('has the command, the options and the values that the connector takes', () => {
    const { options, positions } = usage()
    expect(options).toEqual(['--token-file', '--platform'])
    expect(positions).toEqual([])
    for (const token of [PUBLIC, LOCAL, 'secret'])
      for (const file of [undefined, 'token.txt']) {
        const line = enrolmentCommand(token, 'https://cloud.example', file)
        const [program, command, ...rest] = line.split(' ')
        expect([program, command]).toEqual(['factory-connector', 'enrol'])
        expect(rest.filter((_, index) => index % 2 === 0).every((it) => options.includes(it))).toBe(
          true,
        )
        expect(rest.length % 2).toBe(0)
        expect(line).not.toContain('c2VjcmV0')
      }
  })

  it('trusts the address of the token, which the pin belongs to', () => {
    expect(enrolmentCommand(PUBLIC, 'http://10.0.0.5:8080')).toBe('factory-connector enrol')
    expect(partsOf(PUBLIC)).toEqual({ address: 'https://verbund.example', hasPin: true })
  })

  it('gives the address of the page where that of the token leads nowhere', () => {
    expect(enrolmentCommand(LOCAL, 'http://10.0.0.5:8080')).toBe(
      'factory-connector enrol --platform http://10.0.0.5:8080',
    )
    expect(enrolmentCommand('secret', 'http://127.0.0.1:8080')).toContain('--platform')
    // On one machine both are the same.
    expect(enrolmentCommand(LOCAL, 'http://localhost:8080')).toBe('factory-connector enrol')
    for (const address of ['http://0.0.0.0:8080', 'http://[::]:8080', 'http://[::1]:8080'])
      expect(isLocalOnly(partsOf(`${encoded(address)}.x`), 'https://a.example')).toBe(true)
  })

  it('is what the page shows, beside the token and what the token says', async () => {
    serve({
      'POST /factories/F/enrolment-tokens': () => ({
        token: PUBLIC,
        expiresAt: '2026-01-01T00:00:00Z',
      }),
    })
    render(TokenDialog, { factoryId: 'F', open: true, onclose: vi.fn() })
    const line = await screen.findByLabelText(texts.factories.command)
    expect(line.textContent).toBe('factory-connector enrol')
    const fromFile = screen.getByLabelText(texts.administration.enrolment.file)
    expect(fromFile.textContent).toBe('factory-connector enrol --token-file token.txt')
    expect(screen.getByText(PUBLIC).tagName).toBe('CODE')
    expect(screen.getByText(/https:\/\/verbund\.example/)).toBeTruthy()
  })
})

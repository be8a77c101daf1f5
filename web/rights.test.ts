import { readdirSync, readFileSync } from 'node:fs'
import path from 'node:path'
import { describe, expect, it } from 'vitest'

const FIELD = '/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}'
const METHODS: Record<string, string> = { postFile: 'post', download: 'get', address: 'get' }

/** An operation with the least role that it needs, as its description says; empty for any. */
type Roles = Map<string, string>

function rolesOf(daemon: string): Roles {
  const file = path.join(import.meta.dirname, '..', daemon, 'openapi.json')
  const { paths } = JSON.parse(readFileSync(file, 'utf8')) as {
    paths: Record<string, Record<string, { security?: { session?: string[] }[] }>>
  }
  return new Map(
    Object.entries(paths).flatMap(([address, operations]) =>
      Object.entries(operations).map(([method, { security }]) => [
        `${method} ${address.replace('/api/v1', '')}`,
        security?.[0]?.session?.[0] ?? '',
      ]),
    ),
  )
}

/** Source files of an app, by their path in it. */
function filesOf(app: string): Map<string, string> {
  const folder = path.join(import.meta.dirname, app)
  return new Map(
    readdirSync(folder, { recursive: true, encoding: 'utf8' })
      .filter((file) => /\.(svelte|ts)$/.test(file) && !file.includes('.test.'))
      .map((file) => [file, readFileSync(path.join(folder, file), 'utf8')]),
  )
}

function callsIn(text: string, client: string): string[] {
  const call = new RegExp(`\\b${client}\\s*\\.(\\w+)\\(\\s*['\`]([^'\`]+)['\`]`, 'g')
  return [...text.matchAll(call)].map(([, method = '', address = '']) => {
    return `${METHODS[method] ?? method} ${address.replace('${FIELD}', FIELD)}`
  })
}

const GUARD =
  /\b(mayDecide|mayOperate|mayPlan|mayChange|mayAdminister|isEngineer|isOperator|readsAll)\b|who\?\.role|enters\(role\)/

/** Conditions around each use of a component, in the file that has it. */
function conditionsOf(text: string, use: RegExp): string[] {
  const around: string[] = []
  const found: string[] = []
  const parts = new RegExp(
    `\\{#if ([^}]*)\\}|\\{:else if ([^}]*)\\}|\\{:else\\}|\\{/if\\}|${use.source}`,
    'g',
  )
  for (const [part, begun, other] of text.matchAll(parts)) {
    if (begun !== undefined) around.push(begun)
    else if (part === '{/if}') around.pop()
    else if (part.startsWith('{:else')) around.splice(-1, 1, other ?? '')
    else found.push(around.join(' && '))
  }
  return found
}

/**
 * True where the file asks for a right, or each file that uses it does so, up to the pages. The
 * tables of pages have to ask where they show the page.
 */
function isGuarded(
  file: string,
  files: Map<string, string>,
  seen: readonly string[] = [],
): boolean {
  if (GUARD.test(files.get(file) ?? '')) return true
  const name = path.basename(file).replace(/\.svelte\.ts$|\.svelte$|\.ts$/, '')
  const isComponent = file.endsWith('.svelte')
  const use = isComponent
    ? new RegExp(`<${name}(?=[\\s/>])`)
    : new RegExp(`from '[^']*/${name}(?:\\.svelte)?'`)
  const users = [...files].filter(([other, text]) => other !== file && use.test(text))
  return (
    users.length > 0 &&
    users.every(([user, text]) => {
      if (seen.includes(user)) return true
      if (['App.svelte', 'Pages.svelte'].includes(user))
        return conditionsOf(text, use).every((condition) => GUARD.test(condition))
      return isGuarded(user, files, [...seen, file])
    })
  )
}

/** Calls of an app that a role may not make, in files that nothing guards. */
function unguarded(files: Map<string, string>, client: string, needs: (call: string) => boolean) {
  return [...files].flatMap(([file, text]) =>
    callsIn(text, client)
      .filter(needs)
      .filter(() => !isGuarded(file, files))
      .map((call) => `${file}: ${call}`),
  )
}

describe('the engineers’ pages', () => {
  const roles = rolesOf('factory-connector')
  const needs = (call: string): boolean => !['VIEWER', ''].includes(roles.get(call) ?? 'UNKNOWN')
  const files = filesOf('engineer')

  it('call only what the description has', () => {
    const calls = [...files.values()].flatMap((text) => callsIn(text, 'connector'))
    expect(calls.length).toBeGreaterThan(60)
    expect(calls.filter((call) => !roles.has(call) && !/\{\w*$/.test(call))).toEqual([])
  })
  it('hide from viewers what needs another role', () => {
    expect(unguarded(files, 'connector', needs)).toEqual([])
  })
  it('are told of a call that nothing guards', () => {
    const added = "await connector.put('/rules/{ruleId}', { path: { ruleId } })"
    const more = new Map([...files, ['inbox/New.svelte', added], ['inbox/All.svelte', '<New />']])
    expect(unguarded(more, 'connector', needs)).toEqual(['inbox/New.svelte: put /rules/{ruleId}'])
  })
})

describe('the partners’ pages', () => {
  const files = filesOf('partner')
  /** Changes of people about themselves. */
  const OWN = /^\w+ \/session/

  it('hide from viewers what changes something', () => {
    const needs = (call: string): boolean => !call.startsWith('get ') && !OWN.test(call)
    expect(unguarded(files, 'platform', needs)).toEqual([])
  })
})

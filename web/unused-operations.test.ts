import { readdirSync, readFileSync } from 'node:fs'
import path from 'node:path'
import { describe, expect, it } from 'vitest'

const FIELD = '/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}'

/** The list of sessions, which is the same on all pages, puts their addresses together. */
const SESSIONS = {
  endSession: 'called by the list of sessions',
  endUserSession: 'called by the list of sessions',
}

/** Operations that programs call, or that say no more than another one that pages call. */
const EXCUSED = {
  engineer: {
    ...SESSIONS,
    showConsentOffer: 'answered with the field; for programs that consent',
    showRevocation: 'the list has it',
    listOperationNetworks: 'the inbox and the interface of OPC UA have the networks',
    showOperationNetwork: 'as the list',
    showSpool: 'the status has its numbers',
    streamEvents: 'read by the feed of all pages, under its own address',
  },
  partner: {
    ...SESSIONS,
    enrol: 'for connectors',
    listLedgerLogs: 'for audits by `asi ledger audit`',
    streamLive: 'read by the feed of all pages, under its own address',
  },
} satisfies Record<string, Record<string, string>>

/** Operations for people that no page calls yet. None may be added: a new operation comes with its page. */
const WITHOUT_A_PAGE = {
  engineer: [
    'compareMappingVersions',
    'listAllianceVersions',
    'listCapVersions',
    'listLedgerLogs',
    'listPolicyVersions',
    'listRuleVersions',
    'showRevisionDifference',
  ],
  partner: [],
} satisfies Record<string, readonly string[]>

interface Description {
  paths: Record<string, Record<string, { operationId: string }>>
}

/** Operations of a daemon by their method and address. */
function operationsOf(daemon: string): [string, string][] {
  const file = path.join(import.meta.dirname, '..', daemon, 'openapi.json')
  const { paths } = JSON.parse(readFileSync(file, 'utf8')) as Description
  return Object.entries(paths).flatMap(([address, methods]) =>
    Object.entries(methods).map(([method, { operationId }]): [string, string] => [
      `${method} ${address.replace('/api/v1', '')}`,
      operationId,
    ]),
  )
}

/** All texts of the folders, with the constants of addresses in their places. */
function textOf(...folders: string[]): string {
  return folders
    .flatMap((folder) =>
      readdirSync(path.join(import.meta.dirname, folder), { recursive: true, encoding: 'utf8' })
        .filter((file) => /\.(svelte|ts)$/.test(file) && !file.includes('.test.'))
        .map((file) => readFileSync(path.join(import.meta.dirname, folder, file), 'utf8')),
    )
    .map((text) =>
      [...text.matchAll(/const ([A-Z]+) = '(\/[^']+)'/g)].reduce(
        (filled, [, name = '', address = '']) => filled.replaceAll(`\${${name}}`, address),
        text,
      ),
    )
    .join('\n')
    .replaceAll('${FIELD}', FIELD)
}

/** True where a page names the address, whatever stands for its ids, and by whatever method: an unused method of a used address is not found. */
function isNamed(text: string, call: string): boolean {
  const address = call.slice(call.indexOf(' ') + 1)
  const escaped = address.replace(/[.*+?^$()|[\]\\]/g, '\\$&')
  const pattern = escaped.replace(/\{\w+\}/g, '(?:\\{\\w+\\}|\\$\\{[^}]*\\})')
  return new RegExp(`['\`]${pattern}['\`?]`).test(text)
}

describe.each([
  ['engineer', 'factory-connector'],
  ['partner', 'platform'],
] as const)('the pages of the %s', (app, daemon) => {
  const text = textOf(app, 'account', 'transport', 'shell', 'comments')
  it('name the address of each operation, but those that have a reason', () => {
    const unused = operationsOf(daemon)
      .filter(([call]) => !isNamed(text, call))
      .map(([, operationId]) => operationId)
    const excused = [...Object.keys(EXCUSED[app]), ...WITHOUT_A_PAGE[app]]
    expect(unused.toSorted()).toEqual(excused.toSorted())
  })
})

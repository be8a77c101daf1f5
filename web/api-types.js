// Writes the TypeScript types of both daemons' APIs from their committed descriptions.
// `npm run generate` after an openapi.json changed; a test fails while they differ.
import { readFileSync, writeFileSync } from 'node:fs'
import openapiTS, { astToString } from 'openapi-typescript'

const HEADER = '// Generated from openapi.json by `npm run generate`. Do not edit.\n\n'
const BASE = '/api/v1'

/** The descriptions, each with the file of its types. */
export const APIS = [
  {
    name: 'platform',
    description: new URL('../platform/openapi.json', import.meta.url),
    types: new URL('./api/platform.generated.ts', import.meta.url),
  },
  {
    name: 'factory-connector',
    description: new URL('../factory-connector/openapi.json', import.meta.url),
    types: new URL('./api/connector.generated.ts', import.meta.url),
  },
]

/**
 * Types of a description as it is, with paths below `/api/v1`. A member with a default may be left
 * out.
 *
 * @param {(typeof APIS)[number]} api
 */
export async function typesOf({ description }) {
  const api = JSON.parse(readFileSync(description, 'utf8'))
  api.paths = Object.fromEntries(
    Object.entries(api.paths).map(([path, operations]) => [path.replace(BASE, ''), operations]),
  )
  return HEADER + astToString(await openapiTS(api, { defaultNonNullable: false }))
}

if (process.argv[1] === new URL(import.meta.url).pathname)
  for (const api of APIS) writeFileSync(api.types, await typesOf(api))

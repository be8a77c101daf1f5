// Writes the TypeScript types of both daemons' APIs from their committed descriptions. `npm run generate` after an
// openapi.json changed; a test fails while they differ.
import { existsSync, readFileSync, writeFileSync } from 'node:fs'
import openapiTS, { astToString } from 'openapi-typescript'

const HEADER = '// Generated from openapi.json by `npm run generate`. Do not edit.\n\n'

/** Which description belongs to which page. */
export const APIS = [
  {
    description: new URL('../platform/openapi.json', import.meta.url),
    types: new URL('./partner/api/generated.ts', import.meta.url),
  },
  {
    description: new URL('../factory-connector/openapi.json', import.meta.url),
    types: new URL('./engineer/api/generated.ts', import.meta.url),
  },
]

/** @param {URL} description */
export async function typesOf(description) {
  const api = JSON.parse(readFileSync(description, 'utf8'))
  // Operations are named by their functions, which several resources share; only the schemas are of use here.
  for (const path of Object.values(api.paths))
    for (const operation of Object.values(path)) delete operation.operationId
  const paths = `\n/** The paths that the daemon of this build answers: a page offers nothing else. */\nexport const PATHS: readonly string[] = ${JSON.stringify(Object.keys(api.paths), undefined, 2)}\n`
  return HEADER + astToString(await openapiTS(api)) + paths
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  for (const { description, types } of APIS) {
    if (existsSync(description)) writeFileSync(types, await typesOf(description))
    else process.stderr.write(`${description.pathname} is missing; its types stay as they are.\n`)
  }
}

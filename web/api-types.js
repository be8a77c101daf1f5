// Writes the TypeScript types of both daemons' APIs from their committed descriptions.
// `npm run generate` after an openapi.json changed; a test fails while they differ.
import { readFileSync, writeFileSync } from 'node:fs'
import openapiTS, { astToString } from 'openapi-typescript'
import { connectorSupplements, platformSupplements } from './api-supplements.js'

const HEADER = '// Generated from openapi.json by `npm run generate`. Do not edit.\n\n'
const BASE = '/api/v1'

/** The descriptions, each with the file of its types. */
export const APIS = [
  {
    name: 'platform',
    description: new URL('../platform/openapi.json', import.meta.url),
    types: new URL('./partner/api/generated.ts', import.meta.url),
    supplements: platformSupplements,
  },
  {
    name: 'factory-connector',
    description: new URL('../factory-connector/openapi.json', import.meta.url),
    types: new URL('./engineer/api/generated.ts', import.meta.url),
    supplements: connectorSupplements,
  },
]

/** @param {(typeof APIS)[number]} api */
export async function typesOf({ description, supplements }) {
  const api = JSON.parse(readFileSync(description, 'utf8'))
  api.paths = relative(api.paths)
  supplement(api.components.schemas, supplements())
  return HEADER + astToString(await openapiTS(opened(api)))
}

/**
 * Paths below `/api/v1`. Operations are written in place: their ids are of no use to a client that
 * calls them by method and path. Problems have one form (`transport/problem.ts`).
 *
 * @param {Record<string, Record<string, any>>} paths
 */
function relative(paths) {
  for (const path of Object.values(paths)) {
    for (const operation of Object.values(path)) {
      delete operation.operationId
      // A page's cursor is passed on as it was received.
      for (const parameter of operation.parameters ?? [])
        if (['cursor', 'after'].includes(parameter.name)) parameter.schema = { type: 'string' }
      operation.responses = Object.fromEntries(
        Object.entries(operation.responses).filter(([status]) => status.startsWith('2')),
      )
    }
  }
  return Object.fromEntries(
    Object.entries(paths).map(([path, operations]) => [path.replace(BASE, ''), operations]),
  )
}

/**
 * Adds schemas and describes members that the description leaves open.
 *
 * @param {Record<string, any>} schemas
 * @param {{ schemas: Record<string, any>, members: Record<string, any> }} supplements
 */
function supplement(schemas, { schemas: added, members }) {
  for (const [name, schema] of Object.entries(added))
    schemas[name] = typeof schema === 'function' ? schema(schemas[name]) : schema
  for (const [name, schema] of Object.entries(schemas)) {
    // Pages repeat the schema of their items.
    const item = name.startsWith('Page_') ? name.slice('Page_'.length) : undefined
    if (item !== undefined && item in schemas)
      schema.properties.items.items = { $ref: `#/components/schemas/${item}` }
  }
  for (const [place, schema] of Object.entries(members)) {
    const [name = '', member = ''] = place.split('.')
    const parts = [schemas[name], ...(schemas[name]?.allOf ?? []), ...(schemas[name]?.oneOf ?? [])]
    const part = parts.find((candidate) => candidate?.properties?.[member] !== undefined)
    if (part === undefined) throw new Error(`The description has no member ${place}.`)
    part.properties[member] = schema
  }
}

/**
 * The description with values of any type where it says `object` and nothing about its members.
 *
 * @param {any} node
 * @returns {any}
 */
function opened(node) {
  if (Array.isArray(node)) return node.map(opened)
  if (node === null || typeof node !== 'object') return node
  const isObject = node.type === 'object' || [node.type].flat().includes('object')
  const isOpen =
    isObject && !('properties' in node) && !('additionalProperties' in node) && !('allOf' in node)
  if (isOpen) return node.description === undefined ? {} : { description: node.description }
  return openedMembers(node)
}

/** @param {object} node */
const openedMembers = (node) =>
  Object.fromEntries(Object.entries(node).map(([key, value]) => [key, opened(value)]))

if (process.argv[1] === new URL(import.meta.url).pathname)
  for (const api of APIS) writeFileSync(api.types, await typesOf(api))

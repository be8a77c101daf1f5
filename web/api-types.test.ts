// @vitest-environment node
import { readFileSync } from 'node:fs'
import { expect, it } from 'vitest'
import { APIS, typesOf } from './api-types.js'

it.each(APIS)('the types of $name are fresh; otherwise: npm run generate', async (api) => {
  expect(readFileSync(api.types, 'utf8')).toBe(await typesOf(api))
})

// @vitest-environment node
import { existsSync, readFileSync } from 'node:fs'
import { expect, it } from 'vitest'
import { APIS, typesOf } from './api-types.js'

it.each(APIS.filter(({ types }) => existsSync(types)))(
  'the types of $description are fresh; otherwise: npm run generate',
  async ({ description, types }) => {
    expect(readFileSync(types, 'utf8')).toBe(await typesOf(description))
  },
)

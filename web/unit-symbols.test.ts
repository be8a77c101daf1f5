// @vitest-environment node
import { readFileSync } from 'node:fs'
import { expect, it } from 'vitest'
import { SYMBOLS, symbolsOf } from './unit-symbols.js'

it('the symbols of units are fresh; otherwise: npm run generate', () => {
  expect(readFileSync(SYMBOLS, 'utf8')).toBe(symbolsOf())
})

import { expect, it } from 'vitest'
import { language } from '@/language/language.svelte'
import { statementText } from './statement'
import { unitText } from './unit'

it.each([
  ['KWT', 'kW', 'kW'],
  ['2X', 'm/min', 'm/min'],
  ['METRE_PER_MINUTE', 'm/min', 'm/min'],
  ['CEL', '°C', '°C'],
  ['PIECE', 'pcs', 'Stk.'],
  ['H87', 'pcs', 'Stk.'],
  ['C62', '', ''],
  ['20', '20', '20'],
  ['furlongs', 'furlongs', 'furlongs'],
  [undefined, '', ''],
])('the unit %s is written as people write it', (unit, english, german) => {
  expect(unitText(unit)).toBe(english)
  language.choose('de')
  expect(unitText(unit)).toBe(german)
})

it('a precision has the unit as people write it', () => {
  const parts = [{ code: 'ROUNDED' as const, step: 0.5, unit: '2X' }]
  expect(statementText(parts, 'x')).toBe('Rounded to multiples of 0.5 m/min.')
})

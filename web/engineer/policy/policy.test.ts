import { describe, expect, it } from 'vitest'
import { language } from '@/language/language.svelte'
import type { StatementPart } from '../api/types'
import { bandsOf, isNumber, numberOf, utcOffsetMinutes } from './policy-parts'
import { statementText } from './statement-text'

describe('what is typed into a policy', () => {
  it.each([
    ['10; 2,5;x; ;5', [2.5, 5, 10]],
    ['', []],
  ])('%j are the bands %j', (written, bands) => {
    expect(bandsOf(written)).toEqual(bands)
  })
  it('is a number or nothing', () => {
    expect([numberOf(' '), numberOf('0.5')]).toEqual([null, 0.5])
  })
})
it('only numbers are rounded', () => {
  expect([isNumber('UInt64'), isNumber('String'), isNumber('Boolean')]).toEqual([true, false, false])
})
it('counts the hours from UTC eastwards', () => {
  const summer = new Date('2026-07-01T12:00:00Z')
  expect(utcOffsetMinutes(summer)).toBe(-summer.getTimezoneOffset() + 0)
})

describe('what the partner is told', () => {
  const hours = { days: ['MONDAY', 'FRIDAY'], from: '06:00', until: '22:00', utcOffsetMinutes: 60 } as const
  const parts = [
    { code: 'AGGREGATED', function: 'MEAN', windowMs: 3_600_000 },
    { code: 'BANDED', bounds: [0, 50.5], unit: 'P1' },
    { code: 'DIGITS', digits: 2 },
    { code: 'RATE', values: 3, periodMs: 3_600_000 },
    { code: 'TIME_STEP', periodMs: 900_000 },
    { code: 'DELAYED', periodMs: 1_500 },
    { code: 'HOURS', hours: { ...hours, days: [...hours.days] } },
    { code: 'WITHHELD' },
  ] satisfies StatementPart[]
  it('is said in both languages', () => {
    expect(statementText(parts, '')).toBe('One value per 1 h: Mean; in bands from 0; 50.5 P1; with 2 significant digits; at most 3 values per 1 h; times in steps of 15 min; 1.5 s late; only Mon, Fri from 06:00 until 22:00; withheld in certain states.')
    language.choose('de')
    expect(statementText(parts, '')).toBe('Ein Wert je 1 h: Mittelwert; in Bändern ab 0; 50,5 P1; mit 2 gültigen Ziffern; höchstens 3 Werte je 1 h; Zeiten in Schritten von 15 min; 1,5 s später; nur Mo, Fr von 06:00 bis 22:00; in bestimmten Zuständen zurückgehalten.')
  })
  it('is taken from the connector where this page does not know all of it', () => {
    expect(statementText(undefined, 'Every change, as it is.')).toBe('Every change, as it is.')
    expect(statementText([{ code: 'WITHHELD' }, { code: 'SHUFFLED' } as never], 'Shuffled.')).toBe('Shuffled.')
  })
})

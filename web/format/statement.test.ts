import { describe, expect, it } from 'vitest'
import type { StatementPart } from './statement'
import { language } from '@/language/language.svelte'
import { sentence, statementText } from './statement'

const parts = [
  { code: 'AGGREGATED', function: 'MEAN', windowMs: 3_600_000 },
  { code: 'ROUNDED', step: 1000, unit: 'PIECE' },
  { code: 'BANDED', bounds: [0, 50.5], unit: 'P1' },
  { code: 'DIGITS', digits: 1 },
  { code: 'INTERVAL', periodMs: 5_400_000 },
  { code: 'RATE', values: 3, periodMs: 3_600_000 },
  { code: 'TIME_STEP', periodMs: 900_000 },
  { code: 'DELAYED', periodMs: 1_500 },
  { code: 'HOURS', hours: { days: ['MONDAY', 'FRIDAY'], from: '06:00', until: '22:00' } },
  { code: 'WITHHELD' },
  { code: 'STATUS_CODES', resolution: 'SEVERITY' },
] satisfies StatementPart[]

describe('what a partner is told of a precision', () => {
  it('is said in both languages, with units as people write them, and in the connector’s own words', () => {
    const english =
      'The mean over time per 1 h; rounded to multiples of 1000 PIECE; in bands from 0, 50.5 P1; with 1 significant digit; at most once per 90 min; at most 3 values per 1 h; times in steps of 15 min; 1500 ms late; only Mon, Fri from 06:00 until 22:00; withheld in certain states; of status codes only good, uncertain or bad.'
    expect(statementText(parts, '')).toBe(
      english.replace('1000 PIECE', '1000 pcs').replace('50.5 P1', '50.5 %'),
    )
    language.choose('de')
    expect(statementText(parts, '')).toBe(
      'Ein Wert je 1 h: zeitlicher Mittelwert; gerundet auf Vielfache von 1000 Stk.; in Bändern ab 0; 50,5 %; mit 1 gültigen Ziffer; höchstens einmal je 90 min; höchstens 3 Werte je 1 h; Zeiten in Schritten von 15 min; 1500 ms später; nur Mo, Fr von 06:00 bis 22:00; in bestimmten Zuständen zurückgehalten; von Statuscodes nur gut, unsicher oder schlecht.',
    )
    expect(sentence(parts, 'en')).toBe(english)
  })
  it('is taken from the connector where this page does not know all of it', () => {
    expect(statementText(undefined, 'Every change, as it is.')).toBe('Every change, as it is.')
    expect(statementText([{ code: 'WITHHELD' }, { code: 'SHUFFLED' } as never], 'Shuffled.')).toBe(
      'Shuffled.',
    )
  })
})

import { describe, expect, it } from 'vitest'
import { language } from '@/language/language.svelte'
import { age, isoDuration, span } from './time'

const NOW = Date.parse('2026-11-21T12:00:00Z')

describe('age', () => {
  it.each([
    [0, 'just now', 'gerade eben'],
    [999, 'just now', 'gerade eben'],
    [12_400, '12 s ago', 'vor 12 s'],
    [59_999, '59 s ago', 'vor 59 s'],
    [60_000, '1 min ago', 'vor 1 min'],
    [47 * 3_600_000, '47 h ago', 'vor 47 h'],
    [72 * 3_600_000, '3 d ago', 'vor 3 d'],
    [-90_000, 'in 1 min 30 s', 'in 1 min 30 s'],
  ])('%d ms', (past, english, german) => {
    expect(age(NOW - past, NOW)).toBe(english)
    language.choose('de')
    expect(age(NOW - past, NOW)).toBe(german)
  })
})

describe('span', () => {
  it.each([
    [20, '20 ms'],
    [1_500, '1.5 s'],
    [60_000, '1 min'],
    [5_400_000, '1 h 30 min'],
    [86_400_000, '1 d'],
    [8 * 3_600_000, '8 h'],
  ])('%d ms', (milliseconds, text) => {
    expect(span(milliseconds)).toBe(text)
  })
})

describe('isoDuration', () => {
  it.each([
    ['PT8H', 28_800_000],
    ['P1DT30M', 88_200_000],
    ['PT1.5S', 1_500],
    ['P2W', 1_209_600_000],
  ])('%s', (text, milliseconds) => {
    expect(isoDuration(text)).toBe(milliseconds)
  })
  it.each(['', 'P', 'PT', 'P1Y', '8H', 'PT1H1H'])('refuses %j', (text) => {
    expect(isoDuration(text)).toBeUndefined()
  })
})

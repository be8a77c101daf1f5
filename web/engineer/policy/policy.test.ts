import { render, screen } from '@testing-library/svelte'
import { describe, expect, it } from 'vitest'
import PolicyForm from './PolicyForm.svelte'
import { bandsOf, holdsNumbers, isNumber, numberOf, utcOffsetMinutes } from './policy-parts'

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
  expect([isNumber('UInt64'), isNumber('String'), isNumber('Boolean')]).toEqual([
    true,
    false,
    false,
  ])
})
it('numbers within other values are rounded', () => {
  const shown = (type: string): boolean => {
    const form = { policy: {}, isNumeric: isNumber(type), holdsNumbers: holdsNumbers(type) }
    const { unmount } = render(PolicyForm, form)
    const isShown = screen.queryByLabelText(/^Rounding step/) !== null
    unmount()
    return isShown
  }
  expect(['Double', 'Variant', 'ExtensionObject', 'String', 'DateTime'].map(shown)).toEqual([
    true,
    true,
    true,
    false,
    false,
  ])
})
it('counts the hours from UTC eastwards', () => {
  const summer = new Date('2026-07-01T12:00:00Z')
  expect(utcOffsetMinutes(summer)).toBe(-summer.getTimezoneOffset() + 0)
})

import { describe, expect, it } from 'vitest'
import { language } from '@/language/language.svelte'
import { severity, statusName, statusText } from './status'
import { moment } from './time'
import { bytesText, valueNumber, valueText } from './value'

describe('valueText', () => {
  it.each([
    [5231.884521, '5,231.884521'],
    ['18446744073709551615', '18446744073709551615'],
    [true, 'true'],
    [null, 'no value'],
    [[1, 2.5], '[1, 2.5]'],
    [{ Type: 9, Body: '12' }, '12'],
    [{ a: 1 }, '{"a":1}'],
  ])('%j', (value, text) => {
    expect(valueText(value)).toBe(text)
  })
  it('writes numbers as the reader does', () => {
    language.choose('de')
    expect(valueText(5231.5)).toBe('5.231,5')
  })
})

describe('valueNumber', () => {
  it.each([
    ['12', 12],
    [{ Type: 9, Body: '12' }, 12],
    [false, 0],
    ['Running', undefined],
    [null, undefined],
  ])('%j', (value, number) => {
    expect(valueNumber(value)).toBe(number)
  })
})

describe('status codes', () => {
  it.each([
    [0, 'Good', 'good'],
    [undefined, 'Good', 'good'],
    [0x00300000, 'GoodClamped', 'good'],
    [0x408f0000, 'UncertainNoCommunicationLastUsableValue', 'uncertain'],
    [0x80320000, 'BadWaitingForInitialData', 'bad'],
    [0x80ab0000, '0x80AB0000', 'bad'],
    ['UncertainInitialValue', 'UncertainInitialValue', 'uncertain'],
    ['BadNotConnected', 'BadNotConnected', 'bad'],
  ])('%s', (status, name, level) => {
    expect(statusName(status)).toBe(name)
    expect(severity(status)).toBe(level)
  })
  it('speaks the reader’s language', () => {
    language.choose('de')
    expect(statusText(0x408f0000)).toBe('Quelle verloren, letzter Wert bleibt')
  })
})

it('bytes are told in their unit', () => {
  expect([0, 1023, 18_234, 3 * 1024 ** 3].map(bytesText)).toEqual([
    '0 B',
    '1,023 B',
    '17.8 KiB',
    '3 GiB',
  ])
})

it('says times in the reader’s zone, and states of operations in words', () => {
  const at = '2026-11-23T13:13:15.978Z'
  expect(valueText(at)).toBe(moment(at))
  expect(valueText({ Type: 13, Body: at })).toBe(moment(at))
  expect(valueText('2026-13-99T99:99:99Z')).toBe('2026-13-99T99:99:99Z')
  expect(valueText('AllowedToStart')).toBe('AllowedToStart')
  expect(valueText('AllowedToStart', 'OPERATION_STATE')).toBe('Ready to start')
  expect(valueText({ Type: 12, Body: 'Running' }, 'OPERATION_STATE')).toBe('Running')
})

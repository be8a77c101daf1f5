import type { BuiltInType } from '../api/types'

const NUMERIC: readonly string[] = [
  'SByte',
  'Byte',
  'Int16',
  'UInt16',
  'Int32',
  'UInt32',
  'Int64',
  'UInt64',
  'Float',
  'Double',
] satisfies BuiltInType[]

/** Types whose values hold values of other types, numbers among them. */
const HOLDING: readonly string[] = [
  'ExtensionObject',
  'DataValue',
  'Variant',
  'DiagnosticInfo',
] satisfies BuiltInType[]

/** Returns whether values of this type are numbers. */
export function isNumber(type: string): boolean {
  return NUMERIC.includes(type)
}

/** Returns whether values of this type are numbers or hold some, which are rounded where they are. */
export function holdsNumbers(type: string): boolean {
  return isNumber(type) || HOLDING.includes(type)
}

/** A number as it is typed; nothing where nothing is. */
export function numberOf(written: string): number | null {
  return written.trim() === '' ? null : Number(written)
}

/** Parses bounds of bands and sorts them; text that is no number is dropped. */
export function bandsOf(written: string): number[] {
  return written
    .split(';')
    .map((part) => part.trim().replace(',', '.'))
    .filter((part) => part !== '' && Number.isFinite(Number(part)))
    .map(Number)
    .toSorted((a, b) => a - b)
}

/** Returns the local offset from UTC in minutes. */
export function utcOffsetMinutes(now = new Date()): number {
  // The platform's function counts the other way round; adding 0 makes of its -0 a 0.
  return -now.getTimezoneOffset() + 0
}

/** Another field of the same request, whose state may withhold this one. */
export interface Sibling {
  name: string
  semantic?: string | null | undefined
  description?: string | null | undefined
}

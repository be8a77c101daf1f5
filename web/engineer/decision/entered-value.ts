import { decimalOf } from '@/format/decimal'
import { fromLocalInput } from '@/format/local-time'
import type { BuiltInType } from '../api/types'

const INTEGERS: readonly string[] = [
  'SByte',
  'Byte',
  'Int16',
  'UInt16',
  'Int32',
  'UInt32',
] satisfies BuiltInType[]

/**
 * Returns a typed text as a JSON value of the field's type, or `undefined` if it is none. 64-bit
 * integers stay text, as JSON numbers are not exact that far. A decimal comma is accepted, and
 * a time is local.
 */
export function enteredValue(type: string, written: string): unknown {
  const text = written.trim()
  if (type === 'String') return written
  if (text === '') return undefined
  if (type === 'Boolean') return text === 'true' ? true : text === 'false' ? false : undefined
  if (type === 'Int64' || type === 'UInt64') return /^-?\d+$/.test(text) ? text : undefined
  if (INTEGERS.includes(type)) return /^-?\d+$/.test(text) ? Number(text) : undefined
  if (type === 'Float' || type === 'Double') {
    return decimalOf(text)
  }
  return type === 'DateTime' ? fromLocalInput(text) : text
}

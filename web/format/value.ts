import { language } from '@/language/language.svelte'
import { words } from '@/language/words'
import { moment } from './time'

const DATE_TIME = /^\d{4}-\d{2}-\d{2}T\d{2}:\d{2}:\d{2}(\.\d+)?(Z|[+-]\d{2}:\d{2})$/

/**
 * Text of a value of a field with this meaning. All digits are shown, as precision is decided by
 * disclosure; times are those of this machine's time zone.
 */
export function valueText(value: unknown, semantic?: string | null): string {
  if (value === null || value === undefined) return words.value.none
  if (typeof value === 'number') return numberText(value)
  if (typeof value === 'boolean') return value ? words.value.yes : words.value.no
  if (typeof value === 'string') {
    if (semantic === 'OPERATION_STATE') return words.operationState[value] ?? value
    return DATE_TIME.test(value) && !Number.isNaN(Date.parse(value)) ? moment(value) : value
  }
  if (Array.isArray(value)) return `[${value.map((each) => valueText(each, semantic)).join(', ')}]`
  const body = variantBody(value)
  return body === undefined ? JSON.stringify(value) : valueText(body.value, semantic)
}

/** A number in the reader's notation. */
export function numberText(value: number): string {
  return new Intl.NumberFormat(language.code, { maximumSignificantDigits: 15 }).format(value)
}

/** The value as a number where it is one, for drawing. 64-bit integers arrive as strings. */
export function valueNumber(value: unknown): number | undefined {
  if (typeof value === 'number') return value
  if (typeof value === 'boolean') return value ? 1 : 0
  if (typeof value === 'string' && /^-?\d+(\.\d+)?([eE][-+]?\d+)?$/.test(value))
    return Number(value)
  const body = value === null || typeof value !== 'object' ? undefined : variantBody(value)
  return body === undefined ? undefined : valueNumber(body.value)
}

/** Text of a number of bytes in the fitting unit. */
export function bytesText(bytes: number): string {
  const units = ['B', 'KiB', 'MiB', 'GiB']
  let size = bytes
  let unit = 0
  while (size >= 1024 && unit < units.length - 1) {
    size /= 1024
    unit += 1
  }
  return `${new Intl.NumberFormat(language.code, { maximumFractionDigits: unit === 0 ? 0 : 1 }).format(size)} ${units[unit] ?? ''}`
}

function variantBody(value: object): { value: unknown } | undefined {
  if ('Body' in value) return { value: value.Body }
  if ('Value' in value) return { value: value.Value }
  if ('value' in value) return { value: value.value }
  return undefined
}

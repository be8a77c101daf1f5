import type { components } from '@/api/connector.generated'
import { de } from '@/language/de'
import { en } from '@/language/en'
import { language, type LanguageCode } from '@/language/language.svelte'
import { weekday } from './time'
import { unitText } from './unit'

export type AggregateFunction = components['schemas']['AggregateFunction']
export type StatementPart = components['schemas']['StatementPart']
export type Weekday = components['schemas']['Weekday']

const CATALOGUES = { de, en }
/** The days of a week, from Monday on. */
export const DAYS: readonly Weekday[] = [
  'MONDAY',
  'TUESDAY',
  'WEDNESDAY',
  'THURSDAY',
  'FRIDAY',
  'SATURDAY',
  'SUNDAY',
]
const SIZES = [
  ['d', 86_400_000],
  ['h', 3_600_000],
  ['min', 60_000],
  ['s', 1_000],
  ['ms', 1],
] as const

/**
 * Text of a precision in the chosen language. The connector's English text is used where parts are
 * missing or unknown.
 */
export function statementText(
  parts: readonly StatementPart[] | undefined,
  english: string,
): string {
  return sentence(parts ?? [], language.code, unitText) ?? english
}

/** The text is the code of a day of the week. */
export function isDay(text: string): text is Weekday {
  return (DAYS as readonly string[]).includes(text)
}

/** Precision as one sentence, in English the connector's own; `undefined` if a part is unknown. */
export function sentence(
  parts: readonly StatementPart[],
  code: LanguageCode,
  unitOf: (unit: string) => string = (unit) => unit,
): string | undefined {
  const said = parts.map((part) => partText(part, code, unitOf))
  if (said.length === 0 || said.includes(undefined)) return undefined
  const text = said.join('; ')
  return `${text.slice(0, 1).toLocaleUpperCase()}${text.slice(1)}.`
}

function partText(
  part: StatementPart,
  code: LanguageCode,
  unitOf: (unit: string) => string,
): string | undefined {
  const { statement, span } = CATALOGUES[code]
  // Digits in groups would be taken for decimals in the other language.
  const number = (value: number): string =>
    new Intl.NumberFormat(code, { maximumSignificantDigits: 15, useGrouping: false }).format(value)
  const period = (ms: number): string => {
    const [name, size] = SIZES.find(([, each]) => ms % each === 0) ?? ['ms', 1]
    return `${number(ms / size)} ${span[name]}`
  }
  const of = (unit: string | null | undefined): string => {
    const written = unit == null ? '' : unitOf(unit)
    return written === '' ? '' : ` ${written}`
  }
  switch (part.code) {
    case 'UNCHANGED':
      return statement.unchanged
    case 'AGGREGATED': {
      const what = statement.aggregates[part.function]
      return what === undefined ? undefined : statement.aggregated(what, period(part.windowMs))
    }
    case 'ROUNDED':
      return statement.rounded(number(part.step) + of(part.unit))
    case 'BANDED':
      return statement.banded(part.bounds.map(number), of(part.unit))
    case 'DIGITS':
      return statement.digits(part.digits)
    case 'INTERVAL':
      return statement.interval(period(part.periodMs))
    case 'RATE':
      return statement.rate(part.values, period(part.periodMs))
    case 'TIME_STEP':
      return statement.timeStep(period(part.periodMs))
    case 'DELAYED':
      return statement.delayed(period(part.periodMs))
    case 'HOURS':
      return statement.hours(
        part.hours.days.map((day) => weekday(DAYS.indexOf(day), 'short', code)).join(', '),
        part.hours.from,
        part.hours.until,
      )
    case 'WITHHELD':
      return statement.withheld
    case 'STATUS_CODES':
      return statement.statusCodes[part.resolution]
    default:
      return undefined
  }
}

import { span, weekday } from '@/format/time'
import { numberText } from '@/format/value'
import type { StatementPart } from '../api/types'
import { texts } from '../language/texts'

const DAYS = ['MONDAY', 'TUESDAY', 'WEDNESDAY', 'THURSDAY', 'FRIDAY', 'SATURDAY', 'SUNDAY']

/**
 * A precision in the reader's words, as one sentence. What the connector says in English is taken where it has no parts,
 * or one that this page does not know.
 */
export function statementText(parts: readonly StatementPart[] | undefined, english: string): string {
  const said = (parts ?? []).map(partText)
  if (said.length === 0 || said.includes(undefined)) return english
  const text = said.join('; ')
  return `${text.slice(0, 1).toLocaleUpperCase()}${text.slice(1)}.`
}

function partText(part: StatementPart): string | undefined {
  const { statement } = texts
  switch (part.code) {
    case 'UNCHANGED':
      return statement.unchanged
    case 'AGGREGATED':
      return statement.aggregated(texts.policy.aggregates[part.function] ?? part.function, span(part.windowMs))
    case 'ROUNDED':
      return statement.rounded(withUnit(numberText(part.step), part.unit))
    case 'BANDED':
      return statement.banded(withUnit(part.bounds.map(numberText).join('; '), part.unit))
    case 'DIGITS':
      return statement.digits(part.digits)
    case 'INTERVAL':
      return statement.interval(span(part.periodMs))
    case 'RATE':
      return statement.rate(part.values, span(part.periodMs))
    case 'TIME_STEP':
      return statement.timeStep(span(part.periodMs))
    case 'DELAYED':
      return statement.delayed(span(part.periodMs))
    case 'HOURS':
      return statement.hours(part.hours.days.map((day) => weekday(DAYS.indexOf(day), 'short')).join(', '), part.hours.from, part.hours.until)
    case 'WITHHELD':
      return statement.withheld
    default:
      return undefined
  }
}

function withUnit(text: string, unit: string | null | undefined): string {
  return unit == null ? text : `${text} ${unit}`
}

import type { AggregateFunction, StatementPart } from '@/format/statement'
import { isDay, sentence } from '@/format/statement'
import { unitText } from '@/format/unit'
import { en } from '@/language/en'
import { language } from '@/language/language.svelte'
import type { DisclosureStatement } from '../api/types'

/**
 * Text of a precision in the reader's language. The factory's sentence may contain more than its
 * members. It is translated only if the members yield that very sentence, and shown unchanged
 * otherwise.
 */
export function precisionText(
  statement: DisclosureStatement | null | undefined,
  unit: string | null | undefined,
): string {
  const parts = partsOf(statement ?? {}, unit)
  const said = sentence(parts, language.code, unitText) ?? ''
  return statement == null || sentence(parts, 'en') === statement.description
    ? said
    : statement.description
}

function partsOf(
  statement: Partial<DisclosureStatement>,
  unit: string | null | undefined,
): StatementPart[] {
  const parts: StatementPart[] = []
  const aggregate = statement.aggregate && aggregateOf(statement.aggregate.function)
  if (statement.aggregate && aggregate)
    parts.push({
      code: 'AGGREGATED',
      function: aggregate,
      windowMs: statement.aggregate.windowMs,
    })
  if (statement.roundingStep != null)
    parts.push({ code: 'ROUNDED', step: statement.roundingStep, unit })
  if (statement.bandList && statement.bandList.length > 0)
    parts.push({ code: 'BANDED', bounds: statement.bandList, unit })
  if (statement.significantDigits != null)
    parts.push({ code: 'DIGITS', digits: statement.significantDigits })
  if (statement.minimumIntervalMs != null)
    parts.push({ code: 'INTERVAL', periodMs: statement.minimumIntervalMs })
  for (const limit of statement.rateLimitList ?? []) parts.push({ code: 'RATE', ...limit })
  if (statement.timeStepMs != null)
    parts.push({ code: 'TIME_STEP', periodMs: statement.timeStepMs })
  if (statement.delayMs != null) parts.push({ code: 'DELAYED', periodMs: statement.delayMs })
  for (const { dayList, from, until } of statement.hoursList ?? [])
    parts.push({ code: 'HOURS', hours: { days: dayList.filter(isDay), from, until } })
  if (statement.isWithheldInStates === true) parts.push({ code: 'WITHHELD' })
  if (statement.statusCodes != null)
    parts.push({ code: 'STATUS_CODES', resolution: statement.statusCodes })
  return parts.length === 0 ? [{ code: 'UNCHANGED' }] : parts
}

/** Code of an aggregate with an English name; `undefined` if the name is unknown. */
function aggregateOf(words: string): AggregateFunction | undefined {
  const known = Object.entries(en.statement.aggregates).find(([, name]) => name === words)
  return known?.[0] as AggregateFunction | undefined
}

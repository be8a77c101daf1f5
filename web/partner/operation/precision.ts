import type { AggregateFunction, StatementPart } from '@/format/statement'
import { isDay, sentence } from '@/format/statement'
import { en } from '@/language/en'
import { language } from '@/language/language.svelte'
import type { DisclosureStatement } from '../api/types'

/**
 * Text of a precision in the reader's language. The factory's sentence may contain more than its
 * members. It is translated only if the members yield that very sentence, and shown unchanged
 * otherwise.
 */
export function precisionText(
  told: DisclosureStatement | null | undefined,
  unit: string | null | undefined,
): string {
  const parts = partsOf(told ?? {}, unit)
  const said = sentence(parts, language.code) ?? ''
  return told == null || sentence(parts, 'en') === told.description ? said : told.description
}

function partsOf(
  told: Partial<DisclosureStatement>,
  unit: string | null | undefined,
): StatementPart[] {
  const parts: StatementPart[] = []
  const aggregate = told.aggregate && aggregateOf(told.aggregate.function)
  if (told.aggregate && aggregate)
    parts.push({
      code: 'AGGREGATED',
      function: aggregate,
      windowMs: told.aggregate.windowMs,
    })
  if (told.roundingStep != null) parts.push({ code: 'ROUNDED', step: told.roundingStep, unit })
  if (told.bandList && told.bandList.length > 0)
    parts.push({ code: 'BANDED', bounds: told.bandList, unit })
  if (told.significantDigits != null) parts.push({ code: 'DIGITS', digits: told.significantDigits })
  if (told.minimumIntervalMs != null)
    parts.push({ code: 'INTERVAL', periodMs: told.minimumIntervalMs })
  for (const limit of told.rateLimitList ?? []) parts.push({ code: 'RATE', ...limit })
  if (told.timeStepMs != null) parts.push({ code: 'TIME_STEP', periodMs: told.timeStepMs })
  if (told.delayMs != null) parts.push({ code: 'DELAYED', periodMs: told.delayMs })
  for (const { dayList, from, until } of told.hoursList ?? [])
    parts.push({ code: 'HOURS', hours: { days: dayList.filter(isDay), from, until } })
  if (told.isWithheldInStates === true) parts.push({ code: 'WITHHELD' })
  if (told.statusCodes != null) parts.push({ code: 'STATUS_CODES', resolution: told.statusCodes })
  return parts.length === 0 ? [{ code: 'UNCHANGED' }] : parts
}

/** Code of an aggregate with an English name; `undefined` if the name is unknown. */
function aggregateOf(words: string): AggregateFunction | undefined {
  const known = Object.entries(en.statement.aggregates).find(([, name]) => name === words)
  return known?.[0] as AggregateFunction | undefined
}

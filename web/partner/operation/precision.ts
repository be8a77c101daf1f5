import { sentence, type StatementPart } from '@/format/statement'
import { en } from '@/language/en'
import { language } from '@/language/language.svelte'
import type { DisclosureStatement } from '../api/types'

/**
 * What a factory tells of a precision, in the reader's language.
 *
 * Its sentence may say more than its members do, or be in words of its own. So it is said anew
 * only where the members make that very sentence, and left as it came otherwise.
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
  if (told.aggregate)
    parts.push({
      code: 'AGGREGATED',
      function: aggregateOf(told.aggregate.function),
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
    parts.push({ code: 'HOURS', hours: { days: dayList, from, until } })
  if (told.isWithheldInStates === true) parts.push({ code: 'WITHHELD' })
  return parts.length === 0 ? [{ code: 'UNCHANGED' }] : parts
}

/** The code of an aggregate that is told in English words; of an unknown one, its words. */
function aggregateOf(words: string): string {
  return Object.entries(en.statement.aggregates).find(([, known]) => known === words)?.[0] ?? words
}

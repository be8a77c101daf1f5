import { numberText } from '@/format/value'
import type {
  AllianceView,
  Cap,
  CapView,
  FieldKey,
  FieldLeak,
  LeakBudget,
  LeakWarning,
  VariableKey,
  VariableLeak,
} from '../api/types'
import { fieldAddress } from '../inbox/address'
import { texts } from '../language/texts'

/** Rates are drawn from once a day to ten times a second, in equal steps for equal factors. */
const RATE_LEAST = 1 / 24
const RATE_MOST = 36_000
/** Information of a value of a bounded built-in type, in bits. */
const BITS_MOST = 64
/** Largest information, in bits, that is shown as a number of distinct values. */
const BITS_PICTURED_MAX = 20

export function releasedPerHour({ measured }: Pick<FieldLeak, 'measured'>): number | undefined {
  return measured.hours > 0 ? measured.released / measured.hours : undefined
}

/** Position of a rate on its scale, 0 to 1; `undefined` without a limit. */
export function rateReach(perHour: number | null | undefined): number | undefined {
  if (perHour == null) return undefined
  return within(Math.log(perHour / RATE_LEAST) / Math.log(RATE_MOST / RATE_LEAST))
}

export function bitsReach(bits: number | null | undefined): number | undefined {
  return bits == null ? undefined : within(bits / BITS_MOST)
}

export function rateText(perHour: number | null | undefined): string {
  return perHour == null ? texts.leaks.noLimit : texts.leaks.perHour(figure(perHour))
}

/** Text of a precision: one of a number of values, or bits where the number is too large. */
export function precisionText(bits: number | null | undefined): string {
  if (bits == null) return texts.leaks.noBound
  return bits <= BITS_PICTURED_MAX
    ? texts.leaks.oneOf(figure(Math.round(2 ** bits)))
    : texts.leaks.bits(figure(bits))
}

/** Three digits are plenty for a bound. */
export function figure(value: number): string {
  return numberText(value >= 100 ? Math.round(value) : Number(value.toPrecision(3)))
}

/** Text of bits per hour, or that there is no limit. */
export function bitRateText(bits: number | null | undefined): string {
  return bits == null ? texts.leaks.noLimit : texts.leaks.bits(figure(bits))
}

export const variableText = ({ sourceId, nodeId }: VariableKey): string => `${sourceId} · ${nodeId}`

/** Sorts variables by information; those without a bound come first. */
export function byBits(variables: readonly VariableLeak[]): VariableLeak[] {
  const bits = ({ bitsPerHourMax }: VariableLeak): number => bitsPerHourMax ?? Infinity
  return [...variables].sort((one, other) =>
    bits(one) === bits(other) ? 0 : bits(other) - bits(one),
  )
}

/** Lists the variables of budgets, each once. */
export function variablesOf(budgets: readonly LeakBudget[]): VariableKey[] {
  const known = new Map<string, VariableKey>()
  for (const { variable } of budgets.flatMap(({ variables }) => variables))
    known.set(variableText(variable), variable)
  return [...known.values()]
}

/** Share of a cap that is used, 0 to 1; `undefined` without a bound. */
export function capReach({
  bitsPerHour,
  bitsPerHourMax,
}: Pick<CapView, 'bitsPerHour' | 'bitsPerHourMax'>): number | undefined {
  if (bitsPerHour == null) return undefined
  return bitsPerHourMax > 0 ? within(bitsPerHour / bitsPerHourMax) : 1
}

/** Text of those whom a cap counts together. */
export function subjectText(subject: Cap['subject'], alliances: readonly AllianceView[]): string {
  if ('partner' in subject) return `${texts.caps.partner}: ${subject.partner}`
  const known = alliances.find(({ id }) => id === subject.allianceId)
  return `${texts.caps.alliance}: ${known?.name ?? subject.allianceId}`
}

export const nameOf = (key: FieldKey): string => fieldAddress(key).join('/')

/** Sorts fields: those named in a warning first, then by information. */
export function byWeight(
  fields: readonly FieldLeak[],
  warnings: readonly LeakWarning[],
): { field: FieldLeak; isWarned: boolean }[] {
  const warned = new Set(warnings.flatMap((warning) => warning.fields.map(nameOf)))
  const weight = (field: FieldLeak): number =>
    (field.valuesPerHourMax ?? RATE_MOST) * (field.bitsPerValue ?? BITS_MOST)
  return fields
    .map((field) => ({ field, isWarned: warned.has(nameOf(field.key)), weight: weight(field) }))
    .sort(
      (one, other) => Number(other.isWarned) - Number(one.isWarned) || other.weight - one.weight,
    )
}

function within(share: number): number {
  return Math.min(1, Math.max(0, share))
}

import type { DynamicDataRequest, UpdateFrequencyUnit } from '../api/types'

export const CADENCE_UNITS: readonly UpdateFrequencyUnit[] = [
  'SECOND',
  'MINUTE',
  'HOUR',
  'DAY',
  'WEEK',
]

const LENGTHS_MS: Record<UpdateFrequencyUnit, number> = {
  SECOND: 1_000,
  MINUTE: 60_000,
  HOUR: 3_600_000,
  DAY: 86_400_000,
  WEEK: 604_800_000,
}

/** Requested period between reports in ms; `undefined` means on change. */
export function cadenceMs(
  request: Pick<DynamicDataRequest, 'updateFrequency' | 'updateFrequencyUnit'>,
): number | undefined {
  const { updateFrequency: times, updateFrequencyUnit: unit } = request
  return times && unit ? LENGTHS_MS[unit] / times : undefined
}

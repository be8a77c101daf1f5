import type { Tone } from '@/design/tone'
import { statusText } from '@/format/status'
import { moment, span } from '@/format/time'
import type { HealthCounts, MappingHealth, MappingStatus } from '../api/types'
import { texts } from '../language/texts'
import { placeOf } from '../mapping-status/status-text'

/** The worst first. */
export const HEALTHS = [
  'RESTING',
  'FAILING',
  'WAITING',
  'DOUBTFUL',
  'CLOCK_AHEAD',
  'WELL',
] as const satisfies readonly MappingHealth[]

const MEMBERS = {
  RESTING: 'resting',
  FAILING: 'failing',
  WAITING: 'waiting',
  DOUBTFUL: 'doubtful',
  CLOCK_AHEAD: 'clockAhead',
  WELL: 'well',
} as const satisfies Record<MappingHealth, keyof HealthCounts>
const TONES: Record<MappingHealth, Tone> = {
  RESTING: 'bad',
  FAILING: 'bad',
  WAITING: 'warn',
  DOUBTFUL: 'warn',
  CLOCK_AHEAD: 'warn',
  WELL: 'good',
}

export const countOf = (counts: HealthCounts, health: MappingHealth): number =>
  counts[MEMBERS[health]]
export const healthTone = (health: MappingHealth): Tone => TONES[health]

/** Counts mappings that produce no useful values until they are repaired. */
export const brokenOf = (counts: HealthCounts): number => counts.resting + counts.failing

/** Text of the problem of a mapping. */
export function whyOf(
  health: MappingHealth,
  { circuit, lastFault, inputs, lastCandidate }: MappingStatus,
): string | undefined {
  const fault = lastFault
    ? `${texts.valueFaults[lastFault.kind]} (${placeOf(lastFault)})`
    : undefined
  switch (health) {
    case 'RESTING': {
      const rest =
        circuit.state === 'resting'
          ? texts.mappingStatus.pausedUntil(moment(circuit.until))
          : texts.mappingStatus.trying
      return fault ? `${fault} ${rest}` : rest
    }
    case 'FAILING':
      return fault
    case 'WAITING':
      return texts.survey.noValue(
        inputs
          .filter((input) => input.value == null)
          .map((input) => input.name)
          .join(', '),
      )
    case 'DOUBTFUL':
      return statusText(lastCandidate?.status)
    case 'CLOCK_AHEAD':
      return texts.mappingStatus.clockAhead(
        span(Math.max(...inputs.map((input) => input.clockAheadMs ?? 0))),
      )
    case 'WELL':
      return undefined
  }
}

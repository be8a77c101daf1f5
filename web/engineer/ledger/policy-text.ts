import { span } from '@/format/time'
import { numberText } from '@/format/value'
import type { DisclosurePolicy } from '../api/types'
import { texts } from '../language/texts'

/** Text of a disclosure policy on one line. */
export function policyText(policy: DisclosurePolicy): string {
  const parts: string[] = []
  if (policy.roundingStep != null)
    parts.push(`${texts.decision.roundingStep} ${numberText(policy.roundingStep)}`)
  if (policy.bands?.length)
    parts.push(`${texts.decision.bands} ${policy.bands.map(numberText).join('; ')}`)
  if (policy.minimumIntervalMs != null)
    parts.push(`${texts.decision.minimumInterval} ${span(policy.minimumIntervalMs)}`)
  if (policy.timeStepMs != null) parts.push(`${texts.decision.timeStep} ${span(policy.timeStepMs)}`)
  if (policy.delayMs != null) parts.push(`${texts.decision.delay} ${span(policy.delayMs)}`)
  if (policy.significantDigits != null)
    parts.push(`${texts.policy.significantDigits} ${policy.significantDigits}`)
  if (policy.aggregate)
    parts.push(
      `${texts.policy.aggregates[policy.aggregate.function] ?? policy.aggregate.function} ${span(policy.aggregate.windowMs)}`,
    )
  for (const limit of policy.rateLimits ?? [])
    parts.push(texts.policy.rateText(limit.values, span(limit.periodMs)))
  for (const hours of [
    ...(policy.workingHours ? [policy.workingHours] : []),
    ...(policy.furtherHours ?? []),
  ])
    parts.push(`${hours.from}–${hours.until}`)
  for (const condition of policy.withholdWhile ?? [])
    parts.push(
      texts.policy.withholdText(
        condition.field ?? texts.policy.ownValue,
        condition.states.map(String).join(', '),
      ),
    )
  if (policy.statusCodes != null && policy.statusCodes !== 'COMMON')
    parts.push(
      `${texts.policy.statusCodes}: ${texts.policy.statusResolutions[policy.statusCodes] ?? policy.statusCodes}`,
    )
  return parts.length === 0 ? texts.decision.everyChange : parts.join(' · ')
}

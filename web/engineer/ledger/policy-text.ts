import { span } from '@/format/time'
import { numberText } from '@/format/value'
import type { Disclosure } from '../api/types'
import { texts } from '../language/texts'

/** A disclosure policy on one line, in the reader's words. */
export function policyText(policy: Disclosure): string {
  const parts: string[] = []
  if (policy.roundingStep != null) parts.push(`${texts.decision.roundingStep} ${numberText(policy.roundingStep)}`)
  if (policy.bands?.length) parts.push(`${texts.decision.bands} ${policy.bands.map(numberText).join('; ')}`)
  if (policy.minimumIntervalMs != null) parts.push(`${texts.decision.minimumInterval} ${span(policy.minimumIntervalMs)}`)
  if (policy.timeStepMs != null) parts.push(`${texts.decision.timeStep} ${span(policy.timeStepMs)}`)
  if (policy.delayMs != null) parts.push(`${texts.decision.delay} ${span(policy.delayMs)}`)
  return parts.length === 0 ? texts.decision.everyChange : parts.join(' · ')
}

import { numberText } from '@/format/value'
import type { SourceStatus } from '../api/types'
import { texts } from '../language/texts'

type Limits = NonNullable<SourceStatus['limits']>

/** The limits that a server states of itself. */
export function limitTexts(limits: Limits): string {
  const stated = Object.entries(texts.servers.limit).flatMap(([name, label]) => {
    const limit = limits[name as keyof Limits]
    return limit == null ? [] : [`${numberText(limit)} ${label}`]
  })
  return stated.join(', ') || texts.servers.noLimits
}

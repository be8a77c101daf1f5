import { moment } from '@/format/time'
import type { LedgerEntry } from '../api/types'
import { texts } from '../language/texts'

type Retention = Extract<LedgerEntry, { kind: 'RETENTION' }>

/** What retention took from the chain, and by which rule. */
export function retentionText(entry: Retention): string {
  const count = (entry.emptied ?? []).reduce(
    (sum, { firstSequence, lastSequence }) => sum + lastSequence - firstSequence + 1,
    0,
  )
  const taken = [
    ...(count > 0 ? [texts.ledger.emptiedReports(count)] : []),
    ...(entry.removedThrough == null ? [] : [texts.ledger.removedThrough(entry.removedThrough)]),
  ]
  if (entry.rule === 'FORMER_VERSION') return [texts.ledger.formerRetention, ...taken].join(' · ')
  return [...taken, texts.ledger.olderThan(moment(entry.before))].join(' · ')
}

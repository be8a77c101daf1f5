import { words } from '@/language/words'
import type { AuditFact } from '../api/types'
import { texts } from '../language/texts'

/** What a fact of an entry says: what it is about, and how it was and is. */
export function factText({ kind, former, present }: AuditFact): string {
  const value = (text: string): string => valueText(kind, text)
  if (former == null) return `${texts.audit.fact[kind]}: ${value(present ?? '')}`
  const since = present == null ? texts.audit.ended : value(present)
  return `${texts.audit.fact[kind]}: ${value(former)} → ${since}`
}

function valueText(kind: AuditFact['kind'], text: string): string {
  const known: Partial<Record<AuditFact['kind'], Record<string, string>>> = {
    ROLE: words.session.role,
    STATE: { ...words.mappingState, ...texts.audit.state },
    PASSWORD: texts.audit.state,
    SECOND_FACTOR: texts.audit.state,
    SIGNING_KEY: texts.audit.state,
  }
  return known[kind]?.[kind === 'ROLE' ? text.toLowerCase() : text] ?? text
}

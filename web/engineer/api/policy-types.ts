/** Policies with names, and the rules that decide by themselves. */
import type { Disclosure, FieldKey, MappingState, ValueSource } from './types'

export interface Versioned {
  id: string
  version: number
  changedBy: string
  changedAt: string
}

export interface NamedPolicy {
  name: string
  disclosure: Disclosure
  isRetired: boolean
}
export type PolicyView = NamedPolicy &
  Versioned & { statement: string; fieldCount: number; recipients: string[] }

export type RuleAction = 'ACCEPT' | 'REFUSE' | 'PREFILL'
export interface Rule {
  name: string
  isEnabled: boolean
  when: {
    partners: string[]
    dataTypes: string[]
    semantics: string[]
    units: string[]
    namePattern?: string
  }
  action: RuleAction
  valueSource?: ValueSource
  disclosure: Disclosure
  policyId?: string
  reason?: string
}
export type RuleView = Rule & Versioned

export interface RulePreview {
  count: number
  wouldDecideCount: number
  items: {
    key: FieldKey
    mappingState: MappingState
    wouldDecide: boolean
    offer: { action: RuleAction; statement: string }
  }[]
}

export interface RuleDecision {
  id: string
  field: FieldKey
  action: string
  rules: { id: string; version: number }[]
  decidedAt: string
  undoneBy?: string | null
  undoneAt?: string | null
}

export interface RecipientView {
  recipient: string
  fieldCount: number
  set?: { version: number; policyId?: string | null; changedBy: string; changedAt: string } | null
}

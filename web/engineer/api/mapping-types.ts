/** Mappings: what is suggested for one, its versions, its trials, and templates of many. */
import type { components } from './generated'
import type { DataValue, Diagnostic, FieldKey, Mapping } from './types'

type Schemas = components['schemas']

/** A variable that might be meant by a field, with the reasons and the mapping that taking it would make. */
export interface Suggestion {
  sourceId: string
  nodeId: string
  /** Where it stands, as people read it. */
  place: string
  /** 20 to 100. */
  score: number
  reasons: { kind: string; points: number; text: string }[]
  description?: string | null
  valueType?: string | null
  unit?: string | null
  value?: DataValue | null
  mapping: Mapping
}

export interface Suggestions {
  items: Suggestion[]
  /** How far each server was listed. */
  sources: {
    sourceId: string
    variables: number
    isComplete: boolean
    listedAt?: string | null
    problem?: string | null
  }[]
}

/** One difference between two mappings, as a JSON pointer with what was and what is there. */
export interface MappingChange {
  pointer: string
  before?: unknown
  after?: unknown
}

export interface MappingVersion {
  version: number
  author?: string | null
  note?: string | null
  publishedAt: string
  isCurrent: boolean
  mapping: Mapping
  changes: MappingChange[]
}

export interface TracedValue {
  type?: string
  value: unknown
  status: number
  statusName?: string
  sourceTimestamp?: string
}

export interface TraceRun {
  at: string
  input?: string
  value?: TracedValue
  steps: { step: number; function: string; value?: TracedValue; fault?: { message: string } }[]
  candidate?: TracedValue
  fault?: { message: string }
}

/** A mapping run over recorded values. */
export interface Trial {
  diagnostics: Diagnostic[]
  runs: TraceRun[]
  runsTotal: number
  values: number
  from?: string | null
  to?: string | null
  unrecorded: string[]
}

/** How a mapping is doing. */
export interface MappingStatus {
  target: FieldKey
  received: number
  yielded: number
  repeated: number
  late: number
  clockSteps: number
  /** Values that a script could not keep up with. */
  superseded: number
  faults: number
  lastFault?: MappingFault | null
  lastYieldedAt?: string | null
  lastCandidate?: TracedValue | null
  spentUs: number
  inputs: InputStatus[]
  /** Whether its scripts are run: one that does not keep to its budget rests for a while. */
  circuit: { state: 'closed' | 'trying' } | { state: 'resting'; until: string }
}

export type MappingHealth = Schemas['MappingHealth']
export type HealthCounts = Schemas['HealthCounts']

/** All mappings in use: how many are doing how, and the worst of them. */
export interface MappingSurvey {
  counts: HealthCounts
  items: { health: MappingHealth; status: MappingStatus }[]
}

/** What went wrong, and where. */
export interface MappingFault {
  at: string
  message: string
  /** The function's place in the chain; absent for the end of the chain. */
  step?: number | null
  line?: number | null
  column?: number | null
}

/** How an input of a mapping is doing. */
export interface InputStatus {
  name: string
  value?: TracedValue | null
  receivedAt?: string | null
  /** How far the source's clock is ahead of ours, in milliseconds. */
  clockAheadMs?: number | null
}

/** A mapping on trial beside the published one. */
export interface Shadow {
  mapping: Mapping
  author: string
  startedAt: string
  changes: MappingChange[]
  status?: MappingStatus | null
  published?: MappingStatus | null
}

export interface ImportOutcome {
  isDryRun: boolean
  published: number
  proposed: number
  unchanged: number
  templates: number
  items: { key: FieldKey; outcome: string }[]
}

export interface MappingTemplate {
  templateId: string
  name?: string | null
  description?: string | null
  parameters: { name: string; description?: string | null; default?: string | null }[]
  mapping: unknown
  author?: string
  changedAt?: string
}

/** What the connector's API says, as this UI uses it. */

export interface FieldKey {
  operationNetworkId: string
  operationId: string
  dynamicDataRequestId: string
  fieldName: string
}

export type MappingState = 'PENDING' | 'MAPPED' | 'REFUSED'
export type ValueSource = 'MAPPING' | 'MANUAL' | 'EXTERNAL'

export interface LinkStatus {
  state: string
  since?: string | null
  lastAcceptedAt?: string | null
  lastReceiptedAt?: string | null
  backlog?: number
  reason?: string | null
}

export interface SourceStatus {
  sourceId: string
  state: string
  since: string
  problem?: { kind: string; message: string; remedy: string } | null
  inputs: number
  live: number
  notLive: { input: number; nodeId: string; status: number; reason: string }[]
  lastChangeAt?: string | null
  lastSignOfLifeAt?: string | null
  changes: number
  sessions: number
  clockAheadMs?: number | null
  endpoint?: { endpointUrl: string; securityPolicy: string; messageSecurity: string; serverName: string; applicationUri: string } | null
}

export interface SpoolStatus {
  waiting: number
  sent: number
  bytes: number
  oldestAt?: string | null
}

export interface Status {
  factoryId: string
  version: string
  startedAt: string
  link: LinkStatus
  twin: { endpointUrl?: string | null }
  spool: SpoolStatus
  sources: SourceStatus[]
}

export interface DataValue {
  value: unknown
  status?: number | string | null
  sourceTimestamp?: string | null
}

export interface Disclosure {
  roundingStep?: number | null
  bands?: number[]
  minimumIntervalMs?: number | null
  timeStepMs?: number | null
  delayMs?: number | null
  workingHours?: unknown
}

export interface MappingInput {
  name: string
  sourceId: string
  nodeId: string
  valueType?: string | null
  unit?: string | null
  triggers?: boolean
}

export interface Step {
  function: string
  [parameter: string]: unknown
}

export interface Mapping {
  inputs: MappingInput[]
  steps: Step[]
}

export interface Field {
  key: FieldKey
  name: string
  type: string
  typeName?: string
  unit?: string | null
  semantic?: string | null
  description?: string | null
  mappingState: MappingState
  valueSource?: ValueSource | null
  disclosure?: Disclosure | null
  disclosureStatement?: string | null
  decisionReason?: string | null
  decidedBy?: string | null
  decisionTime?: string | null
  value?: DataValue | null
  mapping?: Mapping | null
}

export interface InboxRequest {
  key: Omit<FieldKey, 'fieldName'>
  operation: { operationId: string; name?: string | null; operationType: string; plannedStart?: string | null; plannedEnd?: string | null }
  requesterId: string
  recipientList: string[]
  purpose: string
  description?: string | null
  updateIntervalMs?: number | null
  validUntil?: string | null
  receivedAt?: string | null
  fields: Field[]
}

export interface Page<T> {
  items: T[]
  nextCursor?: string | null
}

export interface Decision {
  mappingState: MappingState
  valueSource?: ValueSource
  mapping?: Mapping
  disclosure?: Disclosure
  reason?: string
}

export interface Diagnostic {
  severity: 'hint' | 'warning' | 'error'
  /** JSON pointer into the mapping, as `/steps/2/factor`. */
  pointer: string
  code: string
  message: string
  line?: number | null
  column?: number | null
}

export interface PreviewStep {
  function: string
  value?: DataValue | null
  message?: string | null
}

export interface Preview {
  inputs: (DataValue & { name: string })[]
  /** What each function made of its value, as far as the chain got. */
  steps: PreviewStep[]
  candidate?: DataValue | null
  disclosed?: DataValue | null
  /** When it would leave, where policy holds it back. */
  disclosedAt?: string | null
  /** The NetworkMessage as the partner would receive it, byte for byte. */
  message?: string | null
  /** The precision in words, as the partner reads it. */
  statement?: string | null
  diagnostics: Diagnostic[]
}

export interface BrowsedNode {
  nodeId: string
  browseName: string
  displayName: string
  description?: string
  nodeClass: string
  typeDefinition?: { nodeId: string; name: string }
  dataType?: { nodeId: string; name: string }
  builtInType?: string | null
  valueRank?: number
  unit?: { displayName: string; code?: string }
  range?: [number, number]
  isWritable: boolean
  hasChildren: boolean
}

export type SecurityChoice = { choice: 'strongest' } | { choice: 'none' } | { choice: 'exactly'; policy: string; mode: string }

export type Identity = { kind: 'anonymous' } | { kind: 'userName'; userName: string; password?: string } | { kind: 'certificate'; certificatePath: string; privateKeyPath: string }

export interface SourceConfig {
  sourceId: string
  name?: string
  endpointUrl: string
  security?: SecurityChoice
  identity?: Identity
  publishingIntervalMs?: number
  silenceMsMax?: number
}

export interface LedgerEntry {
  sequence: number
  at: string
  recipientId: string
  /** CONSENT, QUEUED, SENT, RECEIPTED, COALESCED, EXPIRED or PURGED. */
  kind: string
  operationNetworkId?: string | null
  operationId?: string | null
  dynamicDataRequestId?: string | null
  fieldName?: string | null
  /** For a report: what left, by field. */
  value?: Record<string, unknown> | null
  /** For a consent: the policy. */
  policy?: Disclosure | null
  dataSetWriterId?: number | null
  epoch?: number | null
  firstSequence?: number | null
  lastSequence?: number | null
  hash: string
}

export interface Verification {
  valid: boolean
  entries: number
  valuesCompared: number
  valuesEmptied: number
  checkpoints: number
  fault?: string | null
}

export interface DeadLetter {
  id: string
  at: string
  direction: string
  messageId?: string | null
  subject: string
  code: string
  reason: string
}

export interface Comment {
  dynamicDataRequestId?: string | null
  fieldName?: string | null
  authorId: string
  isOwn: boolean
  text: string
  writtenAt: string
}

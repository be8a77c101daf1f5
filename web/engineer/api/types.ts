/**
 * What the connector's API says, as this UI uses it: the generated types, with those members made precise that the
 * description leaves open because they are addresses, wire contracts of their own or values of any type.
 */
import type { components } from './generated'

type Schemas = components['schemas']

export interface RequestKey {
  operationNetworkId: string
  operationId: string
  dynamicDataRequestId: string
}

export interface FieldKey extends RequestKey {
  fieldName: string
}

export interface Page<T> {
  items: T[]
  nextCursor?: string | null
}

export type MappingState = 'PENDING' | 'MAPPED' | 'REFUSED'
export type ValueSource = 'MAPPING' | 'MANUAL' | 'EXTERNAL'

export type Role = Schemas['Role']
export interface User {
  userName: string
  role: Role
}
/** How a field is coarsened. The parts below `workingHours` are younger than the others and may be absent in an older connector. */
export type Disclosure = Partial<Schemas['DisclosurePolicy']> & {
  significantDigits?: number | null
  aggregate?: { function: 'LAST' | 'MAXIMUM' | 'MINIMUM' | 'SUM' | 'MEAN'; windowMs: number } | null
  rateLimits?: { values: number; periodMs: number }[]
  furtherHours?: WorkingHours[]
  withholdWhile?: { field?: string | null; states: (string | number | boolean)[] }[]
}
/** A part of a precision as the partner is told it: a code with its parameters. */
export type StatementPart = Schemas['StatementPart']
export type WorkingHours = Schemas['WorkingHours']
export type DataValue = Omit<Schemas['ShownValue'], 'value' | 'status'> & {
  value: unknown
  status?: string | number | null
}
export type MappingInput = Omit<Schemas['MappingInput'], 'valueType'> & {
  valueType?: string | null
}

/** A function of a mapping: the editor shows any of them by its catalogue. */
export interface Step {
  function: string
  [parameter: string]: unknown
}

export interface Mapping {
  inputs: MappingInput[]
  steps: Step[]
}

export type Field = Omit<
  Schemas['FieldView'],
  | 'key'
  | 'mappingState'
  | 'valueSource'
  | 'mapping'
  | 'value'
  | 'disclosure'
  | 'effectiveDisclosure'
  | 'grounds'
  | 'offer'
  | 'disclosureParts'
> & {
  key: FieldKey
  mappingState: MappingState
  valueSource?: ValueSource | null
  disclosure?: Disclosure | null
  mapping?: Mapping | null
  value?: DataValue | null
  /** What holds: the strictest of the field's own policy, a named one and those of its recipients. */
  effectiveDisclosure?: Disclosure | null
  grounds?: { policyId?: string | null; rules?: { id: string; version: number }[] } | null
  /** What standing rules offer for an undecided field. */
  offer?: {
    action: string
    rules: { id: string; version: number; name: string }[]
    disclosure: Disclosure
    statement: string
    valueSource?: ValueSource | null
    mapping?: Mapping | null
    reason?: string | null
  } | null
  isWithheld?: boolean
  disclosureParts?: StatementPart[]
}

export interface Operation {
  operationId: string
  name?: string | null
  operationType: string
  plannedStart?: string | null
  plannedEnd?: string | null
}

export type InboxRequest = Omit<Schemas['RequestView'], 'key' | 'operation' | 'fields'> & {
  key: RequestKey
  operation: Operation
  fields: Field[]
  openSince?: string | null
  isOverdue?: boolean
  hasEnded?: boolean
}

/** Which requests, and which page of them. */
export interface InboxQuery {
  cursor?: string
  limit?: number
  state?: MappingState
  operationNetworkId?: string
  search?: string
  isOverdue?: boolean
}
export type InboxTotals = Schemas['InboxTotals']
/** A page of the inbox: `count` requests are meant; the totals are over all, whatever the query. */
export type InboxAnswer = Page<InboxRequest> & { count: number; totals: InboxTotals }

export interface Decision {
  policyId?: string
  mappingState: MappingState
  valueSource?: ValueSource
  mapping?: Mapping
  disclosure?: Disclosure
  reason?: string
}

export type Diagnostic = Schemas['MappingDiagnostic']
export type PreviewStep = Omit<Schemas['StepView'], 'value'> & { value?: DataValue | null }
export type Preview = Omit<
  Schemas['Preview'],
  'inputs' | 'steps' | 'candidate' | 'disclosed' | 'effects' | 'warnings' | 'statementParts'
> & {
  inputs: (DataValue & { name: string })[]
  steps: PreviewStep[]
  candidate?: DataValue | null
  disclosed?: DataValue | null
  effectiveDisclosure?: Disclosure | null
  statementParts?: StatementPart[]
  effects?: { kind: string; text: string; parts?: StatementPart[]; isFelt: boolean }[]
  /** What partners could conclude if this were decided. */
  warnings?: LeakWarning[]
  isWithheld?: boolean
}

export interface LinkStatus {
  state: string
  since?: string | null
  lastAcceptedAt?: string | null
  lastReceiptedAt?: string | null
  backlog?: number
  reason?: string | null
}

/** A connector with this one's credential. */
export interface LeaseParty {
  instanceId: string
  host: string
  since: string
  lastHeardAt: string
}

/** Whether this connector may speak for its factory. */
export interface LeaseStatus {
  state: 'ASKING' | 'HELD' | 'REFUSED'
  since: string
  host: string
  leaseNumber?: number | null
  holder?: LeaseParty | null
  contender?: LeaseParty | null
}

export interface SpoolStatus {
  waiting: number
  sent: number
  bytes: number
  oldestAt?: string | null
}

export type SourceStatus = Schemas['SourceStatus']

export type Status = Omit<Schemas['Status'], 'link' | 'lease' | 'twin' | 'spool' | 'sources'> & {
  link: LinkStatus
  lease: LeaseStatus
  twin: { endpointUrl?: string | null }
  spool: SpoolStatus
  sources: SourceStatus[]
}

export type BrowsedNode = Schemas['BrowsedNode']
/** What a search in a whole server finds, and how complete the list it searches is. */
export interface Found {
  items: BrowsedNode[]
  total: number
  isComplete: boolean
  listedAt?: string | null
}
export type SecurityChoice = Schemas['SecurityChoice']

export type Identity =
  | { kind: 'anonymous' }
  | { kind: 'userName'; userName: string; password?: string }
  | { kind: 'certificate'; certificatePath: string; privateKeyPath: string }

export type SourceConfig = Omit<Schemas['SourceConfig'], 'identity'> & { identity?: Identity }
export type Source = SourceStatus & SourceConfig
export type Certificate = Schemas['PeerCertificate']

/** The certificate of an OPC UA client that has knocked at the twin. */
export type ClientCertificate = Schemas['ClientCertificateView']
/** The certificate that the twin shows its clients. */
export type ApplicationCertificate = Schemas['ApplicationCertificateView']
/** An authority that issues certificates of clients. */
export type ClientAuthority = Schemas['ClientAuthorityView']
/** What an authority has revoked. */
export type ClientRevocationList = Schemas['ClientRevocationListView']

export interface NewClientCertificate {
  kind: 'CERTIFICATE' | 'ISSUER' | 'REVOCATION_LIST'
  /** PEM, or DER in base64. */
  content: string
}

export type LedgerEntry = Pick<
  Schemas['EntryView'],
  'sequence' | 'at' | 'recipientId' | 'kind' | 'hash' | 'leftInMessage' | 'sentAt' | 'deliveredAt'
> & {
  /** What the partner was told of each field's precision. */
  precision?: Record<string, string>
  precisionParts?: Record<string, StatementPart[]>
  operationNetworkId?: string | null
  operationId?: string | null
  dynamicDataRequestId?: string | null
  fieldName?: string | null
  /** For a report: what left, by field. */
  value?: Record<string, unknown> | null
  /** For a consent: the policy, what was decided, and by whom. */
  policy?: Disclosure | null
  mappingState?: MappingState | null
  decidedBy?: string | null
  dataSetWriterId?: number | null
  epoch?: number | null
  firstSequence?: number | null
  lastSequence?: number | null
  /** For an ended consent: the last number that had arrived. */
  lastDeliveredSequence?: number | null
}

/** What one partner learns in sum, and what it can conclude. */
export type PartnerLeaks = Omit<Schemas['PartnerLeaks'], 'fields' | 'warnings'> & {
  fields: FieldLeak[]
  warnings: LeakWarning[]
}
/** The same in short. */
export type PartnerSummary = Schemas['PartnerSummary']
export type FieldLeak = Omit<Schemas['FieldLeak'], 'key' | 'statementParts'> & {
  key: FieldKey
  statementParts?: StatementPart[]
}
export type LeakWarning = Omit<Schemas['LeakWarning'], 'fields'> & { fields: FieldKey[] }

export type Setting = Schemas['Setting']
export type Checkpoint = Schemas['CheckpointView']
export type Verification = Schemas['VerificationView']
export type DeadLetter = Schemas['DeadLetter']
export type Comment = Schemas['StoredComment']
export type NewComment = Schemas['NewComment']
export type NetworkSummary = Schemas['NetworkSummary']

/** An operation of today as people at the machine see it. */
export type OperatorOperation = Omit<Schemas['OperatorOperation'], 'standing' | 'fields'> & {
  standing: Omit<Schemas['Standing'], 'problem'> & {
    problem?: { text: string; since: string; toldBy: string } | null
  }
  fields: OperatorField[]
}
export type OperatorField = Omit<Schemas['OperatorField'], 'key' | 'entered' | 'value'> & {
  key: FieldKey
  entered?: unknown
  value?: DataValue | null
}
export type EntryOutcome = Omit<Schemas['EntryResult'], 'fields' | 'result'> & {
  result: 'TAKEN' | 'REPEATED' | 'REFUSED'
}

/** Receipt of an ended consent. */
export interface Revocation {
  revocationId: string
  revokedAt: string
  revokedBy?: string | null
  reason?: string | null
  cause: string
  fields: { field: FieldKey; consentVersion: number }[]
  writers: {
    dataSetWriterId: number
    request: RequestKey
    recipientList: string[]
    lastQueuedSequence?: number | null
    lastSentSequence?: number | null
    lastDeliveredSequence?: number | null
  }[]
  signature: string
  arrivedSince: number
  open: number
}

/** Whose consent is to end. */
export interface RevocationBody {
  fields?: FieldKey[]
  operationNetworkId?: string
  operationId?: string
  dynamicDataRequestId?: string
  recipientId?: string
  mappingState?: 'PENDING' | 'REFUSED'
  reason?: string
}

export * from './mapping-types'
export * from './policy-types'

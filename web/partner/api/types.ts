/** What the platform's API says, as this UI uses it. */

export interface FieldKey {
  operationNetworkId: string
  operationId: string
  dynamicDataRequestId: string
  fieldName: string
}

export interface Page<T> {
  items: T[]
  nextCursor?: string | null
}

export interface Organisation {
  organisationId: string
  name: string
}

export interface Factory {
  factoryId: string
  name?: string | null
  organisationId?: string | null
  lastSeenAt?: string | null
  enrolledAt?: string | null
  state?: string | null
}

export interface Collaboration {
  collaborationId: string
  name?: string | null
  memberList?: string[]
}

export interface NetworkSummary {
  operationNetworkId: string
  collaborationId: string
  name?: string | null
  revision: number
  updatedAt?: string | null
  withdrawn?: boolean
}

export interface ReportField {
  name: string
  type: number | string
  unit?: string | null
  semantic?: string | null
  description?: string | null
}

export interface DynamicDataRequest {
  dynamicDataRequestId: string
  dynamicDataRequestPublisherId?: string
  requesterId: string
  recipientList: string[]
  purpose: string
  validFrom?: string
  validUntil?: string
  description?: string
  bufferId?: string
  updateFrequency?: number
  updateFrequencyUnit?: UpdateFrequencyUnit
  reportDataFormat: { reportName: string; reportFieldList: ReportField[] }
}

export type UpdateFrequencyUnit = 'SECOND' | 'MINUTE' | 'HOUR' | 'DAY' | 'WEEK'

export interface Operation {
  operationId: string
  operationType: string
  name?: string | null
  description?: string | null
  stub?: boolean
  owningFactoryId?: string | null
  plannedStart?: string | null
  plannedEnd?: string | null
  plannedQuantity?: number | null
  quantityUnit?: string | null
  equipmentRequirementList?: { equipmentRequirementId: string; equipmentType: string; quantity?: number; assetId?: string }[]
  dynamicDataRequestList?: DynamicDataRequest[]
}

export interface OperationNetwork {
  operationNetworkId: string
  name?: string | null
  description?: string | null
  operationList: Operation[]
  operationRelationList?: {
    operationRelationId: string
    relationType: string
    predecessorOperationId: string
    successorOperationId: string
    conditionList?: { conditionId: string; conditionKind: string; time?: string; duration?: string }[]
  }[]
}

export interface Fault {
  pointer: string
  code: string
  message: string
}

export interface Part {
  factoryId: string
  revision: number
  state: 'SENT' | 'ACCEPTED' | 'UNCHANGED' | 'REJECTED'
  faultList?: Fault[] | null
  answeredAt?: string | null
}

export interface OperationProgress {
  operationId: string
  owningFactoryId?: string | null
  state?: string | null
  quantity?: number | null
  plannedQuantity?: number | null
  percentComplete?: number | null
  actualStart?: string | null
  actualEnd?: string | null
  expectedEnd?: string | null
  lastReportAt?: string | null
}

export interface DisclosureStatement {
  description: string
  roundingStep?: number | null
  minimumIntervalMs?: number | null
  timeStepMs?: number | null
  delayMs?: number | null
}

export interface FieldState {
  key: FieldKey
  mappingState: string
  reason?: string | null
  disclosure?: DisclosureStatement | null
  value?: unknown
  status?: number | string | null
  sourceTimestamp?: string | null
  reportTimestamp?: string | null
  receivedAt?: string | null
  sequence?: number | null
}

export interface NetworkView {
  collaborationId?: string
  network: OperationNetwork
  revision: number
  parts: Part[]
  operations: OperationProgress[]
  fields: FieldState[]
}

export interface Report {
  sequence: number
  reportTimestamp?: string | null
  receivedAt: string
  fields: Record<string, { value: unknown; status?: number | string | null }>
}

export interface Writer {
  dataSetWriterId: number
  epoch: number
  throughSequence: number
  missing: number[]
  gaps: { firstSequence: number; lastSequence: number; cause: string }[]
  received: number
  duplicates: number
}

export interface EnrolmentToken {
  token: string
  expiresAt: string
}

export interface PlatformStatus {
  version?: string
  startedAt?: string
}

export interface DeadLetter {
  id: string
  at: string
  reason: string
  subject?: string | null
  factoryId?: string | null
}

/**
 * What the platform's API says, as this UI uses it: the generated types, with those members made precise that the
 * description leaves open because they are wire contracts of their own or values of any type.
 */
import type { components } from './generated'

type Schemas = components['schemas']

export type FieldKey = Schemas['FieldKey']
export type Organisation = Schemas['Organisation']
export type NewFactory = Schemas['NewFactory']
export type Factory = Schemas['Factory']
export type Collaboration = Schemas['Collaboration']
export type NetworkSummary = Schemas['NetworkSummary']
export type OperationProgress = Schemas['OperationProgress']
export type Writer = Schemas['WriterView']
export type FactoryLease = Schemas['LeaseView']
export type LeaseParty = Schemas['Party']
export type EnrolmentToken = Schemas['TokenView']
export type PlatformStatus = Schemas['Status']
export type DeadLetter = Schemas['DeadLetterView']
export type Comment = Schemas['CommentEntry']
export type NewComment = Schemas['AddComment']

export interface Page<T> {
  items: T[]
  nextCursor?: string | null
}

export interface Fault {
  pointer: string
  code: string
  message: string
}

export type Part = Omit<Schemas['PartView'], 'faultList'> & { faultList: Fault[] }

export interface DisclosureStatement {
  description: string
  roundingStep?: number | null
  significantDigits?: number | null
  /** Which aggregate, in English words. */
  aggregate?: { function: string; windowMs: number } | null
  minimumIntervalMs?: number | null
  rateLimitList?: { values: number; periodMs: number }[]
  timeStepMs?: number | null
  delayMs?: number | null
  bandList?: number[]
  hoursList?: { dayList: string[]; from: string; until: string; utcOffsetMinutes?: number }[]
  isWithheldInStates?: boolean
}

export type FieldState = Omit<Schemas['FieldView'], 'value' | 'disclosure'> & {
  value?: unknown
  disclosure?: DisclosureStatement | null
}

export type NetworkView = Omit<Schemas['NetworkView'], 'network' | 'parts' | 'fields'> & {
  network: OperationNetwork
  parts: Part[]
  fields: FieldState[]
}

export type Report = Omit<Schemas['Report'], 'fields'> & {
  fields: Record<
    string,
    { value: unknown; status?: string | null; sourceTimestamp?: string | null }
  >
}

export interface ReportField {
  name: string
  type: number | string
  unit?: string | null
  semantic?: string | null
  description?: string | null
}

export type UpdateFrequencyUnit = 'SECOND' | 'MINUTE' | 'HOUR' | 'DAY' | 'WEEK'

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
  equipmentRequirementList?: {
    equipmentRequirementId: string
    equipmentType: string
    quantity?: number
    assetId?: string
  }[]
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
    conditionList?: {
      conditionId: string
      conditionKind: string
      time?: string
      duration?: string
    }[]
  }[]
}

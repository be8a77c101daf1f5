import { isoDuration, shortMoment, span } from '@/format/time'
import { words } from '@/language/words'
import type { components } from '@/api/platform.generated'

type Schemas = components['schemas']
type Operation = Schemas['Operation']
type OperationProgress = Schemas['OperationProgress']
type OperationRelation = Schemas['OperationRelation']
type RelationCondition = Schemas['RelationCondition']

/** Operation as the graph and the timeline draw it. */
export interface GraphOperation {
  operationId: string
  name: string
  operationType: Operation['operationType']
  owner?: string | undefined
  isStub: boolean
  state?: OperationProgress['state']
  quantity?: number | undefined
  plannedQuantity?: number | undefined
  quantityUnit?: string | undefined
  percentComplete?: number | undefined
  plannedStart?: string | undefined
  plannedEnd?: string | undefined
  actualStart?: string | undefined
  actualEnd?: string | undefined
  expectedEnd?: string | undefined
  lastReportAt?: string | undefined
  fields: { mapped: number; pending: number; refused: number }
}

/** Relation as the graph draws it, with the conditions it has or none. */
export type GraphRelation = OperationRelation & Pick<Required<OperationRelation>, 'conditionList'>

/** A condition in a sentence: "gap of at most 8 h". */
export function conditionText(condition: RelationCondition): string {
  const length = condition.duration ? isoDuration(condition.duration) : undefined
  const what =
    length !== undefined ? span(length) : condition.time ? shortMoment(condition.time) : '?'
  return words.condition[condition.conditionKind]?.(what) ?? condition.conditionKind
}

/** Progress of an operation, 0 to 1: the reported share, else from its quantities. */
export function completion(operation: GraphOperation): number | undefined {
  if (operation.percentComplete !== undefined)
    return Math.min(1, Math.max(0, operation.percentComplete / 100))
  if (operation.quantity === undefined || !operation.plannedQuantity) return undefined
  return Math.min(1, Math.max(0, operation.quantity / operation.plannedQuantity))
}

import { isoDuration, shortMoment, span } from '@/format/time'
import { words } from '@/language/words'
import type { components } from '@/api/platform.generated'

type Schemas = components['schemas']
type Operation = Schemas['Operation']
type OperationProgress = Schemas['OperationProgress']
type OperationRelation = Schemas['OperationRelation']
type RelationCondition = Schemas['RelationCondition']

/** How an operation stands against its plan at a moment. */
export interface Standing {
  /** Time by which its end is late, in ms: reported, expected by the factory, or past the plan without an end. */
  lateMs?: number
  /** Whether that is only what the plan and the clock say: the factory reported neither an end nor an expected one. */
  isOverdue?: boolean
  /** Operation whose lateness leaves too little time before this one's planned start. */
  heldUpBy?: string
}

/** Operation as the graph and the timeline draw it. */
export interface GraphOperation {
  operationId: string
  name: string
  operationType: Operation['operationType']
  owner?: string | undefined
  isStub: boolean
  state?: OperationProgress['state']
  /** Nobody reported the state; it is concluded from quantities and times. */
  isStateInferred?: boolean | undefined
  /** How it stands against the plan; absent while it is in time. */
  standing?: Standing | undefined
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

/** State in words, and whether it was reported. */
export function stateText(operation: GraphOperation): string {
  const state = words.operationState[operation.state ?? 'unknown'] ?? operation.state ?? ''
  return operation.isStateInferred === true && operation.state != null
    ? words.standing.inferred(state)
    : state
}

/** How late an operation is in words; `undefined` while it is in time. */
export function standingText({ standing }: GraphOperation): string | undefined {
  if (standing?.lateMs === undefined) return undefined
  const late = span(standing.lateMs)
  return standing.isOverdue === true ? words.standing.overdue(late) : words.timeline.late(late)
}

/** Progress of an operation, 0 to 1: the reported share, else from its quantities. */
export function completion(operation: GraphOperation): number | undefined {
  if (operation.percentComplete !== undefined)
    return Math.min(1, Math.max(0, operation.percentComplete / 100))
  if (operation.quantity === undefined || !operation.plannedQuantity) return undefined
  return Math.min(1, Math.max(0, operation.quantity / operation.plannedQuantity))
}

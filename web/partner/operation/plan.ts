import { fromLocalInput, toLocalInput } from '@/format/local-time'
import type { Operation, OperationNetwork } from '../api/types'

/** Plan of an operation as a form shows it: times are local. */
export interface PlanDraft {
  start: string
  end: string
  quantity: number | undefined
  unit: string
}

export function planOf(operation: Operation): PlanDraft {
  return {
    start: operation.plannedStart ? toLocalInput(operation.plannedStart) : '',
    end: operation.plannedEnd ? toLocalInput(operation.plannedEnd) : '',
    quantity: operation.plannedQuantity ?? undefined,
    unit: operation.quantityUnit ?? '',
  }
}

/** True where the operation would have to end before it starts. */
export function isInverted({ start, end }: PlanDraft): boolean {
  const [from, until] = [fromLocalInput(start), fromLocalInput(end)]
  return from !== undefined && until !== undefined && until <= from
}

/** The network with this plan of one operation; what was not changed stays to the millisecond. */
export function withPlan(
  network: OperationNetwork,
  operationId: string,
  plan: PlanDraft,
): OperationNetwork {
  const operationList = network.operationList.map((operation) => {
    if (operation.operationId !== operationId) return operation
    const before = planOf(operation)
    const { plannedStart, plannedEnd, plannedQuantity: _, quantityUnit: __, ...others } = operation
    const start = plan.start === before.start ? plannedStart : fromLocalInput(plan.start)
    const end = plan.end === before.end ? plannedEnd : fromLocalInput(plan.end)
    const unit = plan.unit.trim()
    return {
      ...others,
      ...(start == null ? {} : { plannedStart: start }),
      ...(end == null ? {} : { plannedEnd: end }),
      ...(plan.quantity === undefined ? {} : { plannedQuantity: plan.quantity }),
      ...(unit === '' ? {} : { quantityUnit: unit }),
    } as Operation
  })
  return { ...network, operationList }
}

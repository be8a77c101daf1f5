import { valueNumber } from '@/format/value'
import type { GraphOperation, GraphRelation } from '@/network/model'
import type { FieldView, NetworkView } from '../api/types'

/** Operations of a network with their progress. */
export function graphOperations(view: NetworkView): GraphOperation[] {
  return view.network.operationList.map((operation) => {
    const progress = view.operations.find((each) => each.operationId === operation.operationId)
    const fields = view.fields.filter((field) => field.key.operationId === operation.operationId)
    const requests = operation.dynamicDataRequestList ?? []
    const asked = requests.reduce(
      (sum, request) => sum + request.reportDataFormat.reportFieldList.length,
      0,
    )
    const mapped = fields.filter((field) => field.mappingState === 'MAPPED').length
    const refused = fields.filter((field) => field.mappingState === 'REFUSED').length
    return {
      operationId: operation.operationId,
      name: operation.name ?? operation.operationId,
      operationType: operation.operationType,
      owner: operation.owningFactoryId ?? progress?.owningFactoryId ?? undefined,
      isStub: operation.stub === true,
      state: progress?.state ?? undefined,
      isStateInferred: progress?.isStateInferred,
      quantity: progress?.quantity ?? undefined,
      plannedQuantity: operation.plannedQuantity ?? progress?.plannedQuantity ?? undefined,
      quantityUnit: operation.quantityUnit ?? undefined,
      percentComplete: progress?.percentComplete ?? undefined,
      plannedStart: operation.plannedStart ?? undefined,
      plannedEnd: operation.plannedEnd ?? undefined,
      actualStart: progress?.actualStart ?? meaning(view, operation.operationId, 'ACTUAL_START'),
      actualEnd: progress?.actualEnd ?? meaning(view, operation.operationId, 'ACTUAL_END'),
      expectedEnd: progress?.expectedEnd ?? meaning(view, operation.operationId, 'EXPECTED_END'),
      lastReportAt: progress?.lastReportAt ?? newest(fields),
      fields: { mapped, refused, pending: Math.max(0, asked - mapped - refused) },
    }
  })
}

export function graphRelations(view: NetworkView): GraphRelation[] {
  return (view.network.operationRelationList ?? []).map((relation) => ({
    ...relation,
    conditionList: relation.conditionList ?? [],
  }))
}

/** Share of all planned work that is done, in percent; undefined where nothing is planned. */
export function overall(view: NetworkView): number | undefined {
  const shares = graphOperations(view)
    .map(
      (operation) =>
        operation.percentComplete ??
        (operation.plannedQuantity
          ? ((operation.quantity ?? 0) / operation.plannedQuantity) * 100
          : undefined),
    )
    .filter((share) => share !== undefined)
  return shares.length === 0
    ? undefined
    : shares.reduce((sum, share) => sum + Math.min(100, share), 0) / shares.length
}

/** Reported time of a field with this semantic. */
function meaning(view: NetworkView, operationId: string, semantic: string): string | undefined {
  const operation = view.network.operationList.find((each) => each.operationId === operationId)
  for (const request of operation?.dynamicDataRequestList ?? []) {
    const named = request.reportDataFormat.reportFieldList.find(
      (field) => field.semantic === semantic,
    )
    if (named === undefined) continue
    const field = view.fields.find(
      (each) =>
        each.key.operationId === operationId &&
        each.key.dynamicDataRequestId === request.dynamicDataRequestId &&
        each.key.fieldName === named.name,
    )
    if (
      typeof field?.value === 'string' &&
      !Number.isNaN(Date.parse(field.value)) &&
      valueNumber(field.value) === undefined
    )
      return field.value
  }
  return undefined
}

function newest(fields: readonly FieldView[]): string | undefined {
  return fields
    .map((field) => field.receivedAt ?? undefined)
    .filter((at) => at !== undefined)
    .sort()
    .at(-1)
}

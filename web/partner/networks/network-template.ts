import type { Collaboration, OperationNetwork, OperationRelation } from '../api/types'
import { texts } from '../language/texts'

const HOURS_OF_AN_OPERATION = 8
const HOUR_MS = 3_600_000

/**
 * A network to begin with: each factory of the collaboration makes something, one after the other, from the next full
 * hour on. It is valid as it is; what is made, how many and when is for the planner to change.
 */
export function networkTemplate(
  { collaborationId, name, factories }: Collaboration,
  taken: readonly string[],
  now: number,
): OperationNetwork {
  const begin = Math.ceil(now / HOUR_MS) * HOUR_MS
  const at = (hours: number): string =>
    new Date(begin + hours * HOUR_MS).toISOString().replace('.000', '')
  const operationId = (index: number): string => `Make${index + 1}`
  return {
    operationNetworkId: freeId(collaborationId, taken),
    name,
    operationList: factories.map((owningFactoryId, index) => ({
      operationId: operationId(index),
      operationType: 'PRODUCTION',
      name: texts.networks.templateOperation(owningFactoryId),
      owningFactoryId,
      productId: `PRODUCT-${index + 1}`,
      plannedQuantity: 100,
      quantityUnit: 'PIECE',
      plannedStart: at(index * HOURS_OF_AN_OPERATION),
      plannedEnd: at((index + 1) * HOURS_OF_AN_OPERATION),
    })),
    operationRelationList: factories.slice(1).map((_, index): OperationRelation => ({
      operationRelationId: `Then${index + 1}`,
      relationType: 'FINISH_TO_START',
      predecessorOperationId: operationId(index),
      successorOperationId: operationId(index + 1),
    })),
  }
}

/** The id of the collaboration with the first number that no network has. */
function freeId(collaborationId: string, taken: readonly string[]): string {
  let number = 1
  while (taken.includes(`${collaborationId}-${number}`)) number += 1
  return `${collaborationId}-${number}`
}

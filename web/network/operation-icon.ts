import type { IconName } from '@/design/icons'

export function operationIcon(operationType: string): IconName {
  return operationType === 'TRANSPORTATION'
    ? 'truck'
    : operationType === 'INSPECTION'
      ? 'search'
      : 'factory'
}

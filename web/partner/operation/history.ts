import { valueNumber } from '@/format/value'
import type { Resource } from '@/transport/resource.svelte'
import { platform } from '../api/client'
import type { LiveData } from '../api/types'

/** Members of a report that a curve needs. */
export interface Point {
  at: string
  fields: Record<string, unknown>
}

const KEPT = 300

/** The newest reports about a request, oldest first. */
export async function newestReports(
  networkId: string,
  dynamicDataRequestId: string,
  signal: AbortSignal,
): Promise<Point[]> {
  const { items } = await platform.get('/reports', {
    query: { network: networkId, request: dynamicDataRequestId, newest: true, limit: KEPT },
    signal,
  })
  return items.map((report) => ({
    at: report.reportTimestamp ?? report.receivedAt,
    fields: Object.fromEntries(
      Object.entries(report.fields).map(([name, field]) => [name, field.value]),
    ),
  }))
}

/** Adds the newer values of an event to the history of their request. */
export function takeReport(
  points: Resource<Point[]>,
  request: { operationNetworkId: string; operationId: string; dynamicDataRequestId: string },
  { fields, ...answered }: LiveData<'value'>,
): void {
  if (
    answered.operationNetworkId !== request.operationNetworkId ||
    answered.operationId !== request.operationId ||
    answered.dynamicDataRequestId !== request.dynamicDataRequestId
  )
    return
  const at = fields[0]?.reportTimestamp ?? fields[0]?.receivedAt
  if (at === undefined) return
  const point = {
    at,
    fields: Object.fromEntries(fields.map((field) => [field.key.fieldName, field.value])),
  }
  points.amendByEvent((known) => [
    ...known.filter((other) => other.at !== at).slice(1 - KEPT),
    point,
  ])
}

/** Reported numbers of a field, oldest first. */
export function series(
  points: readonly Point[],
  fieldName: string,
): { at: number; value: number }[] {
  return points
    .map((point) => ({ at: Date.parse(point.at), value: valueNumber(point.fields[fieldName]) }))
    .filter(
      (point): point is { at: number; value: number } =>
        point.value !== undefined && !Number.isNaN(point.at),
    )
    .sort((a, b) => a.at - b.at)
}

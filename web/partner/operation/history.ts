import { valueNumber } from '@/format/value'
import type { Report } from '../api/types'

/** The numbers that reports said about a field, oldest first. */
export function series(reports: readonly Report[], fieldName: string): { at: number; value: number }[] {
  return reports
    .map((report) => ({ at: Date.parse(report.reportTimestamp ?? report.receivedAt), value: valueNumber(report.fields[fieldName]?.value) }))
    .filter((point): point is { at: number; value: number } => point.value !== undefined && !Number.isNaN(point.at))
    .sort((a, b) => a.at - b.at)
}

import { words } from '@/language/words'

export type Severity = 'good' | 'uncertain' | 'bad'

/**
 * OPC UA status codes that a field or an input can have, by the upper half of the code (OPC
 * 10000-6, annex A).
 */
const NAMES: Record<number, string> = {
  0x0000: 'Good',
  0x0030: 'GoodClamped',
  0x002e: 'GoodCompletesAsynchronously',
  0x8032: 'BadWaitingForInitialData',
  0x803d: 'BadNotSupported',
  0x808a: 'BadNotConnected',
  0x8005: 'BadCommunicationError',
  0x8031: 'BadNoCommunication',
  0x8034: 'BadNodeIdUnknown',
  0x8089: 'BadConfigurationError',
  0x8074: 'BadTypeMismatch',
  0x803c: 'BadOutOfRange',
  0x808b: 'BadDeviceFailure',
  0x808c: 'BadSensorFailure',
  0x808d: 'BadOutOfService',
  0x4092: 'UncertainInitialValue',
  0x4090: 'UncertainLastUsableValue',
  0x408f: 'UncertainNoCommunicationLastUsableValue',
}

/** Standard name of a status given as code or name; the code itself if it is not in the list. */
export function statusName(status: number | string | null | undefined): string {
  if (status === null || status === undefined) return 'Good'
  if (typeof status === 'string') return status
  return NAMES[status >>> 16] ?? `0x${(status >>> 0).toString(16).toUpperCase().padStart(8, '0')}`
}

/** Good, uncertain or bad. */
export function severity(status: number | string | null | undefined): Severity {
  if (status === null || status === undefined) return 'good'
  if (typeof status === 'number')
    return (['good', 'uncertain', 'bad', 'bad'] as const)[status >>> 30] ?? 'bad'
  if (status.startsWith('Uncertain')) return 'uncertain'
  return status.startsWith('Bad') ? 'bad' : 'good'
}

/** Text of a status in the chosen language. */
export function statusText(status: number | string | null | undefined): string {
  const name = statusName(status)
  return words.status[name] ?? name
}

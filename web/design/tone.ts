import type { Severity } from '@/format/status'
import type { IconName } from './icons'

/** Meaning of a colour. A word or an icon always goes with it. */
export type Tone = 'good' | 'warn' | 'bad' | 'info' | 'violet' | 'accent' | 'idle'

export function mappingTone(state: string): Tone {
  return state === 'MAPPED' ? 'good' : state === 'REFUSED' ? 'bad' : 'warn'
}

export function mappingIcon(state: string): IconName {
  return state === 'MAPPED' ? 'check' : state === 'REFUSED' ? 'cross' : 'clock'
}

export function severityTone(severity: Severity): Tone {
  return severity === 'good' ? 'good' : severity === 'uncertain' ? 'warn' : 'bad'
}

export function operationTone(state: string | null | undefined): Tone {
  switch (state) {
    case 'Running':
      return 'accent'
    case 'Ended':
      return 'good'
    case 'Interrupted':
      return 'warn'
    case 'Aborted':
      return 'bad'
    case 'AllowedToStart':
      return 'info'
    default:
      return 'idle'
  }
}

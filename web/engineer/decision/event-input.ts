import type { EventSelection, EventValue, MappingInput } from '../api/types'
import { inputName } from './input-name'

/** Server object, which all events of a server come to. */
export const SERVER_OBJECT = 'i=2253'

/** Values that events may make, as people choose them. */
export const EVENT_KINDS = [
  'activeConditions',
  'activeSeverity',
  'activeMessage',
  'message',
  'severity',
  'field',
] as const
export type EventKind = (typeof EVENT_KINDS)[number]

const VALUE_TYPES: Partial<Record<EventKind, NonNullable<MappingInput['valueType']>>> = {
  activeConditions: 'UInt32',
  activeSeverity: 'UInt16',
  activeMessage: 'LocalizedText',
  message: 'LocalizedText',
  severity: 'UInt16',
}

/** Entered selection of events. */
export interface EventForm {
  sourceId: string
  kind: EventKind
  /** Names from the event to its field, one per line. */
  path: string
  severityMin: number | null
  notifier: string
  sourceNode: string
}

export function eventValue(kind: EventKind, path: string): EventValue {
  switch (kind) {
    case 'message':
      return { kind: 'field', path: ['Message'] }
    case 'severity':
      return { kind: 'field', path: ['Severity'] }
    case 'field':
      return { kind: 'field', path: lines(path) }
    default:
      return { kind }
  }
}

/** Choice of people that a value was made by. */
export function eventKind(value: EventValue): EventKind {
  if (value.kind !== 'field') return value.kind
  if (value.path.length !== 1) return 'field'
  return value.path[0] === 'Message'
    ? 'message'
    : value.path[0] === 'Severity'
      ? 'severity'
      : 'field'
}

/** Input without its name. */
export function eventInput(form: EventForm): Omit<MappingInput, 'name'> {
  const sourceNode = form.sourceNode.trim()
  const events: EventSelection = {
    value: eventValue(form.kind, form.path),
    ...(form.severityMin === null ? {} : { severityMin: form.severityMin }),
    ...(sourceNode === '' ? {} : { sourceNode }),
  }
  const valueType = VALUE_TYPES[form.kind]
  return {
    sourceId: form.sourceId,
    nodeId: form.notifier.trim() || SERVER_OBJECT,
    ...(valueType === undefined ? {} : { valueType }),
    monitor: { events },
  }
}

/** Adds what events make, unless it is among the inputs. */
export function takeEvents(inputs: MappingInput[], input: Omit<MappingInput, 'name'>): void {
  if (inputs.some((other) => identityOf(other) === identityOf(input))) return
  inputs.push({ name: inputName(eventName(input), inputs), ...input })
}

/** Name of what events make, for people and scripts. */
function eventName({ monitor }: Omit<MappingInput, 'name'>): string {
  const value = monitor?.events?.value
  return (value?.kind === 'field' ? value.path.at(-1) : value?.kind) ?? 'event'
}

/** Text that differs between inputs that take different values. */
export function identityOf(input: Omit<MappingInput, 'name'>): string {
  return JSON.stringify([input.sourceId, input.nodeId, input.monitor?.events ?? null])
}

function lines(text: string): string[] {
  return text
    .split('\n')
    .map((line) => line.trim())
    .filter((line) => line !== '')
}

import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, expect, it, vi } from 'vitest'
import { serve } from '../../vitest.server'
import type { FieldView, InboxRequest, MappingInput } from '../api/types'
import { Draft } from './draft.svelte'
import {
  eventInput,
  eventKind,
  EVENT_KINDS,
  eventValue,
  takeEvents,
  type EventForm,
} from './event-input'
import Inputs from './Inputs.svelte'
import { PreviewRun } from './preview.svelte'

const key = {
  operationNetworkId: 'n',
  operationId: 'o',
  dynamicDataRequestId: 'r',
  fieldName: 'alarms',
}
const field = { key, name: 'alarms', type: 'UInt32', valueRank: -1 } as unknown as FieldView
const form: EventForm = {
  sourceId: 's',
  kind: 'activeConditions',
  path: '',
  severityMin: null,
  notifier: '',
  sourceNode: ' ',
}

afterEach(() => {
  vi.unstubAllGlobals()
})

it('knows each value again that it makes', () => {
  for (const kind of EVENT_KINDS) expect(eventKind(eventValue(kind, 'A\nB'))).toBe(kind)
})

it('leaves out what was not entered, and takes the whole server where no object is named', () => {
  expect(eventInput(form)).toEqual({
    sourceId: 's',
    nodeId: 'i=2253',
    valueType: 'UInt32',
    monitor: { events: { value: { kind: 'activeConditions' } } },
  })
  const one = {
    ...form,
    kind: 'field' as const,
    path: ' A \n\nB',
    severityMin: 5,
    sourceNode: 'i=9',
  }
  expect(eventInput(one).monitor?.events).toEqual({
    value: { kind: 'field', path: ['A', 'B'] },
    severityMin: 5,
    sourceNode: 'i=9',
  })
})

it('takes several values of one object, each once', () => {
  const draft = new Draft(field, {} as InboxRequest)
  takeEvents(draft.inputs, eventInput(form))
  takeEvents(draft.inputs, eventInput(form))
  takeEvents(draft.inputs, eventInput({ ...form, severityMin: 500 }))
  takeEvents(draft.inputs, eventInput({ ...form, kind: 'message' }))
  const names = draft.inputs.map(({ name }: MappingInput) => name)
  expect(names).toEqual(['activeConditions', 'activeConditions2', 'message'])
  expect(draft.has('s', 'i=2253')).toBe(false)
})

it('takes alarms of a machine as a person chooses them', async () => {
  serve({ 'GET /sources': () => ({ items: [{ sourceId: 'press', name: 'Press' }] }) })
  const draft = new Draft(field, {} as InboxRequest)
  render(Inputs, { draft, preview: new PreviewRun() })
  await userEvent.click(screen.getByRole('button', { name: 'Take alarms or events' }))
  const dialog = within(await screen.findByRole('dialog'))
  await dialog.findByRole('option', { name: 'Press' })
  await userEvent.selectOptions(dialog.getByLabelText('Value'), 'activeSeverity')
  await userEvent.type(dialog.getByLabelText('Least severity'), '600')
  await userEvent.click(dialog.getByRole('button', { name: 'Take in' }))
  await vi.waitFor(() => {
    expect(draft.inputs).toHaveLength(1)
  })
  expect(draft.inputs[0]).toMatchObject({
    name: 'activeSeverity',
    sourceId: 'press',
    nodeId: 'i=2253',
    monitor: { events: { value: { kind: 'activeSeverity' }, severityMin: 600 } },
  })
  screen.getByText(/Highest severity of the active alarms/)
  screen.getByText(/from severity 600/)
})

import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { session } from '@/transport/session.svelte'
import { problem, serve, type Asked } from '../../vitest.server'
import type { DynamicDataRequest, NetworkView, Operation } from '../api/types'
import { nameOf, offersOf } from './offers'
import { RequestDraft } from './request-draft.svelte'
import RequestDialog from './RequestDialog.svelte'

const request: DynamicDataRequest = {
  dynamicDataRequestId: 'Request1',
  requesterId: 'acme',
  recipientList: ['acme'],
  purpose: 'Plan',
  reportDataFormat: {
    reportName: 'R',
    reportFieldList: [
      { name: 'made', type: 'UInt32', semantic: 'PRODUCED_QUANTITY' },
      { name: 'spindlePower', type: 'Double', unit: 'KWT', description: 'Power of the spindle' },
    ],
  },
}
const turn: Operation = {
  operationId: 'turn',
  operationType: 'PRODUCTION',
  quantityUnit: 'KGM',
  dynamicDataRequestList: [request],
}
const carry: Operation = { operationId: 'carry', operationType: 'TRANSPORTATION' }
const view: NetworkView = {
  collaborationId: 'c',
  revision: 1,
  updatedAt: '2026-11-21T10:00:00Z',
  lastEventId: '0-0',
  parts: [],
  operations: [],
  fields: [],
  network: { operationNetworkId: 'n', operationList: [turn, carry] },
}
const POST = 'POST /operation-networks/n/operations/turn/requests'

beforeEach(() => {
  session.state = {
    is: 'signedIn',
    who: { userName: 'p', role: 'PLANNER', csrfToken: 't', organisationId: 'acme' },
  }
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('what is offered', () => {
  const ids = (operation: Operation): string[] =>
    offersOf(view, operation, (id) => id).map(({ id }) => id)

  it('follows from the kind of operation and from what is asked elsewhere', () => {
    expect(ids(turn)).toEqual([
      'OPERATION_STATE',
      'PERCENT_COMPLETE',
      'PRODUCED_QUANTITY',
      'GOOD_QUANTITY',
      'SCRAP_QUANTITY',
      'ACTUAL_START',
      'EXPECTED_END',
      'ACTUAL_END',
      'DELAY_REASON',
      'spindlePower',
    ])
    expect(ids(carry)).not.toContain('PRODUCED_QUANTITY')
  })
  it('has the type and unit that fit its meaning', () => {
    const draft = new RequestDraft(view, turn, 'acme')
    expect(draft.fields[0]).toMatchObject({ type: 'Double', unit: 'KGM' })
    const [field] = draft.fields
    if (field === undefined) throw new Error('A first question is proposed.')
    draft.mean(field, 'EXPECTED_END')
    expect(field).toMatchObject({ type: 'DateTime', unit: '', semantic: 'EXPECTED_END' })
    draft.mean(field, '')
    expect(field.type).toBe('DateTime')
  })
  it('has a technical name that is made of words', () => {
    expect(nameOf('Power of the spindle', [])).toBe('powerOfTheSpindle')
    expect(nameOf('Größe', ['grosse'])).toBe('grosse2')
    expect(nameOf('3. Achse', [])).toBe('field3Achse')
    expect(nameOf('…', ['field'])).toBe('field2')
    const draft = new RequestDraft(view, turn, 'acme')
    draft.addField()
    draft.addField()
    for (const field of draft.fields.slice(1)) field.description = 'Heat'
    expect(draft.request.reportDataFormat.reportFieldList.map(({ name }) => name)).toEqual([
      'producedQuantity',
      'heat',
      'heat2',
    ])
  })
})

describe('the form of a request', () => {
  const show = (answer: () => unknown): { asked: Asked[]; onsent: () => void } => {
    const onsent = vi.fn()
    const asked = serve({ [POST]: answer })
    const closed = (): void => undefined
    const shown = { networkId: 'n', operation: turn, view, open: true, onclose: closed, onsent }
    render(RequestDialog, shown)
    return { asked, onsent }
  }

  it('asks by meaning, and sends the technical fields behind it', async () => {
    const { asked, onsent } = show(() => ({ revision: 2, sentTo: ['F'] }))
    await userEvent.click(screen.getByLabelText(/^How much has been made\?/))
    await userEvent.click(screen.getByLabelText(/^When will it be ready\?/))
    await userEvent.click(screen.getByLabelText(/^Why is it late\?/))
    await userEvent.click(screen.getByLabelText(/^Power of the spindle/))
    await userEvent.click(screen.getByRole('button', { name: 'Something else' }))
    await userEvent.type(screen.getByLabelText('What else 1'), 'Door is open')
    await userEvent.selectOptions(screen.getByLabelText('Kind 1'), 'Yes or no')
    await userEvent.type(screen.getByLabelText('What for'), 'Know delays')
    await userEvent.click(screen.getByRole('button', { name: 'Send the request' }))
    await vi.waitFor(() => {
      expect(onsent).toHaveBeenCalled()
    })
    const sent = asked.find(({ method }) => method === 'POST')?.body as DynamicDataRequest
    expect(sent.reportDataFormat.reportFieldList).toEqual([
      { name: 'expectedEnd', type: 'DateTime', semantic: 'EXPECTED_END' },
      { name: 'delayReason', type: 'String', description: 'Reason of the delay' },
      { name: 'spindlePower', type: 'Double', unit: 'KWT', description: 'Power of the spindle' },
      { name: 'doorIsOpen', type: 'Boolean', description: 'Door is open' },
    ])
  })
  it('says what is wrong at the question that it is about', async () => {
    const pointer =
      '/operationList/0/dynamicDataRequestList/1/reportDataFormat/reportFieldList/0/unit'
    show(() =>
      problem(422, 'The document has a fault.', [
        { pointer, code: 'UNKNOWN_UNIT', message: 'FURLONG is no unit.' },
      ]),
    )
    await userEvent.type(screen.getByLabelText('What for'), 'Know delays')
    await userEvent.click(screen.getByRole('button', { name: 'Send the request' }))
    const choice = screen.getByText(/^How much has been made\?/)
    await vi.waitFor(() => {
      expect(choice.textContent).toContain('This unit is not known.')
    })
  })
  it('is not sent without a question', async () => {
    show(() => ({}))
    await userEvent.click(screen.getByLabelText(/^How much has been made\?/))
    const send = screen.getByRole<HTMLButtonElement>('button', { name: 'Send the request' })
    expect(send.disabled).toBe(true)
  })
})

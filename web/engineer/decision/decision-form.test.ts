import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { session } from '@/transport/session.svelte'
import { problem, serve, type Asked } from '../../vitest.server'
import type { FieldView, InboxRequest, Preview } from '../api/types'
import DecisionForm from './DecisionForm.svelte'
import RefusePanel from './RefusePanel.svelte'

const key = {
  operationNetworkId: 'n',
  operationId: 'o',
  dynamicDataRequestId: 'r',
  fieldName: 'made',
}
const PATH = '/fields/n/o/r/made'
const field = (more: Partial<FieldView> = {}): FieldView => ({
  key,
  name: 'made',
  type: 'UInt32',
  valueRank: -1,
  mappingState: 'MAPPED',
  valueSource: 'MAPPING',
  mapping: {
    mappingId: 'field-1',
    target: key,
    targetType: 'UInt32',
    inputs: [{ name: 'count', sourceId: 's', nodeId: 'i=1' }],
    steps: [],
  },
  disclosure: { roundingStep: 5 },
  disclosureParts: [],
  effectiveDisclosure: {},
  grounds: { policyId: null, policies: [], rules: [] },
  hasShadow: false,
  isWithheld: false,
  shownTag: 'first',
  ...more,
})
const request: InboxRequest = {
  key,
  operation: { operationId: 'o', operationType: 'PRODUCTION' },
  requesterId: 'acme',
  recipientList: ['acme'],
  purpose: 'Plan',
  receivedAt: '2026-01-01T00:00:00Z',
  hasEnded: false,
  isOverdue: false,
  reportName: 'Progress',
  fields: [],
}
const preview = (more: Partial<Preview> = {}): Partial<Preview> => ({
  previewId: 'p1',
  inputs: [{ name: 'count', value: 7, status: 'Good' }],
  steps: [],
  candidate: { value: 7, status: 'Good' },
  statement: 'x',
  statementParts: [],
  effectiveDisclosure: {},
  effects: [],
  warnings: [],
  capExcesses: [],
  isWithheld: false,
  diagnostics: [],
  ...more,
})

function connector(answers: Record<string, (asked: Asked) => unknown> = {}): Asked[] {
  return serve({
    [`POST ${PATH}/preview`]: () => preview(),
    'GET /sources': () => ({ items: [] }),
    'GET /templates': () => ({ items: [] }),
    ...answers,
  })
}
const rounding = (): Promise<HTMLInputElement> => screen.findByLabelText(/^Rounding step/)
const consent = (): HTMLButtonElement => screen.getByRole('button', { name: /^Consent/ })
const decisions = (log: Asked[]): Asked[] => log.filter(({ method }) => method === 'PUT')

async function round(step: string): Promise<void> {
  await userEvent.clear(await rounding())
  await userEvent.type(await rounding(), step)
}

beforeEach(() => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'VIEWER', csrfToken: 't' } }
  sessionStorage.clear()
  toasts.list = []
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the form of a decision', () => {
  it('keeps a draft over other pages, and discards it where that is asked', async () => {
    connector()
    const onrestart = vi.fn()
    const first = render(DecisionForm, { field: field(), request, onrestart })
    expect(screen.queryByText(/your draft from before/)).toBeNull()
    await round('20')
    first.unmount()

    render(DecisionForm, { field: field(), request, onrestart })
    expect((await rounding()).value).toBe('20')
    screen.getByText(/your draft from before/)
    await userEvent.click(screen.getByRole('button', { name: 'Discard draft' }))
    expect(onrestart).toHaveBeenCalledOnce()
    expect(sessionStorage.length).toBe(0)
  })

  it('shows a draft to nobody else', async () => {
    connector()
    const first = render(DecisionForm, { field: field(), request, onrestart: vi.fn() })
    await round('20')
    first.unmount()
    session.state = { is: 'signedIn', who: { userName: 'otto', role: 'VIEWER', csrfToken: 't' } }
    render(DecisionForm, { field: field(), request, onrestart: vi.fn() })
    expect((await rounding()).value).toBe('5')
  })

  it('asks before the page is left with a draft, and not without one', async () => {
    connector()
    render(DecisionForm, { field: field(), request, onrestart: vi.fn() })
    const leaving = (): boolean =>
      window.dispatchEvent(new Event('beforeunload', { cancelable: true }))
    expect(leaving()).toBe(true)
    await round('20')
    expect(leaving()).toBe(false)
    await round('5')
    expect(leaving()).toBe(true)
  })

  it('consents to what was shown, and has nothing to consent to afterwards', async () => {
    const log = connector({ [`PUT ${PATH}/decision`]: () => field({ shownTag: 'second' }) })
    render(DecisionForm, { field: field(), request, onrestart: vi.fn() })
    await round('20')
    await vi.waitFor(() => {
      expect(consent().disabled).toBe(false)
    })
    await userEvent.click(consent())
    expect(decisions(log)).toMatchObject([{ ifMatch: '"first"', body: { previewId: 'p1' } }])
    await vi.waitFor(() => {
      expect(consent().disabled).toBe(true)
    })
    screen.getByText('In effect')
    expect(sessionStorage.length).toBe(0)
    // Nor does undoing it overwrite what another decided meanwhile.
    toasts.list.at(-1)?.action?.run()
    await vi.waitFor(() => {
      expect(decisions(log)).toHaveLength(2)
    })
    expect(decisions(log)[1]).toMatchObject({ ifMatch: '"second"' })
  })

  it('says that another decision came in between, and consents over it only where that is wanted', async () => {
    connector()
    const onrestart = vi.fn()
    const props = { field: field(), request, onrestart }
    const { rerender } = render(DecisionForm, props)
    await round('20')
    await vi.waitFor(() => {
      expect(consent().disabled).toBe(false)
    })
    const other = field({
      shownTag: 'second',
      decidedBy: 'otto',
      decisionTime: '2026-01-02T03:04:05Z',
      disclosure: { roundingStep: 1 },
    })
    await rerender({ ...props, field: other })
    const title = screen.getByText('The field has changed since you began')
    const notice = within(title.closest<HTMLElement>('[role=alert]') ?? title)
    notice.getByText(/The decision of otto/)
    expect(consent().disabled).toBe(true)
    expect((await rounding()).value).toBe('20')
    await userEvent.click(notice.getByRole('button', { name: 'Go on with my draft' }))
    expect(screen.queryByText('The field has changed since you began')).toBeNull()
    expect(consent().disabled).toBe(false)
  })

  it.each([
    ['Good', 'Fails on the present value'],
    ['BadNoCommunication', 'Cannot be tried: no good value of the source at present'],
  ])('is not ready while a function fails on a value that is %s', async (status, said) => {
    const failing = preview({
      inputs: [{ name: 'count', value: 7, status }],
      steps: [{ function: 'script', message: 'x is not defined' }],
    })
    connector({ [`POST ${PATH}/preview`]: () => failing })
    render(DecisionForm, { field: field(), request, onrestart: vi.fn() })
    await round('20')
    await screen.findByText(said)
    expect(screen.queryByText('Ready')).toBeNull()
    // While the draft is looked at again, nothing can be consented to.
    await vi.waitFor(() => {
      expect(consent().disabled).toBe(status === 'Good')
    })
  })

  it('asks with the consequences before it stops a disclosure', async () => {
    const log = connector({ [`PUT ${PATH}/decision`]: () => field({ mappingState: 'PENDING' }) })
    render(DecisionForm, { field: field(), request, onrestart: vi.fn() })
    await userEvent.click(screen.getByRole('button', { name: 'Stop disclosing' }))
    const dialog = within(screen.getByRole('dialog'))
    dialog.getByText(/acme gets no more values from now on/)
    expect(decisions(log)).toEqual([])
    await userEvent.click(dialog.getByRole('button', { name: 'Stop disclosing' }))
    expect(decisions(log)).toMatchObject([
      { ifMatch: '"first"', body: { mappingState: 'PENDING' } },
    ])
  })
})

it('a reason for a refusal outlasts the end of the session, until it is sent', async () => {
  const log = serve({ [`PUT ${PATH}/decision`]: () => problem(409, 'Not as it was shown.') })
  const first = render(RefusePanel, { field: field(), ondone: vi.fn() })
  await userEvent.type(screen.getByLabelText(/^Reason/), 'It is ours')
  await userEvent.click(screen.getByRole('button', { name: 'Refuse this field' }))
  expect(decisions(log)).toMatchObject([{ ifMatch: '"first"' }])
  first.unmount()

  const ondone = vi.fn()
  serve({ [`PUT ${PATH}/decision`]: () => field({ mappingState: 'REFUSED' }) })
  render(RefusePanel, { field: field(), ondone })
  expect(screen.getByLabelText(/^Reason/)).toHaveProperty('value', 'It is ours')
  await userEvent.click(screen.getByRole('button', { name: 'Refuse this field' }))
  expect(ondone).toHaveBeenCalledOnce()
  expect(sessionStorage.length).toBe(0)
})

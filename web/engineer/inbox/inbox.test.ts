import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { session } from '@/transport/session.svelte'
import { problem, serve, type Asked } from '../../vitest.server'
import type { FieldView, InboxRequest } from '../api/types'
import { connectorStore } from '../connector-store.svelte'
import InboxPage from './InboxPage.svelte'
import { matching } from './matching'
import { RequestList, requestOf } from './request-list.svelte'

const REQUESTS = 2_000
const field = (number: number, name: string, more: Partial<FieldView> = {}): FieldView => ({
  key: {
    operationNetworkId: 'n',
    operationId: `op${number}`,
    dynamicDataRequestId: 'R',
    fieldName: name,
  },
  name,
  type: 'Double',
  valueRank: -1,
  mappingState: 'PENDING',
  disclosure: {},
  disclosureParts: [],
  effectiveDisclosure: {},
  grounds: { policyId: null, policies: [], rules: [] },
  hasShadow: false,
  isWithheld: false,
  ...more,
})
const request = (number: number, more: Partial<InboxRequest> = {}): InboxRequest => ({
  key: { operationNetworkId: 'n', operationId: `op${number}`, dynamicDataRequestId: 'R' },
  operation: { operationId: `op${number}`, operationType: 'PRODUCTION', name: `Lot ${number}` },
  requesterId: 'acme',
  recipientList: ['acme'],
  purpose: 'Plan',
  receivedAt: '2026-01-01T00:00:00Z',
  hasEnded: false,
  isOverdue: false,
  reportName: 'Progress',
  fields: [field(number, 'power'), field(number, 'count', { mappingState: 'MAPPED' })],
  ...more,
})
const totals = {
  requests: REQUESTS,
  openRequests: REQUESTS,
  overdueRequests: 3,
  endedRequests: 0,
  pending: REQUESTS,
  mapped: REQUESTS,
  refused: 0,
}
const parameters = ({ path }: Asked): Record<string, string> =>
  Object.fromEntries(new URLSearchParams(path.split('?')[1]))

/** An inbox of many requests, searched and paged as the connector does it. */
function inbox(asked: Asked): unknown {
  const { cursor, limit = '200', search = '' } = parameters(asked)
  const meant = Array.from({ length: REQUESTS }, (_, number) => number).filter((number) =>
    `lot ${number}\nop${number}`.includes(search.toLowerCase().split(' ')[0] ?? ''),
  )
  const count = Number(limit)
  const from =
    cursor === undefined ? 0 : meant.findIndex((number) => `behind op${number}` === cursor) + 1
  const next = from + count < meant.length ? `behind op${meant[from + count - 1] ?? ''}` : null
  return {
    items: meant.slice(from, from + count).map((number) => request(number)),
    nextCursor: next,
    count: meant.length,
    totals,
  }
}

beforeEach(async () => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
  serve({ 'GET /inbox': inbox })
  await connectorStore.totals.refresh()
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('fields that are looked for', () => {
  const names = (state: FieldView['mappingState'] | undefined, search: string): string[][] =>
    matching([request(7)], state, search).map(({ fields }) => fields.map(({ name }) => name))
  it.each([
    [undefined, '', [['power', 'count']]],
    ['MAPPED', '', [['count']]],
    ['REFUSED', '', []],
    [undefined, 'LOT 7', [['power', 'count']]],
    [undefined, 'acme pow', [['power']]],
    ['MAPPED', 'acme pow', []],
  ] as const)('%s %j are %j', (state, search, found) => {
    expect(names(state, search)).toEqual(found)
  })
})

describe('a list of requests', () => {
  it('reads on page by page, and again as far as it was read', async () => {
    const log = serve({ 'GET /inbox': inbox })
    const list = new RequestList()
    await list.answer.refresh()
    await list.more()
    await list.more()
    expect(list.answer.value?.items.map(({ key }) => key.operationId)).toEqual(
      Array.from({ length: 120 }, (_, number) => `op${number}`),
    )
    await list.answer.refresh()
    expect(list.answer.value?.items).toHaveLength(120)
    expect(log.map(parameters)).toEqual([
      { limit: '40' },
      { cursor: 'behind op39', limit: '40' },
      { cursor: 'behind op79', limit: '40' },
      { limit: '120' },
    ])
  })
  it('keeps what it has, and says why no more came', async () => {
    const list = new RequestList()
    await list.answer.refresh()
    serve({ 'GET /inbox': () => problem(503, 'Busy.') })
    await list.more()
    expect([list.answer.value?.items.length, list.problem?.message]).toEqual([40, 'Busy.'])
  })
  it('is not read where one request is wanted, or where that is gone', async () => {
    const log = serve({ 'GET /requests/n/op19/R': () => request(19) })
    const wanted = (number: number): Promise<{ items: InboxRequest[] }> =>
      requestOf(field(number, 'power').key, new AbortController().signal)
    expect((await wanted(19)).items.map(({ key }) => key.operationId)).toEqual(['op19'])
    expect((await wanted(20)).items).toEqual([])
    expect(log.map(({ path }) => path)).toEqual(['/requests/n/op19/R', '/requests/n/op20/R'])
    serve({ 'GET /requests/n/op19/R': () => problem(503, 'Busy.') })
    await expect(wanted(19)).rejects.toThrow('Busy.')
  })
})

describe('the inbox', () => {
  it('lets the connector search and filter, and reads no more than is seen', async () => {
    const log = serve({ 'GET /inbox': inbox })
    const { container } = render(InboxPage)
    expect(await screen.findByText('Lot 0')).toBeTruthy()
    expect(container.querySelectorAll('tr[data-field]').length).toBeLessThan(100)
    expect(screen.getByText('All 4,000')).toBeTruthy()

    await userEvent.type(screen.getByLabelText('Search requests and fields'), '1987')
    expect(await screen.findByText('Lot 1987')).toBeTruthy()
    await userEvent.click(screen.getByText('Mapped 2,000'))
    await vi.waitFor(() =>
      expect(parameters(log.at(-1) as Asked)).toEqual({
        search: '1987',
        state: 'MAPPED',
        limit: '40',
      }),
    )
    await vi.waitFor(() =>
      expect(
        [...container.querySelectorAll('tr[data-field]')].map((row) =>
          row.getAttribute('data-field'),
        ),
      ).toEqual(['count']),
    )
    await userEvent.click(screen.getByText('Overdue 3'))
    await vi.waitFor(() =>
      expect(parameters(log.at(-1) as Asked)).toEqual({
        search: '1987',
        isOverdue: 'true',
        limit: '40',
      }),
    )
    expect(
      log.filter(({ path }) => path.includes('cursor')).length,
      'pages beyond the first',
    ).toBeLessThan(3)
  })

  it('puts in place what was decided, and counts again', async () => {
    const log = serve({ 'GET /inbox': inbox })
    const { container } = render(InboxPage)
    await screen.findByText('Lot 0')
    connectorStore.put(
      field(0, 'power', { mappingState: 'REFUSED', decisionReason: 'That is ours.' }),
    )
    expect(await screen.findByText('That is ours.')).toBeTruthy()
    expect(container.querySelectorAll('tr[data-field=power]').length).toBeGreaterThan(1)
    await vi.waitFor(() => expect(log.map(parameters)).toContainEqual({ limit: '1' }))
  })

  it('says that nothing matches, and that nobody has asked yet', async () => {
    render(InboxPage)
    await userEvent.type(await screen.findByLabelText('Search requests and fields'), 'unheard')
    expect(await screen.findByText('No match')).toBeTruthy()
    serve({ 'GET /inbox': () => ({ items: [], count: 0, totals: { ...totals, requests: 0 } }) })
    await userEvent.clear(screen.getByLabelText('Search requests and fields'))
    expect(await screen.findByText('No requests yet')).toBeTruthy()
  })
})

it('shows viewers what is asked, and nothing that they may not do', async () => {
  session.state = { is: 'signedIn', who: { userName: 'ida', role: 'VIEWER', csrfToken: 't' } }
  serve({ 'GET /inbox': inbox })
  render(InboxPage)
  expect((await screen.findAllByRole('link', { name: 'Open: power' })).length).toBeGreaterThan(0)
  expect(screen.queryByRole('link', { name: /^(Decide|Change):/ })).toBeNull()
  expect(screen.queryByRole('button', { name: /Revoke|Refuse/ })).toBeNull()
})

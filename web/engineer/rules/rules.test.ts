import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { session } from '@/transport/session.svelte'
import { problem, serve, type Asked } from '../../vitest.server'
import type { NamedPolicy, Rule } from '../api/types'
import PoliciesPage from './PoliciesPage.svelte'

const versioned = { version: 3, changedBy: 'eva', changedAt: '2026-11-21T06:00:00Z' }
const rule = {
  ...versioned,
  id: 'power',
  name: 'Power to Acme',
  isEnabled: false,
  when: { partners: ['acme'], dataTypes: [], semantics: [], units: [] },
  action: 'PREFILL',
  disclosure: { roundingStep: 5 },
}
const policy = {
  ...versioned,
  id: 'coarse',
  name: 'Coarse',
  disclosure: { roundingStep: 10 },
  isRetired: false,
  statement: '',
  fieldCount: 2,
  recipients: [],
}
const nothing = { items: [] }

/** Answers to all requests of the page, with the differences of a test. */
function connector(answers: Parameters<typeof serve>[0] = {}): Asked[] {
  return serve({
    'GET /rules': () => ({ items: [rule] }),
    'GET /policies': () => ({ items: [policy] }),
    'GET /recipients': () => ({ items: [{ recipient: 'acme', fieldCount: 2 }] }),
    'GET /rule-decisions': () => nothing,
    'POST /rules/preview': () => ({ count: 0, wouldDecideCount: 0, items: [] }),
    ...answers,
  })
}
const changes = (log: Asked[]): Asked[] => log.filter(({ method }) => method === 'PUT')

beforeEach(() => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
  toasts.list = []
})
afterEach(() => {
  vi.useRealTimers()
  vi.unstubAllGlobals()
})

describe('policies and rules', () => {
  it('have a text for each empty list', async () => {
    connector({
      'GET /rules': () => nothing,
      'GET /policies': () => nothing,
      'GET /recipients': () => nothing,
    })
    render(PoliciesPage)
    for (const text of [
      'No rule yet',
      'No named policy yet.',
      'No partner asks yet.',
      'No rule has decided yet.',
    ])
      expect(await screen.findByText(text)).toBeTruthy()
  })

  it('a rule is enabled at once, and back', async () => {
    const log = connector({ 'PUT /rules/power': () => ({}) })
    render(PoliciesPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Enable: Power to Acme' }))
    await vi.waitFor(() => expect(toasts.list).toHaveLength(1))
    toasts.list[0]?.action?.run()
    await vi.waitFor(() =>
      expect(changes(log).map(({ body }) => (body as { isEnabled: boolean }).isEnabled)).toEqual([
        true,
        false,
      ]),
    )
  })

  it('what a rule means is asked when its conditions change, not its name', async () => {
    vi.useFakeTimers({ shouldAdvanceTime: true })
    const user = userEvent.setup({ advanceTimers: (ms) => vi.advanceTimersByTime(ms) })
    const log = connector()
    const asked = (): unknown[] =>
      log
        .filter(({ path }) => path === '/rules/preview')
        .map(({ body }) => (body as Rule).when.namePattern)
    render(PoliciesPage)
    await user.click(await screen.findByRole('button', { name: 'Edit: Power to Acme' }))
    vi.advanceTimersByTime(1_000)
    expect(asked()).toEqual([undefined])
    const dialog = within(screen.getByRole('dialog'))
    await user.type(dialog.getByLabelText('Name'), ' and others')
    vi.advanceTimersByTime(1_000)
    expect(asked()).toEqual([undefined])
    await user.type(dialog.getByLabelText('Name of the field'), 'power*')
    vi.advanceTimersByTime(1_000)
    expect(asked()).toEqual([undefined, 'power*'])
  })

  it('the rarer ways to coarsen are there where they are looked for or in use', async () => {
    connector({
      'GET /policies': () => ({
        items: [policy, { ...policy, id: 'late', name: 'Late', disclosure: { delayMs: 5 } }],
      }),
    })
    render(PoliciesPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Edit: Coarse' }))
    const dialog = within(screen.getByRole('dialog'))
    expect(dialog.queryByLabelText('Bands')).toBeNull()
    await userEvent.click(dialog.getByText('More ways to coarsen'))
    await userEvent.type(await dialog.findByLabelText('Bands'), '5')
    await userEvent.clear(dialog.getByLabelText('Bands'))
    await userEvent.tab()
    expect(dialog.getByLabelText('Bands')).toBeTruthy()
    await userEvent.click(dialog.getByRole('button', { name: 'Cancel' }))
    await userEvent.click(screen.getByRole('button', { name: 'Edit: Late' }))
    expect(within(screen.getByRole('dialog')).getByLabelText('Bands')).toBeTruthy()
  })

  it('a policy is added, and stays open with the reason where it is refused', async () => {
    const log = connector({
      'PUT /policies/fine-grained': () => problem(422, 'The rounding step is too small.'),
    })
    render(PoliciesPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Add a policy' }))
    const dialog = within(screen.getByRole('dialog'))
    await userEvent.type(dialog.getByLabelText('Name'), 'Fine grained')
    await userEvent.type(dialog.getByLabelText('Rounding step'), '2')
    await userEvent.click(dialog.getByRole('button', { name: 'Save' }))
    expect((await dialog.findByRole('alert')).textContent).toContain(
      'The rounding step is too small.',
    )
    expect(changes(log).map(({ body }) => body)).toEqual([
      { name: 'Fine grained', disclosure: { roundingStep: 2 }, isRetired: false },
    ])

    connector({ 'PUT /policies/fine-grained': () => ({ version: 1 }) })
    await userEvent.click(dialog.getByRole('button', { name: 'Save' }))
    await vi.waitFor(() => expect(screen.queryByRole('dialog')).toBeNull())
    expect(toasts.list.map(({ text }) => text)).toEqual(['Policy saved.'])
  })

  it('a policy that is changed names the fields that get it, with what partners read then', async () => {
    connector({
      'GET /policies': () => ({ items: [{ ...policy, fieldCount: 1 }] }),
      'POST /policies/coarse/preview': ({ body }) => ({
        items: [
          {
            key: {
              operationNetworkId: 'n',
              operationId: 'o',
              dynamicDataRequestId: 'r',
              fieldName: 'made',
            },
            statement: 'Every change.',
            statementParts: [],
            statementThen: `Rounded to ${(body as NamedPolicy).disclosure.roundingStep}.`,
            statementThenParts: [],
          },
        ],
      }),
    })
    render(PoliciesPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Edit: Coarse' }))
    const dialog = within(screen.getByRole('dialog'))
    await userEvent.clear(dialog.getByLabelText('Rounding step'))
    await userEvent.type(dialog.getByLabelText('Rounding step'), '25')
    expect(await dialog.findByText('made')).toBeTruthy()
    expect(await dialog.findByText(/Then: Rounded to 25/)).toBeTruthy()
  })

  it('a recipient has the policy that holds, also where another one was refused', async () => {
    connector({ 'PUT /recipients/acme/policy': () => problem(409, 'Changed by another engineer.') })
    render(PoliciesPage)
    const choice = await screen.findByRole('combobox', { name: 'Named policy: acme' })
    await vi.waitFor(() => expect(within(choice).getAllByRole('option')).toHaveLength(2))
    await userEvent.selectOptions(choice, 'coarse')
    await vi.waitFor(() =>
      expect(toasts.list.map(({ text }) => text)).toEqual(['Changed by another engineer.']),
    )
    await vi.waitFor(() => expect(choice).toHaveProperty('value', ''))
  })

  it('decisions of rules are read page by page, and all of them again after one was undone', async () => {
    const decision = (id: number): object => ({
      id: String(id),
      field: {
        operationNetworkId: 'n',
        operationId: `op${id}`,
        dynamicDataRequestId: 'R',
        fieldName: 'power',
      },
      action: 'ACCEPT',
      rules: [{ id: 'power', version: 3 }],
      decidedAt: '2026-11-21T06:00:00Z',
    })
    const log = connector({
      'GET /rule-decisions': ({ path }) =>
        path.includes('cursor=4')
          ? { items: [decision(3)] }
          : { items: [decision(5), decision(4)], nextCursor: '4' },
      'POST /rule-decisions/3/undo': () => ({}),
      'GET /inbox': () => nothing,
    })
    render(PoliciesPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Load more' }))
    const row = (await screen.findByText('op3 / power')).closest('tr') as HTMLElement
    expect(screen.queryByRole('button', { name: 'Load more' })).toBeNull()
    await userEvent.click(within(row).getByRole('button', { name: 'Undo' }))
    const pages = (): string[] =>
      log
        .map(({ path }) => path)
        .filter((path) => path.startsWith('/rule-decisions') && !path.endsWith('undo'))
    await vi.waitFor(() =>
      expect(pages()).toEqual([
        '/rule-decisions?limit=25',
        '/rule-decisions?cursor=4&limit=25',
        '/rule-decisions?limit=25',
        '/rule-decisions?cursor=4&limit=25',
      ]),
    )
    expect(screen.getByText('op5 / power')).toBeTruthy()
  })

  it('are not for everybody to change', async () => {
    session.state = { is: 'signedIn', who: { userName: 'ida', role: 'VIEWER', csrfToken: 't' } }
    connector()
    render(PoliciesPage)
    await screen.findByText('Power to Acme')
    expect(screen.queryByRole('button')).toBeNull()
    expect(await screen.findByRole('combobox')).toHaveProperty('disabled', true)
  })
})

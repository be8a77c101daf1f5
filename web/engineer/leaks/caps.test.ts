import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { language } from '@/language/language.svelte'
import { session } from '@/transport/session.svelte'
import { problem, serve, type Asked } from '../../vitest.server'
import LeaksPage from './LeaksPage.svelte'

const versioned = { version: 3, changedBy: 'eva', changedAt: '2026-11-21T06:00:00Z' }
const key = {
  operationNetworkId: 'n',
  operationId: 'turn',
  dynamicDataRequestId: 'progress',
  fieldName: 'count',
}
const cap = {
  ...versioned,
  id: 'yard',
  name: 'Yard in sum',
  subject: { allianceId: 'yard' },
  bitsPerHourMax: 100,
  isRetired: false,
  bitsPerHour: 40,
  heldBack: [key],
}
const alliance = {
  ...versioned,
  id: 'yard',
  name: 'The yard',
  memberList: ['acme', 'hull'],
  isRetired: false,
}
const nothing = { items: [] }

function connector(answers: Parameters<typeof serve>[0] = {}): Asked[] {
  return serve({
    'GET /leak-budgets': () => nothing,
    'GET /leak-budgets/alliances': () => nothing,
    'GET /alliances': () => ({ items: [alliance] }),
    'GET /caps': () => ({ items: [cap] }),
    'GET /recipients': () => ({ items: [{ recipient: 'acme', fieldCount: 2 }] }),
    ...answers,
  })
}
const changes = (log: Asked[]): unknown[] =>
  log.filter(({ method }) => method === 'PUT').map(({ path, body }) => [path, body])

beforeEach(() => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
  toasts.list = []
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('caps', () => {
  it('show the sum, and the fields that they hold back', async () => {
    connector()
    render(LeaksPage)
    expect(await screen.findByText('1 field held back')).toBeTruthy()
    expect(screen.getByRole('img', { name: '40 of at most 100 bit per hour' })).toBeTruthy()
    expect(screen.getByRole('link', { name: /count/ }).getAttribute('href')).toBe(
      '#/fields/n/turn/progress/count',
    )
    expect(await screen.findByText('Alliance: The yard')).toBeTruthy()
  })
  it('say beforehand which consents they end', async () => {
    const log = connector({
      'POST /caps/acme/preview': () => ({ items: [{ key, excesses: [] }] }),
      'PUT /caps/acme': () => ({ id: 'acme', version: 1, heldBack: [key] }),
    })
    render(LeaksPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Add a cap' }))
    const dialog = within(await screen.findByRole('dialog'))
    await userEvent.type(dialog.getByLabelText('Name'), 'Acme')
    await userEvent.selectOptions(dialog.getByLabelText('For'), 'acme')
    await userEvent.type(dialog.getByLabelText('Bits per hour, at most'), '20')
    expect(await dialog.findByText('The consent to 1 field ends at once:')).toBeTruthy()
    await userEvent.click(dialog.getByRole('button', { name: 'Save' }))
    const body = {
      name: 'Acme',
      subject: { partner: 'acme' },
      bitsPerHourMax: 20,
      isRetired: false,
    }
    await vi.waitFor(() => expect(changes(log)).toEqual([['/caps/acme', body]]))
    expect(toasts.list[0]?.text).toBe('Cap saved; 1 field is held back.')
  })
  it('are read by viewers, in German, too', async () => {
    session.state = { is: 'signedIn', who: { userName: 'vera', role: 'VIEWER', csrfToken: 't' } }
    language.choose('de')
    connector()
    render(LeaksPage)
    expect(await screen.findByText('1 Feld zurückgehalten')).toBeTruthy()
    expect(screen.queryByRole('button', { name: /Obergrenze/ })).toBeNull()
  })
})

describe('alliances', () => {
  it('are changed, and a refusal shows the figures', async () => {
    const message = 'The cap Yard in sum allows 100.0 bits per hour'
    const log = connector({
      'PUT /alliances/yard': () =>
        problem(422, 'Partners would get more.', [{ pointer: '', code: 'OVER_CAP', message }]),
    })
    render(LeaksPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Edit: The yard' }))
    const dialog = within(await screen.findByRole('dialog'))
    const members = dialog.getByLabelText('Members')
    await userEvent.clear(members)
    await userEvent.type(members, 'acme, hull, keel, acme')
    await userEvent.click(dialog.getByRole('button', { name: 'Save' }))
    expect(await dialog.findByText(new RegExp(message))).toBeTruthy()
    const body = { name: 'The yard', memberList: ['acme', 'hull', 'keel'], isRetired: false }
    expect(changes(log)).toEqual([['/alliances/yard', body]])
  })
  it('have a budget together', async () => {
    const together = {
      alliance,
      fields: [],
      variables: [],
      warnings: [],
      valuesPerHourMeasured: 1,
      bitsPerHourMax: 77,
    }
    const alone = { ...together, partner: 'acme', bitsPerHourMax: 55 }
    connector({
      'GET /leak-budgets': () => ({ items: [alone] }),
      'GET /leak-budgets/alliances': () => ({ items: [together] }),
    })
    render(LeaksPage)
    const panel = await screen.findByRole('region', { name: 'The yard, together' })
    expect(within(panel).getByText('77 bit')).toBeTruthy()
    expect(within(panel).getByText('acme, hull')).toBeTruthy()
  })
})

import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { session } from '@/transport/session.svelte'
import { serve, type Asked } from '../../vitest.server'
import type { PastOfferView } from '../api/types'
import PastOffers from './PastOffers.svelte'

const offer: PastOfferView = {
  request: { operationNetworkId: 'n', operationId: 'turn', dynamicDataRequestId: 'progress' },
  recipientId: 'hull',
  reportCount: 2,
  root: 'ab'.repeat(32),
  parts: [
    {
      reportCount: 2,
      from: '2026-11-01T08:00:00Z',
      until: '2026-11-02T08:00:00Z',
      isOffered: true,
      fields: [
        {
          name: 'count',
          consentVersion: 1,
          policy: { statement: 'Rounded to multiples of 10.', statementParts: [] },
          isClosed: false,
          isLooser: false,
        },
      ],
    },
    {
      reportCount: 7,
      from: '2026-10-01T08:00:00Z',
      until: '2026-10-02T08:00:00Z',
      isOffered: false,
      fields: [{ name: 'count', consentVersion: 0, isClosed: false, isLooser: true }],
    },
  ],
  preview: [
    { value: { count: { Type: 9, Body: '40' }, recipientList: { Type: 12, Body: ['acme'] } } },
  ],
}

/** Connector that asks until it is decided. */
function connector(): Asked[] {
  let items = [offer]
  return serve({
    'GET /past-offers': () => ({ items }),
    'POST /past-decisions': ({ body }) => {
      items = []
      const { isReleased } = body as { isReleased: boolean }
      return { isReleased, reportCount: isReleased ? 2 : 0 }
    },
  })
}
const decisions = (log: Asked[]): unknown[] =>
  log.filter(({ method }) => method === 'POST').map(({ body }) => body)

beforeEach(() => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
  toasts.list = []
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the past for a recipient that was added', () => {
  it('is described part by part, with values as they left', async () => {
    connector()
    render(PastOffers)
    expect(await screen.findByText('Show hull the past, too?')).toBeTruthy()
    expect(screen.getByText('Rounded to multiples of 10.')).toBeTruthy()
    expect(screen.getByText('was looser than now')).toBeTruthy()
    expect(screen.getByText('40')).toBeTruthy()
    expect(screen.queryByText('recipientList')).toBeNull()
  })

  it('stays hidden at one click', async () => {
    const log = connector()
    render(PastOffers)
    await userEvent.click(await screen.findByRole('button', { name: 'Leave it hidden' }))
    await vi.waitFor(() => {
      expect(screen.queryByText('Show hull the past, too?')).toBeNull()
    })
    expect(decisions(log)).toEqual([
      {
        request: offer.request,
        recipientId: 'hull',
        isReleased: false,
        root: offer.root,
      },
    ])
  })

  it('is shown once that is confirmed, with the reason', async () => {
    const log = connector()
    render(PastOffers)
    await userEvent.type(await screen.findByLabelText('Reason'), 'They inspect the lot.')
    await userEvent.click(screen.getByRole('button', { name: 'Show 2 reports' }))
    const dialog = within(screen.getByRole('dialog'))
    expect(dialog.getByText(/cannot be made unseen/)).toBeTruthy()
    expect(decisions(log)).toEqual([])
    await userEvent.click(dialog.getByRole('button', { name: 'Show 2 reports' }))
    await vi.waitFor(() => {
      expect(screen.queryByText('Show hull the past, too?')).toBeNull()
    })
    expect(decisions(log)).toMatchObject([{ isReleased: true, reason: 'They inspect the lot.' }])
  })

  it('is decided by engineers only', async () => {
    session.state = { is: 'signedIn', who: { userName: 'otto', role: 'VIEWER', csrfToken: 't' } }
    connector()
    render(PastOffers)
    await screen.findByText('Show hull the past, too?')
    expect(screen.queryByRole('button')).toBeNull()
  })
})

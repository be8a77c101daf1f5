import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { said } from '@/language/said'
import { router } from '@/navigation/router.svelte'
import { session } from '@/transport/session.svelte'
import { problem, serve } from '../../vitest.server'
import { feed } from '../api/client'
import { texts } from '../language/texts'
import Pages from '../Pages.svelte'
import DeadLettersPage from './DeadLettersPage.svelte'

const letter = {
  id: 'ingest-7',
  address: 'factory.MUC_1.ingress',
  subject: 'ua-data',
  code: 'FORGED_PUBLISHER',
  reason: 'The publisher is INS_HAM.',
  at: '2026-01-01T00:00:00Z',
  bytes: 2048,
}
const broker = { ...letter, id: 'broker-3', code: 'EXPIRED', reason: 'Nobody took it in time.' }
const replay = (id: string): string => texts.deadLetters.replayOf(id)
const lastToast = (): string | undefined => toasts.list.at(-1)?.text

beforeEach(() => {
  session.state = {
    is: 'signedIn',
    who: { userName: 'root', role: 'ADMINISTRATOR', csrfToken: 't' },
  }
})
afterEach(() => {
  vi.unstubAllGlobals()
  toasts.list = []
  router.parts = []
})

describe('dead letters', () => {
  it('are listed with their reason, by pages', async () => {
    const log = serve({
      'GET /dead-letters': ({ path }) =>
        path.includes('cursor=7') ? { items: [broker] } : { items: [letter], nextCursor: '7' },
    })
    render(DeadLettersPage)
    expect(await screen.findByText(said(letter.code, letter.reason))).toBeTruthy()
    expect(screen.getByText(letter.reason)).toBeTruthy()
    expect(screen.getByText(texts.deadLetters.untried)).toBeTruthy()
    await userEvent.click(screen.getByRole('button', { name: /more/i }))
    expect(await screen.findByRole('button', { name: replay('broker-3') })).toBeTruthy()
    expect(log.map(({ path }) => path)).toEqual(['/dead-letters', '/dead-letters?cursor=7'])
  })

  it.each([
    ['ingest-7', true, 'taken'],
    ['ingest-7', false, 'refused'],
    ['broker-3', true, 'queued'],
  ] as const)('are tried again: %s, %s', async (id, isTaken, outcome) => {
    const state = { letters: [{ ...letter, id }] as object[] }
    const log = serve({
      'GET /dead-letters': () => ({ items: state.letters }),
      [`POST /dead-letters/${id}/replay`]: () => {
        state.letters = [{ ...letter, id, replayedAt: '2026-01-02T00:00:00Z' }]
        return { isTaken }
      },
    })
    render(DeadLettersPage)
    await userEvent.click(await screen.findByRole('button', { name: replay(id) }))
    expect(await screen.findByText(texts.deadLetters.tried)).toBeTruthy()
    expect(lastToast()).toBe(texts.deadLetters[outcome])
    const asked = log.filter(({ path }) => path.startsWith('/dead-letters'))
    expect(asked.map(({ method, path }) => `${method} ${path}`)).toEqual([
      'GET /dead-letters',
      `POST /dead-letters/${id}/replay`,
      'GET /dead-letters',
    ])
  })

  it('say why one could not be tried', async () => {
    serve({
      'GET /dead-letters': () => ({ items: [letter] }),
      'POST /dead-letters/ingest-7/replay': () => problem(404, 'It has gone.'),
    })
    render(DeadLettersPage)
    await userEvent.click(await screen.findByRole('button', { name: replay('ingest-7') }))
    await vi.waitFor(() => {
      expect(lastToast()).toBe('It has gone.')
    })
  })

  it('are for those who run the platform alone', async () => {
    const log = serve({ 'GET /dead-letters': () => ({ items: [letter] }) })
    vi.spyOn(feed, 'start').mockImplementation(() => undefined)
    router.parts = ['settings', 'dead-letters']
    const { unmount } = render(Pages)
    const row = (await screen.findByText(letter.address)).closest('tr')
    expect(within(row ?? document.body).getByRole('button')).toBeTruthy()
    unmount()
    session.state = {
      is: 'signedIn',
      who: { userName: 'anna', role: 'PLANNER', organisationId: 'acme', csrfToken: 't' },
    }
    const before = log.length
    render(Pages)
    expect(screen.queryByText(texts.deadLetters.letters)).toBeNull()
    expect(log.slice(before).filter(({ path }) => path.startsWith('/dead-letters'))).toEqual([])
  })
})

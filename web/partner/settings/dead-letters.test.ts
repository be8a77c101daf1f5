import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, expect, it, vi } from 'vitest'
import { toasts } from '@/design/toasts.svelte'
import { serve } from '../../vitest.server'
import DeadLettersPanel from './DeadLettersPanel.svelte'

afterEach(() => {
  vi.unstubAllGlobals()
})

it('a message that was rejected is tried again, and what came of it is said', async () => {
  const letter = {
    id: 'ingest-7',
    at: '2026-11-21T10:00:00Z',
    code: 'FORGED_PUBLISHER',
    reason: 'The publisher is another one.',
    address: 'ingress.F',
    bytes: 3,
  }
  let isTaken = false
  const log = serve({
    'GET /dead-letters': () => ({ items: [letter] }),
    'POST /dead-letters/ingest-7/replay': () => ({ isTaken }),
  })
  render(DeadLettersPanel)
  const button = await screen.findByRole('button', { name: 'Try again: ingest-7' })
  for (const [taken, said] of [
    [false, 'bad'],
    [true, 'good'],
  ] as const) {
    isTaken = taken
    toasts.list = []
    await userEvent.click(button)
    await vi.waitFor(() => {
      expect(toasts.list.map(({ tone }) => tone)).toEqual([said])
    })
  }
  expect(log.filter(({ method }) => method === 'POST')).toHaveLength(2)
})

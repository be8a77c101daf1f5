import { render, screen } from '@testing-library/svelte'
import { describe, expect, it } from 'vitest'
import { session } from '@/transport/session.svelte'
import type { LedgerConflictStatus } from '../api/types'
import ConflictNote from './ConflictNote.svelte'

const conflict: LedgerConflictStatus = {
  recipientId: 'acme',
  kind: 'ROLLED_BACK',
  epoch: 1,
  heldSize: 5,
  foundAt: '2026-11-24T10:00:00Z',
}

describe('a conflict with the witness of the ledger', () => {
  it('is reported with its recipient, what follows and what to do', () => {
    session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
    render(ConflictNote, { conflicts: [conflict] })
    const { textContent } = screen.getByRole('alert')
    for (const part of ['Nothing is disclosed', 'acme', '5', 'newest backup'])
      expect(textContent).toContain(part)
    expect(screen.getByRole('button', { name: 'Begin a new log' })).toBeTruthy()
  })
  it('is shown to viewers, who do not decide about it', () => {
    session.state = { is: 'signedIn', who: { userName: 'ida', role: 'VIEWER', csrfToken: 't' } }
    render(ConflictNote, { conflicts: [conflict] })
    expect(screen.getByRole('alert')).toBeTruthy()
    expect(screen.queryByRole('button', { name: 'Begin a new log' })).toBeNull()
  })
  it.each([undefined, []])('is not reported where there is none', (conflicts) => {
    render(ConflictNote, { conflicts })
    expect(screen.queryByRole('alert')).toBeNull()
  })
})

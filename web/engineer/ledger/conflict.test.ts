import { render, screen } from '@testing-library/svelte'
import { describe, expect, it } from 'vitest'
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
    render(ConflictNote, { conflicts: [conflict] })
    const { textContent } = screen.getByRole('alert')
    for (const part of ['Nothing is disclosed', 'acme', '5', 'newest backup'])
      expect(textContent).toContain(part)
    expect(screen.getByRole('button', { name: 'Begin a new log' })).toBeTruthy()
  })
  it.each([undefined, []])('is not reported where there is none', (conflicts) => {
    render(ConflictNote, { conflicts })
    expect(screen.queryByRole('alert')).toBeNull()
  })
})

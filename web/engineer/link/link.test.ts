import { render, screen } from '@testing-library/svelte'
import { describe, expect, it } from 'vitest'
import type { LeaseStatus } from '../api/types'
import LeaseNote from './LeaseNote.svelte'

const party = (host: string) => ({
  instanceId: 'i',
  host,
  since: '2026-11-22T10:00:00Z',
  lastHeardAt: '2026-11-22T10:00:05Z',
})
const lease = (more: Partial<LeaseStatus>): LeaseStatus => ({
  state: 'HELD',
  since: '2026-11-22T10:00:00Z',
  host: 'cell-pc:/var/lib/verbund',
  ...more,
})

describe('two connectors with one credential', () => {
  it('are reported by the refused one, with the other one’s name and a remedy', () => {
    render(LeaseNote, { lease: lease({ state: 'REFUSED', holder: party('spare-pc:/copy') }) })
    const { textContent } = screen.getByRole('alert')
    for (const part of [
      'Nothing leaves from here',
      'spare-pc:/copy',
      'cell-pc:/var/lib/verbund',
      'administrator of the platform',
    ])
      expect(textContent).toContain(part)
  })
  it('are reported by the one that holds the lease', () => {
    render(LeaseNote, { lease: lease({ contender: party('laboratory:/copy') }) })
    const { textContent } = screen.getByRole('alert')
    for (const part of ['It was refused', 'laboratory:/copy', 'stop it'])
      expect(textContent).toContain(part)
  })
  it('are not, where the platform does not answer, which is said with what it means and a remedy', () => {
    render(LeaseNote, { lease: lease({ state: 'UNANSWERED' }) })
    const { textContent } = screen.getByRole('alert')
    for (const part of ['does not answer', 'No answer since', 'revoked there', 'administrator'])
      expect(textContent).toContain(part)
    expect(textContent).not.toContain('Another connector')
  })
  it.each([undefined, lease({}), lease({ state: 'ASKING' })])(
    'are not reported where there is one',
    (alone) => {
      render(LeaseNote, { lease: alone })
      expect(screen.queryByRole('alert')).toBeNull()
    },
  )
})

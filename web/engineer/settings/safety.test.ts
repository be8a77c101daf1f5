import { render, screen } from '@testing-library/svelte'
import { describe, expect, it } from 'vitest'
import type { Status } from '../api/types'
import SafetyPanel from './SafetyPanel.svelte'

function shown(part: Pick<Status, 'plaintextWays' | 'scriptWorkers'>): string {
  const status = part as Status
  return render(SafetyPanel, { status }).container.textContent.replace(/\s+/g, ' ')
}

describe('what protects and what does not', () => {
  it('is told: walls of each worker, and why one does not run', () => {
    const walls = {
      isFiltered: false,
      landlock: 'partial' as const,
      hasOwnUser: true,
      userId: 65534,
      hasLimits: true,
    }
    const text = shown({
      plaintextWays: [],
      scriptWorkers: [
        { purpose: 'mappings', number: 0, engine: 'quickjs-ng', walls },
        { purpose: 'dryRuns', number: 0, fault: 'scripts are not run: no filter' },
      ],
    })
    expect(text).toMatch(/quickjs-ng.*System calls are NOT filtered.*in part.*user 65534/)
    expect(text).toContain('scripts are not run: no filter')
    expect(text).toContain('Nothing leaves this machine without TLS.')
  })

  it('is an alert for each way without TLS', () => {
    shown({
      plaintextWays: [{ key: 'broker.url', address: 'amqp://broker.example:5672' }],
      scriptWorkers: [],
    })
    expect(screen.getByRole('alert').textContent).toMatch(/WITHOUT TLS.*broker.url.*amqp:/)
  })
})

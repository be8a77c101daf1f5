import { render, screen } from '@testing-library/svelte'
import { describe, expect, it } from 'vitest'
import type { Status } from '../api/types'
import SafetyPanel from './SafetyPanel.svelte'

type Part = Pick<Status, 'plaintextWays' | 'isSealingKeyBesideStore' | 'scriptWorkers'>

function shown(part: Part): string {
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
      isSealingKeyBesideStore: false,
      scriptWorkers: [
        { purpose: 'mappings', number: 0, engine: 'quickjs-ng', walls },
        { purpose: 'dryRuns', number: 0, fault: 'scripts are not run: no filter' },
      ],
    })
    expect(text).toMatch(/quickjs-ng.*System calls are NOT filtered.*in part.*user 65534/)
    expect(text).toContain('scripts are not run: no filter')
    expect(text).toContain('Nothing leaves this machine without TLS.')
    expect(text).toContain('Not in the folder of the store.')
  })

  it('is an alert where scripts run as root, as a setting allows', () => {
    const walls = {
      isFiltered: true,
      landlock: 'full' as const,
      hasOwnUser: false,
      userId: 0,
      hasLimits: true,
    }
    shown({
      plaintextWays: [],
      isSealingKeyBesideStore: false,
      scriptWorkers: [{ purpose: 'mappings', number: 0, engine: 'quickjs-ng', walls }],
    })
    expect(screen.getByRole('alert').textContent).toMatch(/ROOT/)
  })

  it('is an alert for each way without TLS', () => {
    shown({
      plaintextWays: [{ key: 'broker.url', address: 'amqp://broker.example:5672' }],
      isSealingKeyBesideStore: false,
      scriptWorkers: [],
    })
    expect(screen.getByRole('alert').textContent).toMatch(/WITHOUT TLS.*broker.url.*amqp:/)
  })

  it('names each proxy of one key', () => {
    const proxies = ['10.0.0.7/32', '10.0.0.8/32']
    shown({
      plaintextWays: proxies.map((address) => ({ key: 'web.trusted_proxies', address })),
      isSealingKeyBesideStore: false,
      scriptWorkers: [],
    })
    const alerts = screen.getAllByRole('alert').map((alert) => alert.textContent)
    expect(alerts).toHaveLength(proxies.length)
    proxies.forEach((address, index) => {
      expect(alerts[index]).toContain(address)
    })
  })

  it('is an alert where the key of the passwords lies beside the store', () => {
    shown({ plaintextWays: [], isSealingKeyBesideStore: true, scriptWorkers: [] })
    expect(screen.getByRole('alert').textContent).toMatch(/BESIDE THE STORE.*sealing\.key_file/)
  })
})

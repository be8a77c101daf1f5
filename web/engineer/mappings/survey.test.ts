import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { serve, type Asked } from '../../vitest.server'
import type { HealthCounts, MappingHealth, MappingStatus, MappingSurvey } from '../api/types'
import FailingMappings from '../overview/FailingMappings.svelte'
import SurveyPanel from './SurveyPanel.svelte'

const HOUR_MS = 3_600_000
const at = '2026-01-02T03:04:05Z'
const text = (): string => document.body.textContent.replace(/\s+/g, ' ')
const none: HealthCounts = {
  resting: 0,
  failing: 0,
  waiting: 0,
  doubtful: 0,
  clockAhead: 0,
  well: 0,
}

function status(fieldName: string, other: Partial<MappingStatus> = {}): MappingStatus {
  const counts = {
    received: 10,
    yielded: 9,
    repeated: 0,
    late: 0,
    clockSteps: 0,
    superseded: 0,
    faults: 0,
    spentUs: 25,
  }
  const target = {
    operationNetworkId: 'n',
    operationId: 'turn',
    dynamicDataRequestId: 'progress',
    fieldName,
  }
  const inputs = [{ name: 'a', value: { value: 1, status: 0 }, receivedAt: at, clockAheadMs: 2 }]
  return {
    ...counts,
    mappingId: fieldName,
    target,
    inputs,
    circuit: { state: 'closed' },
    lastCandidate: { value: 42, status: 0 },
    lastYieldedAt: at,
    ...other,
  }
}

let survey: MappingSurvey
const every: { health: MappingHealth; status: MappingStatus }[] = [
  {
    health: 'RESTING',
    status: status('load', {
      circuit: { state: 'resting', until: at },
      faults: 5,
      spentUs: 1_660_000,
    }),
  },
  {
    health: 'FAILING',
    status: status('label', {
      faults: 3,
      lastFault: { at, kind: 'scriptError', message: 'out of order', step: 1, line: 2, column: 7 },
    }),
  },
  {
    health: 'WAITING',
    status: status('sum', {
      inputs: [{ name: 'a', value: { value: 1, status: 0 } }, { name: 'b' }],
      lastCandidate: null,
      lastYieldedAt: null,
      received: 0,
    }),
  },
  {
    health: 'DOUBTFUL',
    status: status('power', { lastCandidate: { value: 7, status: 0x40000000 } }),
  },
  {
    health: 'CLOCK_AHEAD',
    status: status('speed', { inputs: [{ name: 'a', clockAheadMs: 2 * HOUR_MS }] }),
  },
  { health: 'WELL', status: status('made') },
]

function show(component: typeof SurveyPanel | typeof FailingMappings): Asked[] {
  const log = serve({ 'GET /mappings/survey': () => survey })
  render(component)
  return log
}

beforeEach(() => {
  survey = {
    counts: { resting: 1, failing: 1, waiting: 1, doubtful: 1, clockAhead: 1, well: 70 },
    items: every,
  }
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the status of all mappings', () => {
  it('lists each with its problem and a link to its field, the worst first', async () => {
    show(SurveyPanel)
    expect((await screen.findByRole('link', { name: 'label' })).getAttribute('href')).toContain(
      'fields/n/turn/progress/label',
    )
    const said = text()
    const words = [
      'Paused',
      'exceeded its budget',
      'Failing',
      'The script failed. (Function 2, line 2, column 7)',
      'out of order',
      'Waiting',
      'No value received yet from: b.',
      'Uncertain',
      'Clock ahead',
      'is 2 h',
      'Good',
    ]
    const places = words.map((word) => said.indexOf(word, said.indexOf('Status')))
    expect(places).toEqual([...places].sort((one, other) => one - other))
    expect(places).not.toContain(-1)
    expect(said).toContain('The first 6 of 75 are shown.')
    expect(said).toContain('2.5 µs')
    expect(said).toContain('170 ms')
  })

  it('is filtered by a status, of those that occur', async () => {
    survey.counts = { ...none, failing: 1, well: 5 }
    const log = show(SurveyPanel)
    expect(
      (await screen.findAllByRole('radio')).map((radio) => (radio as HTMLInputElement).value),
    ).toEqual(['ALL', 'FAILING', 'WELL'])
    await userEvent.click(screen.getByRole('radio', { name: 'Failing 1' }))
    await vi.waitFor(() =>
      expect(log.at(-1)?.path).toBe('/mappings/survey?limit=50&health=FAILING'),
    )
  })

  it('says that nothing is mapped yet', async () => {
    survey = { counts: none, items: [] }
    show(SurveyPanel)
    expect(await screen.findByText('No field is mapped yet.')).toBeTruthy()
  })
})

describe('the overview', () => {
  it('shows the number of failing mappings, and nothing while there is none', async () => {
    show(FailingMappings)
    expect(await screen.findByText('2 mappings are failing')).toBeTruthy()
    expect(screen.getByRole('link', { name: 'Show them' }).getAttribute('href')).toContain(
      'mappings',
    )
  })

  it('is quiet while none fails', async () => {
    survey.counts = { ...none, waiting: 3, well: 2 }
    const log = show(FailingMappings)
    await vi.waitFor(() => expect(log).toHaveLength(1))
    expect(text()).not.toContain('fail')
  })
})

import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { fromLocalInput, toLocalInput } from '@/format/local-time'
import { session } from '@/transport/session.svelte'
import { serve } from '../../vitest.server'
import type { NetworkView, Operation } from '../api/types'
import { isInverted, planOf, withPlan } from './plan'
import PlanButton from './PlanButton.svelte'

const operation: Operation = {
  operationId: 'turn',
  name: 'Turn',
  operationType: 'PRODUCTION',
  owningFactoryId: 'F',
  plannedStart: '2026-11-23T08:00:00.250Z',
  plannedEnd: '2026-11-23T12:00:00Z',
  plannedQuantity: 12,
  quantityUnit: 'H87',
}
const view: NetworkView = {
  collaborationId: 'c',
  revision: 4,
  updatedAt: '2026-11-21T10:00:00Z',
  lastEventId: '0-0',
  drawnBy: 'acme',
  parts: [],
  operations: [],
  fields: [],
  network: {
    operationNetworkId: 'n',
    operationList: [operation, { operationId: 'drill', operationType: 'PRODUCTION' }],
  },
}

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the plan of an operation', () => {
  it('is shown in local time, and what is not changed stays as it is', () => {
    const draft = planOf(operation)
    expect(fromLocalInput(draft.end)).toBe('2026-11-23T12:00:00.000Z')
    const [turn, drill] = withPlan(view.network, 'turn', { ...draft, quantity: 20 }).operationList
    expect(turn).toEqual({ ...operation, plannedQuantity: 20 })
    expect(drill).toEqual(view.network.operationList[1])
  })
  it('may lose a time, and does not end before it starts', () => {
    const draft = { ...planOf(operation), start: '' }
    expect(withPlan(view.network, 'turn', draft).operationList[0]).not.toHaveProperty(
      'plannedStart',
    )
    expect(isInverted(draft)).toBe(false)
    expect(isInverted({ ...draft, start: toLocalInput('2026-11-24T00:00:00Z') })).toBe(true)
  })
  it('is no text that is no time', () => {
    expect([fromLocalInput('23.11.2026 16:00'), fromLocalInput(''), toLocalInput('x')]).toEqual([
      undefined,
      undefined,
      '',
    ])
  })
})

describe('the button of the plan', () => {
  const signIn = (role: 'VIEWER' | 'PLANNER', organisationId: string): void => {
    session.state = {
      is: 'signedIn',
      who: { userName: 'p', role, csrfToken: 't', organisationId },
    }
  }
  const show = (): void => {
    render(PlanButton, { view, operation, onchanged: () => undefined })
  }

  it('puts the revision that was read, with the plan alone changed', async () => {
    signIn('PLANNER', 'acme')
    const server = serve({
      'GET /factories': () => ({ items: [] }),
      'PUT /operation-networks/n': () => ({ revision: 5, sentTo: [] }),
    })
    show()
    await userEvent.click(screen.getByRole('button', { name: 'Change the plan' }))
    const quantity = screen.getByLabelText('Quantity (pcs)')
    await userEvent.clear(quantity)
    await userEvent.type(quantity, '20')
    await userEvent.click(screen.getByRole('button', { name: 'Save' }))
    const put = server.find(({ method }) => method === 'PUT')
    expect(put?.ifMatch).toBe('"4"')
    expect(put?.body).toMatchObject({
      collaborationId: 'c',
      operationNetwork: { operationList: [{ ...operation, plannedQuantity: 20 }, {}] },
    })
  })
  it('is there for the performer, and for nobody else', async () => {
    serve({
      'GET /factories': () => ({
        items: [{ factoryId: 'F', name: 'F', organisationId: 'steel' }],
      }),
    })
    signIn('PLANNER', 'steel')
    show()
    expect(await screen.findByRole('button', { name: 'Change the plan' })).toBeTruthy()
    for (const [role, organisation] of [
      ['VIEWER', 'acme'],
      ['PLANNER', 'other'],
    ] as const) {
      document.body.replaceChildren()
      signIn(role, organisation)
      show()
      await new Promise((done) => setTimeout(done, 20))
      expect(screen.queryByRole('button', { name: 'Change the plan' })).toBeNull()
    }
  })
})

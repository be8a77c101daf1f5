import { render, screen } from '@testing-library/svelte'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { session } from '@/transport/session.svelte'
import { serve } from '../../vitest.server'
import type { FieldView, InboxRequest } from '../api/types'
import DecisionPage from './DecisionPage.svelte'

const key = {
  operationNetworkId: 'n',
  operationId: 'o',
  dynamicDataRequestId: 'r',
  fieldName: 'state',
}
const field: FieldView = {
  key,
  name: 'state',
  semantic: 'OPERATION_STATE',
  type: 'String',
  valueRank: -1,
  mappingState: 'MAPPED',
  valueSource: 'MANUAL',
  value: { value: 'AllowedToStart', status: 'Good' },
  disclosure: {},
  disclosureParts: [],
  effectiveDisclosure: {},
  grounds: { policyId: null, policies: [], rules: [] },
  hasShadow: false,
  isWithheld: false,
}
const request: InboxRequest = {
  key,
  operation: { operationId: 'o', operationType: 'PRODUCTION' },
  requesterId: 'acme',
  recipientList: ['acme'],
  purpose: 'Plan',
  receivedAt: '2026-01-01T00:00:00Z',
  hasEnded: false,
  isOverdue: false,
  reportName: 'Progress',
  fields: [field],
}

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the page of a field', () => {
  const show = (role: 'ENGINEER' | 'VIEWER'): void => {
    session.state = { is: 'signedIn', who: { userName: 'p', role, csrfToken: 't' } }
    serve({ 'GET /requests/n/o/r': () => request, 'GET /inbox': () => ({ items: [request] }) })
    render(DecisionPage, { fieldKey: key })
  }

  it('has the meaning as its title, and the state in words', async () => {
    show('ENGINEER')
    expect(await screen.findByRole('heading', { level: 1, name: 'Operation state' })).toBeTruthy()
    expect(screen.getByText('state')).toBeTruthy()
    expect(screen.getAllByText('Ready to start').length).toBeGreaterThan(0)
    expect(screen.getByRole('button', { name: 'Stop disclosing' })).toBeTruthy()
  })
  it('shows viewers the request, and nothing to decide', async () => {
    show('VIEWER')
    expect(await screen.findByText(/^Your role shows the request/)).toBeTruthy()
    expect(screen.getAllByText('acme').length).toBeGreaterThan(0)
    expect(screen.queryByRole('radio')).toBeNull()
    expect(screen.queryByRole('button', { name: /Stop disclosing|Consent/ })).toBeNull()
  })
})

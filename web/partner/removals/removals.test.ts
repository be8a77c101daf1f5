import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { words } from '@/language/words'
import { session } from '@/transport/session.svelte'
import { serve, type Asked } from '../../vitest.server'
import type { AuditEntry, Removal } from '../api/types'
import AuditPage from '../audit/AuditPage.svelte'
import { factText } from '../audit/facts'
import { texts } from '../language/texts'
import RemovalDialog from './RemovalDialog.svelte'
import LeavePanel from './LeavePanel.svelte'
import { person } from './leavers'

const removal = (more: Partial<Removal> = {}): Removal => ({
  isDone: false,
  inForce: [],
  people: ['anna'],
  sessions: 2,
  credentials: 0,
  requests: [],
  remains: ['COMMENTS', 'AUDIT'],
  ...more,
})

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('a removal', () => {
  it('is confirmed once it was said what ends', async () => {
    const log = serve({
      'DELETE /users/anna': ({ path }: Asked) => removal({ isDone: !path.includes('dryRun=true') }),
    })
    const onleft = vi.fn()
    render(RemovalDialog, { leaver: person('anna', 'acme'), onclose: vi.fn(), onleft })
    expect(await screen.findByText(texts.removals.sessions(2))).toBeTruthy()
    expect(log.map(({ path }) => path)).toEqual(['/users/anna?dryRun=true'])
    expect(screen.getByText(texts.removals.remains.COMMENTS)).toBeTruthy()
    expect(screen.queryByText(texts.removals.remains.REPORTS)).toBeNull()
    await userEvent.click(screen.getByRole('button', { name: texts.removals.remove }))
    await vi.waitFor(() => {
      expect(onleft).toHaveBeenCalledOnce()
    })
    expect(log.map(({ path }) => path)).toEqual([
      '/users/anna?dryRun=true',
      '/users/anna?dryRun=false',
    ])
  })

  it('waits for what is in force', async () => {
    serve({ 'DELETE /users/anna': () => removal({ inForce: ['users/anna'] }) })
    render(RemovalDialog, {
      leaver: person('anna', 'acme'),
      onclose: vi.fn(),
      onleft: vi.fn(),
    })
    expect(await screen.findByText('users/anna')).toBeTruthy()
    const button = screen.getByRole<HTMLButtonElement>('button', { name: texts.removals.remove })
    expect(button.disabled).toBe(true)
  })
})

describe('what is one’s own', () => {
  const who = { userName: 'anna', role: 'PLANNER', organisationId: 'acme', csrfToken: 't' } as const
  const lists = {
    'GET /collaborations': () => ({
      items: [
        {
          collaborationId: 'order',
          name: 'Frames',
          members: ['acme', 'munich'],
          factories: ['ACME_1', 'MUC_1'],
        },
      ],
    }),
    'GET /factories': () => ({
      items: [
        { factoryId: 'ACME_1', organisationId: 'acme' },
        { factoryId: 'MUC_1', organisationId: 'munich' },
      ],
    }),
    'GET /tools': () => ({ items: [{ toolId: 'Planning', organisationId: 'acme' }] }),
  }

  it('is all that a planner lets leave', async () => {
    const log = serve({ ...lists, 'DELETE /tools/Planning': () => removal() })
    render(LeavePanel, { who })
    const tool = (await screen.findByText('Planning')).closest('li')
    expect(screen.getAllByRole('listitem').map((item) => item.textContent.trim())).toHaveLength(5)
    expect(screen.queryByText('MUC_1')).toBeNull()
    expect(screen.queryByText('munich')).toBeNull()
    await userEvent.click(within(tool ?? document.body).getByRole('button'))
    expect(await screen.findByText(texts.removals.stays)).toBeTruthy()
    expect(log.at(-1)).toMatchObject({ method: 'DELETE', path: '/tools/Planning?dryRun=true' })
  })

  it('is the account alone of a viewer, who is signed out with it', async () => {
    const log = serve({
      'DELETE /users/anna': ({ path }: Asked) => removal({ isDone: !path.includes('dryRun=true') }),
    })
    session.state = { is: 'signedIn', who: { ...who, role: 'VIEWER' } }
    render(LeavePanel, { who: { ...who, role: 'VIEWER' } })
    await userEvent.click(await screen.findByRole('button', { name: texts.removals.leave }))
    expect(await screen.findByText(texts.removals.ownAccountNote)).toBeTruthy()
    await userEvent.click(screen.getByRole('button', { name: texts.removals.remove }))
    await vi.waitFor(() => {
      expect(session.who).toBeUndefined()
    })
    expect(log.map(({ method, path }) => `${method} ${path}`)).toEqual([
      'DELETE /users/anna?dryRun=true',
      'DELETE /users/anna?dryRun=false',
      'DELETE /session',
    ])
  })
})

describe('the record of changes', () => {
  it('names people of the own organisation and the organisations of others', async () => {
    const entry: AuditEntry = {
      entryId: '1c',
      recordedAt: '2026-01-01T00:00:00Z',
      agentKind: 'USER',
      operation: 'putUser',
      subject: 'users/anna',
      outcome: 'DONE',
      detail: [],
    }
    serve({
      'GET /audit-entries': () => ({
        items: [
          { ...entry, entryId: 'a3', agentName: 'anna', organisationId: 'acme' },
          { ...entry, entryId: 'b2', organisationId: 'munich' },
          { ...entry, detail: [{ kind: 'ROLE', former: 'VIEWER', present: 'PLANNER' }] },
        ],
      }),
    })
    render(AuditPage)
    for (const who of ['anna', 'munich', texts.audit.operator]) {
      expect(await screen.findByText(who)).toBeTruthy()
    }
    const planner = words.session.role['planner'] ?? ''
    expect(screen.getByText((text) => text.endsWith(`→ ${planner}`))).toBeTruthy()
    expect(screen.getAllByText(texts.audit.operation['putUser'] ?? '')).toHaveLength(3)
  })

  it('says what a person was and is', () => {
    const { role } = words.session
    const promoted = factText({ kind: 'ROLE', former: 'VIEWER', present: 'ADMINISTRATOR' })
    expect(promoted).toBe(`${texts.audit.fact.ROLE}: ${role['viewer']} → ${role['administrator']}`)
    const left = factText({ kind: 'CREDENTIALS', former: '2' })
    expect(left).toBe(`${texts.audit.fact.CREDENTIALS}: 2 → ${texts.audit.ended}`)
    expect(factText({ kind: 'REVISION', present: '7' })).toBe(`${texts.audit.fact.REVISION}: 7`)
  })
})

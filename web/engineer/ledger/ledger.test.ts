import { fireEvent, render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { problem, serve, type Asked } from '../../vitest.server'
import type { CheckpointView, FieldKey, LedgerEntry, VerificationView } from '../api/types'
import { momentOf, subjectsOf, subjectText, withKind, withSubject, withTime } from './filter'
import { session } from '@/transport/session.svelte'
import LedgerPage from './LedgerPage.svelte'

const CHAIN = 25
const PAGE = 10
const entry = (sequence: number, more: object = {}): LedgerEntry =>
  ({
    sequence,
    at: '2026-11-21T06:00:00Z',
    recipientId: 'acme',
    kind: 'SENT',
    hash: 'ab'.repeat(32),
    precision: {},
    precisionParts: {},
    dataSetWriterId: 3,
    firstSequence: sequence,
    lastSequence: sequence,
    ...more,
  }) as LedgerEntry
const verified = (more: Partial<VerificationView> = {}): VerificationView => ({
  valid: true,
  chains: 2,
  entries: 1_000,
  valuesCompared: 800,
  valuesEmptied: 20,
  entriesPruned: 7,
  checkpoints: 5,
  revocations: 1,
  faultCount: 0,
  faultList: [],
  publicKey: 'c0ffee',
  ...more,
})

/** A chain as the connector gives it out: newest first, in pages. */
function page({ path }: Asked): unknown {
  const query = new URLSearchParams(path.split('?')[1])
  const before = Number(query.get('after') ?? CHAIN + 1)
  const items = Array.from({ length: Math.min(PAGE, before - 1) }, (_, index) =>
    entry(before - 1 - index, { recipientId: query.get('recipient') ?? 'acme' }),
  )
  const last = items.at(-1)?.sequence ?? 1
  return { recipients: ['acme', 'byron'], items, nextCursor: last > 1 ? String(last) : null }
}
const pages = (log: Asked[]): Asked[] => log.filter(({ path }) => path.startsWith('/ledger?'))
const rows = (): Element[] => [...document.querySelectorAll('[role=region] tbody tr')]
const nothing = {
  'GET /revocations': () => ({ items: [] }),
  'GET /ledger/checkpoints': () => ({ items: [] }),
  'GET /ledger/fields': () => ({ items: [] }),
}
beforeEach(() => {
  session.state = { is: 'signedIn', who: { userName: 'eva', role: 'ENGINEER', csrfToken: 't' } }
})
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('times in a filter', () => {
  it('are moments, or nothing', () => {
    expect(momentOf('2026-11-21T06:00')).toBe(new Date(2026, 10, 21, 6).toISOString())
    expect([momentOf(''), momentOf('soon')]).toEqual([undefined, undefined])
    expect(withTime({ recipient: 'acme', from: 'x' }, 'from', '')).toEqual({ recipient: 'acme' })
  })
})

const key = (operationId: string, fieldName: string): FieldKey => ({
  operationNetworkId: 'n',
  operationId,
  dynamicDataRequestId: 'R',
  fieldName,
})

describe('what a filter is about', () => {
  it('is offered as requests with their fields', () => {
    expect(
      subjectsOf([key('mill', 'count'), key('mill', 'state'), key('turn', 'count')]).map(
        subjectText,
      ),
    ).toEqual([
      'n / mill / R',
      'n / mill / R / count',
      'n / mill / R / state',
      'n / turn / R',
      'n / turn / R / count',
    ])
  })
  it('is put in the place of what it was about', () => {
    const filter = withSubject(
      { recipient: 'acme', kind: 'SENT', fieldName: 'old' },
      { operationNetworkId: 'n' },
    )
    expect(filter).toEqual({ recipient: 'acme', kind: 'SENT', operationNetworkId: 'n' })
    expect([withSubject(filter, {}), withKind(filter, '')]).toEqual([
      { recipient: 'acme', kind: 'SENT' },
      { recipient: 'acme', operationNetworkId: 'n' },
    ])
  })
})

describe('the ledger', () => {
  it('goes through a chain by pages, one at a time', async () => {
    const log = serve({ ...nothing, 'GET /ledger': page })
    render(LedgerPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Older entries' }))
    expect(await screen.findByText('No. 15 to 6')).toBeTruthy()
    expect(rows()).toHaveLength(PAGE)
    await userEvent.click(screen.getByRole('button', { name: 'Older entries' }))
    expect(await screen.findByText('No. 5 to 1')).toBeTruthy()
    expect(screen.getByRole('button', { name: 'Older entries' })).toHaveProperty('disabled', true)
    await userEvent.click(screen.getByRole('button', { name: 'Newer entries' }))
    expect(await screen.findByText('No. 15 to 6')).toBeTruthy()
    expect(
      pages(log).map(({ path }) => new URLSearchParams(path.split('?')[1]).get('after')),
    ).toEqual([null, '16', '6', '16'])
  })

  it('asks the connector for a partner and a time, from the newest on', async () => {
    const log = serve({ ...nothing, 'GET /ledger': page })
    render(LedgerPage)
    await userEvent.click(await screen.findByRole('button', { name: 'Older entries' }))
    await userEvent.selectOptions(screen.getByLabelText('Recipient'), 'byron')
    await fireEvent.change(screen.getByLabelText('From'), { target: { value: '2026-11-21T06:00' } })
    await fireEvent.change(screen.getByLabelText('Until'), {
      target: { value: '2026-11-22T06:00' },
    })
    const from = new Date(2026, 10, 21, 6).toISOString()
    const until = new Date(2026, 10, 22, 6).toISOString()
    await vi.waitFor(() =>
      expect(
        Object.fromEntries(new URLSearchParams(pages(log).at(-1)?.path.split('?')[1])),
      ).toEqual({ recipient: 'byron', from, until, limit: '100' }),
    )

    const csv = screen.getByRole('link', { name: 'CSV' }).getAttribute('href') ?? ''
    expect(csv.split('?')[0]).toBe('/api/v1/ledger/export')
    expect(Object.fromEntries(new URLSearchParams(csv.split('?')[1]))).toEqual({
      format: 'csv',
      recipient: 'byron',
      from,
      until,
      language: 'en',
    })
    await userEvent.click(screen.getByRole('button', { name: 'Any time' }))
    await vi.waitFor(() =>
      expect(pages(log).at(-1)?.path).toBe('/ledger?recipient=byron&limit=100'),
    )
  })

  it('asks the connector for a kind of entries, and for a field that is typed', async () => {
    const log = serve({
      ...nothing,
      'GET /ledger': page,
      'GET /ledger/fields': () => ({ items: [{ key: key('mill', 'count') }] }),
    })
    const { container } = render(LedgerPage)
    await userEvent.selectOptions(await screen.findByLabelText('Outcome'), 'Sent')
    await vi.waitFor(() =>
      expect(
        [...container.querySelectorAll('datalist option')].map((option) =>
          option.getAttribute('value'),
        ),
      ).toEqual(['n / mill / R', 'n / mill / R / count']),
    )
    const input = screen.getByLabelText('Request or field')
    await fireEvent.input(input, { target: { value: 'mill / cou' } })
    await vi.waitFor(() => expect(log.at(-1)?.path).toBe('/ledger/fields?search=mill%20%20%20cou'))
    await fireEvent.input(input, { target: { value: 'n / mill / R / count' } })
    const about = {
      kind: 'SENT',
      operationNetworkId: 'n',
      operationId: 'mill',
      dynamicDataRequestId: 'R',
      fieldName: 'count',
    }
    await vi.waitFor(() =>
      expect(
        Object.fromEntries(new URLSearchParams(pages(log).at(-1)?.path.split('?')[1])),
      ).toEqual({ ...about, limit: '100' }),
    )
    expect(
      Object.fromEntries(
        new URLSearchParams(
          screen.getByRole('link', { name: 'CSV' }).getAttribute('href')?.split('?')[1],
        ),
      ),
    ).toMatchObject(about)
    await userEvent.click(screen.getByRole('button', { name: 'Any request' }))
    await vi.waitFor(() => expect(pages(log).at(-1)?.path).toBe('/ledger?kind=SENT&limit=100'))
    expect(input).toHaveProperty('value', '')
  })

  it('begins with the field that one came from', async () => {
    const log = serve({ ...nothing, 'GET /ledger': () => ({ recipients: ['acme'], items: [] }) })
    render(LedgerPage, { about: { recipient: 'acme', ...key('mill', 'count') } })
    expect(await screen.findByText('No match')).toBeTruthy()
    expect(screen.getByLabelText('Request or field')).toHaveProperty(
      'value',
      'n / mill / R / count',
    )
    expect(pages(log)[0]?.path).toContain('fieldName=count')
  })

  it('lists the signed checkpoints page by page, each with what proves it', async () => {
    const checkpoint = (number: number): CheckpointView => ({
      number,
      recordedAt: '2026-11-21T06:00:00Z',
      heads: [{ recipient: 'acme', number: 100 * number, hash: 'ab' }],
      signedText: `{"number":${number}}`,
      signature: `${number}`.repeat(32),
      publicKey: 'c0ffee',
    })
    const log = serve({
      ...nothing,
      'GET /ledger': page,
      'GET /ledger/checkpoints': ({ path }) =>
        path.includes('cursor=2')
          ? { items: [checkpoint(1)] }
          : { items: [checkpoint(3), checkpoint(2)], nextCursor: '2' },
    })
    render(LedgerPage)
    const panel = within(
      (await screen.findByRole('heading', { name: 'Signed checkpoints' })).closest(
        'section',
      ) as HTMLElement,
    )
    expect(await panel.findByText('acme 300')).toBeTruthy()
    expect(panel.getByText('{"number":2}')).toBeTruthy()
    await userEvent.click(panel.getByRole('button', { name: 'Load more' }))
    expect(await panel.findByText('acme 100')).toBeTruthy()
    expect(panel.queryByRole('button', { name: 'Load more' })).toBeNull()
    expect(
      log.map(({ path }) => path).filter((path) => path.startsWith('/ledger/checkpoints')),
    ).toEqual(['/ledger/checkpoints', '/ledger/checkpoints?cursor=2'])
  })

  it('exports the chain that is shown, in three forms', async () => {
    serve({ ...nothing, 'GET /ledger': page })
    render(LedgerPage)
    await screen.findByText('No. 25 to 16')
    const links = within(screen.getByRole('group', { name: 'Export' })).getAllByRole('link')
    expect(
      links.map((link) => [
        link.textContent.trim(),
        new URLSearchParams(link.getAttribute('href')?.split('?')[1]).get('format'),
      ]),
    ).toEqual([
      ['JSON lines', 'jsonl'],
      ['CSV', 'csv'],
      ['Page to print (HTML)', 'html'],
    ])
    expect(links[0]?.getAttribute('href')).toContain('recipient=acme')
  })

  it('says what left, in which precision, and how far it came', async () => {
    const items = [
      entry(3, {
        kind: 'QUEUED',
        value: { count: { UaType: 9, Value: 40 } },
        precision: { count: 'Rounded to 10.' },
        leftInMessage: 'm-1',
        sentAt: '2026-11-21T06:00:01Z',
        deliveredAt: '2026-11-21T06:00:02Z',
      }),
      entry(2, { kind: 'QUEUED', value: { count: 30 }, sentAt: '2026-11-21T06:00:01Z' }),
      entry(1, {
        kind: 'CONSENT',
        fieldName: 'count',
        policy: { roundingStep: 10 },
        mappingState: 'MAPPED',
        decidedBy: 'eva',
        grounds: { preview: '00ff' },
      }),
      entry(0, {
        kind: 'CONSENT',
        fieldName: 'scrap',
        policy: {},
        mappingState: 'MAPPED',
        decidedBy: 'eva',
      }),
    ]
    serve({ ...nothing, 'GET /ledger': () => ({ recipients: ['acme'], items }) })
    render(LedgerPage)
    await screen.findByText('Rounded to 10.')
    const said = rows().map((row) => row.textContent.replace(/\s+/g, ' '))
    expect(said[0]).toMatch(/count 40 .*delivered 21 Nov.*m-1/)
    expect(said[1]).toMatch(/sent 21 Nov.*, no receipt yet/)
    expect(said[2]).toMatch(/Decision.*Mapped · eva.*Rounding step 10.*decided on its preview/)
    expect(said[3]).toMatch(/Decision.*Mapped · eva.*decided without a preview/)
    expect(screen.queryByRole('navigation')).toBeNull()
  })

  it('offers a viewer neither export nor verification, which read all of it', async () => {
    session.state = { is: 'signedIn', who: { userName: 'vera', role: 'VIEWER', csrfToken: 't' } }
    serve({ ...nothing, 'GET /ledger': page })
    render(LedgerPage)
    await screen.findByRole('region', { name: 'Ledger' })
    expect(screen.queryByRole('button', { name: 'Verify the chain' })).toBeNull()
    expect(screen.queryByRole('group', { name: 'Export' })).toBeNull()
  })

  it('verifies, with the evidence', async () => {
    serve({ ...nothing, 'GET /ledger': page, 'POST /ledger/verification': () => verified() })
    render(LedgerPage)
    await userEvent.click(screen.getByRole('button', { name: 'Verify the chain' }))
    const result = within(await screen.findByRole('region', { name: 'Result of the verification' }))
    expect(result.getByText(/^Intact: 1,000 entries verified/)).toBeTruthy()
    expect(result.getByText('Signed checkpoints').nextElementSibling?.textContent).toBe('5')
    expect(result.getByText('c0ffee')).toBeTruthy()
  })

  it('lists what was tampered with', async () => {
    serve({
      ...nothing,
      'GET /ledger': page,
      'POST /ledger/verification': () =>
        verified({
          valid: false,
          faultCount: 2,
          faultList: [
            { recipient: 'acme', number: 12, message: 'The hash differs.' },
            { recipient: '', number: 3, message: 'A head is missing.' },
          ],
        }),
    })
    render(LedgerPage)
    await userEvent.click(screen.getByRole('button', { name: 'Verify the chain' }))
    const result = within(await screen.findByRole('region', { name: 'Result of the verification' }))
    expect(result.getByText('The ledger has been tampered with. 2 faults found.')).toBeTruthy()
    const faults = result
      .getAllByRole('listitem')
      .map((item) => item.textContent.replace(/\s+/g, ' ').trim())
    expect(faults).toEqual([
      'acme No. 12: this is not as it was written. In the server’s words The hash differs.',
      'No. 3: this is not as it was written. In the server’s words A head is missing.',
    ])
  })

  it('says when it could not verify', async () => {
    serve({
      ...nothing,
      'GET /ledger': page,
      'POST /ledger/verification': () => problem(500, 'The disk is gone.'),
    })
    render(LedgerPage)
    await userEvent.click(screen.getByRole('button', { name: 'Verify the chain' }))
    expect((await screen.findByRole('alert')).textContent).toContain('The disk is gone.')
  })
})

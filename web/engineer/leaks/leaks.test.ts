import { render, screen, within } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { language } from '@/language/language.svelte'
import { problem, serve, type Asked } from '../../vitest.server'
import type { FieldLeak, PartnerLeaks, StatementPart, VariableLeak } from '../api/types'
import LeaksPage from './LeaksPage.svelte'
import { bitsReach, byWeight, precisionText, rateReach, rateText } from './measure'

const leak = (fieldName: string, more: Partial<FieldLeak> = {}): FieldLeak => ({
  key: {
    operationNetworkId: 'n',
    operationId: 'turn',
    dynamicDataRequestId: 'progress',
    fieldName,
  },
  statement: 'Every value.',
  statementParts: [],
  measured: { released: 24, hours: 2 },
  timeResolutionMs: 0,
  ...more,
})
const budget = (more: Partial<PartnerLeaks> = {}): PartnerLeaks => ({
  partner: 'acme',
  fields: [leak('count')],
  variables: [],
  warnings: [],
  valuesPerHourMeasured: 12,
  ...more,
})
const nothing = { items: [] }
/** Answers to all requests of the page, with those of a test. */
const connector = (answers: Parameters<typeof serve>[0]): Asked[] =>
  serve({
    'GET /leak-budgets': () => nothing,
    'GET /leak-budgets/alliances': () => nothing,
    'GET /alliances': () => nothing,
    'GET /caps': () => nothing,
    'GET /recipients': () => ({ items: [{ recipient: 'acme', fieldCount: 1 }] }),
    ...answers,
  })
afterEach(() => {
  vi.unstubAllGlobals()
})

describe('figures', () => {
  it('lie on scales that end', () => {
    expect([rateReach(1 / 24), rateReach(36_000), rateReach(1e9), rateReach(0)]).toEqual([
      0, 1, 1, 0,
    ])
    expect(rateReach(undefined)).toBeUndefined()
    expect(rateReach(3600)).toBeGreaterThan(rateReach(60) ?? 1)
    expect([bitsReach(0), bitsReach(32), bitsReach(64), bitsReach(null)]).toEqual([
      0,
      0.5,
      1,
      undefined,
    ])
  })
  it('are said in words that people can picture', () => {
    expect([precisionText(Math.log2(21)), precisionText(64), precisionText(null)]).toEqual([
      'one of 21 values',
      '64 bit',
      'no bound',
    ])
    expect([rateText(0.5), rateText(1234.567), rateText(null)]).toEqual([
      '0.5 per hour',
      '1,235 per hour',
      'no limit',
    ])
    language.choose('de')
    expect([precisionText(1), rateText(1.25)]).toEqual(['einer von 2 Werten', '1,25 je Stunde'])
  })
  it('put what is warned of first, then what tells most', () => {
    const fields = [
      leak('little', { valuesPerHourMax: 1, bitsPerValue: 1 }),
      leak('endless'),
      leak('warned', { valuesPerHourMax: 1, bitsPerValue: 1 }),
    ]
    const warnings = [
      { conclusion: 'UTILISATION' as const, text: '', fields: [leak('warned').key] },
    ]
    expect(byWeight(fields, warnings).map(({ field }) => field.key.fieldName)).toEqual([
      'warned',
      'endless',
      'little',
    ])
  })
})

describe('the leak budget', () => {
  it('draws each field and says the same in words', async () => {
    connector({
      'GET /leak-budgets': () => ({
        items: [
          budget({
            fields: [
              leak('count', {
                valuesPerHourMax: 60,
                bitsPerValue: Math.log2(101),
                timeResolutionMs: 300_000,
              }),
            ],
          }),
        ],
      }),
    })
    render(LeaksPage)
    const row = within(
      (await screen.findByRole('link', { name: 'count' })).closest('tr') as HTMLElement,
    )
    expect(row.getByRole('img', { name: 'Rate: 60 per hour, measured 12 per hour' })).toBeTruthy()
    expect(row.getByRole('img', { name: 'Precision: one of 101 values' })).toBeTruthy()
    expect(row.getByText('to within 5 min')).toBeTruthy()
  })
  it('says what can be concluded, why, and leads to the fields that allow it', async () => {
    const warnings = [
      {
        conclusion: 'CYCLE_TIME' as const,
        text: 'The server’s words',
        fields: [leak('count').key],
        neededMs: 360_000,
      },
    ]
    connector({ 'GET /leak-budgets': () => ({ items: [budget({ warnings })] }) })
    render(LeaksPage)
    expect(await screen.findByText('Cycle time')).toBeTruthy()
    expect(screen.getByText(/From 6 min on/)).toBeTruthy()
    expect(screen.getByRole('link', { name: 'Coarsen: count' }).getAttribute('href')).toBe(
      '#/fields/n/turn/progress/count',
    )
    expect(screen.getByText('1 conclusion possible')).toBeTruthy()
  })
  it('shows the description for partners in the reader’s language', async () => {
    language.choose('de')
    const statementParts: StatementPart[] = [
      { code: 'ROUNDED', step: 10, unit: 'PIECE' },
      { code: 'INTERVAL', periodMs: 60_000 },
    ]
    const cycle = {
      conclusion: 'CYCLE_TIME' as const,
      text: 'Each piece …',
      fields: [leak('count').key],
      neededMs: 900_000,
    }
    connector({
      'GET /leak-budgets': () => ({
        items: [budget({ fields: [leak('count', { statementParts })], warnings: [cycle] })],
      }),
    })
    render(LeaksPage)
    expect(
      await screen.findByText('Gerundet auf Vielfache von 10 Stk.; höchstens einmal je 1 min.'),
    ).toBeTruthy()
    expect(screen.getByText(/^Der Plan nennt keine Zeit je Stück/)).toBeTruthy()
  })
  it('takes the server’s words for a conclusion it does not know', async () => {
    const warnings = [
      {
        conclusion: 'SHIFT_PLAN' as never,
        text: 'Pauses tell the shifts.',
        fields: [leak('count').key],
      },
    ]
    connector({ 'GET /leak-budgets': () => ({ items: [budget({ warnings })] }) })
    render(LeaksPage)
    expect(await screen.findByText('Pauses tell the shifts.')).toBeTruthy()
  })
  it('keeps many fields out of the document until they are asked for', async () => {
    const fields = Array.from({ length: 5_000 }, (_, number) => leak(`field${number}`))
    connector({ 'GET /leak-budgets': () => ({ items: [budget({ fields })] }) })
    const { container } = render(LeaksPage)
    await userEvent.click(await screen.findByRole('button', { name: '4980 more fields' }))
    expect(container.querySelectorAll('tr[data-field]')).toHaveLength(120)
  })
  it('sums up by variable, the most telling one first', async () => {
    const about = (nodeId: string, bitsPerHourMax?: number): VariableLeak => ({
      variable: { sourceId: 'mill', nodeId },
      fields: [leak('count').key, leak('rate').key],
      valuesPerHourMax: 8,
      ...(bitsPerHourMax === undefined ? {} : { bitsPerHourMax }),
    })
    const variables = [about('nsu=urn:x;i=1', 20), about('nsu=urn:x;i=2')]
    connector({ 'GET /leak-budgets': () => ({ items: [budget({ variables })] }) })
    render(LeaksPage)
    const table = within(await screen.findByRole('region', { name: 'By variable' }))
    const rows = table.getAllByRole('row').map((row) => row.textContent.replace(/\s+/g, ' '))
    expect(rows[1]).toContain('i=2')
    expect(rows[1]).toContain('no limit')
    expect(rows[2]).toMatch(/i=1.*progress \/ rate.*8 per hour.*20 bit/)
  })
  it('has a word for nothing, and for trouble', async () => {
    connector({ 'GET /leak-budgets': () => ({ items: [] }) })
    const { unmount } = render(LeaksPage)
    expect(await screen.findByText('Nothing is disclosed')).toBeTruthy()
    unmount()
    connector({ 'GET /leak-budgets': () => problem(500, 'The state cannot be read.') })
    render(LeaksPage)
    expect((await screen.findByRole('alert')).textContent).toContain('The state cannot be read.')
  })
})

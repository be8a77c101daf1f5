import { describe, expect, it } from 'vitest'
import { language } from '@/language/language.svelte'
import { Resource } from '@/transport/resource.svelte'
import type { SignedIn } from '@/transport/session.svelte'
import type { DisclosureStatement, FieldView, LiveData, NetworkView } from './api/types'
import { ranges } from './factories/ranges'
import { texts } from './language/texts'
import { eventText } from './live/event-text'
import { graphOperations } from './networks/graph-model'
import { takeProgress, takeValues } from './networks/events'
import { series, takeReport, type Point } from './operation/history'
import { precisionText } from './operation/precision'
import { cadenceMs } from './requests/cadence'
import { RequestDraft } from './requests/request-draft.svelte'
import { mayChange, mayPlan } from './rights'

const key = {
  operationNetworkId: 'n',
  operationId: 'o',
  dynamicDataRequestId: 'r',
  fieldName: 'made',
}
const state = (more: Partial<FieldView> = {}): FieldView => ({
  key,
  factoryId: 'F',
  mappingState: 'MAPPED',
  value: '3',
  epoch: 1,
  sequence: 5,
  ...more,
})
type Values = LiveData<'value'>
const update = (more: Partial<Values['fields'][number]>): Values['fields'][number] => ({
  key,
  value: '3',
  status: 'Good',
  receivedAt: '2026-11-21T10:00:00Z',
  epoch: 1,
  sequence: 6,
  ...more,
})
const values = (
  more: Partial<Values['fields'][number]>,
  request: Partial<Values> = {},
): Values => ({
  operationNetworkId: 'n',
  operationId: 'o',
  dynamicDataRequestId: 'r',
  factoryId: 'F',
  ...request,
  fields: [update(more)],
})
const view = (fields: FieldView[] = [state()]): NetworkView => ({
  collaborationId: 'c',
  revision: 1,
  updatedAt: '2026-11-21T10:00:00Z',
  updatedBy: 'admin',
  lastEventId: '0-0',
  parts: [],
  operations: [{ operationId: 'o', isStateInferred: false, quantity: 3 }],
  fields,
  network: {
    operationNetworkId: 'n',
    operationList: [
      {
        operationId: 'o',
        operationType: 'PRODUCTION',
        plannedQuantity: 12,
        dynamicDataRequestList: [
          {
            dynamicDataRequestId: 'r',
            requesterId: 'a',
            recipientList: ['a'],
            purpose: 'p',
            reportDataFormat: {
              reportName: 'R',
              reportFieldList: [
                { name: 'made', type: 9 },
                { name: 'begun', type: 13, semantic: 'ACTUAL_START' },
              ],
            },
          },
        ],
      },
    ],
  },
})

async function loaded<T>(value: T): Promise<Resource<T>> {
  const resource = new Resource<T>(() => Promise.resolve(value))
  await resource.refresh()
  return resource
}

describe('live values', () => {
  it('take the place of older ones at once', async () => {
    const resource = await loaded(view())
    takeValues(resource, 'n', values({ value: '4' }))
    expect(resource.value?.fields[0]).toMatchObject({
      value: '4',
      sequence: 6,
      mappingState: 'MAPPED',
    })
  })
  it('do not take the place of newer ones, except after a new start', async () => {
    const resource = await loaded(view())
    takeValues(resource, 'n', values({ value: '2', sequence: 4 }))
    expect(resource.value?.fields[0]?.value).toBe('3')
    takeValues(resource, 'n', values({ value: '0', sequence: 0, epoch: 2 }))
    expect(resource.value?.fields[0]?.value).toBe('0')
  })
  it('of other networks are left alone', async () => {
    const resource = await loaded(view())
    const other = { operationNetworkId: 'other' }
    takeValues(resource, 'n', values({ key: { ...key, ...other }, value: '9' }, other))
    expect(resource.value?.fields[0]?.value).toBe('3')
  })
  it('bring progress', async () => {
    const resource = await loaded(view())
    takeProgress(resource, 'n', {
      operationNetworkId: 'n',
      operationId: 'o',
      state: 'Running',
      quantity: 4,
      isStateInferred: false,
    })
    expect(graphOperations(resource.value ?? view())[0]).toMatchObject({
      state: 'Running',
      quantity: 4,
      plannedQuantity: 12,
    })
  })
  it('go on with the curve', async () => {
    const points = await loaded<Point[]>([{ at: '2026-11-21T10:00:00Z', fields: { made: '3' } }])
    const at = (second: number): string => `2026-11-21T10:00:0${second}Z`
    takeReport(points, key, values({ value: '4', reportTimestamp: at(5) }))
    const other = { ...key, dynamicDataRequestId: 'other' }
    takeReport(points, other, values({ value: '5', reportTimestamp: at(6) }))
    expect(series(points.value ?? [], 'made').map((point) => point.value)).toEqual([3, 4])
  })
})

describe('an operation', () => {
  it('counts its fields by state', () => {
    expect(graphOperations(view())[0]?.fields).toEqual({ mapped: 1, refused: 0, pending: 1 })
  })
  it('takes its times from fields by their meaning', () => {
    const begun = state({ key: { ...key, fieldName: 'begun' }, value: '2026-11-21T06:00:00Z' })
    expect(graphOperations(view([state(), begun]))[0]?.actualStart).toBe('2026-11-21T06:00:00Z')
  })
})

it.each([
  [[], ''],
  [[3], '3'],
  [[9, 5, 6, 7, 3], '3, 5–7, 9'],
  [Array.from({ length: 20 }, (_, index) => index * 2), '0, 2, 4, 6, 8, 10, 12, 14 …'],
])('%j is drawn together', (numbers, text) => {
  expect(ranges(numbers)).toBe(text)
})

describe('a request', () => {
  it('is proposed with a free id and what others ask', () => {
    const known = view()
    const draft = new RequestDraft(
      known,
      known.network.operationList[0] ?? { operationId: 'o', operationType: 'PRODUCTION' },
    )
    draft.purpose = ' Plan '
    draft.addField()
    Object.assign(draft.fields[1] ?? {}, { name: 'note', type: 'String' })
    expect(draft.request).toEqual({
      dynamicDataRequestId: 'Request2',
      requesterId: 'a',
      recipientList: ['a'],
      purpose: 'Plan',
      updateFrequency: 1,
      updateFrequencyUnit: 'MINUTE',
      reportDataFormat: {
        reportName: 'ProgressReport',
        reportFieldList: [
          {
            name: 'producedQuantity',
            type: 'UInt32',
            unit: 'PIECE',
            semantic: 'PRODUCED_QUANTITY',
          },
          { name: 'note', type: 'String' },
        ],
      },
    })
  })
  it('is of the own organisation, whatever others ask', () => {
    const known = view()
    const operation = { operationId: 'o', operationType: 'PRODUCTION' } as const
    const draft = new RequestDraft(known, operation, 'own')
    expect([draft.requesterId, draft.recipients]).toEqual(['own', 'own'])
    expect(new RequestDraft(known, operation, 'a').recipients).toBe('a')
  })
  it('has a period where it has a cadence', () => {
    expect(cadenceMs({ updateFrequency: 2, updateFrequencyUnit: 'MINUTE' })).toBe(30_000)
    expect(cadenceMs({})).toBeUndefined()
  })
})

it.each<[SignedIn['role'], string | null, string | null, boolean, boolean]>([
  ['VIEWER', 'a', 'a', false, false],
  ['PLANNER', 'a', 'a', true, true],
  ['PLANNER', 'a', 'b', true, false],
  ['PLANNER', null, null, true, false],
  ['ADMINISTRATOR', null, 'b', true, true],
])('a %s of %s with what belongs to %s', (role, organisationId, owner, plans, changes) => {
  const who = { userName: 'u', role, csrfToken: 't', organisationId }
  expect([mayPlan(who), mayChange(who, owner)]).toEqual([plans, changes])
})

it('events are told on one line', () => {
  const decidedAt = '2026-11-21T10:00:00Z'
  expect(
    eventText({
      event: 'decision',
      data: { key, mappingState: 'REFUSED', reason: 'Secret.', decidedAt },
    }),
  ).toEqual({ where: 'n / o / r / made', what: 'Refused · Secret.' })
  expect(eventText({ event: 'value', data: values({ value: '4' }) })).toEqual({
    where: 'F / n / o / r',
    what: 'made 4',
  })
  expect(
    eventText({
      event: 'part',
      data: {
        operationNetworkId: 'n',
        factoryId: 'F',
        revision: null,
        state: 'ACCEPTED',
        faultList: [],
      },
    }),
  ).toEqual({ where: 'F / n', what: texts.network.part['ACCEPTED'] })
})

describe('a precision', () => {
  it.each<[DisclosureStatement | null, string]>([
    [null, 'Jede Änderung, wie sie ist.'],
    [{ description: 'Every change, as it is.' }, 'Jede Änderung, wie sie ist.'],
    [
      {
        description: 'Rounded to multiples of 10 PIECE; at most once per 1 min.',
        roundingStep: 10,
        minimumIntervalMs: 60_000,
      },
      'Gerundet auf Vielfache von 10 Stk.; höchstens einmal je 1 min.',
    ],
    [
      {
        description:
          'The mean over time per 1 h; with 2 significant digits; at most 1 value per 2 h; times in steps of 15 min; 1500 ms late.',
        aggregate: { function: 'the mean over time', windowMs: 3_600_000 },
        significantDigits: 2,
        rateLimitList: [{ values: 1, periodMs: 7_200_000 }],
        timeStepMs: 900_000,
        delayMs: 1_500,
      },
      'Ein Wert je 1 h: zeitlicher Mittelwert; mit 2 gültigen Ziffern; höchstens 1 Wert je 2 h; Zeiten in Schritten von 15 min; 1500 ms später.',
    ],
    [
      {
        description:
          'In bands from -5, 0.5 PIECE; only Mon, Fri from 06:00 until 22:00; withheld in certain states; with every status code as it is.',
        bandList: [-5, 0.5],
        hoursList: [
          { dayList: ['MONDAY', 'FRIDAY'], from: '06:00', until: '22:00', utcOffsetMinutes: 0 },
        ],
        isWithheldInStates: true,
        statusCodes: 'FULL',
      },
      'In Bändern ab -5; 0,5 Stk.; nur Mo, Fr von 06:00 bis 22:00; in bestimmten Zuständen zurückgehalten; mit jedem Statuscode, wie er ist.',
    ],
  ])('%j is said in the language of the reader', (statement, text) => {
    language.choose('de')
    expect(precisionText(statement, 'PIECE')).toBe(text)
  })
  it.each([
    {
      description: 'Rounded to multiples of 10 PIECE; withheld in certain states.',
      roundingStep: 10,
    },
    { description: 'Rounded to 10 pieces, by day only.', roundingStep: 10 },
    {
      description: 'The median per 1 h.',
      aggregate: { function: 'the median', windowMs: 3_600_000 },
    },
  ])('%j stays as it came: its members do not say all of it', (statement) => {
    language.choose('de')
    expect(precisionText(statement, 'PIECE')).toBe(statement.description)
  })
})

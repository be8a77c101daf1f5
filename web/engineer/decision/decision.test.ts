import { describe, expect, it } from 'vitest'
import type { BrowsedNode, FieldView, InboxRequest } from '../api/types'
import { Draft, tidy } from './draft.svelte'
import { enteredValue } from './entered-value'
import { fromLines, toLines } from './line-table'
import { stepOf } from './preview.svelte'
import {
  newStep,
  parseLiteral,
  STEP_KINDS,
  stepKind,
  withParameter,
  writeLiteral,
  type StepKind,
} from './step-catalogue'

const key = {
  operationNetworkId: 'n',
  operationId: 'o',
  dynamicDataRequestId: 'r',
  fieldName: 'power',
}
const field = (more: Partial<FieldView> = {}): FieldView => ({
  key,
  name: 'power',
  type: 'Double',
  valueRank: -1,
  unit: 'KWT',
  mappingState: 'PENDING',
  disclosure: {},
  disclosureParts: [],
  effectiveDisclosure: {},
  grounds: { policyId: null, policies: [], rules: [] },
  hasShadow: false,
  isWithheld: false,
  ...more,
})
const request = (more: Partial<InboxRequest> = {}): InboxRequest => ({
  key,
  operation: { operationId: 'o', operationType: 'PRODUCTION' },
  requesterId: 'acme',
  recipientList: ['acme'],
  purpose: 'Plan',
  receivedAt: '2026-01-01T00:00:00Z',
  hasEnded: false,
  isOverdue: false,
  reportName: 'Progress',
  updateIntervalMs: 60_000,
  fields: [],
  ...more,
})
const node = (more: Partial<BrowsedNode> = {}): BrowsedNode => ({
  nodeId: 'nsu=urn:m;s=Power',
  browseName: '2:Power',
  displayName: 'Power',
  nodeClass: 'variable',
  builtInType: 'Double',
  unit: { displayName: 'W', code: 'WTT' },
  isWritable: false,
  hasChildren: false,
  ...more,
})

describe('a draft', () => {
  it('starts with the period that the partner asked for', () => {
    expect(new Draft(field(), request()).decision.disclosure).toEqual({ minimumIntervalMs: 60_000 })
    expect(new Draft(field(), request({ updateIntervalMs: null })).decision.disclosure).toEqual({})
  })
  it('keeps what was consented to', () => {
    const draft = new Draft(
      field({
        mappingState: 'MAPPED',
        valueSource: 'MAPPING',
        disclosure: { roundingStep: 5 },
        mapping: {
          mappingId: 'n/o/r/power',
          target: key,
          targetType: 'Double',
          inputs: [],
          steps: [{ function: 'constant', value: 0 }],
        },
      }),
      request(),
    )
    expect(draft.decision.disclosure).toEqual({ roundingStep: 5 })
    expect(draft.isChanged).toBe(false)
    draft.disclosure.roundingStep = 10
    expect(draft.isChanged).toBe(true)
  })
  it('takes a variable once, under a name that scripts can use', () => {
    const draft = new Draft(field(), request())
    draft.take('s', node())
    draft.take('s', node())
    draft.take('s', node({ nodeId: 'nsu=urn:m;s=2', browseName: '2:Power' }))
    draft.take('s', node({ nodeId: 'nsu=urn:m;s=3', browseName: '2:3rd axis' }))
    draft.take('s', node({ nodeId: 'nsu=urn:m;s=4', browseName: '2:Value' }))
    draft.take('s', node({ nodeId: 'nsu=urn:m;s=5', browseName: 'nsu=urn:m:cell;PartCounter' }))
    expect(draft.inputs.map((input) => input.name)).toEqual([
      'power',
      'power2',
      '_3rd_axis',
      'value2',
      'partCounter',
    ])
  })
  it('offers the conversion that is missing', () => {
    const draft = new Draft(field(), request())
    draft.take('s', node())
    expect(draft.unitDifference).toEqual({ is: 'WTT', wanted: 'KWT' })
    draft.addUnitConversion()
    expect(draft.unitDifference).toBeUndefined()
    const counter = new Draft(field({ type: 'UInt64', unit: null }), request())
    counter.take('s', node({ builtInType: 'UInt32' }))
    expect(counter.typeDifference).toEqual({ is: 'UInt32', wanted: 'UInt64' })
    counter.addTypeConversion()
    expect(counter.steps).toEqual([{ function: 'convert', to: 'UInt64' }])
    expect(counter.typeDifference).toBeUndefined()
  })
  it('moves functions within bounds', () => {
    const draft = new Draft(field(), request())
    draft.addStep('scale')
    draft.addStep('counter')
    draft.moveStep(1, -1)
    draft.moveStep(0, -1)
    expect(draft.steps.map((step) => step.function)).toEqual(['counter', 'scale'])
  })
  it('is complete with a source of values', () => {
    const draft = new Draft(field(), request())
    expect(draft.isComplete).toBe(false)
    draft.source = 'MANUAL'
    expect(draft.isComplete).toBe(true)
    expect(draft.decision).not.toHaveProperty('mapping')
  })
})

it('a disclosure says only what it says', () => {
  expect(tidy({ roundingStep: null, bands: [], minimumIntervalMs: 5 })).toEqual({
    minimumIntervalMs: 5,
  })
})

describe('functions', () => {
  const kindOf = (step: string): StepKind => {
    const found = stepKind(step)
    if (found === undefined) throw new Error(step)
    return found
  }
  it('are each offered with their name', () => {
    expect(new Set(STEP_KINDS.map((kind) => kind.function)).size).toBe(STEP_KINDS.length)
    expect(STEP_KINDS).toHaveLength(22)
  })
  it('start apart from each other', () => {
    const kind = kindOf('lookup')
    expect(newStep(kind)['entries']).not.toBe(newStep(kind)['entries'])
  })
  it('leave out what is empty and keep what must be given', () => {
    const parameter = (step: string, name: string) => {
      const found = kindOf(step).parameters.find((known) => known.name === name)
      if (found === undefined) throw new Error(name)
      return found
    }
    expect(
      withParameter(
        { function: 'counter', modulus: 10 },
        parameter('counter', 'modulus'),
        undefined,
      ),
    ).toEqual({ function: 'counter' })
    expect(
      withParameter({ function: 'format', template: 'x' }, parameter('format', 'template'), ''),
    ).toEqual({ function: 'format', template: '' })
  })
})

describe('literals', () => {
  it.each([
    ['12', 12],
    ['-0.5', -0.5],
    ['true', true],
    ['Running', 'Running'],
    ['"12"', '12'],
    ['', undefined],
  ])('%j', (written, value) => {
    expect(parseLiteral(written)).toBe(value)
    expect(parseLiteral(writeLiteral(value))).toBe(value)
  })
})

describe('lines of a table', () => {
  it.each([
    [
      'table',
      [
        { from: 1, to: 'Running' },
        { from: 'x', to: false },
      ],
    ],
    [
      'texts',
      [
        { value: 0, text: 'Off' },
        { value: 1, text: 'On' },
      ],
    ],
    ['bits', [{ bit: 3, text: 'Door open' }]],
  ] as const)('%s goes there and back', (kind, value) => {
    expect(fromLines(kind, toLines(kind, value))).toEqual(value)
  })
  it('ignores what is half typed', () => {
    expect(fromLines('table', [{ from: '1', to: '' }])).toEqual([])
    expect(fromLines('texts', [{ from: 'x', to: 'y' }])).toEqual([])
  })
})

describe('a value that a person types', () => {
  it.each([
    ['Double', '12,5', 12.5],
    ['Double', 'x', undefined],
    ['UInt32', '12', 12],
    ['UInt32', '1.5', undefined],
    ['UInt64', '18446744073709551615', '18446744073709551615'],
    ['Boolean', 'true', true],
    ['String', ' a ', ' a '],
    ['String', '', ''],
    ['DateTime', '2026-11-23T16:00', new Date(2026, 10, 23, 16).toISOString()],
    ['DateTime', '23.11.2026 16:00', undefined],
  ])('%s %j', (type, written, value) => {
    expect(enteredValue(type, written)).toEqual(value)
  })
})

it.each([
  ['/steps/2/factor', 2],
  ['/mapping/steps/0', 0],
  ['/inputs/0/name', undefined],
])('%s is about function %s', (pointer, step) => {
  expect(stepOf({ pointer, severity: 'error', code: 'syntax', message: '' })).toBe(step)
})

import type { BuiltInType, Step } from '../api/types'

/**
 * Function of a mapping in the editor. Its parameters may be absent or wrong until the connector
 * has checked them.
 */
export interface StepDraft {
  function: Step['function']
  [parameter: string]: unknown
}

/** Input control of a parameter. */
export type ParameterKind<Option extends string = string> =
  | { is: 'number' }
  | { is: 'duration' }
  | { is: 'text'; wide?: boolean }
  | { is: 'flag' }
  | { is: 'literal' }
  | { is: 'type' }
  | { is: 'input' }
  | { is: 'inputs' }
  | { is: 'choice'; options: readonly Option[] }
  | { is: 'table' }
  | { is: 'texts' }
  | { is: 'bits' }
  | { is: 'script' }

export interface Parameter<Name extends string = string, Option extends string = string> {
  name: Name
  kind: ParameterKind<Option>
  /** Must be given; all others may stay empty. */
  needed?: boolean
}

export interface StepKind {
  function: Step['function']
  parameters: readonly Parameter[]
  /** Initial parameters of a new function. */
  initial: StepDraft
}

/** Parameters of the function with a name. */
type ParametersOf<Name extends Step['function']> = Omit<
  Extract<Step, { function: Name }>,
  'function'
>
/** Input control for one of these parameters; the options to choose from are among its values. */
type ParameterOf<Parameters> = {
  [Name in keyof Parameters & string]: Parameter<Name, '' | Extract<Parameters[Name], string>>
}[keyof Parameters & string]

export const BUILT_IN_TYPES = [
  'Boolean',
  'SByte',
  'Byte',
  'Int16',
  'UInt16',
  'Int32',
  'UInt32',
  'Int64',
  'UInt64',
  'Float',
  'Double',
  'String',
  'DateTime',
  'Guid',
] as const satisfies readonly BuiltInType[]

const number = <Name extends string>(name: Name, needed = false): Parameter<Name, never> => ({
  name,
  kind: { is: 'number' },
  needed,
})
const duration = <Name extends string>(name: Name, needed = false): Parameter<Name, never> => ({
  name,
  kind: { is: 'duration' },
  needed,
})
const text = <Name extends string>(
  name: Name,
  wide = false,
  needed = false,
): Parameter<Name, never> => ({
  name,
  kind: { is: 'text', wide },
  needed,
})
const choice = <Name extends string, Option extends string>(
  name: Name,
  ...options: Option[]
): Parameter<Name, Option> => ({
  name,
  kind: { is: 'choice', options },
})
const onDecrease = choice('onDecrease', 'reset', 'set', 'subtract')

const NEW_SCRIPT = `(value, ctx) => {
  return value
}`

/** The functions a mapping can be made of, in the order in which they are offered. */
export const STEP_KINDS: readonly StepKind[] = [
  kind(
    'scale',
    { factor: 1, divisor: 1, offset: 0 },
    number('factor'),
    number('divisor'),
    number('offset'),
  ),
  kind('unitConversion', {}, text('from'), text('to')),
  kind(
    'convert',
    { to: 'Int64' },
    { name: 'to', kind: { is: 'type' }, needed: true },
    choice('rounding', 'nearest', 'halfEven', 'down', 'up', 'towardZero', 'exact'),
    choice('overflow', 'fault', 'clamp'),
  ),
  kind(
    'counter',
    { start: 0 },
    choice('counts', '', 'increments', 'risingEdges', 'values'),
    number('start'),
    number('modulus'),
    onDecrease,
    { name: 'resetBy', kind: { is: 'input' } },
  ),
  kind('increment', {}, number('modulus'), onDecrease),
  kind(
    'threshold',
    { limit: 0 },
    number('limit', true),
    number('release'),
    { name: 'above', kind: { is: 'literal' } },
    { name: 'below', kind: { is: 'literal' } },
  ),
  kind('deadband', {}, number('absolute'), number('percent')),
  kind('debounce', { quietMs: 1000 }, duration('quietMs', true)),
  kind('edge', { direction: 'rising' }, choice('direction', 'rising', 'falling', 'both')),
  kind('rate', { per: 'minute' }, choice('per', 'second', 'minute', 'hour', 'day')),
  kind(
    'window',
    { aggregate: 'mean', durationMs: 60000 },
    choice('aggregate', 'minimum', 'maximum', 'mean', 'sum', 'count', 'last'),
    number('samples'),
    duration('durationMs'),
  ),
  kind(
    'lookup',
    { entries: [] },
    { name: 'entries', kind: { is: 'table' } },
    { name: 'otherwise', kind: { is: 'literal' } },
    { name: 'interpolate', kind: { is: 'flag' } },
  ),
  kind('enumeration', { texts: [] }, { name: 'texts', kind: { is: 'texts' } }, text('otherwise')),
  kind('bit', { bit: 0 }, number('bit', true)),
  kind(
    'bitTexts',
    { bits: [] },
    { name: 'bits', kind: { is: 'bits' } },
    text('separator'),
    text('none'),
  ),
  kind('format', { template: '{value}' }, text('template', true, true)),
  kind(
    'parse',
    { to: 'Double' },
    { name: 'to', kind: { is: 'type' }, needed: true },
    text('pattern', true),
    number('radix'),
    { name: 'decimalComma', kind: { is: 'flag' } },
  ),
  kind('select', { path: '[0]' }, text('path', true, true)),
  kind(
    'merge',
    { rule: 'newest' },
    choice(
      'rule',
      'newest',
      'firstGood',
      'minimum',
      'maximum',
      'sum',
      'mean',
      'all',
      'any',
      'join',
      'array',
    ),
    { name: 'inputs', kind: { is: 'inputs' } },
    text('separator'),
  ),
  kind('constant', { value: 0 }, { name: 'value', kind: { is: 'literal' }, needed: true }),
  kind('expression', { expression: 'value' }, text('expression', true, true)),
  kind('script', { source: NEW_SCRIPT }, { name: 'source', kind: { is: 'script' }, needed: true }),
]

export function stepKind(name: string): StepKind | undefined {
  return STEP_KINDS.find((known) => known.function === name)
}

/** A new function of this kind, sharing nothing with others. */
export function newStep(kind: StepKind): StepDraft {
  return structuredClone(kind.initial)
}

/**
 * Returns the function with one parameter changed. An empty parameter is left out, so that the
 * connector uses its default.
 */
export function withParameter(step: StepDraft, parameter: Parameter, value: unknown): StepDraft {
  const changed = { ...step }
  const isEmpty =
    value === undefined ||
    value === '' ||
    (Array.isArray(value) && value.length === 0 && parameter.kind.is === 'inputs')
  if (isEmpty && parameter.needed !== true) Reflect.deleteProperty(changed, parameter.name)
  else changed[parameter.name] = value ?? ''
  return changed
}

/**
 * Text of a literal in a form: `true`, `12`, `0.5` or text. Quotes mark text that looks like
 * another type.
 */
export function parseLiteral(written: string): unknown {
  const trimmed = written.trim()
  if (trimmed === '') return undefined
  if (trimmed === 'true' || trimmed === 'false') return trimmed === 'true'
  if (/^-?\d+(\.\d+)?([eE][-+]?\d+)?$/.test(trimmed)) return Number(trimmed)
  const quoted = /^"(.*)"$/s.exec(trimmed)
  return quoted === null ? written : quoted[1]
}

/** The other way round. */
export function writeLiteral(value: unknown): string {
  if (value === undefined || value === null) return ''
  if (typeof value === 'string') return parseLiteral(value) === value ? value : `"${value}"`
  if (typeof value === 'number' || typeof value === 'boolean') return String(value)
  return JSON.stringify(value)
}

function kind<Name extends Step['function']>(
  name: Name,
  initial: Partial<ParametersOf<Name>>,
  ...parameters: ParameterOf<ParametersOf<Name>>[]
): StepKind {
  return { function: name, parameters, initial: { function: name, ...initial } }
}

import { expect, it } from 'vitest'
import { tokens } from './json-tokens'

it.each([
  '{"a":[1,-2.5e3,true,null,"x \\" y"],"b":{"c":"ü"}}',
  'not JSON - "half',
  '',
  '-',
  '{"a" : 1}',
])('never changes the text: %j', (text) => {
  expect(
    tokens(text)
      .map((token) => token.text)
      .join(''),
  ).toBe(text)
})

it('tells names from values', () => {
  expect(tokens('{"a":"b"}').map((token) => token.kind)).toEqual([
    'mark',
    'name',
    'mark',
    'text',
    'mark',
  ])
})

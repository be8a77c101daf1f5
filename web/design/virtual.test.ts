import { describe, expect, it } from 'vitest'
import { layOut, within } from './virtual'

describe('a long list', () => {
  const layout = layOut((index) => (index % 2 === 0 ? 10 : 30), 100_000)

  it('is as high as all its items', () => {
    expect(layout.offsets.at(-1)).toBe(2_000_000)
  })
  it.each([
    [0, 100, 0, 6],
    [-500, -100, 0, 0],
    [10, 11, 1, 2],
    [9.9, 11, 0, 2],
    [1_999_999, 3_000_000, 99_999, 100_000],
    [5_000_000, 6_000_000, 100_000, 100_000],
  ])('shows between %d and %d the items from %d to %d', (from, to, first, end) => {
    expect(within(layout, from, to)).toEqual({ first, end })
  })
  it('may be empty', () => {
    expect(
      within(
        layOut(() => 10, 0),
        0,
        100,
      ),
    ).toEqual({ first: 0, end: 0 })
  })
})

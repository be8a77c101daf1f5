/**
 * Positions of the items of a long list, each with its own height. Pure arithmetic; the component
 * measures.
 */
export interface Layout {
  /** The top of every item, and behind the last one the height of all. */
  offsets: Float64Array
}

export function layOut(heights: (index: number) => number, count: number): Layout {
  const offsets = new Float64Array(count + 1)
  for (let index = 0; index < count; index += 1)
    offsets[index + 1] = (offsets[index] ?? 0) + heights(index)
  return { offsets }
}

/** Range of the items between `from` and `to`: the first index and the index behind the last. */
export function within(
  { offsets }: Layout,
  from: number,
  to: number,
): { first: number; end: number } {
  const count = offsets.length - 1
  const first = Math.max(0, Math.min(firstAbove(offsets, from) - 1, count))
  let end = first
  while (end < count && (offsets[end] ?? 0) < to) end += 1
  return { first, end }
}

/** The index of the first offset greater than `position`, by halving. */
function firstAbove(offsets: Float64Array, position: number): number {
  let low = 0
  let high = offsets.length
  while (low < high) {
    const middle = (low + high) >>> 1
    if ((offsets[middle] ?? 0) > position) high = middle
    else low = middle + 1
  }
  return low
}

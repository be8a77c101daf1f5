/** Positions of the boxes of a layered graph, left to right, in drawing units. */
export interface Layout {
  width: number
  height: number
  boxes: Map<string, { x: number; y: number; layer: number }>
}

export interface LayoutSizes {
  boxWidth: number
  boxHeight: number
  gapX: number
  gapY: number
  margin: number
}

interface Edge {
  from: string
  to: string
}

const SWEEPS = 6

/**
 * Layers operations by the longest path from a start, then orders each layer by the mean position
 * of its neighbours, back and forth, which removes most crossings. Edges that close a cycle are
 * ignored.
 */
export function layered(
  ids: readonly string[],
  edges: readonly Edge[],
  sizes: LayoutSizes,
): Layout {
  const layerOf = longestPaths(ids, edges)
  const layers: string[][] = []
  for (const id of ids) (layers[layerOf.get(id) ?? 0] ??= []).push(id)

  const before = neighbours(edges, 'to', 'from')
  const after = neighbours(edges, 'from', 'to')
  for (let sweep = 0; sweep < SWEEPS; sweep += 1) {
    const forward = sweep % 2 === 0
    const order = forward ? layers.keys() : [...layers.keys()].reverse()
    for (const index of order)
      sortByNeighbours(layers, index, forward ? before : after, forward ? -1 : 1)
  }

  const tallest = Math.max(1, ...layers.map((layer) => layer.length))
  const inner = tallest * (sizes.boxHeight + sizes.gapY) - sizes.gapY
  const boxes: Layout['boxes'] = new Map()
  layers.forEach((layer, index) => {
    const height = layer.length * (sizes.boxHeight + sizes.gapY) - sizes.gapY
    layer.forEach((id, row) => {
      boxes.set(id, {
        layer: index,
        x: sizes.margin + index * (sizes.boxWidth + sizes.gapX),
        y: sizes.margin + (inner - height) / 2 + row * (sizes.boxHeight + sizes.gapY),
      })
    })
  })
  return {
    width: 2 * sizes.margin + layers.length * (sizes.boxWidth + sizes.gapX) - sizes.gapX,
    height: 2 * sizes.margin + inner,
    boxes,
  }
}

function longestPaths(ids: readonly string[], edges: readonly Edge[]): Map<string, number> {
  const after = neighbours(edges, 'from', 'to')
  const depth = new Map<string, number>()
  const open = new Set<string>()
  // The length of the longest path that starts here, cycles cut where they close.
  const measure = (id: string): number => {
    const known = depth.get(id)
    if (known !== undefined) return known
    open.add(id)
    const lengths = (after.get(id) ?? [])
      .filter((next) => !open.has(next))
      .map((next) => measure(next) + 1)
    open.delete(id)
    const length = Math.max(0, ...lengths)
    depth.set(id, length)
    return length
  }
  const lengths = new Map(ids.map((id) => [id, measure(id)]))
  const deepest = Math.max(0, ...lengths.values())
  const layers = new Map(ids.map((id) => [id, deepest - (lengths.get(id) ?? 0)]))
  // An operation without predecessors is directly before its first successor already; one without
  // edges is first.
  for (const id of ids)
    if (!edges.some((edge) => edge.from === id || edge.to === id)) layers.set(id, 0)
  return layers
}

function neighbours(
  edges: readonly Edge[],
  of: keyof Edge,
  are: keyof Edge,
): Map<string, string[]> {
  const map = new Map<string, string[]>()
  for (const edge of edges) {
    const list = map.get(edge[of]) ?? []
    list.push(edge[are])
    map.set(edge[of], list)
  }
  return map
}

function sortByNeighbours(
  layers: string[][],
  index: number,
  beside: Map<string, string[]>,
  towards: 1 | -1,
): void {
  const layer = layers[index]
  const reference = layers[index + towards]
  if (layer === undefined || reference === undefined) return
  const weight = (id: string, own: number): number => {
    const places = (beside.get(id) ?? [])
      .map((other) => reference.indexOf(other))
      .filter((place) => place >= 0)
    return places.length === 0 ? own : places.reduce((sum, place) => sum + place, 0) / places.length
  }
  layers[index] = layer
    .map((id, own) => ({ id, own, weight: weight(id, own) }))
    .sort((a, b) => a.weight - b.weight || a.own - b.own)
    .map(({ id }) => id)
}

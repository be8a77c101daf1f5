import { SvelteMap, SvelteSet } from 'svelte/reactivity'
import { Problem } from '@/transport/problem'
import { connector } from '../api/client'
import type { BrowsedNode, ShownValue } from '../api/types'

/** Node as a row of the tree. */
export interface TreeRow {
  node: BrowsedNode
  depth: number
  isOpen: boolean
  isLoading: boolean
  /**
   * Position among its siblings for screen readers; the number is -1 while not all siblings are
   * known.
   */
  position: number
  siblings: number
}

/** Children of a node read so far, and the cursor of the next page. */
interface Children {
  nodes: BrowsedNode[]
  next: string | undefined
}

const ROOT = ''
const VALUES_READ = 40
const VALUES_EVERY_MS = 1_500

/**
 * Address space of a source, read on demand: children are fetched when a node is opened, page by
 * page while the tree scrolls, so that a folder of 100 000 nodes costs only the visible part.
 */
export class AddressSpace {
  readonly #sourceId: string
  readonly #children = new SvelteMap<string, Children>()
  readonly #open = new SvelteSet<string>()
  readonly #loading = new SvelteSet<string>()

  problem = $state.raw<Problem | undefined>()
  readonly values = new SvelteMap<string, ShownValue>()
  readonly rows = $derived.by(() => {
    const rows: TreeRow[] = []
    this.#collect(ROOT, 0, rows)
    return rows
  })

  constructor(sourceId: string) {
    this.#sourceId = sourceId
  }

  get isReady(): boolean {
    return this.#children.has(ROOT)
  }

  async start(): Promise<void> {
    await this.#load(ROOT)
    // A root with a single folder is opened at once, as nothing else can be chosen.
    const only = this.#children.get(ROOT)?.nodes
    if (only?.length === 1 && only[0] !== undefined) await this.open(only[0])
  }

  async open(node: BrowsedNode): Promise<void> {
    if (!node.hasChildren) return
    this.#open.add(node.nodeId)
    if (!this.#children.has(node.nodeId)) await this.#load(node.nodeId)
  }

  close(node: BrowsedNode): void {
    this.#open.delete(node.nodeId)
  }

  toggle(node: BrowsedNode): void {
    if (this.#open.has(node.nodeId)) this.close(node)
    else void this.open(node)
  }

  /** Reads on below every open node whose last known child is among the rows that are seen. */
  seen(rows: readonly TreeRow[]): void {
    for (const [parent, { nodes, next }] of this.#children) {
      const last = nodes.at(-1)
      const isOpen = parent === ROOT || this.#open.has(parent)
      if (
        isOpen &&
        next !== undefined &&
        last !== undefined &&
        rows.some((row) => row.node.nodeId === last.nodeId) &&
        !this.#loading.has(parent)
      )
        void this.#load(parent)
    }
  }

  /** Polls the values of the variables among the visible nodes. Returns a function that stops. */
  watch(visible: () => readonly BrowsedNode[]): () => void {
    const running = new AbortController()
    const read = async (): Promise<void> => {
      const wanted = document.hidden
        ? []
        : visible()
            .filter((node) => node.nodeClass === 'variable')
            .slice(0, VALUES_READ)
      if (wanted.length > 0) {
        const nodes = wanted.map(({ nodeId }) => nodeId)
        const page = await connector
          .post('/sources/{sourceId}/values', {
            path: { sourceId: this.#sourceId },
            body: { nodes },
            signal: running.signal,
          })
          .catch(() => undefined)
        page?.items.forEach((value, index) => {
          const nodeId = nodes[index]
          if (nodeId !== undefined && !running.signal.aborted) this.values.set(nodeId, value)
        })
      }
      if (!running.signal.aborted) next = setTimeout(() => void read(), VALUES_EVERY_MS)
    }
    let next = setTimeout(() => void read(), 100)
    return () => {
      clearTimeout(next)
      running.abort()
    }
  }

  async #load(parent: string): Promise<void> {
    this.#loading.add(parent)
    try {
      const known = this.#children.get(parent)
      const page = await connector.get('/sources/{sourceId}/nodes', {
        path: { sourceId: this.#sourceId },
        query: { parent: parent === ROOT ? undefined : parent, cursor: known?.next },
      })
      this.#children.set(parent, {
        nodes: [...(known?.nodes ?? []), ...page.items],
        next: page.nextCursor ?? undefined,
      })
      this.problem = undefined
    } catch (failure) {
      this.problem = Problem.from(failure)
      if (!this.#children.has(parent)) this.#open.delete(parent)
    }
    this.#loading.delete(parent)
  }

  #collect(parent: string, depth: number, rows: TreeRow[]): void {
    const children = this.#children.get(parent)
    children?.nodes.forEach((node, index) => {
      const isOpen = this.#open.has(node.nodeId)
      rows.push({
        node,
        depth,
        isOpen,
        isLoading: this.#loading.has(node.nodeId),
        position: index + 1,
        siblings: children.next === undefined ? children.nodes.length : -1,
      })
      if (isOpen) this.#collect(node.nodeId, depth + 1, rows)
    })
  }
}

import { SvelteMap, SvelteSet } from 'svelte/reactivity'
import { Problem } from '@/transport/problem'
import { connector } from '../api/client'
import type { BrowsedNode, DataValue } from '../api/types'

/** A node as it stands in the tree. */
export interface TreeRow {
  node: BrowsedNode
  depth: number
  isOpen: boolean
  isLoading: boolean
  /** Its place among its siblings, for screen readers. */
  position: number
  siblings: number
}

const ROOT = ''
const CHILDREN_SHOWN = 400
const VALUES_READ = 40
const VALUES_EVERY_MS = 1_500

/** What a source offers, as far as somebody looked: children are fetched when a node is opened. */
export class AddressSpace {
  readonly #sourceId: string
  readonly #children = new SvelteMap<string, BrowsedNode[]>()
  readonly #open = new SvelteSet<string>()
  readonly #loading = new SvelteSet<string>()

  problem = $state.raw<Problem | undefined>()
  readonly values = new SvelteMap<string, DataValue>()
  readonly rows = $derived.by(() => {
    const rows: TreeRow[] = []
    this.#collect(ROOT, 0, rows)
    return rows
  })
  /** How many children were left out because one node has too many. */
  readonly omitted = $derived([...this.#children.values()].reduce((sum, children) => sum + Math.max(0, children.length - CHILDREN_SHOWN), 0))

  constructor(sourceId: string) {
    this.#sourceId = sourceId
  }

  get isReady(): boolean {
    return this.#children.has(ROOT)
  }

  async start(): Promise<void> {
    await this.#load(ROOT)
    // A root with a single folder in it is opened at once: that click tells nothing.
    const only = this.#children.get(ROOT)
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

  /** Keeps the values of the visible variables live. Returns how to stop. */
  watch(): () => void {
    const running = new AbortController()
    const read = async (): Promise<void> => {
      const wanted = document.hidden ? [] : this.rows.filter((row) => row.node.nodeClass === 'variable').slice(0, VALUES_READ)
      await Promise.all(
        wanted.map(async ({ node }) => {
          const value = await connector.value(this.#sourceId, node.nodeId, running.signal).catch(() => undefined)
          if (value !== undefined && !running.signal.aborted) this.values.set(node.nodeId, value)
        }),
      )
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
      this.#children.set(parent, await connector.nodes(this.#sourceId, parent === ROOT ? undefined : parent))
      this.problem = undefined
    } catch (failure) {
      this.problem = Problem.from(failure)
      this.#open.delete(parent)
    }
    this.#loading.delete(parent)
  }

  #collect(parent: string, depth: number, rows: TreeRow[]): void {
    const children = (this.#children.get(parent) ?? []).slice(0, CHILDREN_SHOWN)
    children.forEach((node, index) => {
      const isOpen = this.#open.has(node.nodeId)
      rows.push({ node, depth, isOpen, isLoading: this.#loading.has(node.nodeId), position: index + 1, siblings: children.length })
      if (isOpen) this.#collect(node.nodeId, depth + 1, rows)
    })
  }
}

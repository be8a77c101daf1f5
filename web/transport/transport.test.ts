import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest'
import { credentials, request } from './http'
import { LiveFeed } from './live.svelte'
import { PagedList } from './paged.svelte'
import { Problem } from './problem'
import { Resource } from './resource.svelte'

const answer = (status: number, body: unknown): Response =>
  new Response(JSON.stringify(body), { status })

afterEach(() => {
  vi.unstubAllGlobals()
  vi.useRealTimers()
  credentials.csrfToken = undefined
})

describe('requests', () => {
  it('carry the CSRF token with changes only', async () => {
    const fetched = vi.fn<typeof fetch>(() => Promise.resolve(answer(200, {})))
    vi.stubGlobal('fetch', fetched)
    credentials.csrfToken = 'secret'
    await request('GET', '/a')
    await request('PUT', '/a', { body: 1 })
    const sent = fetched.mock.calls.map(
      ([, options]) => (options?.headers as Record<string, string>)['x-csrf-token'],
    )
    expect(sent).toEqual([undefined, 'secret'])
  })
  it('become problems with the server’s words and faults', async () => {
    vi.stubGlobal('fetch', () =>
      Promise.resolve(
        answer(422, {
          type: 'urn:verbund:problem:invalid-document',
          title: 'Unprocessable',
          status: 422,
          code: 'INVALID_DOCUMENT',
          detail: 'Two faults.',
          faults: [{ pointer: '/a', code: 'X', message: 'Wrong.' }],
        }),
      ),
    )
    const problem = await request('POST', '/a', { body: {} }).catch((failure: unknown) => failure)
    expect(problem).toBeInstanceOf(Problem)
    expect(problem).toMatchObject({
      status: 422,
      message: 'Two faults.',
      faults: [{ pointer: '/a', message: 'Wrong.' }],
    })
  })
  it('become problems where a proxy answers in place of the server', async () => {
    vi.stubGlobal('fetch', () =>
      Promise.resolve(new Response('<h1>Bad Gateway</h1>', { status: 502 })),
    )
    const problem = await request('GET', '/a').catch((failure: unknown) => failure)
    expect(problem).toMatchObject({ status: 502, message: 'HTTP 502', faults: [] })
  })
  it('that do not arrive are told apart', async () => {
    vi.stubGlobal('fetch', () => Promise.reject(new TypeError('Failed to fetch')))
    expect(
      await request('GET', '/a').catch((failure: unknown) => (failure as Problem).unreachable),
    ).toBe(true)
  })
  it('end the session when the server no longer knows it', async () => {
    vi.stubGlobal('fetch', () => Promise.resolve(answer(401, {})))
    const expired = vi.spyOn(credentials, 'onExpired')
    await request('GET', '/a').catch(() => undefined)
    expect(expired).toHaveBeenCalledOnce()
    await request('POST', '/session', { body: {}, signingIn: true }).catch(() => undefined)
    expect(expired).toHaveBeenCalledOnce()
  })
})

describe('a resource', () => {
  it('does not lose what events told while it was being read', async () => {
    let answer: (value: number[]) => void = () => undefined
    const resource = new Resource(() => new Promise<number[]>((resolve) => (answer = resolve)))
    const add = (number: number) => (known: number[]) =>
      known.includes(number) ? known : [...known, number]
    const first = resource.refresh()
    resource.amendByEvent(add(2))
    answer([1])
    await first
    expect(resource.value).toEqual([1, 2])
    const second = resource.refresh()
    resource.amendByEvent(add(3))
    expect(resource.value).toEqual([1, 2, 3])
    answer([1, 2])
    await second
    expect(resource.value).toEqual([1, 2, 3])
  })

  it('keeps its last value when a refresh fails, and recovers', async () => {
    let works = true
    const resource = new Resource(() =>
      works
        ? Promise.resolve('fine')
        : Problem.of(answer(500, undefined)).then((problem) => Promise.reject(problem)),
    )
    await resource.refresh()
    works = false
    await resource.refresh()
    expect([resource.value, resource.problem?.status]).toEqual(['fine', 500])
    works = true
    await resource.refresh()
    expect(resource.problem).toBeUndefined()
  })
  it('ignores an answer that came too late', async () => {
    const answers: ((text: string) => void)[] = []
    const resource = new Resource(() => new Promise<string>((resolve) => answers.push(resolve)))
    const first = resource.refresh()
    const second = resource.refresh()
    answers[1]?.('new')
    answers[0]?.('old')
    await Promise.all([first, second])
    expect(resource.value).toBe('new')
  })
  it('reads once for many reasons', async () => {
    vi.useFakeTimers()
    const load = vi.fn(() => Promise.resolve(1))
    const resource = new Resource(load)
    for (let reason = 0; reason < 50; reason += 1) resource.refreshSoon()
    await vi.advanceTimersByTimeAsync(1000)
    expect(load).toHaveBeenCalledOnce()
  })
  it('asks again by itself while the server is out of reach', async () => {
    vi.useFakeTimers()
    const load = vi.fn(() => Promise.reject(new TypeError('offline')))
    const resource = new Resource<never>(load)
    await resource.refresh()
    await vi.advanceTimersByTimeAsync(10_000)
    expect(load.mock.calls.length).toBeGreaterThan(2)
    resource.stop()
  })
})

describe('a list in pages', () => {
  const numbers = Array.from({ length: 5 }, (_, number) => number)
  const pageOf = (cursor: string | undefined): { items: number[]; nextCursor: string | null } => {
    const from = Number(cursor ?? 0)
    return {
      items: numbers.slice(from, from + 2),
      nextCursor: from + 2 < numbers.length ? String(from + 2) : null,
    }
  }
  it('is read as far as a page asks, and again that far', async () => {
    const load = vi.fn((cursor: string | undefined) => Promise.resolve(pageOf(cursor)))
    const paged = new PagedList(load)
    await paged.list.refresh()
    expect([paged.list.value, paged.hasMore]).toEqual([[0, 1], true])
    await paged.more()
    await paged.list.refresh()
    expect([paged.list.value, paged.hasMore]).toEqual([[0, 1, 2, 3], true])
    await paged.more()
    await paged.more()
    expect([paged.list.value, paged.hasMore]).toEqual([numbers, false])
    expect(load.mock.calls.map(([cursor]) => cursor)).toEqual([undefined, '2', undefined, '2', '4'])
  })
  it('keeps what it has where no more comes, and tries again', async () => {
    let works = true
    const paged = new PagedList((cursor) =>
      works ? Promise.resolve(pageOf(cursor)) : Promise.reject(new TypeError('offline')),
    )
    await paged.list.refresh()
    works = false
    await paged.more()
    expect([paged.list.value, paged.problem?.unreachable]).toEqual([[0, 1], true])
    works = true
    await paged.more()
    expect([paged.list.value, paged.problem]).toEqual([[0, 1, 2, 3], undefined])
  })
  it('has no page twice, when it is read again meanwhile', async () => {
    const waiting: (() => void)[] = []
    const paged = new PagedList(
      (cursor) =>
        new Promise<{ items: number[]; nextCursor: string | null }>((resolve) =>
          waiting.push(() => {
            resolve(pageOf(cursor))
          }),
        ),
    )
    const settle = async (): Promise<void> => {
      while (waiting.length > 0) {
        waiting.shift()?.()
        await new Promise((done) => setTimeout(done))
      }
    }
    const first = paged.list.refresh()
    await settle()
    await first
    const more = paged.more()
    const slow = waiting.shift()
    const again = paged.list.refresh()
    await settle()
    await again
    slow?.()
    await more
    expect(paged.list.value).toEqual([0, 1, 2, 3])
  })
})

/** Event of the stream of these tests. */
type Values =
  { event: 'value'; data: { a: number } } | { event: 'comment'; data: Record<string, never> }

class FakeEventSource extends EventTarget {
  static readonly CLOSED = 2
  static opened: FakeEventSource[] = []
  readyState = 0
  onopen: (() => void) | null = null
  onerror: (() => void) | null = null
  constructor() {
    super()
    FakeEventSource.opened.push(this)
  }
  close(): void {
    this.readyState = 2
  }
}

describe('the live feed', () => {
  beforeEach(() => {
    FakeEventSource.opened = []
    vi.stubGlobal('EventSource', FakeEventSource)
    vi.useFakeTimers()
  })
  const latest = (): FakeEventSource => FakeEventSource.opened.at(-1) ?? new FakeEventSource()

  it('tells events to who listens', () => {
    const feed = new LiveFeed<Values>('/live')
    const heard = vi.fn()
    const stop = feed.on('value', heard)
    feed.start()
    const later = vi.fn()
    feed.on(['value', 'comment'], later)
    latest().dispatchEvent(new MessageEvent('value', { data: '{"a":1}' }))
    latest().dispatchEvent(new MessageEvent('comment', { data: '{}' }))
    stop()
    latest().dispatchEvent(new MessageEvent('value', { data: '{"a":2}' }))
    const value = (a: number): Values => ({ event: 'value', data: { a } })
    expect(heard.mock.calls).toEqual([[value(1)]])
    expect(later.mock.calls).toEqual([[value(1)], [{ event: 'comment', data: {} }], [value(2)]])
  })
  it('lets pages catch up after an event that cannot be read', () => {
    const feed = new LiveFeed<Values>('/live')
    const [heard, caughtUp] = [vi.fn(), vi.fn()]
    feed.on('value', heard)
    feed.onCatchUp(caughtUp)
    feed.start()
    latest().dispatchEvent(new MessageEvent('value', { data: 'what?' }))
    expect([heard.mock.calls.length, caughtUp.mock.calls.length]).toEqual([0, 1])
    feed.stop()
  })
  it('says that it is interrupted, starts again with growing pauses, and lets pages catch up', async () => {
    const feed = new LiveFeed<Values>('/live')
    const caughtUp = vi.fn()
    feed.onCatchUp(caughtUp)
    feed.start()
    latest().onopen?.()
    expect([feed.state, caughtUp.mock.calls.length]).toEqual(['live', 1])
    for (let failure = 0; failure < 3; failure += 1) {
      latest().readyState = 2
      latest().onerror?.()
      expect(feed.state).toBe('interrupted')
      await vi.advanceTimersByTimeAsync(20_000)
    }
    expect(FakeEventSource.opened).toHaveLength(4)
    latest().onopen?.()
    expect([feed.state, caughtUp.mock.calls.length]).toEqual(['live', 2])
    latest().dispatchEvent(new MessageEvent('reset', { data: '' }))
    expect(caughtUp).toHaveBeenCalledTimes(3)
    feed.stop()
  })
})

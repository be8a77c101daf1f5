import { afterEach, describe, expect, it, vi } from 'vitest'
import { Api, resolve } from './api'

interface Paths {
  '/items': {
    get: {
      parameters: { query?: { search?: string; limit?: number }; path?: never }
      responses: { 200: { content: { 'application/json': { names: string[] } } } }
    }
  }
  '/items/{id}': {
    put: {
      parameters: { query?: never; path: { id: string } }
      requestBody: { content: { 'application/json': { name: string } } }
      responses: { 204: { content?: never } }
    }
  }
}
const api = new Api<Paths>()

afterEach(() => {
  vi.unstubAllGlobals()
})

function respond(response: () => Response) {
  const fetched = vi.fn<typeof fetch>(() => Promise.resolve(response()))
  vi.stubGlobal('fetch', fetched)
  return fetched
}

describe('an API client', () => {
  it('sends query parameters and returns the typed answer', async () => {
    const fetched = respond(() => new Response('{"names":["a"]}'))
    const { names } = await api.get('/items', { query: { search: 'x y' } })
    expect(names).toEqual(['a'])
    expect(fetched.mock.calls[0]?.[0]).toBe('/api/v1/items?search=x%20y')
  })

  it('sends a body to a path with encoded parameters', async () => {
    const fetched = respond(() => new Response(null, { status: 204 }))
    await api.put('/items/{id}', { path: { id: 'a/b' }, body: { name: 'ü' }, ifMatch: 3 })
    const [address, options] = fetched.mock.calls[0] ?? []
    expect(address).toBe('/api/v1/items/a%2Fb')
    expect(options).toMatchObject({
      method: 'PUT',
      body: '{"name":"ü"}',
      headers: { 'if-match': '"3"' },
    })
  })

  it('accepts what the description has and nothing else', () => {
    const check = (): unknown[] => [
      // @ts-expect-error: there is no such path
      api.get('/nothing'),
      // @ts-expect-error: the path has no such operation
      api.put('/items'),
      // @ts-expect-error: the body lacks a member
      api.put('/items/{id}', { path: { id: 'a' }, body: {} }),
      // @ts-expect-error: the path lacks its parameter
      api.put('/items/{id}', { body: { name: 'a' } }),
      // @ts-expect-error: a parameter has another type
      api.get('/items', { query: { limit: 'many' } }),
    ]
    expect(check).toBeTypeOf('function')
  })
})

describe('a resolved path', () => {
  it.each([
    ['/fields/{a}/{b}', { path: { a: 'a/b', b: 'ü' } }, '/fields/a%2Fb/%C3%BC'],
    ['/items', { query: { a: 'x y', b: undefined, c: 0, d: '', e: null } }, '/items?a=x%20y&c=0'],
    ['/items', {}, '/items'],
  ])('of %s with %j is %s', (template, input, path) => {
    expect(resolve(template, input)).toBe(path)
  })

  it('needs all of its parameters', () => {
    expect(() => resolve('/items/{id}', {})).toThrow('lacks the parameter id')
  })
})

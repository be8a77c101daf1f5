import { tick } from 'svelte'

/** Where the reader is: the parts of the address after `#/`, decoded. The first part names the page. */
class Router {
  parts = $state.raw<string[]>(read())

  constructor() {
    addEventListener('hashchange', () => {
      this.parts = read()
      void arrive()
    })
  }

  get page(): string {
    return this.parts[0] ?? ''
  }
}

export const router = new Router()

/** The link to a page. Ids may contain anything. */
export function to(...parts: string[]): string {
  return `#/${parts.map(encodeURIComponent).join('/')}`
}

export function go(...parts: string[]): void {
  location.hash = to(...parts)
}

function read(): string[] {
  return location.hash
    .replace(/^#\/?/, '')
    .split('/')
    .filter((part) => part !== '')
    .map((part) => {
      try {
        return decodeURIComponent(part)
      } catch {
        return part
      }
    })
}

/** Screen readers and the keyboard start at the heading of the page that was opened. */
async function arrive(): Promise<void> {
  await tick()
  document.querySelector<HTMLElement>('main h1')?.focus({ preventScroll: true })
  scrollTo({ top: 0 })
}

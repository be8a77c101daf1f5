import { tick } from 'svelte'

/** Address of the page: the decoded parts after `#/`. The first part names the page. */
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

/** Link to a page. Ids may contain any character. */
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

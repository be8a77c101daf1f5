import { session } from './session.svelte'

const PREFIX = 'verbund.kept'

/**
 * Input that a person has not sent yet, under a name. It outlasts a reload, visits to other pages and the end of
 * the session, in this tab and for this person alone.
 */
export class KeptInput<T> {
  readonly #key: string

  constructor(name: string) {
    this.#key = `${PREFIX}/${session.known?.userName ?? ''}/${name}`
  }

  /** Input that was kept, if it can still be read. */
  read(): T | undefined {
    try {
      const text = sessionStorage.getItem(this.#key)
      return text === null ? undefined : (JSON.parse(text) as T)
    } catch {
      return undefined
    }
  }

  /** Keeps the input, or forgets what was kept where there is none. */
  keep(input: T | undefined): void {
    try {
      if (input === undefined) sessionStorage.removeItem(this.#key)
      else sessionStorage.setItem(this.#key, JSON.stringify(input))
    } catch {
      // A full or forbidden storage keeps nothing; the form works all the same.
    }
  }
}

/** Asks before the page is left, until the returned function is called. */
export function askBeforeLeaving(): () => void {
  const ask = (event: BeforeUnloadEvent): void => {
    event.preventDefault()
  }
  addEventListener('beforeunload', ask)
  return () => {
    removeEventListener('beforeunload', ask)
  }
}

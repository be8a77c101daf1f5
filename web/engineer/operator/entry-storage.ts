import type { OperatorOperation } from '../api/types'
import type { StoredEntry } from './entries'

/** Storage of a tablet that survives reloads and restarts while the connector is out of reach. */
export interface EntryStorage {
  entries(): Promise<StoredEntry[]>
  put(entry: StoredEntry): Promise<void>
  drop(entryId: string): Promise<void>
  operations(): Promise<{ at: number; items: OperatorOperation[] } | undefined>
  putOperations(at: number, items: OperatorOperation[]): Promise<void>
}

const DATABASE = 'verbund-operator'
const VERSION = 1
const ENTRIES = 'entries'
const SHOWN = 'shown'
const OPERATIONS = 'operations'

/** Storage in the browser's IndexedDB. */
export class BrowserEntryStorage implements EntryStorage {
  readonly #database: Promise<IDBDatabase>

  constructor() {
    this.#database = new Promise((resolve, reject) => {
      const opening = indexedDB.open(DATABASE, VERSION)
      opening.onupgradeneeded = () => {
        opening.result.createObjectStore(ENTRIES, { keyPath: 'entry.entryId' })
        opening.result.createObjectStore(SHOWN)
      }
      opening.onsuccess = () => {
        resolve(opening.result)
      }
      opening.onerror = () => {
        reject(opening.error ?? new Error('This browser has no database for the page.'))
      }
    })
    this.#database.catch(() => undefined)
  }

  async entries(): Promise<StoredEntry[]> {
    const kept = await this.#run<StoredEntry[]>(
      ENTRIES,
      'readonly',
      (store) => store.getAll() as IDBRequest<StoredEntry[]>,
    )
    return kept.toSorted((a, b) => a.entry.madeAt.localeCompare(b.entry.madeAt))
  }

  async put(entry: StoredEntry): Promise<void> {
    await this.#run(ENTRIES, 'readwrite', (store) => store.put(entry))
  }

  async drop(entryId: string): Promise<void> {
    await this.#run(ENTRIES, 'readwrite', (store) => store.delete(entryId))
  }

  async operations(): Promise<{ at: number; items: OperatorOperation[] } | undefined> {
    return this.#run(
      SHOWN,
      'readonly',
      (store) =>
        store.get(OPERATIONS) as IDBRequest<{ at: number; items: OperatorOperation[] } | undefined>,
    )
  }

  async putOperations(at: number, items: OperatorOperation[]): Promise<void> {
    await this.#run(SHOWN, 'readwrite', (store) => store.put({ at, items }, OPERATIONS))
  }

  /** One request in a transaction of its own, answered once the transaction is on the disk. */
  async #run<T>(
    name: string,
    mode: IDBTransactionMode,
    work: (store: IDBObjectStore) => IDBRequest<T>,
  ): Promise<T> {
    const database = await this.#database
    return new Promise((resolve, reject) => {
      const transaction = database.transaction(name, mode, { durability: 'strict' })
      const asked = work(transaction.objectStore(name))
      transaction.oncomplete = () => {
        resolve(asked.result)
      }
      transaction.onabort = transaction.onerror = () => {
        reject(transaction.error ?? new Error('The browser could not store this.'))
      }
    })
  }
}

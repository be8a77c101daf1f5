import { de } from './de'
import { en } from './en'
import { catalogue } from './language.svelte'

/** The texts that both apps share. */
export const words = catalogue({ en, de })

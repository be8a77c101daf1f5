import { catalogue } from '@/language/language.svelte'
import { de } from './de'
import { en } from './en'

/** The texts of the factory engineer's UI. */
export const texts = catalogue({ en, de })

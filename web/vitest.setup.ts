import { beforeEach } from 'vitest'
import { language } from '@/language/language.svelte'

beforeEach(() => {
  language.choose('en')
})

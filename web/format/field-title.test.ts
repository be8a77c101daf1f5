import { describe, expect, it } from 'vitest'
import { language } from '@/language/language.svelte'
import { fieldTitle, technicalName } from './field-title'

describe('the title of a field', () => {
  it('is its meaning in the language of the page, with the technical name behind', () => {
    const field = { name: 'prodQty', semantic: 'PRODUCED_QUANTITY', description: 'Pieces so far' }
    expect([fieldTitle(field), technicalName(field)]).toEqual(['Produced quantity', 'prodQty'])
    language.choose('de')
    expect(fieldTitle(field)).not.toBe('Produced quantity')
    language.choose('en')
  })
  it('is a short description, and the name where there is none', () => {
    expect(fieldTitle({ name: 'spd', description: ' Speed of the belt ' })).toBe(
      'Speed of the belt',
    )
    const explained = { name: 'spd', description: 'x'.repeat(61) }
    expect([fieldTitle(explained), technicalName(explained)]).toEqual(['spd', undefined])
    expect(fieldTitle({ name: 'spd', semantic: null, description: null })).toBe('spd')
  })
})

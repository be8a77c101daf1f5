import { words } from '@/language/words'

interface Named {
  name: string
  semantic?: string | null | undefined
  description?: string | null | undefined
}

/** Longest description that is a title. */
const TITLE_CHARS = 60

/** Title of a field for people: its meaning or its short description, else its technical name. */
export function fieldTitle({ name, semantic, description }: Named): string {
  if (semantic) return words.semantic[semantic] ?? semantic
  const said = description?.trim() ?? ''
  return said === '' || said.length > TITLE_CHARS ? name : said
}

/** Technical name, where the title says something else. */
export function technicalName(field: Named): string | undefined {
  return fieldTitle(field) === field.name ? undefined : field.name
}

import type { MappingInput } from '../api/types'

/** Name of an input for scripts, by the name of its variable, that no other input has. */
export function inputName(browseName: string, inputs: readonly MappingInput[]): string {
  const plain = browseName
    .replace(/^nsu=[^;]*;/, '')
    .replace(/^.*[:/]/, '')
    .replace(/[^A-Za-z0-9_]/g, '_')
    .replace(/^(?=\d|$)/, '_')
    .slice(0, 60)
  const base = plain.charAt(0).toLowerCase() + plain.slice(1)
  const isTaken = (name: string): boolean =>
    name === 'value' || inputs.some((input) => input.name === name)
  let name = base
  for (let number = 2; isTaken(name); number += 1) name = `${base}${number}`
  return name
}

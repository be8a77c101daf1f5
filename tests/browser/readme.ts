import { readFileSync } from 'node:fs'
import path from 'node:path'

/** Where a program shows its pages, and who signs in there at first. */
export interface Entrance {
  url: string
  userName: string
  /** File with the password, in the folder where the program was started. */
  passwordFile: string
}

/** What the section of the README says that leads from nothing to the first value. */
export interface Way {
  /** Commands in their order, block by block. */
  blocks: string[][]
  /** The platform's, then the connector's. */
  entrances: [Entrance, Entrance]
}

export function wayWithoutTheDemo(): Way {
  const readme = readFileSync(path.resolve(import.meta.dirname, '../../README.md'), 'utf8')
  const section = /^## Without the demo\n([^]*?)^## /m.exec(readme)?.[1]
  if (section === undefined) throw new Error('The README says nothing of a way without the demo.')
  const blocks = [...section.matchAll(/^```sh\n([^]*?)^```$/gm)].map(([, block = '']) =>
    block.split('\n').filter((line) => line.trim() !== ''),
  )
  const entrances = [
    ...section.matchAll(
      /sign in at\s+<(\S+)>\s+as\s+`(\w+)`;\s+the\s+password\s+is\s+in\s+`(\S+)`/g,
    ),
  ].map(([, url = '', userName = '', passwordFile = '']) => ({ url, userName, passwordFile }))
  const [platform, connector, ...others] = entrances
  if (platform === undefined || connector === undefined || others.length > 0)
    throw new Error('The README has to name the pages of both programs, and who signs in.')
  return { blocks, entrances: [platform, connector] }
}

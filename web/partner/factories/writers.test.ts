import { render, screen } from '@testing-library/svelte'
import userEvent from '@testing-library/user-event'
import { afterEach, describe, expect, it, vi } from 'vitest'
import { words } from '@/language/words'
import { serve, type Asked } from '../../vitest.server'
import type { WriterView } from '../api/types'
import { texts } from '../language/texts'
import FactoryPage from './FactoryPage.svelte'

const writer = (dataSetWriterId: number, more: Partial<WriterView> = {}): WriterView => ({
  dataSetWriterId,
  epoch: 1,
  throughSequence: 9,
  missing: [],
  missingCount: 0,
  gaps: [],
  gapCount: 0,
  received: 10,
  ...more,
})

afterEach(() => {
  vi.unstubAllGlobals()
})

describe('the writers of a factory', () => {
  it('are read page by page, and earlier gaps are counted', async () => {
    const gap = { firstSequence: 3, lastSequence: 4, cause: 'EXPIRED', isCoarse: false } as const
    const log = serve({
      'GET /factories': () => ({ items: [{ factoryId: 'F', name: 'F' }] }),
      'GET /factories/F/lease': () => ({ contenders: [] }),
      'GET /factories/F/writers': ({ path }: Asked) =>
        path.includes('cursor=7.1')
          ? { items: [writer(8)] }
          : { items: [writer(7, { gaps: [gap], gapCount: 3 })], nextCursor: '7.1' },
    })
    render(FactoryPage, { factoryId: 'F' })
    expect(await screen.findByText('7')).toBeTruthy()
    expect(screen.getByText(new RegExp(texts.factories.earlierGaps(2)))).toBeTruthy()
    expect(screen.queryByText('8')).toBeNull()
    await userEvent.click(screen.getByRole('button', { name: words.action.more }))
    expect(await screen.findByText('8')).toBeTruthy()
    const paths = log.map(({ path }) => path).filter((path) => path.includes('writers'))
    expect(paths).toEqual(['/factories/F/writers', '/factories/F/writers?cursor=7.1'])
  })
})

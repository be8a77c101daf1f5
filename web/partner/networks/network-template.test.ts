import { describe, expect, it } from 'vitest'
import { networkTemplate } from './network-template'

const collaboration = {
  collaborationId: 'frames',
  name: 'Frames',
  members: ['acme'],
  factories: ['MUC_1', 'HAM_1'],
  createdAt: '2026-11-27T05:00:00Z',
}
const now = Date.parse('2026-11-27T05:08:20.123Z')

describe('the network to begin with', () => {
  it('gives each factory an operation, one after the other', () => {
    const network = networkTemplate(collaboration, [], now)
    expect(network.operationNetworkId).toBe('frames-1')
    expect(
      network.operationList.map(({ owningFactoryId, plannedStart, plannedEnd }) => [
        owningFactoryId,
        plannedStart,
        plannedEnd,
      ]),
    ).toEqual([
      ['MUC_1', '2026-11-27T06:00:00Z', '2026-11-27T14:00:00Z'],
      ['HAM_1', '2026-11-27T14:00:00Z', '2026-11-27T22:00:00Z'],
    ])
    expect(network.operationRelationList).toMatchObject([
      { predecessorOperationId: 'Make1', successorOperationId: 'Make2' },
    ])
  })

  it('takes an id that no network has', () => {
    expect(networkTemplate(collaboration, ['frames-1', 'frames-2'], now).operationNetworkId).toBe(
      'frames-3',
    )
  })
})

import { valueText } from '@/format/value'
import { words } from '@/language/words'
import type { LiveEvent } from '../api/types'
import { texts } from '../language/texts'

export interface EventText {
  where: string
  what: string
}

/** Text of an event on one line, with the address that it is about. */
export function eventText(live: LiveEvent): EventText {
  return { where: addressOf(live).join(' / '), what: changesOf(live).join(' · ') }
}

/** Ids of what an event is about, from the outside in. */
function addressOf(live: LiveEvent): string[] {
  switch (live.event) {
    case 'value': {
      const { factoryId, operationNetworkId, operationId, dynamicDataRequestId } = live.data
      return [factoryId, operationNetworkId, operationId, dynamicDataRequestId]
    }
    case 'decision': {
      const { operationNetworkId, operationId, dynamicDataRequestId, fieldName } = live.data.key
      return [operationNetworkId, operationId, dynamicDataRequestId, fieldName]
    }
    case 'part':
      return [live.data.factoryId, live.data.operationNetworkId]
    case 'progress':
      return [live.data.operationNetworkId, live.data.operationId]
    case 'network':
    case 'comment':
      return [live.data.operationNetworkId]
    case 'factory':
      return [live.data.factoryId]
    case 'reset':
      return []
  }
}

/** Texts of the changes that an event tells of. */
function changesOf(live: LiveEvent): string[] {
  switch (live.event) {
    case 'value': {
      const values = live.data.fields.map(
        ({ key, value }) => `${key.fieldName} ${valueText(value)}`,
      )
      return [values.join(', ')]
    }
    case 'decision': {
      const { mappingState, reason } = live.data
      return [words.mappingState[mappingState] ?? mappingState, ...(reason == null ? [] : [reason])]
    }
    case 'part': {
      const { state, revision } = live.data
      return [
        texts.network.part[state] ?? state,
        ...(revision == null ? [] : [texts.networks.revision(revision)]),
      ]
    }
    case 'progress': {
      const { state, quantity } = live.data
      return [
        ...(state == null ? [] : [words.operationState[state] ?? state]),
        ...(quantity == null ? [] : [valueText(quantity)]),
      ]
    }
    case 'network':
      return [texts.networks.revision(live.data.revision)]
    case 'comment':
    case 'factory':
    case 'reset':
      return []
  }
}

import { to } from '@/navigation/router.svelte'
import type { Collaboration, Factory, Organisation, UserView } from '../api/types'
import { texts } from '../language/texts'

/** What is there already. */
export interface Known {
  organisations: readonly Organisation[]
  factories: readonly Factory[]
  collaborations: readonly Collaboration[]
  people: readonly UserView[]
}

export interface FirstStep {
  title: string
  text: string
  done: boolean
  action: string
  href: string
}

/** Steps of those who run the platform, from an empty one to partners that can work together. */
export function administratorSteps(known: Known): FirstStep[] {
  const { firstSteps: t, organisations, factories, collaborations, people } = texts.administration
  const waiting = known.factories.filter(({ enrolledAt }) => enrolledAt == null)
  const [begun] = known.collaborations
  const isWhole = (each: Collaboration): boolean =>
    each.members.length > 0 && each.factories.length > 0
  return [
    {
      title: t.organisation,
      text: t.organisationText,
      done: known.organisations.length > 0,
      action: organisations.title,
      href: to('administration', 'organisations'),
    },
    {
      title: t.factory,
      text: t.factoryText,
      done: known.factories.length > 0,
      action: factories.title,
      href: to('administration', 'factories'),
    },
    {
      title: t.enrol,
      text: waiting.length > 0 ? t.enrolText(waiting.map(nameOf).join(', ')) : t.factoryText,
      // One that never came is no reason to show this for good.
      done: known.factories.some(({ enrolledAt }) => enrolledAt != null),
      action: factories.enrol,
      href: to('administration', 'factories'),
    },
    {
      title: t.collaboration,
      text: begun ? t.incompleteText : t.collaborationText,
      done: known.collaborations.some(isWhole),
      action: collaborations.title,
      href: to('administration', 'collaborations', ...(begun ? [begun.collaborationId] : [])),
    },
    {
      title: t.person,
      text: t.personText,
      done: known.people.some(
        ({ organisationId, role }) => organisationId != null && role !== 'VIEWER',
      ),
      action: people.title,
      href: to('administration', 'people'),
    },
  ]
}

/** Steps of those who plan: a network, and something asked about it. */
export function plannerSteps(networkId: string | undefined, isAsked: boolean): FirstStep[] {
  const { firstSteps: t } = texts.administration
  return [
    {
      title: t.network,
      text: t.networkText,
      done: networkId !== undefined,
      action: texts.networks.add,
      href: to('new-network'),
    },
    {
      title: t.request,
      text: t.requestText,
      done: isAsked,
      action: networkId === undefined ? texts.networks.title : t.openNetwork,
      href: networkId === undefined ? to('new-network') : to('networks', networkId),
    },
  ]
}

function nameOf({ factoryId, name }: Factory): string {
  return name || factoryId
}

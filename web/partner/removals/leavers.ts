import type { SignedIn } from '@/transport/session.svelte'
import { platform } from '../api/client'
import type { Collaboration, Removal } from '../api/types'
import { texts } from '../language/texts'
import { mayPlan } from '../rights'

/** Who or what can leave: a name for people, and the removal or its preview. */
export interface Leaver {
  key: string
  name: string
  /** More about it, for people. */
  of: string
  /** What it means beside what ends, for people. */
  note?: string
  leave: (dryRun: boolean) => Promise<Removal>
}

export function person(userName: string, organisationId: string | null | undefined): Leaver {
  return {
    key: `users/${userName}`,
    name: userName,
    of: organisationId ?? '',
    leave: (dryRun) =>
      platform.delete('/users/{userName}', { path: { userName }, query: { dryRun } }),
  }
}

export function organisation(organisationId: string, name: string): Leaver {
  return {
    key: `organisations/${organisationId}`,
    name,
    of: organisationId,
    leave: (dryRun) =>
      platform.delete('/organisations/{organisationId}', {
        path: { organisationId },
        query: { dryRun },
      }),
  }
}

export function factory(factoryId: string, organisationId: string | null | undefined): Leaver {
  return {
    key: `factories/${factoryId}`,
    name: factoryId,
    of: organisationId ?? '',
    leave: (dryRun) =>
      platform.delete('/factories/{factoryId}', { path: { factoryId }, query: { dryRun } }),
  }
}

export function tool(toolId: string, organisationId: string): Leaver {
  return {
    key: `tools/${toolId}`,
    name: toolId,
    of: organisationId,
    leave: (dryRun) => platform.delete('/tools/{toolId}', { path: { toolId }, query: { dryRun } }),
  }
}

export function collaboration({ collaborationId, name }: Collaboration): Leaver {
  return {
    key: `collaborations/${collaborationId}`,
    name,
    of: collaborationId,
    note: texts.administration.collaborations.removeNote,
    leave: (dryRun) =>
      platform.delete('/collaborations/{collaborationId}', {
        path: { collaborationId },
        query: { dryRun },
      }),
  }
}

/** The members and factories of a collaboration. */
export function partners({ collaborationId, name, members, factories }: Collaboration): Leaver[] {
  return [
    ...factories.map((factoryId) => ({
      key: `collaborations/${collaborationId}/factories/${factoryId}`,
      name: factoryId,
      of: name,
      leave: (dryRun: boolean) =>
        platform.delete('/collaborations/{collaborationId}/factories/{factoryId}', {
          path: { collaborationId, factoryId },
          query: { dryRun },
        }),
    })),
    ...members.map((organisationId) => ({
      key: `collaborations/${collaborationId}/members/${organisationId}`,
      name: organisationId,
      of: name,
      leave: (dryRun: boolean) =>
        platform.delete('/collaborations/{collaborationId}/members/{organisationId}', {
          path: { collaborationId, organisationId },
          query: { dryRun },
        }),
    })),
  ]
}

/** The account of the signed-in person, which ends with all its sessions. */
export function ownAccount({ userName, organisationId }: SignedIn): Leaver {
  const { ofOwnAccount, ownAccountNote } = texts.removals
  return { ...person(userName, organisationId), of: ofOwnAccount, note: ownAccountNote }
}

/** What the signed-in person may let leave: the own account and, as a planner, what the organisation has. */
export async function own(who: SignedIn, signal: AbortSignal): Promise<Leaver[]> {
  const { organisationId } = who
  // Administrators have a page for all that can leave.
  if (!mayPlan(who) || who.role === 'ADMINISTRATOR' || organisationId == null)
    return [ownAccount(who)]
  const [collaborations, factories, tools] = await Promise.all([
    platform.get('/collaborations', { signal }),
    platform.get('/factories', { signal }),
    platform.get('/tools', { signal }),
  ])
  const isOwn = (each: { organisationId?: string | null }): boolean =>
    each.organisationId === organisationId
  const ownFactories = factories.items.filter(isOwn).map(({ factoryId }) => factoryId)
  return [
    ownAccount(who),
    ...collaborations.items.flatMap((each) =>
      partners({
        ...each,
        factories: each.factories.filter((id) => ownFactories.includes(id)),
        members: each.members.filter((id) => id === organisationId),
      }),
    ),
    ...ownFactories.map((id) => factory(id, organisationId)),
    ...tools.items.filter(isOwn).map(({ toolId }) => tool(toolId, organisationId)),
  ]
}

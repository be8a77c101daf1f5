import { platform } from '../api/client'
import type { Collaboration, Removal } from '../api/types'

/** Who or what can leave: a name for people, and the removal or its preview. */
export interface Leaver {
  key: string
  name: string
  /** More about it, for people. */
  of: string
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

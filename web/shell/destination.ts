import type { IconName } from '@/design/icons'

/** Entry of the navigation. */
export interface Destination {
  /** First part of the address, empty for the start page. */
  page: string
  label: string
  icon: IconName
  /** Things that wait there; none is shown for zero. */
  count?: number | undefined
  /** Other first parts of an address that belong to this destination. */
  also?: readonly string[]
}

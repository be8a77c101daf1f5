import { decision } from './de/decision'
import { disclosure } from './de/disclosure'
import { faults } from './de/faults'
import { ledger } from './de/ledger'
import { mapping } from './de/mapping'
import { operator } from './de/operator'
import { overview } from './de/overview'
import { servers } from './de/servers'
import { settings } from './de/settings'
import { sources } from './de/sources'
import type { Texts } from './en'

export const de: Texts = {
  ...overview,
  ...decision,
  ...mapping,
  ...disclosure,
  ...faults,
  ...ledger,
  ...sources,
  ...servers,
  ...operator,
  ...settings,
}

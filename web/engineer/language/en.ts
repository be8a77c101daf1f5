import { decision } from './en/decision'
import { disclosure } from './en/disclosure'
import { faults } from './en/faults'
import { ledger } from './en/ledger'
import { mapping } from './en/mapping'
import { operator } from './en/operator'
import { overview } from './en/overview'
import { servers } from './en/servers'
import { settings } from './en/settings'
import { sources } from './en/sources'

export const en = {
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

export type Texts = typeof en

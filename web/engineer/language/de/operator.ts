import type { operator as English } from '../en/operator'

export const operator: typeof English = {
  operator: {
    page: 'Bedienung',
    title: 'Vorgänge an den Maschinen',
    subtitle:
      'Eingaben werden sofort festgehalten und gesendet, sobald die Anbindung erreichbar ist.',
    empty: 'Zurzeit ist nichts einzugeben',
    emptyText: 'Vorgänge erscheinen hier, wenn eines ihrer Felder von Hand gefüllt wird.',
    later: 'An den nächsten Tagen',
    notStarted: 'Nicht begonnen',
    good: 'gut',
    scrap: 'Ausschuss',
    start: 'Start',
    resume: 'Fortsetzen',
    addOne: 'Ein weiteres Gutteil',
    addMany: 'Mehrere',
    scrapOne: 'Ausschuss',
    done: 'Fertig',
    problem: 'Störung',
    started: 'Begonnen.',
    ended: 'Fertig.',
    addedGood: (n: string) => `${n} gut gezählt.`,
    addedScrap: (n: string) => `${n} Ausschuss gezählt.`,
    entered: (name: string) => `${name} eingegeben.`,
    problemRecorded: 'Störung festgehalten. Der Vorgang ist unterbrochen.',
    problemTitle: 'Was ist los?',
    problemOther: 'Etwas anderes',
    problemHint:
      'Dieser Text bleibt in der Fabrik. Partner sehen nur, dass der Vorgang unterbrochen ist.',
    problems: [
      'Maschine steht',
      'Material fehlt',
      'Werkzeug verschlissen oder gebrochen',
      'Qualität fraglich',
    ],
    record: 'Festhalten',
    quantityTitle: 'Wie viele Teile?',
    piece: 'Art der Teile',
    addNow: 'Zählen',
    deleteDigit: 'Letzte Ziffer löschen',
    enter: 'Eingeben',
    yes: 'Ja',
    no: 'Nein',
    doesNotFit: (type: string) => `Das ist kein Wert vom Typ ${type}.`,
    allSent: 'Alles, was Sie eingegeben haben, ist angekommen.',
    sending: (n: number) =>
      n === 1 ? '1 Eintrag wird gesendet …' : `${n} Einträge werden gesendet …`,
    offline: (n: number) =>
      n === 1 ? '1 Eintrag liegt auf diesem Gerät.' : `${n} Einträge liegen auf diesem Gerät.`,
    offlineText: (age: string) =>
      `Die Anbindung hat zuletzt ${age} geantwortet. Arbeiten Sie weiter: Einträge behalten ihre Zeit und werden automatisch gesendet.`,
    foreign: (n: number) => `${n} weitere warten, bis sich ihr Verfasser hier anmeldet.`,
    volatile:
      'Dieser Browser kann keine Einträge speichern: Schließen Sie die Seite nicht, bevor alles angekommen ist.',
    refused: (operation: string) => `Ein Eintrag zu ${operation} wurde nicht angenommen.`,
    waitingHere: (n: number) =>
      n === 1 ? '1 Eintrag noch nicht gesendet' : `${n} Einträge noch nicht gesendet`,
    lastEntry: 'Letzter Eintrag',
    noEntry: 'Noch kein Eintrag',
  },
}

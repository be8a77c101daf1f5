import type { overview as English } from '../en/overview'

export const overview: typeof English = {
  shell: {
    subtitle: 'Fabrikanbindung',
    overview: 'Übersicht',
    inbox: 'Eingang',
    sources: 'Quellen',
    ledger: 'Ausgangsbuch',
    link: 'Verbindung',
    settings: 'Einstellungen',
  },
  overview: {
    title: 'Übersicht',
    path: 'Weg eines Werts',
    pathHint:
      'Von Ihren Maschinen zu Ihren Partnern. Nur Felder, die Sie geöffnet haben, passieren die Freigabe.',
    machines: 'Maschinen',
    machinesState: (live: number, all: number) => `${live} von ${all} Quellen verbunden`,
    inputs: (live: number, all: number) => `${live} von ${all} Eingängen live`,
    gate: 'Freigabe',
    gateState: (mapped: number, all: number) => `${mapped} von ${all} Feldern offen`,
    gatePending: (n: number) =>
      n === 0
        ? 'nichts wartet auf Sie'
        : n === 1
          ? '1 Feld wartet auf Ihre Entscheidung'
          : `${n} Felder warten auf Ihre Entscheidung`,
    twin: 'Zwilling',
    twinState: 'OPC-UA-Adresse',
    spool: 'Ausgangspuffer',
    spoolState: (n: string) => `${n} warten`,
    spoolEmpty: 'Nichts wartet auf den Versand',
    spoolOldest: 'älteste ',
    link: 'Verbindung',
    partner: 'Partner',
    partnerState: (n: number) => (n === 1 ? '1 Organisation fragt' : `${n} Organisationen fragen`),
    conclusions: (n: number) =>
      n === 1 ? '1 Rückschluss ist möglich' : `${n} Rückschlüsse sind möglich`,
    toDecide: 'Wartet auf Ihre Entscheidung',
    nothingToDecide: 'Über jedes angefragte Feld ist entschieden.',
    whatLeaves: 'Geht jetzt hinaus',
    moreLeaves: (n: string) => `${n} weitere im Eingang`,
    nothingLeaves: 'Kein Feld ist offen: Nichts verlässt diese Fabrik.',
    field: 'Feld',
    forWhom: 'Für',
    value: 'Wert',
    age: 'Alter',
  },
  firstSteps: {
    title: 'Erste Schritte',
    hint: 'Von hier bis zum ersten Wert, der diese Fabrik verlässt.',
    link: 'Der Plattform beitreten',
    linkText: 'Die Verbindung steht noch nicht. Ihre Seite sagt, warum.',
    source: 'Eine Maschine verbinden',
    sourceText: 'Die Adresse ihres OPC-UA-Servers genügt.',
    sourceWaits: 'Die Quelle ist noch nicht verbunden; ihre Zeile sagt, was zu tun ist.',
    request: 'Ein Partner fragt',
    requestText: 'Nichts zu tun: Die Anfrage erscheint von selbst.',
    requestCame: (n: number) => (n === 1 ? '1 Feld ist angefragt.' : `${n} Felder sind angefragt.`),
    decide: 'Über das erste Feld entscheiden',
    decideText: 'Vorschlag übernehmen, Vorschau prüfen, einwilligen.',
  },
  link: {
    title: 'Verbindung und Ausgangspuffer',
    state: {
      up: 'Verbunden',
      connecting: 'Wird verbunden',
      down: 'Nicht verbunden',
      stopped: 'Angehalten',
      notConfigured: 'Nicht aufgenommen',
    },
    since: 'seit ',
    accepted: 'Zuletzt vom Broker angenommen',
    receipted: 'Zuletzt von der Plattform quittiert',
    backlog: 'Wartet auf Quittung',
    why: {
      partly: 'Senden oder Empfangen gelingt teilweise nicht; es wird wieder versucht.',
      retrying: 'Der Broker ist nicht erreichbar. Es wird von selbst wieder versucht.',
      permanent:
        'Der Broker weist diese Anbindung ab. Jemand muss handeln: Prüfen Sie Zugangsdaten und Zertifikate.',
    },
    reason: 'Grund',
    spool: 'Ausgangspuffer',
    spoolHint:
      'Eine Nachricht bleibt hier, bis die Plattform sie quittiert hat. Ein Ausfall kostet Zeit, keine Daten.',
    waiting: 'Wartet auf Versand',
    sent: 'Gesendet, noch nicht quittiert',
    size: 'Größe',
    oldest: 'Älteste',
    deadLetters: 'Unzustellbare Nachrichten',
    deadLettersHint: 'Nachrichten, die endgültig abgewiesen wurden, mit dem Grund.',
    noDeadLetters: 'Noch nie wurde eine Nachricht abgewiesen.',
    when: 'Wann',
    subject: 'Betreff',
  },
  lease: {
    title: 'Sendeberechtigung der Fabrik',
    state: {
      ASKING: 'Die Plattform hat noch nicht geantwortet',
      HELD: 'Diese Anbindung',
      REFUSED: 'Eine andere Anbindung',
      UNANSWERED: 'Die Plattform antwortet nicht',
    },
    refused:
      'Eine andere Anbindung hat die Sendeberechtigung dieser Fabrik. Von hier geht nichts hinaus; Werte werden gespeichert.',
    contested: 'Eine zweite Anbindung mit den Zugangsdaten dieser läuft. Sie wurde abgewiesen.',
    unanswered: 'Die Plattform antwortet nicht. Was von hier hinausgeht, zählt womöglich nicht.',
    unansweredSince: 'Keine Antwort seit der Anfrage ',
    unansweredRemedy:
      'Der Broker nimmt Nachrichten an, und die Plattform beantwortet keine: Sie läuft nicht, oder der Zugang dieser Anbindung wurde dort widerrufen. Fragen Sie einen Verwalter der Plattform. Werte bleiben hier gespeichert, bis die Plattform sie quittiert hat; wurde der Zugang widerrufen, nehmen Sie diese Anbindung erneut auf.',
    own: 'Diese Anbindung:',
    other: 'Die andere:',
    refusedRemedy:
      'Halten Sie eine der beiden an. Gibt es die andere nicht mehr, kann ein Verwalter der Plattform auf der Seite der Fabrik die Sendeberechtigung an diese übergeben.',
    contestedRemedy:
      'Suchen Sie die andere und halten Sie sie an: Wahrscheinlich wurde sie aus einer Kopie des Datenverzeichnisses dieser Anbindung gestartet.',
  },
  witness: {
    title: 'Die Plattform hat eine andere Geschichte des Ausgangsbuchs',
    held: 'Es wird nichts offengelegt: Werte warten hier, bis das geklärt ist.',
    kind: {
      ROLLED_BACK:
        'Die Plattform hat mehr Einträge: Der Speicher wurde zurückgesetzt oder gekürzt.',
      REPLACED:
        'Die Plattform hat andere Einträge: Der Speicher wurde ersetzt, oder zurückgesetzt und fortgeführt.',
      OTHER_KEY: 'Die Plattform kennt dieses Log unter einem anderen Schlüssel.',
      SUPERSEDED: 'Ein neueres Log hat dieses ersetzt: Der Speicher ist älter.',
      UNPROVABLE:
        'Die Einträge, die den Prüfpunkt der Plattform beweisen würden, sind nicht im Speicher.',
    },
    heldSize: (size) => `Sie hat ${size} davon.`,
    remedy:
      'Halten Sie die Anbindung an und stellen Sie die neueste Sicherung ihres Datenverzeichnisses wieder her. Gibt es keine, beginnen Sie ein neues Log: Der Empfänger sieht es.',
    begin: 'Neues Log beginnen',
    beginFor: (recipient) => `Neues Log für ${recipient}`,
    consequence:
      'Das neue Log hat die Einträge, die hier gespeichert sind. Was die Plattform vom früheren hat, bleibt dort als Beleg. Danach gehen wieder Werte hinaus.',
    reason: 'Grund',
    reasonHint: 'Steht mit Ihrem Namen und der Zeit im neuen Log; der Empfänger liest ihn.',
  },
  users: {
    title: 'Benutzer',
    subtitle: 'Wer sich hier und über OPC UA am Zwilling anmelden darf',
    everybody: 'Wer sich anmelden darf',
    nobody: 'Niemand darf sich anmelden.',
    add: 'Person hinzufügen',
    role: 'Rolle',
    may: 'Darf',
    you: 'Sie',
    roles: {
      ENGINEER: 'entscheiden, zuordnen, einrichten',
      OPERATOR: 'Werte zu Vorgängen eingeben',
      VIEWER: 'ansehen',
    } as Record<string, string>,
    newPassword: 'Neues Passwort',
    passwordHint: 'Mindestens zehn Zeichen. Ein paar Wörter merken sich leichter als Zeichen.',
    passwordShort: 'Das Passwort hat weniger als zehn Zeichen.',
    resetFactor: 'Zweiten Faktor zurücksetzen',
    factorReset: (name: string) => `Zur Anmeldung von ${name} genügt wieder das Passwort.`,
    sessionsEnd: 'Mindestens zehn Zeichen. Offene Sitzungen der Person enden.',
    changed: (who: string) => `${who} gespeichert.`,
    remove: (who: string) => `${who} entfernen`,
    removeText:
      'Die Person kann sich nicht mehr anmelden, offene Sitzungen enden. Was entschieden und eingegeben wurde, bleibt festgehalten.',
    removed: (who: string) => `${who} entfernt.`,
  },
}

import type { sources as English } from '../en/sources'

const kept = (queue: string) => (queue === '1' ? 'die neueste Änderung' : `${queue} Änderungen`)

export const sources: typeof English = {
  sources: {
    title: 'Quellen',
    subtitle: 'OPC-UA-Server Ihrer Maschinen',
    add: 'Quelle hinzufügen',
    edit: 'Quelle bearbeiten',
    empty: 'Noch keine Quelle',
    emptyText:
      'Fügen Sie den OPC-UA-Server einer Maschine oder Linie hinzu, um ihre Werte zuzuordnen.',
    name: 'Name',
    id: 'Kennung',
    idHint: 'Buchstaben, Ziffern, - und _. Später nicht mehr zu ändern.',
    endpointUrl: 'Adresse',
    security: 'Sicherheit',
    securityStrongest: 'Die stärkste Verschlüsselung, die der Server anbietet',
    securitySigned: 'Signiert, nicht verschlüsselt (Basic256Sha256)',
    securityNone: 'Keine (nur in einem vertrauten Netz)',
    securityExactly: 'Wie eingerichtet',
    identity: 'Anmelden als',
    anonymous: 'Anonym',
    withUser: 'Benutzername und Passwort',
    userName: 'Benutzername',
    password: 'Passwort',
    passwordKept: 'Leer lassen, um es zu behalten. Eine andere Adresse braucht es erneut.',
    passwordUnprotected: 'Das Passwort ungeschützt senden',
    passwordUnprotectedHint:
      'Jeder im Netz kann es lesen. Ohne dies wird es nicht gesendet, und die Quelle bleibt unverbunden.',
    publishingInterval: 'Sendeintervall (ms)',
    publishingIntervalHint: 'Was gewünscht wird. Viele Steuerungen gewähren 100 bis 1000 ms.',
    samplingInterval: 'Abtastintervall (ms)',
    samplingIntervalHint:
      'So oft sieht der Server nach jeder Variablen. Leer: so oft, wie er sendet. 0: bei jeder Änderung.',
    silence: 'Aufgegeben nach Stille von (ms)',
    silenceHint: 'Ein langsamerer Server bekommt die Zeit, die er für ein Lebenszeichen braucht.',
    granted: 'Der Server gewährt',
    grantedIntervals: (publishing: string, keepAlive: string, silence: string) =>
      `Änderungen alle ${publishing} ms, ein Lebenszeichen alle ${keepAlive} ms; aufgegeben nach ${silence} ms`,
    grantedItems: (sampling: string, queue: string) =>
      `sieht alle ${sampling} ms nach und hebt zwischen zwei Nachrichten ${kept(queue)} eines Eingangs auf`,
    grantedOnChange: (queue: string) =>
      `sieht jede Änderung und hebt zwischen zwei Nachrichten ${kept(queue)} eines Eingangs auf`,
    coarse: 'Eingänge, denen einzelne Änderungen fehlen können',
    coarseHint:
      'Der neueste Wert kommt immer an. Änderungen zwischen zwei Nachrichten vielleicht nicht.',
    coarseQueue: (queue: string, sampling: string) =>
      `Der Server hebt zwischen zwei Nachrichten ${kept(queue)} auf und sieht alle ${sampling} ms nach.`,
    coarseOverflows: (count: string) => `Er hat ${count}-mal Änderungen verworfen.`,
    filled: 'Eingänge, die aufgeholt haben',
    filledHint:
      'Während die Verbindung fehlte, gingen ihre Werte vorbei. Danach wurden sie aus der Historie des Servers gelesen.',
    filledValues: (count: string, since: string) => `${count} Werte seit ${since}.`,
    filledPartly: 'Es waren mehr, als auf einmal gelesen werden: Einige fehlen.',
    state: {
      connected: 'Verbunden',
      subscribing: 'Abonniert',
      connecting: 'Wird verbunden',
      waiting: 'Nicht verbunden',
    },
    live: 'Live-Eingänge',
    liveOf: (live: number, all: number) => `${live} von ${all}`,
    lastChange: 'Letzte Änderung',
    signOfLife: 'Lebenszeichen',
    problem: 'Was nicht stimmt',
    remedy: 'Was zu tun ist',
    removed: 'Quelle entfernt.',
    unknown: (id: string) => `Es gibt keine Quelle ${id}, oder sie wurde entfernt.`,
    saved: 'Quelle gespeichert.',
    browse: 'Adressraum',
    browseHint: 'Was der Server anbietet, mit Live-Werten.',
    details: 'Verbindung',
    serverName: 'Server',
    applicationUri: 'Anwendungs-URI',
    policy: 'Sicherheitsrichtlinie',
    changes: 'Empfangene Änderungen',
    sessions: 'Sitzungen bisher',
    clock: 'Uhr des Servers',
    clockAhead: (ms: string) => `geht ${ms} ms vor`,
    notLive: 'Eingänge, die nicht live sind',
    node: 'Knoten',
    reason: 'Grund',
    remove: 'Quelle entfernen',
    removeTitle: (name: string) => `${name} entfernen?`,
    removeUnused: 'Kein preisgegebenes Feld bekommt Werte von ihr.',
    removeUsed: (n: number) =>
      n === 1
        ? 'Ein preisgegebenes Feld bekommt seine Werte von ihr. Es behält seinen letzten Wert mit einem Status, der sagt, dass die Quelle fehlt, bis Sie wieder eine Quelle mit derselben Kennung hinzufügen:'
        : `${n} preisgegebene Felder bekommen ihre Werte von ihr. Sie behalten ihre letzten Werte mit einem Status, der sagt, dass die Quelle fehlt, bis Sie wieder eine Quelle mit derselben Kennung hinzufügen:`,
    removeMore: (n: number) => (n === 1 ? 'und eines mehr.' : `und ${n} weitere.`),
    treeEmpty: 'Hier zeigt der Server nichts.',
    treeLabel: 'Adressraum der Quelle',
    searchNodes: 'Den ganzen Server durchsuchen, oder eine Node-Id einfügen',
    nothingFound: 'Nichts gefunden',
    found: (shown: string, all: string) =>
      shown === all ? `${all} gefunden` : `${shown} von ${all} gefunden`,
    stillListing: 'Der Server wird noch gelistet; gleich kann mehr zu finden sein.',
    chooseSource: 'Quelle',
    certificate: 'Zertifikat',
    problems: {
      unreachable: {
        what: 'Keine Antwort von dieser Adresse',
        remedy:
          'Prüfen Sie, ob der Server läuft, die Adresse und das Netz dazwischen. Es wird von selbst wieder versucht.',
      },
      hostNameUnknown: {
        what: 'Kein Namensdienst kennt diesen Rechnernamen',
        remedy:
          'Prüfen Sie den Namen, oder geben Sie die IP-Adresse des Servers an. Es wird von selbst wieder versucht.',
      },
      nothingListens: {
        what: 'An diesem Port antwortet nichts',
        remedy:
          'Prüfen Sie den Port, und ob der OPC-UA-Server im Projekt der Maschine eingeschaltet ist. Es wird von selbst wieder versucht.',
      },
      endpointsHidden: {
        what: 'Der Server zeigt nicht, was er anbietet',
        remedy:
          'Lassen Sie in den Einstellungen des Servers die Richtlinie None für die Endpunktsuche zu. Sitzungen bleiben geschützt.',
      },
      noSuitableEndpoint: {
        what: 'Der Server bietet diese Sicherheit oder Anmeldung nicht',
        remedy: 'Wählen Sie eine Sicherheit und eine Anmeldung, die der Server anbietet.',
      },
      securityOutdated: {
        what: 'Der Server bietet nur veraltete Sicherheit',
        remedy:
          'Schalten Sie in den Sicherheitseinstellungen des Servers die Richtlinie Basic256Sha256, signiert und verschlüsselt, ein.',
      },
      serverCertificateUntrusted: {
        what: 'Dem Zertifikat des Servers wird noch nicht vertraut',
        remedy:
          'Vergleichen Sie den Fingerabdruck mit dem des Zertifikats an der Maschine und vertrauen Sie ihm dann.',
      },
      serverCertificateInvalid: {
        what: 'Das Zertifikat des Servers ist nicht gültig',
        remedy: 'Lassen Sie das Zertifikat des Servers erneuern.',
      },
      serverKeyTooShort: {
        what: 'Der Schlüssel des Serverzertifikats ist zu kurz',
        remedy:
          'Lassen Sie den Server ein Zertifikat mit einem Schlüssel von mindestens 2048 Bit erstellen, und vertrauen Sie dann diesem.',
      },
      clientCertificateRejected: {
        what: 'Der Server vertraut dieser Anbindung noch nicht',
        remedy:
          'Bitten Sie den Betreiber des Servers, dem Zertifikat dieser Anbindung zu vertrauen, und warten Sie einen Augenblick.',
      },
      clientCertificateOutOfTime: {
        what: 'Nach der Uhr des Servers ist das Zertifikat dieser Anbindung nicht gültig',
        remedy:
          'Stellen Sie die Uhr des Servers; ohne Zeitabgleich beginnen viele Steuerungen im Jahr 1970. Geht sie richtig, erneuern Sie das Zertifikat dieser Anbindung.',
      },
      credentialsRejected: {
        what: 'Benutzername oder Passwort ist nicht richtig',
        remedy: 'Berichtigen Sie sie hier, oder fragen Sie den Betreiber des Servers.',
      },
      serverFull: {
        what: 'Der Server hat keinen Platz für eine weitere Sitzung',
        remedy: 'Schließen Sie einen anderen Client des Servers, oder erhöhen Sie seine Grenze.',
      },
      connectionLost: {
        what: 'Die Verbindung ist abgebrochen',
        remedy: 'Nichts zu tun: Sie wird von selbst wieder aufgebaut.',
      },
      stalled: {
        what: 'Der Server hat nicht mehr geantwortet',
        remedy:
          'Nichts zu tun: Eine neue Sitzung wird aufgebaut. Geschieht das oft, prüfen Sie den Server.',
      },
      refused: { what: 'Der Server hat abgelehnt', remedy: 'Sein Protokoll sagt, warum.' },
      configuration: {
        what: 'Die Quelle ist nicht richtig eingerichtet',
        remedy: 'Berichtigen Sie die Einstellungen der Quelle.',
      },
    } as Record<string, { what: string; remedy: string }>,
  },
  certificates: {
    title: 'Zertifikate der Server',
    clients: 'Zertifikate von OPC-UA-Clients',
    clientsHint:
      'Clients, die sich mit dem Zwilling verbinden wollten. Ein vertrauter Client darf sich mit Benutzername und Passwort anmelden.',
    noClients: 'Noch wollte sich kein OPC-UA-Client verbinden.',
    add: 'Zertifikat hinzufügen',
    added: 'Zertifikat hinzugefügt.',
    kind: 'Art',
    kinds: {
      CERTIFICATE: 'Ein Client oder eine Stelle, der vertraut wird',
      ISSUER: 'Eine Zwischenstelle',
      REVOCATION_LIST: 'Die Sperrliste einer Stelle',
      DENIED_CERTIFICATE: 'Ein Client, der abgelehnt wird, auch wenn eine Stelle für ihn bürgt',
    } as Record<string, string>,
    file: 'Aus einer Datei',
    content: 'Inhalt',
    contentHint: 'PEM oder DER in Base64.',
    hint: 'Vergleichen Sie den Fingerabdruck mit dem des Zertifikats an der Maschine, bevor Sie ihm vertrauen.',
    none: 'Noch hat kein Server ein Zertifikat gezeigt.',
    subject: 'Gehört zu',
    fingerprint: 'Fingerabdruck (SHA-256)',
    valid: 'Gültigkeit',
    validity: (from: string, until: string) =>
      [from, until].filter((day) => day !== '').join(' bis '),
    over: 'Abgelaufen',
    soon: 'Endet bald',
    early: 'Noch nicht gültig',
    rejectedLast: 'Zuletzt abgewiesen',
    rejectedClient: (application: string | null, address: string | null) =>
      [application ?? '', address === null ? '' : `von ${address}`]
        .filter((part) => part !== '')
        .join(', '),
    reasons: {
      NOT_TRUSTED: 'Ihm wurde nicht vertraut.',
      OUT_OF_TIME: 'Es ist zu dieser Zeit nicht gültig.',
      USAGE: 'Es darf nicht zum Signieren verwendet werden.',
      KEY_LENGTH: 'Sein Schlüssel ist zu kurz oder zu lang.',
      UNREADABLE: 'Es ist nicht lesbar.',
      REVOKED: 'Seine Stelle hat es gesperrt.',
      REVOCATION_UNKNOWN: 'Die aktuelle Sperrliste seiner Stelle fehlt.',
      TRUST_LIST_UNREADABLE:
        'Eine Datei der Vertrauensliste ist nicht lesbar; das Protokoll des Konnektors nennt sie.',
    } as Record<string, string>,
    tooLarge: (size: string) => `Die Datei ist größer als ${size}: Das kann kein Zertifikat sein.`,
    isTrusted: 'Vertraut',
    isIssued: 'Kam durch seine Stelle herein',
    isUnapproved: 'Von keinem Menschen genehmigt',
    unapprovedHint:
      'Eine frühere Version vertraute ihm, oder es wurde in den Ordner kopiert. Vergleichen Sie den Fingerabdruck, dann genehmigen Sie es oder vertrauen ihm nicht mehr.',
    isRejected: 'Wartet auf Sie',
    isDenied: 'Abgelehnt',
    trust: 'Vertrauen',
    approve: 'Genehmigen',
    withdraw: 'Nicht mehr vertrauen',
    deny: 'Ablehnen',
    trusted: 'Dem Zertifikat wird vertraut.',
    rejected: 'Dem Zertifikat wird nicht mehr vertraut.',
  },
  applicationCertificate: {
    title: 'Zertifikat des Zwillings',
    hint: 'Das Zertifikat, das OPC-UA-Clients sehen. Der Zwilling stellt es aus und erneuert es, wenn Sie keines Ihrer Stelle installieren.',
    issuer: 'Ausgestellt von',
    selfSigned: 'Vom Zwilling selbst; er erneuert es rechtzeitig.',
    renewItself: 'Beantragen Sie es bei dieser Stelle neu, bevor es endet.',
    hosts: 'Für Anwendung und Rechner',
    request: 'Zertifikat beantragen',
    requestNow: 'Antrag erstellen',
    requestText:
      'Der Antrag nennt diese Anwendung und ihre eingestellten Rechnernamen. Der Schlüssel bleibt auf diesem Rechner.',
    commonName: 'Name (CN)',
    organization: 'Organisation (O)',
    optional: 'Darf leer bleiben.',
    newKey: 'Mit neuem Schlüssel, der ab der Installation gilt',
    requested:
      'Geben Sie dies Ihrer Stelle, und installieren Sie das Zertifikat, das sie ausstellt.',
    download: 'Als Datei',
    install: 'Ausgestelltes Zertifikat installieren',
    installNow: 'Installieren',
    installText:
      'Das Zertifikat und die seiner Stellen bis zur Wurzel, zusammen als PEM. Offene Verbindungen behalten das alte.',
    installed: 'Zertifikat installiert. Der Zwilling zeigt es ab der nächsten Verbindung.',
  },
  authorities: {
    title: 'Zertifizierungsstellen von OPC-UA-Clients',
    hint: 'Ein Client mit einem Zertifikat einer vertrauten Stelle braucht keine eigene Zulassung, solange die Stelle es nicht sperrt.',
    none: 'Keine Stelle: Jeder Client braucht eine eigene Zulassung.',
    authority: 'Stelle',
    isTrusted: 'Vertraut mit allen ihren Clients',
    isBetween: 'Zwischenstelle',
    issuedBy: (issuer: string) => `ausgestellt von ${issuer}`,
    revocations: 'Sperrliste',
    current: 'Aktuell',
    missing: 'Fehlt',
    outdated: 'Veraltet',
    stayOutside: 'Ihre Clients werden abgewiesen, bis Sie die aktuelle Liste hinzufügen.',
    remove: 'Diese Stelle entfernen?',
    removeText: (subject: string) =>
      `Clients mit einem Zertifikat von ${subject} werden abgewiesen, und ihre offenen Sitzungen enden. Um der Stelle wieder zu vertrauen, brauchen Sie ihre Datei.`,
    removed: 'Stelle entfernt.',
  },
  revocationLists: {
    title: 'Sperrlisten',
    hint: 'Zertifikate, die Stellen gesperrt haben. Eine neue Liste ersetzt die alte der Stelle; fügen Sie sie hinzu, bevor die alte abläuft.',
    none: 'Keine Sperrliste.',
    revoked: 'Gesperrt',
    unknown: 'Von einer unbekannten Stelle signiert',
    remove: 'Diese Sperrliste entfernen?',
    removeText: (issuer: string) =>
      `Clients mit einem Zertifikat von ${issuer} werden abgewiesen, bis Sie eine neue Liste hinzufügen.`,
    removed: 'Sperrliste entfernt.',
  },
}

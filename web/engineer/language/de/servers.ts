import type { servers as English } from '../en/servers'

export const servers: typeof English = {
  servers: {
    ask: 'Server fragen',
    askHint: 'Er sagt, was er anbietet; gespeichert wird nichts.',
    offered: 'Was der Server anbietet',
    certificate: 'Sein Zertifikat, zum Vergleich an der Maschine',
    noCertificate: 'Er zeigt kein Zertifikat.',
    alreadyTrusted: 'Schon vertraut',
    asOffered: (policy: string, mode: string) => `${policy}, ${mode}`,
    modes: {
      none: 'ungeschützt',
      sign: 'nur signiert',
      signAndEncrypt: 'signiert und verschlüsselt',
    },
    notUsed: 'Angeboten, aber veraltet und nicht verwendet',
    addressUsed: 'Verwendete Adresse',
    noSignIn: 'Der Server nimmt keine der Anmeldungen, die hier gewählt werden können.',
    test: 'Testen',
    testing: 'Eine Sitzung wird geöffnet und wieder geschlossen …',
    tested: 'Die Anbindung kommt hinein.',
    product: 'Produkt',
    limits: 'Seine Grenzen',
    noLimits: 'Er nennt keine.',
    limit: {
      nodesPerReadMax: 'Knoten je Lesen',
      nodesPerWriteMax: 'Knoten je Schreiben',
      nodesPerBrowseMax: 'Knoten je Durchsuchen',
      pathsPerTranslateMax: 'Pfade je Übersetzung',
      itemsPerCallMax: 'Eingänge je Aufruf',
      itemsPerSubscriptionMax: 'Eingänge je Subscription',
      subscriptionsPerSessionMax: 'Subscriptions je Sitzung',
      browseContinuationPointsMax: 'Fortsetzungspunkte',
      sessionsMax: 'Sitzungen',
      queueSizeMax: 'in der Warteschlange eines Eingangs',
    } as Record<string, string>,
    publishes: (ms: string) => `Änderungen alle ${ms} ms`,
    clockRight: 'Seine Uhr stimmt mit unserer überein.',
    findings: {
      hostNameUnknown: (host: string, used: string) =>
        `Der Server nennt sich ${host}, was hier kein Namensdienst kennt. Stattdessen wird ${used} verwendet; zu tun ist nichts. Andere Clients brauchen den Namen vielleicht: Er steht in den Endpunkteinstellungen des Servers.`,
      hostNameDiffers: (host: string, used: string) =>
        `Der Server nennt sich ${host}. Verwendet wird ${used}, wie Sie es angegeben haben. Prüfen Sie, ob es die Maschine ist, die Sie meinen.`,
      nothingEncrypted: (offered: string) =>
        `Der Server bietet keine Verschlüsselung, die nicht veraltet ist, nur: ${offered}. Schalten Sie in seinen Sicherheitseinstellungen Basic256Sha256 (signieren und verschlüsseln) ein. Ohne sie liest jeder im Netz mit und kann an seiner Stelle antworten.`,
      certificateExpired: (to: string) =>
        `Sein Zertifikat endete am ${to}. Für geschützte Sitzungen taugt es nicht: Lassen Sie an der Maschine ein neues erstellen.`,
      certificateNotYetValid: (from: string) =>
        `Sein Zertifikat beginnt am ${from}: Es entstand, während die Uhr der Maschine falsch ging, oder unsere geht falsch. Stellen Sie die Uhr, und lassen Sie dann ein neues Zertifikat erstellen.`,
      certificateOfOtherHost: (host: string, names: string) =>
        `Sein Zertifikat ist für ${names}, nicht für ${host}. Diese Anbindung vertraut genau diesem Zertifikat: Vergleichen Sie den Fingerabdruck an der Maschine. Nach einer Änderung ihrer Adresse lassen Sie ein neues erstellen.`,
      certificateOfOtherHostNone: (host: string) =>
        `Sein Zertifikat nennt keinen Rechner, also auch nicht ${host}. Diese Anbindung vertraut genau diesem Zertifikat: Vergleichen Sie den Fingerabdruck an der Maschine.`,
      certificateOfOtherApplication: (application: string) =>
        `Sein Zertifikat ist für die Anwendung ${application}, der Server sagt aber, er sei eine andere. Vielleicht ist es die Kopie von einer anderen Maschine: Lassen Sie ein neues erstellen.`,
      keyTooShort: (bits: string) =>
        `Der Schlüssel seines Zertifikats hat ${bits} Bit, gebraucht werden 2048. Lassen Sie an der Maschine ein neues Zertifikat erstellen.`,
      signedWithSha1:
        'Sein Zertifikat ist über SHA-1 signiert, das sich fälschen lässt. Lassen Sie eines mit SHA-256 erstellen.',
      clockAhead: (time: string) =>
        `Seine Uhr geht gegenüber unserer um ${time} vor. Zeiten von Werten sind die der Maschine und gehen so hinaus: Stellen Sie sie, am besten über NTP.`,
      clockBehind: (time: string) =>
        `Seine Uhr geht gegenüber unserer um ${time} nach. Zeiten von Werten sind die der Maschine und gehen so hinaus: Stellen Sie sie, am besten über NTP.`,
    },
    family: 'Familie des Servers',
    familyOf: (name: string) => `Wissenswertes über ${name}`,
    familyHint: 'Nach öffentlichen Unterlagen; was der Server gewährt, geht vor.',
    advised: (publishing: string, sampling: string) =>
      `Empfohlen: Sendeintervall ${publishing} ms, Abtastintervall ${sampling} ms.`,
    useAdvised: 'Die empfohlenen Intervalle übernehmen',
    figures: 'Grenzen',
    expected: 'Was zu erwarten ist',
    settings: 'Was an der Maschine einzustellen ist',
    evidence: {
      manual: 'Handbuch',
      source: 'Quelltext',
      issue: 'Fehlerbericht',
      project: 'öffentliches Projekt',
      general: 'ungeprüft',
    },
    figure: {
      publishingIntervalMsMin: 'kleinstes Sendeintervall (ms)',
      samplingIntervalMsMin: 'kleinstes Abtastintervall (ms)',
      sessionsMax: 'Sitzungen',
      subscriptionsPerSessionMax: 'Subscriptions einer Sitzung',
      queueSizeMax: 'Änderungen in der Warteschlange eines Elements',
      nodesPerCallMax: 'Knoten oder Elemente je Anfrage',
      nodesPerBrowseMax: 'Knoten je Durchsuchen',
      keepAliveCountMax: 'Keep-Alive-Zähler',
      lifetimeCountMax: 'Lebensdauer-Zähler',
    },
    own: 'Zertifikat dieser Anbindung',
    ownHint:
      'Maschinen sehen es, wenn die Anbindung sich anmeldet. Wer sie verwaltet, muss ihm vertrauen, meist durch einen Import.',
    asDer: 'Herunterladen (DER)',
    asPem: 'Herunterladen (PEM)',
    renew: 'Ein neues erstellen',
    renewTitle: 'Ein neues Zertifikat erstellen?',
    renewText:
      'Es bekommt einen eigenen Schlüssel und wird noch nicht verwendet. Lassen Sie erst jede Maschine ihm vertrauen, und verwenden Sie es dann; bis dahin ändert sich nichts.',
    next: 'Das nächste, noch nicht verwendet',
    nextHint: 'Lassen Sie jede Maschine ihm vertrauen, bevor Sie es verwenden.',
    use: 'Jetzt verwenden',
    useTitle: 'Das nächste Zertifikat jetzt verwenden?',
    useText:
      'Offene Sitzungen laufen weiter. Jede neue beginnt mit ihm, und eine Maschine, die ihm noch nicht vertraut, weist die Anbindung ab. Das jetzige Zertifikat und sein Schlüssel werden gelöscht.',
    used: 'Das nächste Zertifikat wird von jetzt an verwendet.',
    discard: 'Verwerfen',
    discardTitle: 'Das nächste Zertifikat verwerfen?',
    discardText:
      'Es kommt nicht wieder: Maschinen, die ihm schon vertrauen, müssen vor dem nächsten Wechsel einem anderen vertrauen.',
    discarded: 'Das nächste Zertifikat ist gelöscht.',
    made: 'Das nächste Zertifikat ist erstellt.',
  },
}

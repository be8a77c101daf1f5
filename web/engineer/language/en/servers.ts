export const servers = {
  servers: {
    ask: 'Ask the server',
    askHint: 'It says what it offers; nothing is stored.',
    offered: 'What the server offers',
    certificate: 'Its certificate, to be compared at the machine',
    noCertificate: 'It shows no certificate.',
    alreadyTrusted: 'Trusted already',
    asOffered: (policy: string, mode: string) => `${policy}, ${mode}`,
    modes: {
      none: 'not protected',
      sign: 'signed only',
      signAndEncrypt: 'signed and encrypted',
    },
    notUsed: 'Offered, but outdated and not used',
    addressUsed: 'Address that is used',
    noSignIn: 'The server takes none of the sign-ins that can be chosen here.',
    test: 'Test',
    testing: 'Opens a session and closes it again …',
    tested: 'The connector comes in.',
    product: 'Product',
    limits: 'Its limits',
    noLimits: 'It states none.',
    limit: {
      nodesPerReadMax: 'nodes per read',
      nodesPerWriteMax: 'nodes per write',
      nodesPerBrowseMax: 'nodes per browse',
      pathsPerTranslateMax: 'paths per translation',
      itemsPerCallMax: 'items per call',
      itemsPerSubscriptionMax: 'items per subscription',
      subscriptionsPerSessionMax: 'subscriptions per session',
      browseContinuationPointsMax: 'continuation points',
      sessionsMax: 'sessions',
      queueSizeMax: 'in the queue of an item',
    } as Record<string, string>,
    publishes: (ms: string) => `changes every ${ms} ms`,
    clockRight: 'Its clock agrees with ours.',
    findings: {
      hostNameUnknown: (host: string, used: string) =>
        `The server calls itself ${host}, which no name service here knows. ${used} is used instead; nothing to do. Other clients may need the name set in the server’s endpoint settings.`,
      hostNameDiffers: (host: string, used: string) =>
        `The server calls itself ${host}. ${used} is used, as you gave it. Check that it is the machine that you mean.`,
      nothingEncrypted: (offered: string) =>
        `The server offers no encryption that is not outdated, only: ${offered}. Switch on Basic256Sha256 (sign and encrypt) in its security settings. Without it everybody on the network reads along, and may answer in its place.`,
      certificateExpired: (to: string) =>
        `Its certificate ended on ${to}. It cannot be used for protected sessions: have a new one made at the machine.`,
      certificateNotYetValid: (from: string) =>
        `Its certificate begins on ${from}: it was made while the machine’s clock was wrong, or ours is. Set the clock, then have a new certificate made.`,
      certificateOfOtherHost: (host: string, names: string) =>
        `Its certificate is for ${names}, not for ${host}. This connector trusts the exact certificate, so compare the fingerprint at the machine. After a change of its address, have a new one made.`,
      certificateOfOtherHostNone: (host: string) =>
        `Its certificate names no host, so not ${host} either. This connector trusts the exact certificate: compare the fingerprint at the machine.`,
      certificateOfOtherApplication: (application: string) =>
        `Its certificate is for the application ${application}, but the server says that it is another one. It may be a copy of another machine’s: have a new one made.`,
      keyTooShort: (bits: string) =>
        `The key of its certificate has ${bits} bits, and 2048 are needed. Have a new certificate made at the machine.`,
      signedWithSha1:
        'Its certificate is signed over SHA-1, which can be forged. Have a new one made with SHA-256.',
      clockAhead: (time: string) =>
        `Its clock is ${time} ahead of ours. Times of values are the machine’s and leave as they are: set it, best by NTP.`,
      clockBehind: (time: string) =>
        `Its clock is ${time} behind ours. Times of values are the machine’s and leave as they are: set it, best by NTP.`,
    },
    family: 'Family of the server',
    familyOf: (name: string) => `What to know of ${name}`,
    familyHint: 'By public documents; what the server grants goes before it.',
    advised: (publishing: string, sampling: string) =>
      `Advised: publishing interval ${publishing} ms, sampling interval ${sampling} ms.`,
    useAdvised: 'Use the advised intervals',
    figures: 'Limits',
    expected: 'What to expect',
    settings: 'What to set at the machine',
    evidence: {
      manual: 'manual',
      source: 'source code',
      issue: 'issue',
      project: 'public project',
      general: 'unchecked',
    },
    figure: {
      publishingIntervalMsMin: 'least publishing interval (ms)',
      samplingIntervalMsMin: 'least sampling interval (ms)',
      sessionsMax: 'sessions',
      subscriptionsPerSessionMax: 'subscriptions of a session',
      queueSizeMax: 'changes in the queue of an item',
      nodesPerCallMax: 'nodes or items in a request',
      nodesPerBrowseMax: 'nodes in a browse request',
      keepAliveCountMax: 'keep-alive count',
      lifetimeCountMax: 'lifetime count',
    },
    own: 'Certificate of this connector',
    ownHint:
      'Machines see it when the connector signs in. Their administrators must trust it, mostly by importing it.',
    asDer: 'Download (DER)',
    asPem: 'Download (PEM)',
    renew: 'Make a new one',
    renewTitle: 'Make a new certificate?',
    renewText:
      'It gets a key of its own and is not used yet. Have every machine trust it first, then use it; until then nothing changes.',
    next: 'The next one, not used yet',
    nextHint: 'Have every machine trust it before you use it.',
    use: 'Use it now',
    useTitle: 'Use the next certificate now?',
    useText:
      'Sessions that are open go on. Each new one begins with it, and a machine that does not trust it yet refuses the connector. The present certificate and its key are deleted.',
    used: 'The next certificate is used from now on.',
    discard: 'Discard it',
    discardTitle: 'Discard the next certificate?',
    discardText:
      'It cannot be had back: machines that trust it already have to trust another one before the next change.',
    discarded: 'The next certificate is gone.',
    made: 'The next certificate is made.',
  },
}

const kept = (queue: string) => (queue === '1' ? 'the newest change' : `${queue} changes`)

export const sources = {
  sources: {
    title: 'Sources',
    subtitle: 'OPC UA servers of your machines',
    add: 'Add a source',
    edit: 'Edit the source',
    empty: 'No source yet',
    emptyText: 'Add the OPC UA server of a machine or a line to map its values.',
    name: 'Name',
    id: 'Id',
    idHint: 'Letters, digits, - and _. It cannot be changed later.',
    endpointUrl: 'Address',
    security: 'Security',
    securityStrongest: 'The strongest encryption that the server offers',
    securitySigned: 'Signed, not encrypted (Basic256Sha256)',
    securityNone: 'None (only on a trusted network)',
    securityExactly: 'As configured',
    identity: 'Sign in as',
    anonymous: 'Anonymous',
    withUser: 'User name and password',
    userName: 'User name',
    password: 'Password',
    passwordKept: 'Leave empty to keep it. Another address needs it again.',
    passwordUnprotected: 'Send the password unprotected',
    passwordUnprotectedHint:
      'Everybody on the network can read it. Without this it is not sent, and the source stays unconnected.',
    publishingInterval: 'Publishing interval (ms)',
    publishingIntervalHint: 'What is asked for. Many controllers grant 100 to 1000 ms.',
    samplingInterval: 'Sampling interval (ms)',
    samplingIntervalHint:
      'How often the server looks at each variable. Empty: as often as it publishes. 0: on every change.',
    silence: 'Given up after silence of (ms)',
    silenceHint: 'A slower server is given the time that it takes for a sign of life.',
    granted: 'The server grants',
    grantedIntervals: (publishing: string, keepAlive: string, silence: string) =>
      `changes every ${publishing} ms, a sign of life every ${keepAlive} ms; given up after ${silence} ms`,
    grantedItems: (sampling: string, queue: string) =>
      `looks every ${sampling} ms and keeps ${kept(queue)} of an input between two messages`,
    grantedOnChange: (queue: string) =>
      `looks at every change and keeps ${kept(queue)} of an input between two messages`,
    coarse: 'Inputs that may miss single changes',
    coarseHint: 'The newest value always arrives. Changes between two messages may not.',
    coarseQueue: (queue: string, sampling: string) =>
      `The server keeps ${kept(queue)} between two messages and looks every ${sampling} ms.`,
    coarseOverflows: (count: string) => `It has dropped changes ${count} times.`,
    filled: 'Inputs that caught up',
    filledHint:
      'While the connection was away, their values were missed. They were read from the server’s history since.',
    filledValues: (count: string, since: string) => `${count} values since ${since}.`,
    filledPartly: 'There were more than are read at once: some are missing.',
    state: {
      connected: 'Connected',
      subscribing: 'Subscribing',
      connecting: 'Connecting',
      waiting: 'Not connected',
    } as Record<string, string>,
    live: 'Live inputs',
    liveOf: (live: number, all: number) => `${live} of ${all}`,
    lastChange: 'Last change',
    signOfLife: 'Sign of life',
    problem: 'What is wrong',
    remedy: 'What to do',
    removed: 'Source removed.',
    unknown: (id: string) => `There is no source ${id}, or it was removed.`,
    saved: 'Source saved.',
    browse: 'Address space',
    browseHint: 'What the server offers, with live values.',
    details: 'Connection',
    serverName: 'Server',
    applicationUri: 'Application URI',
    policy: 'Security policy',
    changes: 'Changes received',
    sessions: 'Sessions so far',
    clock: 'Server’s clock',
    clockAhead: (ms: string) => `${ms} ms ahead of ours`,
    notLive: 'Inputs that are not live',
    node: 'Node',
    reason: 'Reason',
    remove: 'Remove the source',
    removeTitle: (name: string) => `Remove ${name}?`,
    removeUnused: 'No disclosed field gets values from it.',
    removeUsed: (n: number) =>
      n === 1
        ? 'One disclosed field gets its values from it. It keeps its last value, with a status that says that the source is missing, until you add a source with the same id again:'
        : `${n} disclosed fields get their values from it. They keep their last values, with a status that says that the source is missing, until you add a source with the same id again:`,
    removeMore: (n: number) => (n === 1 ? 'and one more.' : `and ${n} more.`),
    treeEmpty: 'The server shows nothing here.',
    treeLabel: 'Address space of the source',
    searchNodes: 'Search the whole server, or paste a node id',
    nothingFound: 'Nothing found',
    found: (shown: string, all: string) =>
      shown === all ? `${all} found` : `${shown} of ${all} found`,
    stillListing: 'The server is still being listed; more may be found in a moment.',
    chooseSource: 'Source',
    certificate: 'Certificate',
    problems: {
      unreachable: {
        what: 'No answer from this address',
        remedy:
          'Check that the server runs, its address, and the network. The connector retries automatically.',
      },
      hostNameUnknown: {
        what: 'No name service knows this host name',
        remedy:
          'Check the name, or use the IP address of the server. The connector retries automatically.',
      },
      nothingListens: {
        what: 'Nothing listens at this port',
        remedy:
          'Check the port, and that the OPC UA server is switched on in the machine’s project. The connector retries automatically.',
      },
      endpointsHidden: {
        what: 'The server does not show what it offers',
        remedy:
          'Allow the security policy None for discovery in the settings of the server. Sessions stay protected.',
      },
      noSuitableEndpoint: {
        what: 'The server offers no such security or sign-in',
        remedy: 'Choose a security setting and a sign-in that the server offers.',
      },
      securityOutdated: {
        what: 'The server offers outdated security only',
        remedy:
          'Switch on the policy Basic256Sha256, signed and encrypted, in the security settings of the server.',
      },
      serverCertificateUntrusted: {
        what: 'The server’s certificate is not trusted yet',
        remedy:
          'Compare the fingerprint with that of the certificate at the machine, then trust it.',
      },
      serverCertificateInvalid: {
        what: 'The server’s certificate is not valid',
        remedy: 'Have the server’s certificate renewed.',
      },
      serverKeyTooShort: {
        what: 'The key of the server’s certificate is too short',
        remedy:
          'Have the server make a certificate with a key of 2048 bits or more, then trust that.',
      },
      clientCertificateRejected: {
        what: 'The server does not trust this connector yet',
        remedy:
          'Ask the operator of the server to trust this connector’s certificate, then wait a moment.',
      },
      clientCertificateOutOfTime: {
        what: 'By the server’s clock, the certificate of this connector is not valid',
        remedy:
          'Set the clock of the server; without time synchronisation many controllers start in 1970. If it is right, renew the certificate of this connector.',
      },
      credentialsRejected: {
        what: 'User name or password is not right',
        remedy: 'Correct them here, or ask the operator of the server.',
      },
      serverFull: {
        what: 'The server has no room for another session',
        remedy: 'Close another client of the server, or raise its limit of sessions.',
      },
      connectionLost: {
        what: 'The connection was lost',
        remedy: 'Nothing to do: the connector reconnects automatically.',
      },
      stalled: {
        what: 'The server stopped responding',
        remedy: 'Nothing to do: a new session is created. If this happens often, check the server.',
      },
      refused: { what: 'The server refused', remedy: 'Its log says why.' },
      configuration: {
        what: 'The source is not configured right',
        remedy: 'Correct the source’s settings.',
      },
    } as Record<string, { what: string; remedy: string }>,
  },
  certificates: {
    title: 'Certificates of servers',
    clients: 'Certificates of OPC UA clients',
    clientsHint:
      'Clients that tried to connect to the twin. A trusted client may sign in with user name and password.',
    noClients: 'No OPC UA client has tried to connect yet.',
    add: 'Add a certificate',
    added: 'Certificate added.',
    kind: 'Kind',
    kinds: {
      CERTIFICATE: 'A client, or an authority to trust',
      ISSUER: 'An intermediate authority',
      REVOCATION_LIST: 'An authority’s list of revoked certificates',
      DENIED_CERTIFICATE: 'A client to deny, also where an authority vouches for it',
    } as Record<string, string>,
    file: 'From a file',
    content: 'Content',
    contentHint: 'PEM, or DER in base64.',
    hint: 'Compare the fingerprint with that of the certificate at the machine before you trust it.',
    none: 'No server has shown a certificate yet.',
    subject: 'Belongs to',
    fingerprint: 'Fingerprint (SHA-256)',
    valid: 'Validity',
    validity: (from: string, until: string) =>
      [from, until].filter((day) => day !== '').join(' to '),
    over: 'Expired',
    soon: 'Ends soon',
    early: 'Not valid yet',
    rejectedLast: 'Last rejected',
    rejectedClient: (application: string | null, address: string | null) =>
      [application ?? '', address === null ? '' : `from ${address}`]
        .filter((part) => part !== '')
        .join(', '),
    reasons: {
      NOT_TRUSTED: 'It was not trusted.',
      OUT_OF_TIME: 'It is not valid at this time.',
      USAGE: 'It may not be used for signing.',
      KEY_LENGTH: 'Its key is too short or too long.',
      UNREADABLE: 'It cannot be read.',
      REVOKED: 'Its authority revoked it.',
      REVOCATION_UNKNOWN: 'Its authority’s current revocation list is missing.',
      TRUST_LIST_UNREADABLE:
        'A file of the trust list cannot be read; the connector’s log names it.',
    } as Record<string, string>,
    tooLarge: (size: string) => `The file is larger than ${size}: it cannot be a certificate.`,
    isTrusted: 'Trusted',
    isIssued: 'Came in through its authority',
    isUnapproved: 'Not approved by a person',
    unapprovedHint:
      'A former version trusted it, or it was copied into the folder. Compare the fingerprint, then approve it or stop trusting it.',
    isRejected: 'Waits for you',
    isDenied: 'Denied',
    trust: 'Trust',
    approve: 'Approve',
    withdraw: 'Stop trusting',
    deny: 'Deny',
    trusted: 'Certificate trusted.',
    rejected: 'Certificate no longer trusted.',
  },
  applicationCertificate: {
    title: 'Certificate of the twin',
    hint: 'The certificate that OPC UA clients see. The twin makes and renews it, unless you install one of your authority.',
    issuer: 'Issued by',
    selfSigned: 'The twin itself; it renews it in time.',
    renewItself: 'Ask this authority again before it ends.',
    hosts: 'For application and hosts',
    request: 'Request a certificate',
    requestNow: 'Make the request',
    requestText:
      'The request names this application and its configured host names. The key stays on this machine.',
    commonName: 'Common name',
    organization: 'Organisation',
    optional: 'May stay empty.',
    newKey: 'With a new key, used once the certificate is installed',
    requested: 'Give this to your authority, and install the certificate that it issues.',
    download: 'As a file',
    install: 'Install an issued certificate',
    installNow: 'Install',
    installText:
      'The certificate and those of its authorities up to the root, together as PEM. Connections that are open keep the old one.',
    installed: 'Certificate installed. The twin shows it from the next connection on.',
  },
  authorities: {
    title: 'Authorities of OPC UA clients',
    hint: 'A client with a certificate of a trusted authority needs no approval of its own, unless the authority revoked the certificate.',
    none: 'No authority: every client needs an approval of its own.',
    authority: 'Authority',
    isTrusted: 'Trusted, with all its clients',
    isBetween: 'Intermediate authority',
    issuedBy: (issuer: string) => `issued by ${issuer}`,
    revocations: 'Revocation list',
    current: 'Current',
    missing: 'Missing',
    outdated: 'Outdated',
    stayOutside: 'Its clients are rejected until you add the current list.',
    remove: 'Remove this authority?',
    removeText: (subject: string) =>
      `Clients with a certificate of ${subject} are rejected, and their open sessions end. To trust the authority again you need its file.`,
    removed: 'Authority removed.',
  },
  revocationLists: {
    title: 'Revocation lists',
    hint: 'Certificates that authorities revoked. A new list replaces the authority’s old one; add it before the old one expires.',
    none: 'No revocation list.',
    revoked: 'Revoked',
    unknown: 'Signed by an unknown authority',
    remove: 'Remove this revocation list?',
    removeText: (issuer: string) =>
      `Clients with a certificate of ${issuer} are rejected until you add a new list.`,
    removed: 'Revocation list removed.',
  },
}

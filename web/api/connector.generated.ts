// Generated from openapi.json by `npm run generate`. Do not edit.

export interface paths {
    "/alliances": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the alliances in their newest version, retired ones included.
         * @description Least role: VIEWER.
         */
        get: operations["listAlliances"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/alliances/{allianceId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Stores a new version of an alliance. Leak budgets and caps of its members count together from now
         *     on; refused (`OVER_CAP`) where a cap would be exceeded by that. `If-Match` as for policies.
         * @description Least role: ENGINEER.
         */
        put: operations["putAlliance"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/alliances/{allianceId}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists every version of an alliance, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listAllianceVersions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/application-certificate": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the OPC UA server's own certificate.
         * @description Least role: VIEWER.
         */
        get: operations["showApplicationCertificate"];
        /**
         * Installs an issued certificate; the server shows it from the next connection on.
         * @description Least role: ENGINEER.
         */
        put: operations["installApplicationCertificate"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/application-certificate/request": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Makes a request for a certificate with the server's application URI and host names. The key
         *     stays here.
         * @description Least role: ENGINEER.
         */
        post: operations["requestApplicationCertificate"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/caps": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the caps in their newest version, retired ones included.
         * @description Least role: VIEWER.
         */
        get: operations["listCaps"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/caps/{capId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Stores a new version of a cap. Decisions, policies, alliances and mappings that would exceed it are
         *     refused from now on (`OVER_CAP`). Where the present sum exceeds it, consents end at once until it
         *     holds: in the order of their decisions each field stays that fits beside the earlier ones.
         *     `If-Match` as for policies.
         * @description Least role: ENGINEER.
         */
        put: operations["putCap"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/caps/{capId}/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Lists the fields whose consents a draft of a cap would end, in the order of their decisions.
         *     Changes nothing.
         * @description Least role: ENGINEER.
         */
        post: operations["previewCap"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/caps/{capId}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists every version of a cap, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listCapVersions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-authorities": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the authorities whose clients may connect, and those in between. They are added with the
         *     clients' certificates.
         * @description Least role: VIEWER.
         */
        get: operations["listClientAuthorities"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-authorities/{thumbprint}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Removes an authority: its clients are rejected, and their open sessions end.
         * @description Least role: ENGINEER.
         */
        delete: operations["removeClientAuthority"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-certificates": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the certificates of OPC UA clients, those that wait for an approval first. A local
         *     discovery server's is among them.
         * @description Least role: VIEWER.
         */
        get: operations["listClientCertificates"];
        put?: never;
        /**
         * Adds a certificate or a revocation list to the trust list.
         * @description Least role: ENGINEER.
         */
        post: operations["addClientCertificate"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-certificates/{thumbprint}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Trusts or rejects a client's certificate.
         * @description Least role: ENGINEER.
         */
        put: operations["trustClientCertificate"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-revocation-lists": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the authorities' lists of revoked certificates.
         * @description Least role: VIEWER.
         */
        get: operations["listClientRevocationLists"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/client-revocation-lists/{revocationListId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Removes a list of revoked certificates: clients of its authority stay outside until there is a
         *     new one.
         * @description Least role: ENGINEER.
         */
        delete: operations["removeClientRevocationList"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/configuration": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists every setting with its meaning, default and value, and who set it. Secrets are not shown.
         * @description Least role: ENGINEER.
         */
        get: operations["showConfiguration"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/dead-letters": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists messages that were received or sent and rejected, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listDeadLetters"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/events": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Streams server-sent events (HTML living standard §9.2). Of each event, the schema's `event` is
         *     the line `event:`, and its `data` is the JSON of the line `data:`.
         * @description Least role: VIEWER.
         */
        get: operations["streamEvents"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows a field with its decision and its newest disclosed value.
         * @description Least role: VIEWER.
         */
        get: operations["showField"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/consent-offer": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the disclosure that a consent begins with, and what "every change" instead of the partner's
         *     period would add.
         * @description Least role: ENGINEER.
         */
        get: operations["showConsentOffer"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/decision": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Decides about a field. The partner is notified; values flow or stop at once. Refused (`OVER_CAP`)
         *     where partners would get more information than a cap allows. `If-Match` with the `shownTag` of the
         *     field that was shown refuses (`DECIDED_SINCE`) what another decision or a changed request has overtaken.
         * @description Least role: ENGINEER.
         */
        put: operations["decideField"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/mapping-status": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the status of a field's mapping: last values in and out, counts, faults, time spent.
         * @description Least role: ENGINEER.
         */
        get: operations["showMappingStatus"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/mapping-status/restart": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Closes the circuit breakers of a field's scripts that exceeded their budget: they run again at
         *     once.
         * @description Least role: ENGINEER.
         */
        post: operations["restartMapping"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Runs a draft on the live values of its inputs; nothing is changed and nothing leaves.
         * @description Least role: ENGINEER.
         */
        post: operations["previewDecision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/shadow": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the shadow mapping, with its values beside those of the published one.
         * @description Least role: ENGINEER.
         */
        get: operations["showShadowMapping"];
        /**
         * Starts a shadow mapping, in place of the present one.
         * @description Least role: ENGINEER.
         */
        put: operations["startShadowMapping"];
        post?: never;
        /**
         * Ends the shadow mapping.
         * @description Least role: ENGINEER.
         */
        delete: operations["endShadowMapping"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/shadow/publish": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Publishes the shadow mapping as the next version, under the consent in force, and ends it.
         * @description Least role: ENGINEER.
         */
        post: operations["publishShadowMapping"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/suggestions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Suggests variables for a field, each with its reasons.
         * @description Least role: ENGINEER.
         */
        get: operations["listSuggestions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/template": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Makes a template of a field's mapping without storing it.
         * @description Least role: ENGINEER.
         */
        post: operations["makeMappingTemplate"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/trial": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Runs a mapping on live or recorded values and shows every intermediate value. Nothing is changed,
         *     and nothing leaves.
         * @description Least role: ENGINEER.
         */
        post: operations["dryRunMapping"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/value": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Enters a value for a field that was decided Manual. It goes through the same gate as any other.
         * @description Least role: OPERATOR.
         */
        put: operations["enterValue"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/version-difference": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Compares two versions of a field's mapping.
         * @description Least role: VIEWER.
         */
        get: operations["compareMappingVersions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the last hundred versions of a field's mapping, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listMappingVersions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/fields/{operationNetworkId}/{operationId}/{dynamicDataRequestId}/{fieldName}/versions/{version}/rollback": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Publishes a version again as the newest one, under the consent in force.
         * @description Least role: ENGINEER.
         */
        post: operations["rollMappingBack"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/inbox": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the requests of all active networks with their fields, filtered, in pages, in the order of
         *     their addresses.
         * @description Least role: VIEWER.
         */
        get: operations["listInbox"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/leak-budgets": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the leak budget of each partner: the sum over its open fields, and the conclusions that
         *     they permit together.
         * @description Least role: VIEWER.
         */
        get: operations["listLeakBudgets"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/leak-budgets/alliances": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the leak budget of each alliance: the sum over the open fields of its members, and the
         *     conclusions that they permit together.
         * @description Least role: VIEWER.
         */
        get: operations["listAllianceBudgets"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/leak-budgets/summary": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Summarises the leak budget of each partner: number of fields, most values and bits per hour, time
         *     resolution, and number of conclusions.
         * @description Least role: VIEWER.
         */
        get: operations["summariseLeakBudgets"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the entries of a recipient's chain, newest first, with the values that left. Without a
         *     recipient, of the first one by name.
         * @description Least role: VIEWER.
         */
        get: operations["listLedgerEntries"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/checkpoints": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the signed checkpoints over all chains, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listCheckpoints"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Exports entries as JSON lines, as a table for spreadsheets or as a page to print, in the order of
         *     the chains.
         * @description Least role: ENGINEER.
         */
        get: operations["exportLedger"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/fields": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Searches the fields that the ledger has entries about, in the order of their addresses; those of
         *     ended requests included.
         * @description Least role: VIEWER.
         */
        get: operations["searchLedgerFields"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/logs": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the logs of all chains, by their recipients.
         * @description Least role: VIEWER.
         */
        get: operations["listLedgerLogs"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/logs/{recipientId}/successor": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Begins a new log in place of one of which the platform holds another history. It has all entries
         *     that the store has; what the platform holds of the former log stays there for the recipient.
         *     Values leave again.
         * @description Least role: ENGINEER.
         */
        post: operations["beginLedgerLog"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/ledger/verification": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Reads every chain from its beginning and finds any change, deletion or reordering; one verification at
         *     a time.
         * @description Least role: ENGINEER.
         */
        post: operations["verifyLedger"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mapping-templates": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the templates.
         * @description Least role: VIEWER.
         */
        get: operations["listMappingTemplates"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mapping-templates/{templateId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Stores a template, in place of the one with the same id.
         * @description Least role: ENGINEER.
         */
        put: operations["putMappingTemplate"];
        post?: never;
        /**
         * Removes a template; mappings made from it stay.
         * @description Least role: ENGINEER.
         */
        delete: operations["removeMappingTemplate"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mapping-templates/{templateId}/fill": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Fills a template once per member of a series and imports the mappings, all or none.
         * @description Least role: ENGINEER.
         */
        post: operations["fillMappingTemplate"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mappings/export": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Exports all mappings, in force and proposed, in a form that can be imported again. The file has
         *     the templates too.
         * @description Least role: ENGINEER.
         */
        get: operations["exportMappings"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mappings/import": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Imports mappings from a table (`text/csv`) or a readable file (`application/json`), as exported:
         *     all or, if there is any fault, none, with a list of all faults and their positions. Consents stay
         *     as they are: mappings of fields that are not mapped are proposals.
         * @description Least role: ENGINEER.
         */
        post: operations["importMappings"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/mappings/survey": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Surveys all published mappings: numbers by condition, and the worst of them.
         * @description Least role: ENGINEER.
         */
        get: operations["surveyMappings"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists all networks, withdrawn ones included.
         * @description Least role: VIEWER.
         */
        get: operations["listOperationNetworks"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows a network as received, and the state of its requests and fields.
         * @description Least role: VIEWER.
         */
        get: operations["showOperationNetwork"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}/comments": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the comments about a network, oldest first.
         * @description Least role: VIEWER.
         */
        get: operations["listComments"];
        put?: never;
        /**
         * Sends a comment to the partners of a network.
         * @description Least role: OPERATOR.
         */
        post: operations["addComment"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operation-networks/{operationNetworkId}/news": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Compares the revision in force of a network with the one before.
         * @description Least role: VIEWER.
         */
        get: operations["showRevisionDifference"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operator/entries": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the last 200 entries about an operation, newest first.
         * @description Least role: OPERATOR.
         */
        get: operations["listOperatorEntries"];
        put?: never;
        /**
         * Accepts entries. They are stored together before the answer is sent; a page without an answer
         *     delivers them again.
         * @description Least role: OPERATOR.
         */
        post: operations["deliverOperatorEntries"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/operator/operations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the operations of a day that have fields for people to fill, and those that are running or
         *     interrupted.
         * @description Least role: OPERATOR.
         */
        get: operations["listOperatorOperations"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/past-decisions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the decisions about the past, newest first: who decided what, when and why.
         * @description Least role: VIEWER.
         */
        get: operations["listPastDecisions"];
        put?: never;
        /**
         * Decides whether a recipient that was added later sees what had left before. It is entered in the
         *     recipient's ledger, and the platform is told. What was shown cannot be made unseen; a revocation
         *     ends what is current, as for every recipient. Reports that the platform holds no longer do not
         *     appear there.
         * @description Least role: ENGINEER.
         */
        post: operations["decidePast"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/past-offers": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the recipients that were added to requests later and could be shown what had left for
         *     others before. Nothing of it is shown unless an engineer decides so.
         * @description A report can be shown where each of its fields is open to the recipient at present, and left
         *     under a policy that satisfies the present one; it is shown whole and as it left, or not at all.
         *     Reports whose values retention has emptied here are not offered.
         *
         *     Least role: VIEWER.
         */
        get: operations["listPastOffers"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/policies": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the named policies in their newest version, retired ones included.
         * @description Least role: VIEWER.
         */
        get: operations["listPolicies"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/policies/{policyId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Stores a new version of a named policy. Values of fields and recipients with it change at once;
         *     each change is a consent in the ledger, and the partner is notified. Refused (`OVER_CAP`) where a
         *     cap would be exceeded by that. `If-Match` with the version read (`"0"` for a new one) keeps two
         *     engineers from overwriting each other.
         * @description Least role: ENGINEER.
         */
        put: operations["putPolicy"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/policies/{policyId}/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Lists the mapped fields that a draft of a named policy would change, at most 500. Changes nothing.
         * @description Least role: ENGINEER.
         */
        post: operations["previewPolicy"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/policies/{policyId}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists every version of a named policy, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listPolicyVersions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/recipients": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists every organisation that may get values, with the policy set for it.
         * @description Least role: VIEWER.
         */
        get: operations["listRecipients"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/recipients/{recipient}/policy": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Sets a named policy for everything that a recipient gets. All recipients of a request get the same
         *     values, so the strictest of the field's and of all its recipients' policies applies, at once.
         *     Refused (`OVER_CAP`) where a cap would be exceeded by that.
         * @description Least role: ENGINEER.
         */
        put: operations["putRecipientPolicy"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/requests/{operationNetworkId}/{operationId}/{dynamicDataRequestId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows one request of an active network with its fields.
         * @description Least role: VIEWER.
         */
        get: operations["showRequest"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/revocations": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the receipts of ended consents, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listRevocations"];
        put?: never;
        /**
         * Revokes consents. Values stop at once, waiting reports are taken back, the partner is notified,
         *     and the receipt lists what had left.
         * @description Least role: ENGINEER.
         */
        post: operations["revokeConsents"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/revocations/{revocationId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows one receipt.
         * @description Least role: VIEWER.
         */
        get: operations["showRevocation"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/revocations/{revocationId}/print": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Prints a receipt as a page.
         * @description Least role: VIEWER.
         */
        get: operations["printRevocation"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rule-decisions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the decisions that rules made, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listRuleDecisions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rule-decisions/{id}/undo": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Undoes the decision of rules about a field: it is pending again, and left to the engineer. A
         *     conflict if something else was decided since.
         * @description Least role: ENGINEER.
         */
        post: operations["undoRuleDecision"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the standing rules in their newest version.
         * @description Least role: VIEWER.
         */
        get: operations["listRules"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules/apply": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Applies the enabled rules to all undecided fields; what an engineer left open stays open.
         * @description Least role: ENGINEER.
         */
        post: operations["applyRules"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules/preview": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Lists the fields that a draft of a rule matches. Changes nothing.
         * @description Least role: ENGINEER.
         */
        post: operations["previewRule"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules/{ruleId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Stores a new version of a rule. Enabled, it decides about requests from now on; requests that are
         *     there already are decided by `POST /rules/apply`. `If-Match` as for policies.
         * @description Least role: ENGINEER.
         */
        put: operations["putRule"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/rules/{ruleId}/versions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists every version of a rule, newest first.
         * @description Least role: VIEWER.
         */
        get: operations["listRuleVersions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/server-profiles": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the families of servers that are known: limits, what to expect, what to set at the machine.
         * @description Least role: VIEWER.
         */
        get: operations["listServerProfiles"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the session of the caller.
         * @description Least role: VIEWER.
         */
        get: operations["showSession"];
        put?: never;
        /** Signs in; the answer sets the session's cookie. */
        post: operations["signIn"];
        /**
         * Signs out.
         * @description Least role: VIEWER.
         */
        delete: operations["signOut"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/passkeys": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the own passkeys.
         * @description Least role: VIEWER.
         */
        get: operations["listPasskeys"];
        /**
         * Adds a passkey that a browser made; the answer has recovery codes where it is the first second factor.
         * @description Least role: VIEWER.
         */
        put: operations["addPasskey"];
        /**
         * Makes the options with which a browser makes a passkey.
         * @description Least role: VIEWER.
         */
        post: operations["beginPasskey"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/passkeys/{passkeyId}/removal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Removes one of the own passkeys.
         * @description Least role: VIEWER.
         */
        post: operations["removePasskey"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/password": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Changes the own password; the person's other sessions end.
         * @description Least role: VIEWER.
         */
        put: operations["changePassword"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/second-factor": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Says whether signing in takes a code.
         * @description Least role: VIEWER.
         */
        get: operations["showSecondFactor"];
        /**
         * Turns the second factor on with a code of the app; the answer has the recovery codes.
         * @description Least role: VIEWER.
         */
        put: operations["confirmSecondFactor"];
        /**
         * Makes a secret for an authenticator app, which counts once it is confirmed.
         * @description Least role: VIEWER.
         */
        post: operations["beginSecondFactor"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/session/second-factor/removal": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Turns the own second factor off.
         * @description Least role: VIEWER.
         */
        post: operations["removeSecondFactor"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sessions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the own sessions, at the pages and at the OPC UA server.
         * @description Least role: VIEWER.
         */
        get: operations["listSessions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sessions/{sessionId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Ends one of the own sessions.
         * @description Least role: VIEWER.
         */
        delete: operations["endSession"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-certificates": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the certificates that servers have shown.
         * @description Least role: VIEWER.
         */
        get: operations["listSourceCertificates"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-certificates/{thumbprint}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Trusts or rejects a server's certificate.
         * @description Least role: ENGINEER.
         */
        put: operations["trustSourceCertificate"];
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-client-certificate": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the certificate that machines see, and the next one.
         * @description Least role: VIEWER.
         */
        get: operations["showSourceClientCertificate"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-client-certificate/next": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Makes the next certificate with a key of its own, unless there is one. It is not used yet.
         * @description Least role: ENGINEER.
         */
        post: operations["prepareSourceClientCertificate"];
        /**
         * Deletes the next certificate and its key.
         * @description Least role: ENGINEER.
         */
        delete: operations["discardSourceClientCertificate"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-client-certificate/next/use": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Uses the next certificate for each new session; open ones go on. A server that does not trust it refuses them.
         * @description Least role: ENGINEER.
         */
        post: operations["useSourceClientCertificate"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-discovery": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Asks a server which endpoints it offers. Nothing is stored.
         * @description Least role: ENGINEER.
         */
        post: operations["discoverSource"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/source-test": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Opens a session with a server as a source would, and closes it again. No source is stored; a certificate of the server
         *     that no person has approved is listed with those that servers have shown.
         * @description Least role: ENGINEER.
         */
        post: operations["testSource"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the stored sources with their state.
         * @description Least role: VIEWER.
         */
        get: operations["listSources"];
        put?: never;
        /**
         * Adds a source; the connector connects to it at once.
         * @description Least role: ENGINEER.
         */
        post: operations["addSource"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Changes a source; mappings that use it go on under the new settings. Without a password the stored one of the same user
         *     is kept, at the same address.
         * @description Least role: ENGINEER.
         */
        put: operations["changeSource"];
        post?: never;
        /**
         * Removes a source; mappings that use it keep their last value with a status that says so.
         * @description Least role: ENGINEER.
         */
        delete: operations["removeSource"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}/nodes": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Browses a source's address space.
         * @description Least role: VIEWER.
         */
        get: operations["browseSource"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}/search": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Searches the connector's list of a server's variables for words of their paths.
         * @description Least role: VIEWER.
         */
        get: operations["searchSource"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}/use": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the fields that get no values any more where a source is removed.
         * @description Least role: VIEWER.
         */
        get: operations["showSourceUse"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/sources/{sourceId}/values": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        /**
         * Reads variables of a source, in the order of the request and in one turn. The values are those of the machine, before
         *     any policy.
         * @description Least role: ENGINEER.
         */
        post: operations["readSourceValues"];
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/spool": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the backlog of the spool.
         * @description Least role: VIEWER.
         */
        get: operations["showSpool"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/status": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Shows the status of the connector.
         * @description Least role: VIEWER.
         */
        get: operations["showStatus"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists all users.
         * @description Least role: ENGINEER.
         */
        get: operations["listUsers"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users/{userName}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        /**
         * Adds a person, or changes role or password. With a new password the person's sessions end,
         *     except the one in which the person did it; those of OPC UA clients also end with another role.
         *     `If-None-Match: *` adds only: it is refused (`ALREADY_EXISTS`) where the name is taken.
         * @description Least role: ENGINEER.
         */
        put: operations["putUser"];
        post?: never;
        /**
         * Removes a person; the person's sessions end.
         * @description Least role: ENGINEER.
         */
        delete: operations["removeUser"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users/{userName}/second-factor": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Removes the second factor of a person who has lost it, passkeys included.
         * @description Least role: ENGINEER.
         */
        delete: operations["resetSecondFactor"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users/{userName}/sessions": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        /**
         * Lists the sessions of a person, at the pages and at the OPC UA server.
         * @description Least role: ENGINEER.
         */
        get: operations["listUserSessions"];
        put?: never;
        post?: never;
        delete?: never;
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
    "/users/{userName}/sessions/{sessionId}": {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        get?: never;
        put?: never;
        post?: never;
        /**
         * Ends a session of a person.
         * @description Least role: ENGINEER.
         */
        delete: operations["endUserSession"];
        options?: never;
        head?: never;
        patch?: never;
        trace?: never;
    };
}
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        /**
         * @description Acceptance of an entry; in each case the page must not deliver it again.
         * @enum {string}
         */
        Acceptance: "TAKEN" | "REPEATED" | "REFUSED";
        /** @description Action that an operator entered. */
        Action: {
            /** @enum {string} */
            action: "START";
        } | {
            /** @enum {string} */
            action: "ADD";
            /** @description Good pieces without it. */
            piece?: components["schemas"]["Piece"];
            /**
             * Format: double
             * @description Number of pieces; 1 without it.
             */
            quantity?: number;
        } | {
            /** @enum {string} */
            action: "DONE";
        } | {
            /** @enum {string} */
            action: "PROBLEM";
            text: string;
        } | {
            /** @enum {string} */
            action: "VALUE";
            /** @description The field's request. */
            dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
            fieldName: components["schemas"]["FieldName"];
            /** @description Value in plain JSON; 64-bit integers may be texts. */
            value: components["schemas"]["PlainValue"];
        };
        /** @description Intervals that fit a family, by judgement, in milliseconds. */
        AdvisedIntervals: {
            /** Format: int32 */
            publishingIntervalMs: number;
            /** Format: int32 */
            samplingIntervalMs: number;
        };
        /**
         * @description Function over the values in a window.
         * @enum {string}
         */
        Aggregate: "minimum" | "maximum" | "mean" | "sum" | "count" | "last";
        /**
         * @description Function that aggregates a window's values.
         * @enum {string}
         */
        AggregateFunction: "LAST" | "MAXIMUM" | "MINIMUM" | "SUM" | "MEAN";
        /**
         * @description A group of partners of which the engineer assumes that they tell each other what they get. No
         *     partner is told of it.
         */
        Alliance: {
            /** @description True when its members are no longer assumed to tell each other. */
            isRetired?: boolean;
            /** @description The organisations, 2 to 100. */
            memberList: components["schemas"]["OrganisationId"][];
            /** @description Name for people, 1 to 120 characters. */
            name: string;
        };
        /** @description Leak budget of an alliance over all open fields of its members. */
        AllianceLeaks: components["schemas"]["LeakBudget"] & {
            alliance: components["schemas"]["Versioned_Alliance"];
        };
        /** @description The certificate that the OPC UA server shows its clients. */
        ApplicationCertificateView: {
            /** @description The application it is for. */
            applicationUri?: string | null;
            /** @description SHA-256 over the certificate in hexadecimal digits, for people to compare. */
            fingerprint: string;
            /** @description The names and addresses of the machine it is for. */
            hostNames: string[];
            /** @description The server made it and renews it. Otherwise an engineer has to ask the authority in time. */
            isSelfSigned: boolean;
            /** @description The distinguished name of who issued it. */
            issuer: string;
            /** @description Length of its RSA key in bits. */
            keyBits: number;
            /** @description End of its validity. */
            notAfter: components["schemas"]["DateTime"];
            /** @description Beginning of its validity. */
            notBefore: components["schemas"]["DateTime"];
            /** @description The subject's distinguished name. */
            subject: string;
            /** @description SHA-1 over the certificate in hexadecimal digits. */
            thumbprint: string;
        };
        /** @description Result of applying the rules. */
        Applied: {
            /** @description Number of fields that were decided. */
            decidedCount: number;
        };
        /** @description A concrete asset of a factory, as in its status data sets (OPC 10000-100 AssetId). */
        AssetId: string;
        /**
         * @description Numbers of rows and bytes in a spool, for the link's state and metrics. Parked rows are not
         *     counted.
         */
        Backlog: {
            /**
             * Format: int64
             * @description Bytes of waiting and sent rows.
             */
            bytes: number;
            /**
             * Format: date-time
             * @description Creation time of the oldest waiting or sent row.
             */
            oldestAt?: string | null;
            /**
             * Format: int64
             * @description Rows that are sent and wait for the receipt.
             */
            sent: number;
            /**
             * Format: int64
             * @description Rows that wait to be sent.
             */
            waiting: number;
        };
        /** @description One bit of an integer, as Boolean. */
        Bit: {
            /**
             * Format: int32
             * @description 0 is the lowest.
             */
            bit: number;
        };
        /** @description Text of one bit. */
        BitText: {
            /**
             * Format: int32
             * @description 0 is the lowest.
             */
            bit: number;
            /** @description Text that is yielded. */
            text: string;
        };
        /** @description The texts of all bits that are set, in their order. */
        BitTexts: {
            /** @description Texts of bits; bits without one are left out. */
            bits: components["schemas"]["BitText"][];
            /** @description The text when none of the bits is set. */
            none?: string;
            /** @description Separator between two texts. */
            separator?: string;
        };
        /**
         * @description Browse names from the Objects folder down to a node. In JSON a list of texts `nsu=<uri>;<name>`,
         *     those of namespace 0 bare.
         */
        BrowsePath: string[];
        /** @description A node as a person picks it in a tree. */
        BrowsedNode: {
            /** @description Its browse name, as an element of a browse path. */
            browseName: string;
            browsePath?: components["schemas"]["BrowsePath"] | null;
            builtInType?: components["schemas"]["BuiltInType"] | null;
            dataType?: components["schemas"]["NodeType"] | null;
            /** @description Description of the server, if it has one. */
            description?: string | null;
            /** @description Its name for people. */
            displayName: string;
            /** @description True when it has child nodes. */
            hasChildren: boolean;
            /** @description True when the signed-in user may write the value. */
            isWritable: boolean;
            nodeClass: components["schemas"]["NodeClass"];
            nodeId: components["schemas"]["NodeId"];
            /** @description The usual range of an analog variable, low and high. */
            range?: [
                number,
                number
            ] | null;
            typeDefinition?: components["schemas"]["NodeType"] | null;
            unit?: components["schemas"]["UnitName"] | null;
            /**
             * Format: int32
             * @description Rank of a variable: -1 scalar, 1 or more the number of dimensions, 0 one or more, -2 any, -3
             *     scalar or one.
             */
            valueRank?: number | null;
        };
        /**
         * @description An OPC UA built-in type by its name.
         * @enum {string}
         */
        BuiltInType: "Boolean" | "SByte" | "Byte" | "Int16" | "UInt16" | "Int32" | "UInt32" | "Int64" | "UInt64" | "Float" | "Double" | "String" | "DateTime" | "Guid" | "ByteString" | "XmlElement" | "NodeId" | "ExpandedNodeId" | "StatusCode" | "QualifiedName" | "LocalizedText" | "ExtensionObject" | "DataValue" | "Variant" | "DiagnosticInfo";
        /** @description Buttons with an effect on a field. The others only inform this plant. */
        Buttons: {
            addGood: boolean;
            addScrap: boolean;
            done: boolean;
            problem: boolean;
            start: boolean;
        };
        /** @description Limit of the information that a partner or an alliance gets per hour. */
        Cap: {
            /**
             * Format: double
             * @description Most bits per hour, 0 to 1e15. With 0 nothing is disclosed.
             */
            bitsPerHourMax: number;
            /** @description True when it no longer limits anything. */
            isRetired?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
            subject: components["schemas"]["CapSubject"];
            variable?: components["schemas"]["VariableKey"] | null;
        };
        /** @description A cap that a change would exceed. The text names the figures and the remedies. */
        CapExcess: {
            /**
             * Format: double
             * @description Limit of the cap, in bits per hour.
             */
            bitsPerHourMax: number;
            /**
             * Format: double
             * @description Bits per hour at present; none without a bound.
             */
            bitsPerHourNow?: number | null;
            /**
             * Format: double
             * @description Bits per hour with the change; none without a bound.
             */
            bitsPerHourThen?: number | null;
            cap: components["schemas"]["DocumentVersion"];
            /** @description Name of the cap. */
            name: string;
            variable?: components["schemas"]["VariableKey"] | null;
        };
        /** @description Partners whose information a cap limits. */
        CapSubject: {
            /** @description A partner, together with its allies: it learns what they tell it. */
            partner: components["schemas"]["OrganisationId"];
        } | {
            /** @description All members of an alliance together. */
            allianceId: components["schemas"]["DocumentId"];
        };
        /** @description A cap with the sum under it. */
        CapView: components["schemas"]["Versioned_Cap"] & {
            /**
             * Format: double
             * @description Most bits per hour that its partners get at present; none for a retired cap.
             */
            bitsPerHour?: number | null;
            /** @description Fields that wait since the cap ended their consents, sorted. */
            heldBack: components["schemas"]["FieldKey"][];
        };
        /** @description Request to an authority, besides application and host names. */
        CertificateRequestBody: {
            /** @description Common name of the subject; without it that of the present certificate. */
            commonName?: string | null;
            /** @description Organisation (`O`) of the subject. */
            organization?: string | null;
            /** @description True to make a new key, which is used from the installation on. */
            withNewKey?: boolean;
        };
        /** @description A request to be given to an authority. */
        CertificateRequestView: {
            /** @description PKCS #10, as PEM. */
            content: string;
        };
        /**
         * @description Aspects of a field or its request that differ.
         * @enum {string}
         */
        ChangeReason: "DESCRIPTION" | "REPORT_NAME" | "SLOWER_CADENCE" | "FASTER_CADENCE" | "SHORTER_VALIDITY" | "LONGER_VALIDITY" | "REQUESTER" | "RECIPIENTS" | "PURPOSE" | "BUFFER" | "TYPE" | "UNIT" | "VALUE_RANK" | "SEMANTIC";
        /**
         * @description Keys that were added, changed and removed. Added and changed ones are in the new order, removed
         *     ones in the old.
         */
        Changes_OperationId: {
            /** @description Elements only in the new revision. */
            added: string[];
            /** @description Elements in both, but not alike. */
            changed: string[];
            /** @description Elements only in the old revision. */
            removed: string[];
        };
        /**
         * @description Keys that were added, changed and removed. Added and changed ones are in the new order, removed
         *     ones in the old.
         */
        Changes_OperationRelationId: {
            /** @description Elements only in the new revision. */
            added: string[];
            /** @description Elements in both, but not alike. */
            changed: string[];
            /** @description Elements only in the old revision. */
            removed: string[];
        };
        /**
         * @description Keys that were added, changed and removed. Added and changed ones are in the new order, removed
         *     ones in the old.
         */
        Changes_RequestKey: {
            /** @description Elements only in the new revision. */
            added: {
                /** @description The request itself. */
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                /** @description The operation it asks about. */
                operationId: components["schemas"]["OperationId"];
                /** @description The network the request belongs to. */
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            }[];
            /** @description Elements in both, but not alike. */
            changed: {
                /** @description The request itself. */
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                /** @description The operation it asks about. */
                operationId: components["schemas"]["OperationId"];
                /** @description The network the request belongs to. */
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            }[];
            /** @description Elements only in the old revision. */
            removed: {
                /** @description The request itself. */
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                /** @description The operation it asks about. */
                operationId: components["schemas"]["OperationId"];
                /** @description The network the request belongs to. */
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            }[];
        };
        /** @description The head of one chain. */
        CheckpointHead: {
            /** @description Hash of its last entry, hexadecimal. */
            hash: string;
            /**
             * Format: int64
             * @description Number of its last entry.
             */
            number: number;
            /** @description Organisation of the chain. */
            recipient: components["schemas"]["OrganisationId"];
        };
        /**
         * @description A checkpoint. A copy of it elsewhere proves later whether the ledger still has the entries of that
         *     time.
         */
        CheckpointView: {
            /** @description Last entry of each chain at that time. */
            heads: components["schemas"]["CheckpointHead"][];
            /**
             * Format: int64
             * @description Number, from 1 without gaps.
             */
            number: number;
            /** @description The key it is verified with, hexadecimal. */
            publicKey: string;
            /** @description Time at which it was made. */
            recordedAt: components["schemas"]["DateTime"];
            /** @description The Ed25519 signature over that text, hexadecimal. */
            signature: string;
            /** @description Exact text that was signed: factory, number, time, and the last number and hash of each chain. */
            signedText: string;
        };
        /** @description The endpoint in use. */
        ChosenEndpoint: {
            /** @description The server's application URI. */
            applicationUri: string;
            endpointUrl: string;
            messageSecurity: components["schemas"]["MessageSecurity"];
            securityPolicy: components["schemas"]["SecurityPolicy"];
            /** @description Application name of the server. */
            serverName: string;
        };
        /** @description State of the circuit breakers of a mapping's scripts. */
        CircuitState: {
            /** @enum {string} */
            state: "closed";
        } | {
            /** @enum {string} */
            state: "resting";
            /** @description Time at which it is closed for one call, by the local clock. */
            until: components["schemas"]["DateTime"];
        } | {
            /** @enum {string} */
            state: "trying";
        };
        /** @description The certificate of an authority. */
        ClientAuthorityView: {
            /** @description SHA-256 over the certificate in hexadecimal digits, for people to compare. */
            fingerprint: string;
            /**
             * @description Clients with a certificate of it may connect; otherwise it only leads to one that is
             *     trusted.
             */
            isTrusted: boolean;
            /** @description The distinguished name of who issued it; the subject's where it did so itself. */
            issuer: string;
            nextUpdate?: components["schemas"]["DateTime"] | null;
            /** @description End of its validity. */
            notAfter: components["schemas"]["DateTime"];
            /** @description Beginning of its validity. */
            notBefore: components["schemas"]["DateTime"];
            /** @description State of its revocation list. Without a current one its clients are rejected. */
            revocationList: components["schemas"]["RevocationListState"];
            /** @description The subject's distinguished name. */
            subject: string;
            /** @description SHA-1 over the certificate in hexadecimal digits: its identity here. */
            thumbprint: string;
        };
        /** @description A certificate that the OPC UA server has seen or was given. */
        ClientCertificateView: {
            /** @description The application it was made for, as it says. */
            applicationUri?: string | null;
            /** @description Person who approved it; none for one that is trusted without an approval on record, or not trusted. */
            approvedBy?: string | null;
            /** @description SHA-256 over the certificate in hexadecimal digits, for people to compare. */
            fingerprint: string;
            /** @description End of its validity. */
            notAfter: components["schemas"]["DateTime"];
            /** @description Beginning of its validity. */
            notBefore: components["schemas"]["DateTime"];
            /** @description Address of the client then; none if the OPC UA server had opened the connection. */
            rejectedAddress?: string | null;
            /** @description Name that the application gave itself then, unproven. */
            rejectedApplicationName?: string | null;
            rejectedAt?: components["schemas"]["DateTime"] | null;
            rejectionReason?: components["schemas"]["ClientRejection"] | null;
            state: components["schemas"]["ClientTrust"];
            /** @description The subject's distinguished name. */
            subject: string;
            /** @description SHA-1 over the certificate in hexadecimal digits: its identity here. */
            thumbprint: string;
        };
        /**
         * @description Reason of a rejection.
         * @enum {string}
         */
        ClientRejection: "NOT_TRUSTED" | "OUT_OF_TIME" | "USAGE" | "KEY_LENGTH" | "UNREADABLE" | "REVOKED" | "REVOCATION_UNKNOWN" | "TRUST_LIST_UNREADABLE";
        /** @description An authority's list of revoked certificates. */
        ClientRevocationListView: {
            /** @description An authority that is known here signed it; otherwise it is of no use. */
            isSignedByKnownAuthority: boolean;
            /** @description The distinguished name of the authority. */
            issuer: string;
            nextUpdate?: components["schemas"]["DateTime"] | null;
            /** @description Identity of the list in paths of this API. */
            revocationListId: string;
            /** @description Number of certificates that it revokes. */
            revokedCount: number;
            /** @description Time of issue. */
            thisUpdate: components["schemas"]["DateTime"];
        };
        /**
         * @description Trust in a client's certificate.
         * @enum {string}
         */
        ClientTrust: "TRUSTED" | "REJECTED" | "DENIED";
        /** @description Approval of a client's certificate. */
        ClientTrustBody: {
            /** @description True: its bearer may connect from now on, with this person's approval. False: it is rejected, and its open sessions end. */
            isTrusted: boolean;
        };
        /**
         * @description A time of day, `HH:MM`, up to and including `24:00`.
         * @example 06:00
         */
        ClockTime: string;
        /** @description Input of which single changes may not arrive: the newest value does. */
        CoarseInput: {
            input: components["schemas"]["InputKey"];
            nodeId: components["schemas"]["NodeId"];
            /**
             * Format: int64
             * @description Number of times in this session that the server said that its queue overflowed.
             */
            overflows: number;
            /**
             * Format: int32
             * @description Number of changes that the server's queue holds between two messages; absent where it suffices.
             */
            queueSize?: number | null;
            /**
             * Format: double
             * @description Time between two samples that the server granted, in milliseconds; absent where its queue suffices.
             */
            samplingMs?: number | null;
        };
        /** @description A collaboration on the platform, under whose agreement networks are exchanged. */
        CollaborationId: string;
        /**
         * @description Conclusion from fields that are disclosed together.
         * @enum {string}
         */
        Conclusion: "CYCLE_TIME" | "UTILISATION" | "ORDER_QUANTITY" | "YIELD";
        /** @description A condition of a relation, unique within its network. */
        ConditionId: string;
        /**
         * @description The kinds of condition.
         * @enum {string}
         */
        ConditionKind: "START_NO_EARLIER_THAN" | "START_NO_LATER_THAN" | "FINISH_NO_EARLIER_THAN" | "FINISH_NO_LATER_THAN" | "MINIMUM_GAP" | "MAXIMUM_GAP";
        /**
         * @description Kind of a conflict between a log and its witness.
         * @enum {string}
         */
        ConflictKind: "ROLLED_BACK" | "REPLACED" | "OTHER_KEY" | "SUPERSEDED" | "UNPROVABLE";
        /**
         * @description Effect of a difference on the engineer's consent.
         * @enum {string}
         */
        ConsentEffect: "KEPT" | "BACK_TO_PENDING" | "REMOVED";
        /** @description Disclosure that the consent for a field begins with. */
        ConsentOffer: components["schemas"]["Statement"] & {
            /**
             * @description Coarsening to begin with: that of the standing rules, and a minimum interval as long as the
             *     requested period.
             */
            disclosure: components["schemas"]["DisclosurePolicy"];
            /**
             * Format: double
             * @description Values per hour that "every change" would add to that, as far as it was measured.
             */
            everyChangeAddsPerHour?: number | null;
            measured?: components["schemas"]["Measured"] | null;
            /**
             * Format: int64
             * @description The period that the partner asked for, in milliseconds.
             */
            requestedIntervalMs?: number | null;
            /** @description The rules behind it. */
            rules: components["schemas"]["RuleReference"][];
            /**
             * Format: double
             * @description Values per hour at that period.
             */
            valuesPerHour?: number | null;
        };
        /** @description Decision about a field. */
        ConsentView: components["schemas"]["FieldKey"] & {
            /** @description Name of the person or rule that decided. */
            decidedBy?: string | null;
            grounds?: components["schemas"]["DecisionBasis"] | null;
            mappingState: components["schemas"]["MappingState"];
            /** @description Coarsening of values as decided. */
            policy: components["schemas"]["DisclosurePolicy"];
            valueSource?: components["schemas"]["ValueSource"] | null;
            /**
             * Format: int32
             * @description Number of the consent of the field, from 1.
             */
            version: number;
        };
        /** @description Yields the same value whatever comes in; with no input before it, once. */
        Constant: {
            /** @description Value that the step yields. */
            value: components["schemas"]["Literal"];
        };
        /**
         * @description Converts to another built-in type: numbers, Boolean, String, DateTime and Guid among each other
         *     where it makes sense. Text that is no number is a fault, never zero.
         */
        Convert: {
            /** @description Treatment of a number outside the wanted type's range. */
            overflow?: components["schemas"]["Overflow"];
            /** @description Rounding of a fraction to an integer. */
            rounding?: components["schemas"]["Rounding"];
            /** @description The wanted type. */
            to: components["schemas"]["TypeName"];
        };
        /** @description The sum of a counter's increments, across wraps, resets and restarts of machine and connector. */
        Counter: {
            counts?: components["schemas"]["CounterInput"] | null;
            modulus?: components["schemas"]["Number"] | null;
            /** @description Treatment of a decrease as in `increment`. */
            onDecrease?: components["schemas"]["OnDecrease"];
            /** @description An input that sets the sum back to `start` when it becomes true (or not zero). */
            resetBy?: string | null;
            /** @description Sum before the first value. */
            start?: components["schemas"]["Number"];
        };
        /**
         * @description Kind of counting of a `counter`.
         * @enum {string}
         */
        CounterInput: "increments" | "risingEdges" | "values";
        /**
         * Format: date-time
         * @description An instant in UTC with a resolution of 100 ns. On the wire an RFC 3339 text.
         */
        DateTime: string;
        /** @description A message that was received or sent and rejected. */
        DeadLetter: {
            at: components["schemas"]["DateTime"];
            /**
             * Format: int64
             * @description Size of the body, in bytes.
             */
            bytes: number;
            /** @description Cause of the rejection, as a code. */
            code: string;
            /** @description `RECEIVED` or `SENT`. */
            direction: string;
            /** @description Number of the dead letter, as text. */
            id: string;
            /** @description Id of the message; none for one that could not be read. */
            messageId?: string | null;
            /** @description Cause of the rejection, in words. */
            reason: string;
            /** @description Type of the message, as far as it is known. */
            subject: string;
        };
        /**
         * @description Holds changes back that are too small. Without parameters only repeats of the same value are
         *     held back; values that are no numbers pass when they differ. A change of the status always
         *     passes.
         */
        Deadband: {
            absolute?: components["schemas"]["Number"] | null;
            /**
             * Format: double
             * @description The change must be greater than this share of the last value that passed, in percent.
             */
            percent?: number | null;
        };
        /** @description Lets a value pass once it has not changed for a while. */
        Debounce: {
            /**
             * Format: int64
             * @description Time that it must stay the same, in milliseconds.
             */
            quietMs: number;
        };
        /** @description A decision about the past that was stored. */
        DecidedPast: {
            /** @description True where reports of the past are shown to the recipient. */
            isReleased: boolean;
            /**
             * Format: int64
             * @description Number of reports that are shown.
             */
            reportCount: number;
        };
        /**
         * @description Named policies, standing rules and caps that a decision is based on, beside the engineer's own
         *     policy.
         */
        DecisionBasis: {
            /**
             * @description The caps that hold the field back, in their versions at that time.
             * @default []
             */
            caps?: components["schemas"]["DocumentVersion"][];
            /**
             * @description The named policies that contributed to the precision, in their versions at that time; in
             *     consents only.
             * @default []
             */
            policies?: components["schemas"]["DocumentVersion"][];
            /** @default null */
            policyId?: components["schemas"]["DocumentId"] | null;
            /**
             * @description Salted hash of the preview that the engineer decided on, hexadecimal; in consents only.
             * @default null
             */
            preview?: string | null;
            /**
             * @description The rules that decided, each in its version at that time.
             * @default []
             */
            rules?: components["schemas"]["DocumentVersion"][];
        };
        /** @description A decision about a field. */
        DecisionBody: {
            disclosure?: components["schemas"]["DisclosurePolicy"] | null;
            mapping?: components["schemas"]["MappingDraft"] | null;
            /** @description `PENDING`, `MAPPED` or `REFUSED`. */
            mappingState: components["schemas"]["MappingState"];
            policyId?: components["schemas"]["DocumentId"] | null;
            /** @description The preview of this draft that the engineer saw; the ledger has a salted hash of it. */
            previewId?: string | null;
            /** @description Reason that the partner reads; needed with `REFUSED`. */
            reason?: string | null;
            valueSource?: components["schemas"]["ValueSource"] | null;
        };
        /** @description Number of decisions in one transaction. */
        DecisionCounts: {
            /** @description All decisions, those of standing rules included. */
            count: number;
            /** @description Decisions of standing rules among them. */
            ruleCount: number;
        };
        /**
         * @description Stable codes of diagnostics.
         * @enum {string}
         */
        DiagnosticCode: "tooMany" | "missing" | "invalidName" | "unknownName" | "invalidParameter" | "typeMismatch" | "lossyConversion" | "unknownUnit" | "incompatibleUnits" | "unitMismatch" | "syntax" | "workerUnavailable" | "scriptFault" | "closureState" | "unusedInput";
        /** @description Difference between two versions. */
        Difference: {
            /** @description The later mapping. */
            after: components["schemas"]["Mapping"];
            /** @description The earlier mapping. */
            before: components["schemas"]["Mapping"];
            /** @description Changes from the earlier to the later mapping. */
            changes: components["schemas"]["MappingChange"][];
        };
        /**
         * @description Coarsening of a field's values before they are released. Empty: every change is released
         *     unchanged.
         *
         *     In this order: values in a withheld state are dropped, each window is aggregated, the number is
         *     banded or rounded and then cut to its significant digits, and the status code is coarsened; the
         *     result waits for its delay, the intervals and rates, the time step and the working hours.
         */
        DisclosurePolicy: {
            /** @default null */
            aggregate?: components["schemas"]["WindowAggregate"] | null;
            /**
             * @description Numbers are replaced by the greatest of these bounds not above them (by the lowest, if below
             *     all); ascending.
             * @default []
             */
            bands?: number[];
            /**
             * Format: int64
             * @description Delay of every value, in milliseconds.
             * @default null
             */
            delayMs?: number | null;
            /**
             * @description Values are released only within all of these hours, too.
             * @default []
             */
            furtherHours?: components["schemas"]["WorkingHours"][];
            /**
             * Format: int64
             * @description Shortest time between two released values, in milliseconds; the latest value wins.
             * @default null
             */
            minimumIntervalMs?: number | null;
            /**
             * @description Most released values per period; all of these limits apply.
             * @default []
             */
            rateLimits?: components["schemas"]["RateLimit"][];
            /** @default null */
            roundingStep?: components["schemas"]["RoundingStep"] | null;
            /**
             * Format: int32
             * @description Most significant digits of numbers, 1 to 15.
             * @default null
             */
            significantDigits?: number | null;
            /**
             * @description Resolution of status codes; a small fixed set when absent.
             * @default COMMON
             */
            statusCodes?: components["schemas"]["StatusCodes"];
            /**
             * Format: int64
             * @description Times are rounded down to multiples of this many milliseconds since 1970, and values are
             *     released only at these times.
             * @default null
             */
            timeStepMs?: number | null;
            /**
             * @description No value is released while one of these conditions is met; candidates of that time never are.
             * @default []
             */
            withholdWhile?: components["schemas"]["WithholdCondition"][];
            /** @default null */
            workingHours?: components["schemas"]["WorkingHours"] | null;
        };
        /** @description Address to ask. */
        DiscoveryBody: {
            /** @description The server's address, `opc.tcp://host:port/path`. */
            endpointUrl: string;
        };
        /** @description The id of a policy or rule, chosen by its author. */
        DocumentId: string;
        /** @description One version of a policy or rule. */
        DocumentVersion: {
            id: components["schemas"]["DocumentId"];
            /**
             * Format: int32
             * @description Number from 1, which increases by one with every change.
             */
            version: number;
        };
        /** @description Draft of a decision. */
        Draft: {
            /** @description Coarsening of the values. */
            disclosure?: components["schemas"]["DisclosurePolicy"];
            mapping?: components["schemas"]["MappingDraft"] | null;
            policyId?: components["schemas"]["DocumentId"] | null;
            /** @description `MAPPING`, `MANUAL` or `EXTERNAL`. */
            valueSource: components["schemas"]["ValueSource"];
        };
        /** @description Result of a dry run. */
        DryRun: components["schemas"]["Trace"] & {
            from?: components["schemas"]["DateTime"] | null;
            /** @description Number of all runs. */
            runsTotal: number;
            to?: components["schemas"]["DateTime"] | null;
            /**
             * @description Inputs without recorded values: only variables that a published or shadow mapping uses are
             *     recorded.
             */
            unrecorded: string[];
            /** @description Number of values that went in. */
            values: number;
        };
        /** @description A dry run to make. */
        DryRunBody: {
            /** @description Most runs in the answer, the last ones, up to 2000; 200 without it. */
            limit?: number | null;
            mapping: components["schemas"]["MappingDraft"];
            /** @description `LIVE` (the default) or `HISTORY`. */
            on?: components["schemas"]["DryRunValues"];
        };
        /**
         * @description Values that a dry run is made on.
         * @enum {string}
         */
        DryRunValues: "LIVE" | "HISTORY";
        /** @description A partner's request for data about an operation. One request is one DataSetWriter. */
        DynamicDataRequest: {
            /** @description The buffer or store the request is about. */
            bufferId?: string | null;
            /** @description More about the request. */
            description?: string | null;
            /** @description Unique within the network. */
            dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
            dynamicDataRequestPublisherId?: components["schemas"]["ToolId"] | null;
            /** @description Purpose of the data in words, for the factory's engineer. */
            purpose: string;
            /** @description The organisations that may see the answers, and no others. */
            recipientList: components["schemas"]["OrganisationId"][];
            /** @description The composition of the report. */
            reportDataFormat: components["schemas"]["ReportDataFormat"];
            /** @description The organisation that asks. */
            requesterId: components["schemas"]["OrganisationId"];
            /**
             * Format: int32
             * @description Number of reports wanted per [`Self::update_frequency_unit`].
             */
            updateFrequency?: number | null;
            updateFrequencyUnit?: components["schemas"]["UpdateFrequencyUnit"] | null;
            validFrom?: components["schemas"]["DateTime"] | null;
            validUntil?: components["schemas"]["DateTime"] | null;
        };
        /** @description A dynamic data request, unique within its network. One request is one DataSetWriter. */
        DynamicDataRequestId: string;
        /** @description Lets a Boolean (or a number: not zero is true) pass only when it changes. */
        Edge: {
            /** @description Change that passes. */
            direction: components["schemas"]["EdgeDirection"];
        };
        /**
         * @description A change of a Boolean.
         * @enum {string}
         */
        EdgeDirection: "rising" | "falling" | "both";
        /** @description Effect of one part of a policy. */
        Effect: {
            /** @description True when it changes this value or its times, or withholds it at present. */
            isFelt: boolean;
            kind: components["schemas"]["EffectKind"];
            /** @description The same as codes with parameters. */
            parts: components["schemas"]["StatementPart"][];
            /** @description Sentence in English. */
            text: string;
        };
        /**
         * @description A part of a policy.
         * @enum {string}
         */
        EffectKind: "WITHHELD" | "AGGREGATED" | "BANDED" | "ROUNDED" | "DIGITS" | "STATUS_CODES" | "TIME_STEP" | "DELAYED" | "INTERVAL" | "RATE" | "HOURS";
        /** @description A value in the OPC UA JSON encoding (OPC 10000-6 §5.4) of the message that carried it: plain, a Variant, or a DataValue. */
        EncodedValue: unknown;
        /** @description An endpoint that a server offers. */
        EndpointOffer: {
            /** @description Accepts anonymous users. */
            allowsAnonymous: boolean;
            /** @description Accepts user certificates. */
            allowsCertificate: boolean;
            /** @description Accepts user name and password. */
            allowsUserName: boolean;
            /** @description The server's application URI. */
            applicationUri: string;
            /** @description SHA-256 fingerprint of the server's certificate, hex. */
            certificateFingerprint?: string | null;
            choice?: components["schemas"]["SecurityChoice"] | null;
            /** @description Address of the server as the server returns it. */
            endpointUrl: string;
            messageSecurity: components["schemas"]["MessageSecurity"];
            /** @description Name of the policy, also of one that the client does not use. */
            securityPolicy: string;
            serverName: string;
            /** @description Address that is used instead: with the host and port that were asked. */
            usedUrl: string;
        };
        /** @description Outcome of an entered value. */
        Entered: {
            /** @description Less than was entered is disclosed. */
            isCoarsened: boolean;
            /**
             * @description `DISCLOSED`, `UNCHANGED`, `WITHHELD` (it leaves later) or `SUPPRESSED` (the policy withholds
             *     the present state: it never leaves).
             */
            outcome: string;
            until?: components["schemas"]["DateTime"] | null;
        };
        /** @description A value that a person enters. */
        EnteredValue: {
            /** @description The value as plain JSON; 64-bit integers may be texts. */
            value: components["schemas"]["PlainValue"];
        };
        /** @description Entries that a page has collected. */
        EntryDelivery: {
            /** @description Up to 500, in any order. */
            entries: components["schemas"]["NewEntry"][];
            sentAt?: components["schemas"]["DateTime"] | null;
        };
        /** @description An entry's id, made where it was entered: 1 to 64 letters, digits, `-` or `_`. */
        EntryId: string;
        /** @description Answer to one delivered entry: taken, known, or refused with the reason. */
        EntryResult: {
            /** @description Code of the reason for `REFUSED`. */
            code?: string | null;
            entryId: string;
            /** @description Fields that got a value from it. */
            fields: components["schemas"]["FieldResult"][];
            /** @description Reason for `REFUSED` in words, and what to do. */
            message?: string | null;
            result: components["schemas"]["Acceptance"];
        };
        /** @description An entry of a chain. */
        EntryView: components["schemas"]["EventView"] & {
            /** @description Time of recording, RFC 3339. */
            at: string;
            /**
             * Format: date-time
             * @description Time of the platform's receipt for a report.
             */
            deliveredAt?: string | null;
            /** @description Hash of the entry, hexadecimal. */
            hash: string;
            /** @description Id of the message that carried a report last. */
            leftInMessage?: string | null;
            /**
             * @description Precision under each consent that the entry names, by field, in the words of the statement to
             *     the partner.
             */
            precision: {
                [key: string]: string;
            };
            /** @description The same as codes with parameters. */
            precisionParts: {
                [key: string]: components["schemas"]["StatementPart"][];
            };
            /** @description Recipient of the chain. */
            recipientId: string;
            /**
             * Format: date-time
             * @description Time at which the broker accepted a report last.
             */
            sentAt?: string | null;
            /**
             * Format: int64
             * @description Position in the chain, from 1.
             */
            sequence: number;
            /** @description Values of a report that left, by field, while they are retained. */
            value?: {
                [key: string]: components["schemas"]["EncodedValue"];
            } | null;
        };
        /** @description Conversion of the numbers of an enumeration to texts. */
        Enumeration: {
            /** @description The text for any other number; the number itself in digits where absent. */
            otherwise?: string | null;
            /** @description Number to text. */
            texts: components["schemas"]["EnumerationText"][];
        };
        /** @description The text of one number of an enumeration. */
        EnumerationText: {
            /** @description Text that is yielded. */
            text: string;
            /**
             * Format: int64
             * @description Number of the enumeration.
             */
            value: number;
        };
        /** @description Equipment that an operation needs. */
        EquipmentRequirement: {
            assetId?: components["schemas"]["AssetId"] | null;
            /** @description IRI of a capability the equipment must have. */
            capability?: string | null;
            /** @description Unique within the network. */
            equipmentRequirementId: components["schemas"]["EquipmentRequirementId"];
            /** @description The class of equipment, as `ROBOT`. */
            equipmentType: string;
            /**
             * Format: double
             * @description Number of pieces of equipment, not negative.
             */
            quantity?: number | null;
        };
        /** @description An equipment requirement, unique within its network. */
        EquipmentRequirementId: string;
        /** @description Event that an entry records. */
        EventView: (components["schemas"]["ConsentView"] & {
            /** @enum {string} */
            kind: "CONSENT";
        }) | (components["schemas"]["QueuedView"] & {
            /** @enum {string} */
            kind: "QUEUED";
        }) | (components["schemas"]["SentView"] & {
            /** @enum {string} */
            kind: "SENT";
        }) | (components["schemas"]["SequenceRange"] & {
            /** @enum {string} */
            kind: "RECEIPTED";
        }) | (components["schemas"]["SequenceRange"] & {
            /** @enum {string} */
            kind: "COALESCED";
        }) | (components["schemas"]["SequenceRange"] & {
            /** @enum {string} */
            kind: "EXPIRED";
        }) | (components["schemas"]["SequenceRange"] & {
            /** @enum {string} */
            kind: "PURGED";
        }) | (components["schemas"]["RevokedView"] & {
            /** @enum {string} */
            kind: "REVOKED";
        }) | (components["schemas"]["RetentionStatement"] & {
            /** @enum {string} */
            kind: "RETENTION";
        }) | (components["schemas"]["PastReleasedView"] & {
            /** @enum {string} */
            kind: "PAST_RELEASED";
        }) | {
            /** @enum {string} */
            kind: "UNREADABLE";
        };
        /**
         * @description Kinds of evidence, the strongest first.
         * @enum {string}
         */
        EvidenceKind: "manual" | "source" | "issue" | "project" | "general";
        /**
         * @description An arithmetic expression over `value` and the inputs by name.
         *
         *     Numbers, texts in quotes, `true` and `false`; `+ - * / // %`, comparisons, `&& || !`, `c ? a :
         *     b`; `min max abs round floor ceil trunc sqrt pow exp ln log10 clamp mod bit length upper lower
         *     trim text number`. `//` divides towards minus infinity; `/` of two integers is an integer where
         *     it comes out even. `+` joins texts.
         */
        Expression: {
            /** @description Text of the expression. */
            expression: string;
        };
        /** @description A factory: one connector, one PublisherId, one pair of addresses on the broker. */
        FactoryId: string;
        /**
         * @description Kinds of faults.
         * @enum {string}
         */
        FaultKind: "typeMismatch" | "outOfRange" | "decoding" | "scriptSyntax" | "scriptError" | "scriptTimeout" | "scriptOutOfMemory" | "scriptResult" | "scriptCrash" | "workerUnavailable" | "circuitOpen";
        /** @description A fault with its place and time, as shown to the engineer. */
        FaultRecord: {
            /** @description Time of the fault by the local clock. */
            at: components["schemas"]["DateTime"];
            /**
             * Format: int32
             * @description The column in the script, from 1.
             */
            column?: number | null;
            /** @description Kind, for programs. */
            kind: components["schemas"]["FaultKind"];
            /**
             * Format: int32
             * @description The line in the script, from 1.
             */
            line?: number | null;
            /** @description Sentence that names the fault, without the value. */
            message: string;
            /** @description Index of the function in the chain; absent for the end of the chain. */
            step?: number | null;
        };
        /**
         * @description Kind of a field's difference.
         * @enum {string}
         */
        FieldChange: "ADDED" | "CHANGED" | "REMOVED";
        /** @description State of a field after a change. The members of the key are there twice, flat and as `key`. */
        FieldChangeView: components["schemas"]["FieldKey"] & {
            /**
             * Format: int32
             * @description Number of the consent in force.
             */
            consentVersion: number;
            /** @description True while no value leaves; for operators and engineers only. */
            isWithheld?: boolean | null;
            key: components["schemas"]["FieldKey"];
            mappingState: components["schemas"]["MappingState"];
            value?: components["schemas"]["ShownValue"] | null;
        };
        /** @description Difference of one field, with its effects. */
        FieldDifference: {
            change: components["schemas"]["FieldChange"];
            consent: components["schemas"]["ConsentEffect"];
            key: components["schemas"]["FieldKey"];
            mapping: components["schemas"]["MappingEffect"];
            /** @description Reasons for the engineer to read; empty where the field is new or removed. */
            reasons: components["schemas"]["ChangeReason"][];
        };
        /** @description One report field, addressed from the network down. */
        FieldKey: components["schemas"]["RequestKey"] & {
            /** @description The field's name within that report. */
            fieldName: components["schemas"]["FieldName"];
        };
        /** @description Information in one field. */
        FieldLeak: components["schemas"]["Statement"] & {
            /**
             * Format: double
             * @description Most information per hour, in bits: values, statuses, source times and the times of releases;
             *     none without a limit.
             */
            bitsPerHourMax?: number | null;
            /**
             * Format: double
             * @description Most information of one value with its status and source time, in bits; none for texts and
             *     other values without a bound.
             */
            bitsPerValue?: number | null;
            key: components["schemas"]["FieldKey"];
            measured: components["schemas"]["MeasuredRelease"];
            /**
             * Format: int64
             * @description Resolution of the times of changes, in milliseconds; 0 when every change is released at once.
             */
            timeResolutionMs: number;
            /**
             * Format: double
             * @description Most values per hour; none when only the publishing interval limits them.
             */
            valuesPerHourMax?: number | null;
        };
        /** @description The name of a report field: a key of the payload. */
        FieldName: string;
        /** @description Result of an entry for one field. */
        FieldResult: components["schemas"]["Entered"] & {
            key: components["schemas"]["FieldKey"];
        };
        /** @description A field that a cap would hold back. */
        FieldToHoldBack: {
            /** @description The caps beside which it does not fit, with their figures. */
            excesses: components["schemas"]["CapExcess"][];
            key: components["schemas"]["FieldKey"];
        };
        /** @description An OPC UA built-in type: its id (1 to 25) or its name. */
        FieldType: number | ("Boolean" | "SByte" | "Byte" | "Int16" | "UInt16" | "Int32" | "UInt32" | "Int64" | "UInt64" | "Float" | "Double" | "String" | "DateTime" | "Guid" | "ByteString" | "XmlElement" | "NodeId" | "ExpandedNodeId" | "StatusCode" | "QualifiedName" | "LocalizedText" | "ExtensionObject" | "DataValue" | "Variant" | "DiagnosticInfo");
        /** @description A requested field with its decision and value. */
        FieldView: {
            /** @description Name of the person or rule that decided. */
            decidedBy?: string | null;
            decisionReason?: string | null;
            decisionTime?: components["schemas"]["DateTime"] | null;
            description?: string | null;
            /** @description Coarsening of values as decided. */
            disclosure: components["schemas"]["DisclosurePolicy"];
            /** @description Coarsening in effect as codes with parameters; none while pending. */
            disclosureParts: components["schemas"]["StatementPart"][];
            /** @description Coarsening in effect in words, as in the statement to the partner. */
            disclosureStatement?: string | null;
            /**
             * @description Coarsening in effect: the strictest of that, of the named policy and of the recipients'
             *     policies.
             */
            effectiveDisclosure: components["schemas"]["DisclosurePolicy"];
            /** @description Named policy and rules that the decision is based on. */
            grounds: components["schemas"]["DecisionBasis"];
            /** @description True while a shadow mapping runs beside the published one. */
            hasShadow: boolean;
            /**
             * @description True while no value leaves: the policy withholds the present state, or an unknown one. For
             *     operators and engineers only, since it says which state it is.
             */
            isWithheld?: boolean | null;
            key: components["schemas"]["FieldKey"];
            mapping?: components["schemas"]["Mapping"] | null;
            /** @description `PENDING`, `MAPPED` or `REFUSED`. */
            mappingState: components["schemas"]["MappingState"];
            /**
             * Format: int32
             * @description Number of the newest version of the mapping; none before the first.
             */
            mappingVersion?: number | null;
            name: string;
            offer?: components["schemas"]["RuleOfferView"] | null;
            /** @description Meaning: a well-known name or an IRI. */
            semantic?: string | null;
            /** @description Tag of what a decision rests on: differs after each decision and each change of the request. */
            shownTag?: string | null;
            /** @description Name of the built-in type. */
            type: string;
            /** @description Unit in the words of the request. */
            unit?: string | null;
            value?: components["schemas"]["ShownValue"] | null;
            /**
             * Format: int32
             * @description -1 scalar, 1 array.
             */
            valueRank: number;
            valueSource?: components["schemas"]["ValueSource"] | null;
        };
        /**
         * @description Puts values into a text: `Order {value}: {temperature:.1} of {limit}`.
         *
         *     `{value}` is the chain's value, `{name}` an input. After a colon: an optional `0` and width
         *     (`{value:06}`), an optional number of decimals (`{value:.2}`). `{{` and `}}` are braces.
         */
        Format: {
            /** @description The text with its placeholders. */
            template: string;
        };
        /** @description Variables that were found. */
        FoundVariables: {
            /**
             * @description False while the server's variables are still being listed (ask again), or if there are too
             *     many.
             */
            isComplete: boolean;
            /** @description Variables with their browse paths, those whose own name fits first. */
            items: components["schemas"]["BrowsedNode"][];
            listedAt?: components["schemas"]["DateTime"] | null;
            /** @description Number of all variables that fit. */
            total: number;
        };
        /**
         * @description Reason for sequence numbers that will never come.
         * @enum {string}
         */
        GapCause: "COALESCED" | "EXPIRED" | "WITHDRAWN" | "REVOKED";
        /**
         * @description Intervals that a server granted (OPC 10000-4 §5.14.2.2), in milliseconds. What it grants rules, whatever
         *     was requested.
         */
        GrantedIntervals: {
            /**
             * Format: int64
             * @description Time between two signs of life while nothing changes.
             */
            keepAliveMs: number;
            /**
             * Format: int64
             * @description Time between two messages with changes; a change arrives this much later at most.
             */
            publishingMs: number;
            /**
             * Format: int64
             * @description Silence after which the connection is given up.
             */
            silenceMsMax: number;
        };
        /** @description Number of mappings by health. */
        HealthCounts: {
            /** @description Number of mappings that are `CLOCK_AHEAD`. */
            clockAhead: number;
            /** @description Number of mappings that are `DOUBTFUL`. */
            doubtful: number;
            /** @description Number of mappings that are `FAILING`. */
            failing: number;
            /** @description Number of mappings that are `RESTING`. */
            resting: number;
            /** @description Number of mappings that are `WAITING`. */
            waiting: number;
            /** @description Number of mappings that are `WELL`. */
            well: number;
        };
        /** @description Sign-in of the client on a server. */
        Identity: {
            /** @enum {string} */
            kind: "anonymous";
        } | {
            /** @enum {string} */
            kind: "userName";
            password?: components["schemas"]["Password"];
            userName: string;
        } | {
            /** @description The certificate, DER or PEM. */
            certificatePath: string;
            /** @enum {string} */
            kind: "certificate";
            /** @description Its private key, PEM. */
            privateKeyPath: string;
        };
        /**
         * @description Effect of importing a mapping.
         * @enum {string}
         */
        ImportEffect: "PUBLISHED" | "PROPOSED" | "UNCHANGED";
        /** @description Outcome of an import, or of its dry run. */
        ImportOutcome: {
            /** @description True if nothing was changed. */
            isDryRun: boolean;
            /** @description Each mapping that was not there already, in the order of the file. */
            items: components["schemas"]["ImportedMapping"][];
            /** @description Mappings that are offered with the decision about their field, which is not mapped. */
            proposed: number;
            /** @description Mappings that are the next version of their field and run, under the consent in force. */
            published: number;
            /** @description Templates that are new or changed. */
            templates: number;
            /** @description Mappings that were there already. */
            unchanged: number;
        };
        /** @description A mapping that an import changes. */
        ImportedMapping: {
            key: components["schemas"]["FieldKey"];
            /** @description Effect on the field. */
            outcome: components["schemas"]["ImportEffect"];
        };
        /** @description A page of the inbox, and totals. */
        InboxPage: {
            /** @description Number of requests that pass the filter. */
            count: number;
            /** @description Requests in the order of their addresses. */
            items: components["schemas"]["RequestView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
            /** @description Totals over all requests and fields, without the filter. */
            totals: components["schemas"]["InboxTotals"];
        };
        /** @description Numbers of requests and fields of all active networks, by state. */
        InboxTotals: {
            /** @description Requests whose validity has ended. */
            endedRequests: number;
            mapped: number;
            /** @description Requests with an undecided field. */
            openRequests: number;
            /** @description Number of these that are open for longer than the time after which the inbox reminds. */
            overdueRequests: number;
            pending: number;
            refused: number;
            requests: number;
        };
        /** @description Increment of a counter since its last value. The first value yields nothing. */
        Increment: {
            modulus?: components["schemas"]["Number"] | null;
            /** @description Meaning of a decrease that is no wrap. */
            onDecrease?: components["schemas"]["OnDecrease"];
        };
        /**
         * Format: int64
         * @description A caller's own key of one input. The same variable may be monitored under several keys.
         */
        InputKey: number;
        /** @description Reason why an input has no value. */
        InputProblem: {
            input: components["schemas"]["InputKey"];
            nodeId: components["schemas"]["NodeId"];
            reason: string;
            /** @description Status of the server, or of the connector when the server gave none. */
            status: components["schemas"]["StatusCode"];
        };
        /** @description Last value of an input. */
        InputStatus: {
            /**
             * Format: int64
             * @description Difference of the source's clock to ours, in milliseconds, transport included; positive
             *     where the source is ahead.
             */
            clockAheadMs?: number | null;
            /** @description Name of the input in the mapping. */
            name: string;
            receivedAt?: components["schemas"]["DateTime"] | null;
            value?: components["schemas"]["TracedValue"] | null;
        };
        /** @description A variable with its present value. */
        InputView: components["schemas"]["ShownValue"] & {
            /** @description Its name in the mapping. */
            name: string;
        };
        /** @description A running connector: a new id at every start. */
        InstanceId: string;
        /**
         * Format: duration
         * @description An ISO 8601 duration of fixed length: weeks, days, hours, minutes, seconds (`PT8H`, `P1DT30M`).
         *     Years and months have no fixed length and are refused. Digits beyond the microsecond are dropped
         *     on reading: as OPC UA's Duration, a Double of milliseconds, a hundred years stay exact to that.
         */
        IsoDuration: string;
        /** @description The certificate that an authority made of the request. */
        IssuedCertificateBody: {
            /**
             * @description PEM: the certificate, and those of its authorities up to the root unless the trust list has
             *     them, in any order. Or the certificate alone as DER in base64.
             */
            content: string;
        };
        /**
         * @description Extent to which the kernel enforces the rules of Landlock.
         * @enum {string}
         */
        LandlockState: "none" | "partial" | "full";
        /**
         * @description Treatment of a value whose source time lies before that of the newest value of the same
         *     variable.
         *
         *     A value is late by at most ten seconds. A longer step back is a source whose clock was set back,
         *     and the value is used.
         * @enum {string}
         */
        LateValues: "ignore" | "use";
        /** @description Information that a partner gets in total. */
        LeakBudget: {
            /**
             * Format: double
             * @description Most bits per hour in values, statuses and times; none when a field has no limit.
             */
            bitsPerHourMax?: number | null;
            fields: components["schemas"]["FieldLeak"][];
            /**
             * Format: double
             * @description Most values per hour; none when a field has no limit.
             */
            valuesPerHourMax?: number | null;
            /**
             * Format: double
             * @description Values per hour as measured.
             */
            valuesPerHourMeasured: number;
            /** @description The same by variable: the sum over all fields that rest on it. */
            variables: components["schemas"]["VariableLeak"][];
            warnings: components["schemas"]["LeakWarning"][];
        };
        /** @description Information that a partner gets in total, as a summary. */
        LeakSummary: {
            /**
             * Format: double
             * @description Most bits per hour in values, statuses and times; none when a field has no limit.
             */
            bitsPerHourMax?: number | null;
            /**
             * Format: double
             * @description Most information of one value of any field, in bits; none when a field has no bound.
             */
            bitsPerValueMax?: number | null;
            /** @description Possible conclusions, each once. */
            conclusions: components["schemas"]["Conclusion"][];
            fieldCount: number;
            /**
             * Format: int64
             * @description Finest resolution of the times of changes of any field, in milliseconds; 0 when every change
             *     is released at once.
             */
            timeResolutionMs: number;
            /**
             * Format: double
             * @description Most values per hour; none when a field has no limit.
             */
            valuesPerHourMax?: number | null;
            /**
             * Format: double
             * @description Values per hour as measured.
             */
            valuesPerHourMeasured: number;
            /** @description Number of warnings in the full budget. */
            warningCount: number;
        };
        /** @description Warning about a conclusion that a partner can draw. */
        LeakWarning: {
            /** @description The conclusion, as a code with the other members as parameters. */
            conclusion: components["schemas"]["Conclusion"];
            /** @description The fields that allow the conclusion. */
            fields: components["schemas"]["FieldKey"][];
            /**
             * Format: int64
             * @description Resolution of times that prevents the conclusion, in milliseconds, if one does.
             */
            neededMs?: number | null;
            /**
             * Format: int64
             * @description Planned time of a piece in milliseconds, for `CYCLE_TIME` and when the plan has one.
             */
            pieceMs?: number | null;
            /** @description English text, with the remedy. */
            text: string;
        };
        /** @description Information that the decision would let out. */
        Leaks: {
            /** @description Caps that the decision would exceed, so that it would be refused. */
            capExcesses: components["schemas"]["CapExcess"][];
            /** @description Conclusions that the decision would permit to partners. */
            warnings: components["schemas"]["LeakWarning"][];
        };
        /** @description A connector that holds the lease or asked for it. */
        LeaseParty: {
            /** @description Its machine and folder. */
            host: string;
            instanceId: components["schemas"]["InstanceId"];
            /** @description Time of its last request, by the platform's clock. */
            lastHeardAt: components["schemas"]["DateTime"];
            /** @description Time at which it got the lease, or first asked for it. */
            since: components["schemas"]["DateTime"];
        };
        /**
         * @description Right to send, as the platform last answered.
         * @enum {string}
         */
        LeaseState: "ASKING" | "HELD" | "REFUSED" | "UNANSWERED";
        /** @description State of the lease, as pages show it. */
        LeaseStatus: {
            contender?: components["schemas"]["LeaseParty"] | null;
            holder?: components["schemas"]["LeaseParty"] | null;
            /** @description Machine and folder, as the platform knows it. */
            host: string;
            /**
             * Format: int64
             * @description Number of the lease that it has; `None` unless granted.
             */
            leaseNumber?: number | null;
            since: components["schemas"]["DateTime"];
            state: components["schemas"]["LeaseState"];
        };
        /** @description A log of the ledger of which the platform holds another history. */
        LedgerConflictStatus: components["schemas"]["LogConflict"] & {
            /** @description Organisation of the chain. */
            recipientId: components["schemas"]["OrganisationId"];
        };
        /** @description A difference from what was written. */
        LedgerFault: {
            /** @description Description of the fault. */
            message: string;
            /**
             * Format: int64
             * @description Number of the entry or checkpoint.
             */
            number: number;
            /** @description Organisation of the chain; empty when no single chain is affected. */
            recipient: string;
        };
        /** @description A field that the ledger has entries about, requested still or no more. */
        LedgerField: {
            key: components["schemas"]["FieldKey"];
        };
        /** @description Entries of one chain, newest first. */
        LedgerView: {
            /** @description Entries, newest first. */
            items: components["schemas"]["EntryView"][];
            /** @description Value of `after` for the next page; none on the last. */
            nextCursor?: string | null;
            /** @description Every recipient that has a chain. */
            recipients: string[];
        };
        /** @description Progress of a link towards a connection with a broker. */
        LinkPhase: {
            /** @enum {string} */
            state: "connecting";
        } | {
            /** @enum {string} */
            state: "up";
        } | {
            /**
             * @description True when a person must act (credentials, permissions, certificates) before an attempt
             *     can succeed.
             */
            isPermanent: boolean;
            /**
             * Format: date-time
             * @description Time of the next attempt.
             */
            retryAt: string;
            /** @enum {string} */
            state: "down";
        } | {
            /** @enum {string} */
            state: "stopped";
        };
        /** @description Link to the platform, with evidence. */
        LinkStatus: components["schemas"]["LinkPhase"] & {
            /**
             * Format: int64
             * @description Number of messages that wait to be sent; the spool's status has the rest.
             */
            backlog: number;
            /** @description Address of the broker. */
            broker: string;
            /**
             * Format: int64
             * @description Number of connections established since the start.
             */
            connects: number;
            /**
             * Format: date-time
             * @description Time at which the broker last accepted a message.
             */
            lastAcceptedAt?: string | null;
            /**
             * Format: date-time
             * @description Time at which the last receipt of the platform arrived.
             */
            lastReceiptedAt?: string | null;
            /**
             * Format: date-time
             * @description Time at which the last message was received.
             */
            lastReceivedAt?: string | null;
            /** @description Cause for which the link is not up, or an obstacle though it is; a sentence for people. */
            reason?: string | null;
            /**
             * Format: date-time
             * @description Time at which the state was entered.
             */
            since: string;
        };
        /** @description A value: plain text, Boolean or number, or an object with its type. */
        Literal: string | boolean | number | {
            /** @description The built-in type. */
            type: components["schemas"]["TypeName"];
            /** @description The value; 64-bit integers as text. */
            value: components["schemas"]["PlainValue"];
        };
        /** @description Live event: `event` is its name, `data` says what changed. */
        LiveEvent: {
            /** @description State of a field that was decided or has another value. */
            data: components["schemas"]["FieldChangeView"];
            /** @enum {string} */
            event: "field";
        } | {
            /** @description Number of fields decided at once. */
            data: components["schemas"]["DecisionCounts"];
            /** @enum {string} */
            event: "decisions";
        } | {
            /** @description New revision of a network, or its withdrawal. */
            data: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            };
            /** @enum {string} */
            event: "inbox";
        } | {
            /** @description New comment on a network. */
            data: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
            };
            /** @enum {string} */
            event: "comment";
        } | {
            /** @description Operation that an operator entered something about; for operators and engineers only. */
            data: components["schemas"]["OperationKey"];
            /** @enum {string} */
            event: "operator";
        } | {
            /** @description End of consents. */
            data: {
                /** @description Id of the receipt. */
                revocationId: string;
            };
            /** @enum {string} */
            event: "revocation";
        } | {
            /** @description Change of policies or standing rules. */
            data: Record<string, never>;
            /** @enum {string} */
            event: "policies";
        } | {
            /** @description New entries of the ledger; at most every other second. */
            data: Record<string, never>;
            /** @enum {string} */
            event: "ledger";
        } | {
            /** @description Change of the link's or a local server's state. */
            data: Record<string, never>;
            /** @enum {string} */
            event: "status";
        } | {
            /** @description Loss of events: more happened than the connector remembers, and the page loads afresh. */
            data: Record<string, never>;
            /** @enum {string} */
            event: "reset";
        };
        /**
         * @description Finding that the platform holds another history of the log. Nothing is disclosed until an engineer
         *     restores the store or begins a new log.
         */
        LogConflict: {
            /** @description The checkpoint that it holds, a C2SP signed note. */
            checkpoint?: string | null;
            /**
             * Format: int32
             * @description Number of the log that the platform holds, among those that replaced each other.
             */
            epoch: number;
            foundAt: components["schemas"]["DateTime"];
            /**
             * Format: int64
             * @description Number of entries in the checkpoint that the platform holds, where it can be read.
             */
            heldSize?: number | null;
            kind: components["schemas"]["ConflictKind"];
        };
        /** @description Log of a chain, which others check with one checkpoint that they kept. */
        LogView: {
            conflict?: components["schemas"]["LogConflict"] | null;
            /**
             * Format: int32
             * @description Number of the log among those that replaced each other, from 1.
             */
            epoch: number;
            /** @description Name of the log (C2SP tlog-checkpoint). */
            origin: string;
            /** @description Organisation of the chain. */
            recipientId: components["schemas"]["OrganisationId"];
            /**
             * Format: int64
             * @description Number of leaves: the entries, and one for the beginning.
             */
            size: number;
            /** @description The key of the log, for the recipient to note: name, id and key. */
            verifierKey?: string | null;
            witnessed?: components["schemas"]["WitnessedView"] | null;
        };
        /** @description Conversion of values to values by a table. */
        Lookup: {
            /** @description The table. Numbers match by value whatever their types, texts exactly. */
            entries: components["schemas"]["LookupEntry"][];
            /** @description Between two numeric entries, interpolate linearly; outside, the nearest entry. */
            interpolate?: boolean;
            otherwise?: components["schemas"]["Literal"] | null;
        };
        /** @description One line of a lookup table. */
        LookupEntry: {
            /** @description The value that comes in. */
            from: components["schemas"]["Literal"];
            /** @description The value that goes out. */
            to: components["schemas"]["Literal"];
        };
        /** @description Document that leads from local variables to a requested field. */
        Mapping: {
            /** @description The variables it reads. The first one enters the chain. */
            inputs: components["schemas"]["MappingInput"][];
            /** @description Treatment of values that arrive after newer ones of the same variable. */
            lateValues?: components["schemas"]["LateValues"];
            /** @description Its identity within the connector. */
            mappingId: components["schemas"]["MappingId"];
            /** @description The functions, applied in this order. */
            steps?: components["schemas"]["Step"][];
            /** @description The report field that gets the values. */
            target: components["schemas"]["FieldKey"];
            /** @description The built-in type of the field; what leaves the chain is of this type or a fault. */
            targetType: components["schemas"]["TypeName"];
            /** @description The unit the partner asked for (UNECE code or alias). */
            targetUnit?: string | null;
            /**
             * Format: int32
             * @description The ValueRank of the field: -1 scalar (default), 1 array, n matrix.
             */
            targetValueRank?: number;
        };
        /** @description One difference. */
        MappingChange: {
            /** @description Value in the later version; absent where it was taken away. */
            after?: components["schemas"]["PlainValue"];
            /** @description Value in the earlier version; absent where it is new. */
            before?: components["schemas"]["PlainValue"];
            /**
             * @description JSON pointer into the mapping: of the later version, or of the earlier one where something
             *     was taken away.
             */
            pointer: string;
        };
        /** @description Fault or warning about a mapping document, with its JSON pointer. */
        MappingDiagnostic: {
            /** @description A stable code in camelCase. */
            code: components["schemas"]["DiagnosticCode"];
            /**
             * Format: int32
             * @description The column in the expression or script, from 1.
             */
            column?: number | null;
            /**
             * Format: int32
             * @description The line in the expression or script, from 1.
             */
            line?: number | null;
            /** @description Fault and remedy, in a sentence. */
            message: string;
            /** @description JSON pointer into the mapping, as `/steps/2/factor`. */
            pointer: string;
            /** @description Severity; a mapping with an error does not run. */
            severity: components["schemas"]["Severity"];
        };
        /** @description Mapping from local variables to a field, without its target. */
        MappingDraft: {
            /** @description Variables by their names in the mapping. */
            inputs: components["schemas"]["MappingInput"][];
            /** @description Treatment of values that arrive after newer ones of the same variable. */
            lateValues?: components["schemas"]["LateValues"];
            /** @description The functions, applied in this order. */
            steps?: components["schemas"]["Step"][];
        };
        /**
         * @description Effect of a difference on a mapping.
         * @enum {string}
         */
        MappingEffect: "KEPT" | "OFFERED_AGAIN" | "SUGGESTED" | "REMOVED";
        /** @description Mappings and templates as one JSON document. */
        MappingFile: {
            /** @description Mappings without a template. */
            mappings?: components["schemas"]["Mapping"][];
            /** @description Templates for series of like machines. */
            templates?: components["schemas"]["MappingTemplate"][];
            /**
             * Format: int32
             * @description The format's version: 1.
             */
            version: number;
        };
        /**
         * @description Health of a mapping; the worst first.
         * @enum {string}
         */
        MappingHealth: "RESTING" | "FAILING" | "WAITING" | "DOUBTFUL" | "CLOCK_AHEAD" | "WELL";
        /** @description A mapping's identity within a connector. */
        MappingId: string;
        /** @description A variable of a local server, under the name that expressions and scripts use. */
        MappingInput: {
            /** @description Monitoring of the variable: sampling, queue, browse path to find it again, part of an array. */
            monitor?: components["schemas"]["MonitorOptions"];
            /** @description `[A-Za-z_][A-Za-z0-9_]*`, unique within the mapping, not `value`. */
            name: string;
            /** @description The variable, with its namespace's URI. */
            nodeId: components["schemas"]["NodeId"];
            /** @description The local server. */
            sourceId: components["schemas"]["SourceId"];
            /**
             * @description True where a change of this variable makes the mapping run; otherwise it is only read when
             *     another one changes.
             */
            triggers?: boolean;
            /** @description The variable's unit as seen when it was picked (UNECE code or alias). */
            unit?: string | null;
            valueType?: components["schemas"]["TypeName"] | null;
        };
        /**
         * @description State of a field's decision.
         * @enum {string}
         */
        MappingState: "PENDING" | "MAPPED" | "REFUSED";
        /** @description Status of a mapping, for its page. */
        MappingStatus: {
            /** @description State of the circuit breakers of its scripts. */
            circuit: components["schemas"]["CircuitState"];
            /**
             * Format: int64
             * @description Number of times that a source's clock was set back.
             */
            clockSteps: number;
            /**
             * Format: int64
             * @description Number of faults since the mapping was published.
             */
            faults: number;
            /** @description Last value of each input, in the mapping's order. */
            inputs: components["schemas"]["InputStatus"][];
            lastCandidate?: components["schemas"]["TracedValue"] | null;
            lastFault?: components["schemas"]["FaultRecord"] | null;
            lastYieldedAt?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int64
             * @description Values that were late.
             */
            late: number;
            mappingId: components["schemas"]["MappingId"];
            /**
             * Format: int64
             * @description Values that came.
             */
            received: number;
            /**
             * Format: int64
             * @description Values that were repeats.
             */
            repeated: number;
            /**
             * Format: int64
             * @description Time spent on it, in microseconds.
             */
            spentUs: number;
            /**
             * Format: int64
             * @description Values that newer ones replaced because a script did not keep up.
             */
            superseded: number;
            /** @description Field that gets the candidates. */
            target: components["schemas"]["FieldKey"];
            /**
             * Format: int64
             * @description Candidates that went out.
             */
            yielded: number;
        };
        /** @description Health of the published mappings, without shadow mappings. */
        MappingSurvey: {
            /** @description Numbers of all published mappings. */
            counts: components["schemas"]["HealthCounts"];
            /**
             * @description The worst of those that were asked for; of two that are doing alike, the one with more
             *     faults first.
             */
            items: components["schemas"]["SurveyedMapping"][];
        };
        /** @description A mapping with gaps. */
        MappingTemplate: {
            /** @description Purpose, for people. */
            description?: string | null;
            /** @description The JSON of a mapping with placeholders. */
            mapping: components["schemas"]["TemplateContent"];
            /** @description Name for people. */
            name?: string | null;
            /** @description The parameters, for the form that asks for them. */
            parameters: components["schemas"]["TemplateParameter"][];
            /** @description Its identity within the connector. */
            templateId: string;
        };
        /** @description Counts over a period, before and behind the gate. */
        Measured: {
            /**
             * Format: int64
             * @description Candidates from the source.
             */
            candidates: number;
            /**
             * Format: double
             * @description Length of the period in hours, at most 24; since the connector started or the field was
             *     opened.
             */
            hours: number;
            /**
             * Format: int64
             * @description Values that the gate released.
             */
            released: number;
        };
        /**
         * @description Count of what the gate released over a period. A budget has no other count: that of the
         *     candidates tells what no partner gets.
         */
        MeasuredRelease: {
            /**
             * Format: double
             * @description Length of the period in hours, at most 24; since the connector started or the field was
             *     opened.
             */
            hours: number;
            /**
             * Format: int64
             * @description Values that the gate released.
             */
            released: number;
        };
        /** @description One value from several inputs. */
        Merge: {
            /** @description The names of the inputs, in their order of precedence; all where empty. */
            inputs?: string[];
            /** @description Rule by which the inputs become one value. */
            rule: components["schemas"]["MergeRule"];
            /** @description Separator between the texts of `join`. */
            separator?: string | null;
        };
        /**
         * @description Rule by which several inputs become one value.
         * @enum {string}
         */
        MergeRule: "newest" | "firstGood" | "minimum" | "maximum" | "sum" | "mean" | "all" | "any" | "join" | "array";
        /** @description A message id, unique per message; our own senders write a UUID. */
        MessageId: string;
        /**
         * @description Protection of messages.
         * @enum {string}
         */
        MessageSecurity: "none" | "sign" | "signAndEncrypt";
        /** @description Options of a monitored variable. */
        MonitorOptions: {
            /** @default null */
            browsePath?: components["schemas"]["BrowsePath"] | null;
            /**
             * @description Part of an array, as OPC 10000-4 §7.27 writes it: `2` or `1:3`.
             * @default null
             */
            indexRange?: string | null;
            /**
             * Format: int32
             * @description Changes that the server queues between two publishings. Default: enough for the sampling and
             *     publishing interval, so that no change is lost.
             * @default null
             */
            queueSize?: number | null;
            /**
             * Format: double
             * @description Sampling interval of the server, in milliseconds. 0: on every change. Default: the
             *     sampling interval of the source.
             * @default null
             */
            samplingIntervalMs?: number | null;
        };
        /** @description A policy with a name, which can be chosen for fields and set for recipients. */
        NamedPolicy: {
            disclosure: components["schemas"]["DisclosurePolicy"];
            /** @description True when it is no longer offered or applied. */
            isRetired?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
        };
        /** @description Differences between two revisions of a network. */
        NetworkDifference: {
            /**
             * @description Every field of the old and the new network with what becomes of it; untouched ones are left
             *     out.
             */
            fields: components["schemas"]["FieldDifference"][];
            /** @description The network's own name or description. */
            isDescribedAnew: boolean;
            /** @description Operations, without regard to their requests. */
            operations: components["schemas"]["Changes_OperationId"];
            /** @description Relations with their conditions. */
            relations: components["schemas"]["Changes_OperationRelationId"];
            /** @description Requests, without regard to their fields. */
            requests: components["schemas"]["Changes_RequestKey"];
        };
        /** @description A network in short. */
        NetworkSummary: {
            collaborationId?: string | null;
            fieldCount: number;
            isWithdrawn: boolean;
            name?: string | null;
            operationNetworkId: string;
            pendingCount: number;
            receivedAt: components["schemas"]["DateTime"];
            requestCount: number;
            /** Format: int64 */
            revision: number;
        };
        /** @description A network with its requests. */
        NetworkView: {
            message?: components["schemas"]["OperationNetworkMessage"] | null;
            requests: components["schemas"]["RequestView"][];
            /** Format: int64 */
            revision: number;
        };
        /** @description A comment to send. */
        NewComment: {
            dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"] | null;
            fieldName?: components["schemas"]["FieldName"] | null;
            text: string;
        };
        /** @description An entry of a page. */
        NewEntry: components["schemas"]["OperationKey"] & components["schemas"]["Action"] & {
            /**
             * @description Id made by the page: 1 to 64 letters, digits, `-` or `_`. An entry that comes again has no
             *     further effect.
             */
            entryId: components["schemas"]["EntryId"];
            /** @description Time of the entry by the page's clock. */
            madeAt: components["schemas"]["DateTime"];
        };
        /** @description Decision to begin a new log. */
        NewLogBody: {
            /** @description Reason, which stands in the new log for the recipient to read. */
            reason: string;
        };
        /** @description New passkey from a browser. */
        NewPasskey: {
            /** @description Credential that the browser made: `RegistrationResponseJSON` of WebAuthn Level 3. */
            credential: Record<string, never>;
            /** @description Name by which its owner knows it, at most 64 characters. */
            name: string;
        };
        /**
         * @description Node classes (OPC 10000-3 §5.2.3).
         * @enum {string}
         */
        NodeClass: "object" | "variable" | "method" | "objectType" | "variableType" | "referenceType" | "dataType" | "view";
        /**
         * @description A NodeId as text; its namespace by URI.
         * @example nsu=urn:press;s=Cell.Counter
         */
        NodeId: string;
        /** @description A type's identity and name. */
        NodeType: {
            /** @description Its browse name without the namespace; empty where the server does not know the type. */
            name: string;
            nodeId: components["schemas"]["NodeId"];
        };
        /** @description A number; integers beyond 2^53 as text. */
        Number: number | string;
        /** @description Certificate that a server offers, to be compared with the one at the machine. */
        OfferedCertificate: {
            /** @description The application it is for. */
            applicationUri?: string | null;
            /** @description SHA-256 fingerprint, hex, for people to compare. */
            fingerprint: string;
            /** @description The names and addresses of the machine it is for. */
            hostNames: string[];
            /** @description True where it is signed over SHA-1, of which two certificates with the same can be made. */
            isSignedWithSha1: boolean;
            /** @description True where a person approved it already. */
            isTrusted: boolean;
            /** @description The length of its RSA key in bits. */
            keyBits?: number | null;
            /** @description Distinguished name of the subject. */
            subject: string;
            /** @description SHA-1 thumbprint, hex: the certificate's name in OPC UA. */
            thumbprint: string;
            validFrom?: components["schemas"]["DateTime"] | null;
            validTo?: components["schemas"]["DateTime"] | null;
        };
        /**
         * @description Meaning of a counter's decrease that is no wrap.
         * @enum {string}
         */
        OnDecrease: "reset" | "set" | "subtract";
        /** @description A production, inspection or transportation step. */
        Operation: components["schemas"]["OperationKind"] & {
            /** @description More about it. */
            description?: string | null;
            /** @description Data that partners request about the operation. */
            dynamicDataRequestList?: components["schemas"]["DynamicDataRequest"][];
            /** @description Equipment that the operation needs. */
            equipmentRequirementList?: components["schemas"]["EquipmentRequirement"][];
            /** @description Name for people, at most 256 characters. */
            name?: string | null;
            /** @description Unique within the network. */
            operationId: components["schemas"]["OperationId"];
            owningFactoryId?: components["schemas"]["FactoryId"] | null;
            plannedEnd?: components["schemas"]["DateTime"] | null;
            /**
             * Format: double
             * @description Planned quantity in [`Self::quantity_unit`], not negative.
             */
            plannedQuantity?: number | null;
            plannedStart?: components["schemas"]["DateTime"] | null;
            /** @description The unit of the planned quantity: a UNECE common code or one of its aliases (`PIECE`). */
            quantityUnit?: string | null;
            /** @description A neighbour's operation that a relation names: only type, id, name and owner. */
            stub?: boolean;
        };
        /** @description An operation, unique within its network. */
        OperationId: string;
        /** @description An operation of a network. */
        OperationKey: {
            operationId: components["schemas"]["OperationId"];
            operationNetworkId: components["schemas"]["OperationNetworkId"];
        };
        /** @description The three kinds of operation. */
        OperationKind: {
            /** @enum {string} */
            operationType: "PRODUCTION";
            /** @description Product, by the partners' own id. */
            productId?: string | null;
        } | {
            /** @description Characteristic that is measured or judged. */
            characteristic?: string | null;
            inspectedOperationId?: components["schemas"]["OperationId"] | null;
            /** @enum {string} */
            operationType: "INSPECTION";
        } | {
            /** @description Place that the material is brought to. */
            destination?: string | null;
            /** @enum {string} */
            operationType: "TRANSPORTATION";
            /** @description Place that the material leaves. */
            origin?: string | null;
        };
        /** @description A network of operations, or the part of it that concerns one factory. */
        OperationNetwork: {
            /** @description More about it. */
            description?: string | null;
            /** @description Name for people, at most 256 characters. */
            name?: string | null;
            /** @description The operations, stubs of neighbours included. */
            operationList: components["schemas"]["Operation"][];
            /** @description Unique on a platform. */
            operationNetworkId: components["schemas"]["OperationNetworkId"];
            /** @description The relations between them. */
            operationRelationList?: components["schemas"]["OperationRelation"][];
        };
        /** @description An operation network, unique on a platform. */
        OperationNetworkId: string;
        /** @description The whole part of a network that concerns the factory. A higher revision replaces a lower one. */
        OperationNetworkMessage: {
            /** @description The collaboration it belongs to. */
            collaborationId: components["schemas"]["CollaborationId"];
            /** @description The factory it is for. */
            factoryId: components["schemas"]["FactoryId"];
            /** @description Unique per message. */
            messageId: components["schemas"]["MessageId"];
            operationNetwork: components["schemas"]["OperationNetwork"];
            /**
             * Format: int64
             * @description Counts up with every change.
             */
            revision: number;
        };
        /** @description "The successor's start or finish depends on the predecessor's." */
        OperationRelation: {
            /** @description Bounds on the dependency. */
            conditionList?: components["schemas"]["RelationCondition"][];
            /** @description Unique within the network. */
            operationRelationId: components["schemas"]["OperationRelationId"];
            /** @description The operation that comes first. */
            predecessorOperationId: components["schemas"]["OperationId"];
            /** @description Ends of the two operations that the relation connects. */
            relationType: components["schemas"]["RelationType"];
            /** @description The operation that waits. */
            successorOperationId: components["schemas"]["OperationId"];
        };
        /** @description A relation between two operations, unique within its network. */
        OperationRelationId: string;
        /**
         * @description The state of an operation after the ISA-95 job states (OPC 10031-4).
         * @enum {string}
         */
        OperationState: "NotAllowedToStart" | "AllowedToStart" | "Running" | "Interrupted" | "Ended" | "Aborted";
        /** @description Status of an operation by its entries. */
        OperationStatus: {
            endedAt?: components["schemas"]["DateTime"] | null;
            /**
             * Format: double
             * @description Good pieces counted with the buttons.
             */
            goodQuantity: number;
            lastEntryAt?: components["schemas"]["DateTime"] | null;
            problem?: components["schemas"]["OperatorProblem"] | null;
            /**
             * Format: double
             * @description Scrap counted with the buttons.
             */
            scrapQuantity: number;
            startedAt?: components["schemas"]["DateTime"] | null;
            state?: components["schemas"]["OperationState"] | null;
        };
        /** @description A stored entry. */
        OperatorEntry: components["schemas"]["OperationKey"] & components["schemas"]["Action"] & {
            /** @description Made where it was entered. */
            entryId: components["schemas"]["EntryId"];
            /** @description Time of the entry by the connector's clock. */
            madeAt: components["schemas"]["DateTime"];
            /** @description Name of the user. */
            madeBy: string;
            /** @description Time of its delivery. */
            receivedAt: components["schemas"]["DateTime"];
        };
        /** @description A field that takes entered values. */
        OperatorField: {
            description?: string | null;
            /** @description Last entered value, before the disclosure gate. */
            entered?: components["schemas"]["PlainValue"];
            enteredAt?: components["schemas"]["DateTime"] | null;
            /** @description True if the value follows from the buttons; it can be typed all the same. */
            hasButton: boolean;
            key: components["schemas"]["FieldKey"];
            name: string;
            semantic?: string | null;
            type: string;
            unit?: string | null;
            value?: components["schemas"]["ShownValue"] | null;
        };
        /** @description An operation with fields for people to fill. */
        OperatorOperation: components["schemas"]["OperationKey"] & {
            buttons: components["schemas"]["Buttons"];
            description?: string | null;
            /** @description The fields that take entered values. */
            fields: components["schemas"]["OperatorField"][];
            name?: string | null;
            networkName?: string | null;
            /** @description `PRODUCTION`, `INSPECTION` or `TRANSPORTATION`. */
            operationType: string;
            plannedEnd?: components["schemas"]["DateTime"] | null;
            /** Format: double */
            plannedQuantity?: number | null;
            plannedStart?: components["schemas"]["DateTime"] | null;
            quantityUnit?: string | null;
            /** @description Progress by the entries so far. */
            standing: components["schemas"]["OperationStatus"];
        };
        /** @description A problem that is not solved yet. */
        OperatorProblem: {
            /** @description Time of its entry. */
            since: components["schemas"]["DateTime"];
            text: string;
            /** @description Name of the user who entered it. */
            toldBy: string;
        };
        /** @description An organisation that takes part in collaborations. */
        OrganisationId: string;
        /**
         * @description Treatment of a number outside the wanted type's range.
         * @enum {string}
         */
        Overflow: "fault" | "clamp";
        /** @description Client certificate, which a server's administrator must trust. */
        OwnCertificate: {
            /** @description The application URI it is for. */
            applicationUri: string;
            /** @description SHA-256 fingerprint, hex, for people to compare. */
            fingerprint: string;
            /** @description Distinguished name of the subject. */
            subject: string;
            /** @description SHA-1 thumbprint, hex: the certificate's name in OPC UA. */
            thumbprint: string;
            validFrom: components["schemas"]["DateTime"];
            validTo: components["schemas"]["DateTime"];
        };
        /** @description A page of a list. */
        Page_AllianceLeaks: {
            items: components["schemas"]["AllianceLeaks"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_BrowsedNode: {
            items: components["schemas"]["BrowsedNode"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_CapView: {
            items: components["schemas"]["CapView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_CheckpointView: {
            items: components["schemas"]["CheckpointView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_ClientAuthorityView: {
            items: components["schemas"]["ClientAuthorityView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_ClientCertificateView: {
            items: components["schemas"]["ClientCertificateView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_ClientRevocationListView: {
            items: components["schemas"]["ClientRevocationListView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_DeadLetter: {
            items: components["schemas"]["DeadLetter"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_EntryResult: {
            items: components["schemas"]["EntryResult"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_FieldToHoldBack: {
            items: components["schemas"]["FieldToHoldBack"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_LedgerField: {
            items: components["schemas"]["LedgerField"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_LogView: {
            items: components["schemas"]["LogView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_NetworkSummary: {
            items: components["schemas"]["NetworkSummary"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_OperatorEntry: {
            items: components["schemas"]["OperatorEntry"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_OperatorOperation: {
            items: components["schemas"]["OperatorOperation"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PartnerLeaks: {
            items: components["schemas"]["PartnerLeaks"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PartnerSummary: {
            items: components["schemas"]["PartnerSummary"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PastOfferView: {
            items: components["schemas"]["PastOfferView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PeerCertificate: {
            items: components["schemas"]["PeerCertificate"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PersonSession: {
            items: components["schemas"]["PersonSession"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PolicyUse: {
            items: components["schemas"]["PolicyUse"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_PolicyView: {
            items: components["schemas"]["PolicyView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_RecipientView: {
            items: components["schemas"]["RecipientView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_RuleDecision: {
            items: components["schemas"]["RuleDecision"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_ServerProfile: {
            items: components["schemas"]["ServerProfile"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Setting: {
            items: components["schemas"]["Setting"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_ShownValue: {
            items: components["schemas"]["ShownValue"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_SourceView: {
            items: components["schemas"]["SourceView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_StoredComment: {
            items: components["schemas"]["StoredComment"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_StoredPastDecision: {
            items: components["schemas"]["StoredPastDecision"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_StoredRevocation: {
            items: components["schemas"]["StoredRevocation"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_TemplateView: {
            items: components["schemas"]["TemplateView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_UserView: {
            items: components["schemas"]["UserView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_VersionView: {
            items: components["schemas"]["VersionView"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Versioned_Alliance: {
            items: components["schemas"]["Versioned_Alliance"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Versioned_Cap: {
            items: components["schemas"]["Versioned_Cap"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Versioned_NamedPolicy: {
            items: components["schemas"]["Versioned_NamedPolicy"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description A page of a list. */
        Page_Versioned_Rule: {
            items: components["schemas"]["Versioned_Rule"][];
            /** @description Cursor of the next page; none on the last. */
            nextCursor?: string | null;
        };
        /** @description Takes a value out of a text. */
        Parse: {
            /** @description A comma is the decimal sign, points group digits. */
            decimalComma?: boolean;
            /**
             * @description Position of the value: `{}` is the value, `*` any text, all else itself (`Temp={} *`). The
             *     whole text where absent.
             */
            pattern?: string | null;
            /**
             * Format: int32
             * @description The base of an integer: 2 to 36.
             */
            radix?: number | null;
            /** @description The type of the value. */
            to: components["schemas"]["TypeName"];
        };
        /** @description Leak budget of one partner over all its open fields. */
        PartnerLeaks: components["schemas"]["LeakBudget"] & {
            /** @description The organisation: a requester or a recipient. */
            partner: components["schemas"]["OrganisationId"];
        };
        /** @description Leak budget of one partner, in short. */
        PartnerSummary: components["schemas"]["LeakSummary"] & {
            /** @description The organisation: a requester or a recipient. */
            partner: components["schemas"]["OrganisationId"];
        };
        /** @description Password that a new passkey takes. */
        PasskeyBegin: {
            /** Format: password */
            password: string;
        };
        /** @description Passkeys of a person, the oldest first. */
        PasskeyList: {
            items: components["schemas"]["PasskeySummary"][];
            /** @description Reason why browsers make no passkeys for these pages, for people; absent where they do. */
            unavailable?: string | null;
        };
        /** @description Options with which a browser makes a passkey. */
        PasskeyOffer: {
            /**
             * @description Options of `navigator.credentials.create`: `PublicKeyCredentialCreationOptionsJSON` of WebAuthn Level 3.
             *     Their challenge is good once, for two minutes.
             */
            options: Record<string, never>;
        };
        /** @description Password with which a passkey is removed. */
        PasskeyRemoval: {
            /** Format: password */
            password: string;
        };
        /** @description A passkey, shown to its owner. */
        PasskeySummary: {
            /** Format: date-time */
            createdAt: string;
            /**
             * Format: date-time
             * @description Last sign-in with it.
             */
            lastUsedAt?: string | null;
            /** @description Name that its owner gave. */
            name: string;
            /** @description Name by which the passkey is removed. */
            passkeyId: string;
        };
        /**
         * Format: password
         * @description A password: not printed, not serialised, wiped from memory.
         */
        Password: string;
        /** @description Present and new password. */
        PasswordChange: {
            /**
             * Format: password
             * @description At least ten characters.
             */
            newPassword: string;
            /** Format: password */
            presentPassword: string;
        };
        /** @description Decision about the past, with the offer that the person saw. */
        PastDecisionBody: {
            /** @description True to show the recipient what is offered; false to leave it hidden. */
            isReleased: boolean;
            /** @description Reason, for the record. */
            reason?: string | null;
            /** @description The recipient of the offer. */
            recipientId: components["schemas"]["OrganisationId"];
            /** @description The request of the offer. */
            request: components["schemas"]["RequestKey"];
            /** @description `root` of the offer. */
            root: string;
        };
        /** @description A field of reports of the past. */
        PastFieldView: {
            /**
             * Format: int32
             * @description Number of the consent under which it left.
             */
            consentVersion: number;
            /** @description True where the field is not open to the recipient at present. */
            isClosed: boolean;
            /** @description True where that policy does not satisfy the present one. */
            isLooser: boolean;
            name: components["schemas"]["FieldName"];
            policy?: components["schemas"]["Statement"] | null;
        };
        /** @description Offer to show a recipient what had left for others before it was added. */
        PastOfferView: {
            /** @description All reports, grouped by the consents under which they left; the oldest first. */
            parts: components["schemas"]["PastPartView"][];
            /** @description The newest reports that can be shown, as they left. */
            preview: components["schemas"]["PastReportView"][];
            /** @description The recipient that was added. */
            recipientId: components["schemas"]["OrganisationId"];
            /**
             * Format: int64
             * @description Number of reports that can be shown.
             */
            reportCount: number;
            request: components["schemas"]["RequestKey"];
            /** @description Root over their values, hexadecimal: names this offer in the decision. */
            root: string;
        };
        /** @description Reports that left under the same consents. */
        PastPartView: {
            fields: components["schemas"]["PastFieldView"][];
            /** @description Time of the first report. */
            from: components["schemas"]["DateTime"];
            /** @description True where they can be shown. */
            isOffered: boolean;
            /**
             * Format: int64
             * @description Number of reports.
             */
            reportCount: number;
            /** @description Time of the last report. */
            until: components["schemas"]["DateTime"];
        };
        /** @description Reports of the past that are shown to the recipient of the chain. */
        PastReleasedView: components["schemas"]["SequenceRange"] & {
            /** @description Name of the person who decided. */
            decidedBy: string;
            /** @description Reason that the person gave. */
            reason?: string | null;
            /** @description Root over the roots of the reports' values, hexadecimal. */
            values: string;
        };
        /** @description Values of a report as they left. */
        PastReportView: {
            /** @description The payload by member. */
            value: {
                [key: string]: components["schemas"]["EncodedValue"];
            };
        };
        /** @description Certificate that a server has presented. */
        PeerCertificate: {
            /** @description SHA-256 fingerprint, hex, for people to compare. */
            fingerprint: string;
            /** @description The length of its RSA key in bits. */
            keyBits?: number | null;
            /** @description Distinguished name of the subject. */
            subject: string;
            /** @description SHA-1 thumbprint, hex: the certificate's name in OPC UA. */
            thumbprint: string;
            trust: components["schemas"]["TrustState"];
            validFrom?: components["schemas"]["DateTime"] | null;
            validTo?: components["schemas"]["DateTime"] | null;
        };
        /** @description Session of a person, shown to its owner or to an engineer. */
        PersonSession: {
            /** @description Address from which the person signed in; empty if the OPC UA server had opened the connection. */
            address: string;
            /** @description Subject of the OPC UA client's certificate; none at the pages, and without protection. */
            clientCertificate?: string | null;
            /** @description True for the session that asks. */
            isPresent: boolean;
            kind: components["schemas"]["SessionKind"];
            /** @description Last use, at the pages to the minute. An open page uses its session. */
            lastUsedAt: components["schemas"]["DateTime"];
            /** @description Name by which the session is ended; nobody can use the session with it. */
            sessionId: string;
            startedAt: components["schemas"]["DateTime"];
            /** @description Browser or OPC UA client as it calls itself. */
            userAgent: string;
        };
        /**
         * @description Quality of a counted piece.
         * @enum {string}
         */
        Piece: "GOOD" | "SCRAP";
        /** @description A value as plain JSON of any kind: number, text, truth value, list, object, or null where there is none. 64-bit integers are texts. */
        PlainValue: unknown;
        /** @description An address of the configuration by which passwords and values leave this machine without TLS. */
        PlaintextWay: {
            address: string;
            /** @description Key with the address, as `web.listen`. */
            key: string;
        };
        /** @description Effect of a changed policy on a field. */
        PolicyUse: components["schemas"]["Statement"] & {
            key: components["schemas"]["FieldKey"];
            /** @description Statement with the draft, in words. */
            statementThen: string;
            /** @description Statement with the draft, as codes with parameters. */
            statementThenParts: components["schemas"]["StatementPart"][];
        };
        /** @description A named policy and its uses. */
        PolicyView: components["schemas"]["Versioned_NamedPolicy"] & components["schemas"]["Statement"] & {
            /** @description Number of mapped fields that name it. */
            fieldCount: number;
            /** @description Recipients that it is set for. */
            recipients: components["schemas"]["OrganisationId"][];
        };
        /** @description Side by side: machine, mapping, what is disclosed, and the message. */
        Preview: components["schemas"]["Statement"] & components["schemas"]["Leaks"] & {
            candidate?: components["schemas"]["ShownValue"] | null;
            /** @description Errors and warnings about the mapping. */
            diagnostics: components["schemas"]["MappingDiagnostic"][];
            disclosed?: components["schemas"]["ShownValue"] | null;
            disclosedAt?: components["schemas"]["DateTime"] | null;
            /**
             * @description Policy that would apply: the strictest of the draft, the named policy and the recipients'
             *     policies.
             */
            effectiveDisclosure: components["schemas"]["DisclosurePolicy"];
            /** @description Effect of each part of the policy on this value. */
            effects: components["schemas"]["Effect"][];
            /** @description Present values of the variables. */
            inputs: components["schemas"]["InputView"][];
            /**
             * @description True where nothing would leave now: the policy withholds the present state, or one that is
             *     not known.
             */
            isWithheld: boolean;
            /**
             * @description The NetworkMessage that the partner would receive, byte for byte but for its id, numbers and
             *     times.
             */
            message?: string | null;
            /** @description Id by which a decision names this preview, for some minutes. */
            previewId: string;
            /** @description Results of the mapping's functions, in order. */
            steps: components["schemas"]["StepView"][];
        };
        /**
         * @description A problem document. `code` is stable and for programs, `detail` is for people; what went wrong
         *     inside is logged and never shown.
         */
        Problem: {
            /** @description A stable code, as `NOT_FOUND`. */
            code: string;
            /** @description Problem and remedy, for people. */
            detail: string;
            /** @description Each single fault, where a document has several. */
            faults?: components["schemas"]["ProblemFault"][];
            /** @description Values that a text of the code in another language names, by their names in it. */
            parameters?: {
                [key: string]: string;
            } | null;
            /**
             * Format: int64
             * @description Seconds after which trying again makes sense; also the header `Retry-After`.
             */
            retryAfterSeconds?: number | null;
            secondFactor?: components["schemas"]["SecondFactorNeeded"] | null;
            /**
             * Format: int32
             * @description The HTTP status.
             */
            status: number;
            /** @description The HTTP status in words. */
            title: string;
            /** @description Problem type, `urn:verbund:problem:<code>`. */
            type: string;
        };
        /** @description One fault of a document, placed. */
        ProblemFault: {
            /** @description A stable code. */
            code: string;
            /** @description A sentence that says what is wrong and what to do. */
            message: string;
            /** @description JSON pointer (RFC 6901) into the document that was sent. */
            pointer: string;
        };
        /** @description A limit of a family, with its evidence. */
        ProfileFigure: {
            kind: components["schemas"]["EvidenceKind"];
            limit: components["schemas"]["ProfileLimit"];
            /** @description Document, thread or project that says so. */
            source: string;
            /** Format: int32 */
            value: number;
        };
        /**
         * @description Limits that a family may have.
         * @enum {string}
         */
        ProfileLimit: "publishingIntervalMsMin" | "samplingIntervalMsMin" | "sessionsMax" | "subscriptionsPerSessionMax" | "queueSizeMax" | "nodesPerCallMax" | "nodesPerBrowseMax" | "keepAliveCountMax" | "lifetimeCountMax";
        /** @description A sentence about a family in both languages, with its evidence. */
        ProfileNote: {
            /** @description The same in German. */
            de: string;
            /** @description The sentence in English. */
            en: string;
            kind: components["schemas"]["EvidenceKind"];
            /** @description Document, thread or project that says so. */
            source: string;
        };
        /** @description Commitment to the values of a DataSetMessage. */
        QueuedView: components["schemas"]["SequenceRange"] & {
            /** @description The consent of each field, by its number. */
            consents: {
                [key: string]: number;
            };
            /** @description Root over the salted hashes of its members, hexadecimal. */
            values: string;
        };
        /** @description Change per time, by the source's times, as Double. The first value yields nothing. */
        Rate: {
            /** @description Time that the rate refers to. */
            per?: components["schemas"]["RatePeriod"];
        };
        /** @description Most values that are released within any period of this length. */
        RateLimit: {
            /**
             * Format: int64
             * @description The period in milliseconds.
             */
            periodMs: number;
            /**
             * Format: int32
             * @description Number of values, 1 to 100.
             */
            values: number;
        };
        /**
         * @description The time that a rate refers to.
         * @enum {string}
         */
        RatePeriod: "second" | "minute" | "hour" | "day";
        /** @description A piece of evidence. */
        Reason: {
            /** @description Kind of evidence, for programs. */
            kind: components["schemas"]["ReasonKind"];
            /**
             * Format: int32
             * @description Its weight; negative where it speaks against.
             */
            points: number;
            /** @description Sentence for the engineer. */
            text: string;
        };
        /**
         * @description Kinds of evidence.
         * @enum {string}
         */
        ReasonKind: "name" | "semantic" | "place" | "description" | "type" | "unit" | "companionType" | "value" | "decision";
        /** @description Policy for everything that a recipient gets. */
        RecipientBody: {
            policyId?: components["schemas"]["DocumentId"] | null;
        };
        /** @description The policy that is set for everything one recipient gets. */
        RecipientPolicy: {
            changedAt: components["schemas"]["DateTime"];
            changedBy: string;
            policyId?: components["schemas"]["DocumentId"] | null;
            /**
             * Format: int32
             * @description Number from 1, one more with every change.
             */
            version: number;
        };
        /** @description Version of a recipient's policy. */
        RecipientVersion: {
            /**
             * Format: int32
             * @description Number of changes so far.
             */
            version: number;
        };
        /** @description A recipient and the policy set for it. */
        RecipientView: {
            /** @description Number of mapped fields whose values it gets. */
            fieldCount: number;
            recipient: components["schemas"]["OrganisationId"];
            set?: components["schemas"]["RecipientPolicy"] | null;
        };
        /**
         * @description Codes that sign in once each when app or passkey is lost; shown this once. None where the person has
         *     codes of before, which stay good.
         */
        RecoveryCodes: {
            recoveryCodes: string[];
        };
        /** @description A bound: absolute for the first four kinds (`time`), relative for the gaps (`duration`). */
        RelationCondition: {
            /** @description Unique within the network. */
            conditionId: components["schemas"]["ConditionId"];
            /** @description Kind of bound, which tells whether a time or a duration is needed. */
            conditionKind: components["schemas"]["ConditionKind"];
            duration?: components["schemas"]["IsoDuration"] | null;
            time?: components["schemas"]["DateTime"] | null;
        };
        /**
         * @description Dependency between an end of the predecessor and an end of the successor.
         * @enum {string}
         */
        RelationType: "FINISH_TO_START" | "START_TO_START" | "FINISH_TO_FINISH" | "START_TO_FINISH";
        /** @description The fields of a report, under its name. */
        ReportDataFormat: {
            /** @description The fields, in payload order. */
            reportFieldList: components["schemas"]["ReportField"][];
            /** @description The report's name; the first payload member. */
            reportName: string;
        };
        /** @description One value that a partner requests. */
        ReportField: {
            /** @description More about the field. */
            description?: string | null;
            /** @description The field's name; unique within the report. */
            name: components["schemas"]["FieldName"];
            semantic?: components["schemas"]["Semantic"] | null;
            /** @description Its built-in type: id 1 to 25 or name. */
            type: components["schemas"]["FieldType"];
            /** @description The unit: a UNECE common code or one of its aliases (`PIECE`). */
            unit?: string | null;
            /**
             * Format: int32
             * @description OPC UA ValueRank: -1 scalar, 1 array, n matrix of n dimensions.
             */
            valueRank?: number;
        };
        /** @description One dynamic data request, addressed through its network and operation. */
        RequestKey: {
            /** @description The request itself. */
            dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
            /** @description The operation it asks about. */
            operationId: components["schemas"]["OperationId"];
            /** @description The network the request belongs to. */
            operationNetworkId: components["schemas"]["OperationNetworkId"];
        };
        /** @description A request of a partner. */
        RequestView: {
            /**
             * Format: int32
             * @description DataSetWriter of its reports; none before the first decision.
             */
            dataSetWriterId?: number | null;
            description?: string | null;
            fields: components["schemas"]["FieldView"][];
            /** @description True after that period: no value leaves any more. */
            hasEnded: boolean;
            /** @description True after a day of waiting. */
            isOverdue: boolean;
            key: components["schemas"]["RequestKey"];
            networkName?: string | null;
            openSince?: components["schemas"]["DateTime"] | null;
            /** @description Operation that it is about, without requests. */
            operation: components["schemas"]["Operation"];
            /** @description Purpose in the requester's words. */
            purpose: string;
            /** @description Arrival of this revision of the network. */
            receivedAt: components["schemas"]["DateTime"];
            /** @description Organisations that get the values. */
            recipientList: components["schemas"]["OrganisationId"][];
            reportName: string;
            /** @description Organisation that asks. */
            requesterId: string;
            /**
             * Format: int64
             * @description Requested time between two reports, in milliseconds.
             */
            updateIntervalMs?: number | null;
            validFrom?: components["schemas"]["DateTime"] | null;
            validUntil?: components["schemas"]["DateTime"] | null;
        };
        /**
         * @description Rule by which values are emptied or entries removed.
         * @enum {string}
         */
        RetentionRule: "VALUE_DAYS" | "ENTRY_DAYS" | "FORMER_VERSION";
        /** @description Statement in a chain about what retention took from it. What is missing without one is a fault. */
        RetentionStatement: {
            /** @description Time before which reports and entries are affected. */
            before: components["schemas"]["DateTime"];
            /**
             * Format: int32
             * @description Configured number of days; none for what was found.
             */
            days?: number | null;
            /** @description Reports whose values were emptied. */
            emptied?: components["schemas"]["SequenceRange"][];
            /**
             * Format: int64
             * @description Number of the last entry of the chain that was removed.
             */
            removedThrough?: number | null;
            rule: components["schemas"]["RetentionRule"];
        };
        /** @description Difference between the revision in force and the one before. */
        RevisionDifference: {
            /**
             * @description Changed operations, relations and requests, and each changed field with the reasons and the
             *     effect on its mapping and on the consent.
             */
            difference: components["schemas"]["NetworkDifference"];
            /**
             * Format: int64
             * @description The one before it; none for the first.
             */
            previousRevision?: number | null;
            /**
             * Format: int64
             * @description The revision in force.
             */
            revision: number;
        };
        /** @description Fields whose consents end: single ones, or all that the other members select together. */
        RevocationBody: {
            dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"] | null;
            /** @description Single fields; if any, the other members select none. */
            fields?: components["schemas"]["FieldKey"][];
            mappingState?: components["schemas"]["MappingState"] | null;
            operationId?: components["schemas"]["OperationId"] | null;
            operationNetworkId?: components["schemas"]["OperationNetworkId"] | null;
            /** @description Reason that the partner reads; needed with `REFUSED`. */
            reason?: string | null;
            recipientId?: components["schemas"]["OrganisationId"] | null;
        };
        /**
         * @description State of an authority's revocation list.
         * @enum {string}
         */
        RevocationListState: "CURRENT" | "OUTDATED" | "MISSING";
        /**
         * @description Statement about the reports that had left when a consent ended. It is signed with the ledger's key
         *     and never deleted.
         */
        RevocationReceipt: {
            /** @description `REVOKED`, or `WITHDRAWN` by the partner. */
            cause: components["schemas"]["GapCause"];
            factoryId: components["schemas"]["FactoryId"];
            /** @description The fields with the consents that ended. */
            fields: components["schemas"]["RevokedField"][];
            reason?: string | null;
            revocationId: string;
            /** @description Time of the end; no value of these fields left afterwards. */
            revokedAt: components["schemas"]["DateTime"];
            /** @description User who ended the consent; none when the partner withdrew or changed the request. */
            revokedBy?: string | null;
            /** @description The data sets that contained them. */
            writers: components["schemas"]["RevokedWriter"][];
        };
        /** @description A field whose consent ended. */
        RevokedField: {
            /**
             * Format: int32
             * @description Number of the consent that ended.
             */
            consentVersion: number;
            field: components["schemas"]["FieldKey"];
        };
        /** @description End of a consent. */
        RevokedView: {
            /**
             * Format: int32
             * @description The writer of the fields' reports.
             */
            dataSetWriterId: number;
            /**
             * Format: int32
             * @description The writer's epoch until then.
             */
            epoch: number;
            /**
             * Format: int32
             * @description The last sequence number that the platform confirmed.
             */
            lastDeliveredSequence?: number | null;
            /**
             * Format: int32
             * @description The last sequence number that the broker accepted.
             */
            lastSentSequence?: number | null;
            /** @description Id of the receipt that states it. */
            revocationId: string;
        };
        /** @description Delivery of a data set until the end of the consent. */
        RevokedWriter: {
            /** Format: int32 */
            dataSetWriterId: number;
            /**
             * Format: int32
             * @description The writer's epoch until then.
             */
            epoch: number;
            /** @description Sent without a confirmation: they may have arrived, and are not sent again. */
            inFlight: components["schemas"]["Sequences"][];
            /**
             * Format: int32
             * @description The last sequence number that the platform confirmed.
             */
            lastDeliveredSequence?: number | null;
            /**
             * Format: int32
             * @description The last sequence number given to a report; none when there was no report.
             */
            lastQueuedSequence?: number | null;
            /**
             * Format: int32
             * @description The last sequence number that the broker accepted.
             */
            lastSentSequence?: number | null;
            /** @description Organisations that received it. */
            recipientList: components["schemas"]["OrganisationId"][];
            /** @description The request that it reported for. */
            request: components["schemas"]["RequestKey"];
            /** @description Queued and withdrawn: they never left. */
            takenBack: components["schemas"]["Sequences"][];
        };
        /**
         * @description Rights of a person.
         * @enum {string}
         */
        Role: "ENGINEER" | "OPERATOR" | "VIEWER";
        /**
         * @description Rounding of a fraction to an integer.
         * @enum {string}
         */
        Rounding: "nearest" | "halfEven" | "down" | "up" | "towardZero" | "exact";
        /**
         * Format: double
         * @description A positive decimal with at most 15 significant digits: values are rounded to multiples of it.
         */
        RoundingStep: number;
        /** @description A standing rule. */
        Rule: {
            action: components["schemas"]["RuleAction"];
            disclosure?: components["schemas"]["DisclosurePolicy"] | null;
            /** @description True when it is applied to new requests. */
            isEnabled?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
            policyId?: components["schemas"]["DocumentId"] | null;
            /** @description Reason for the partner, with `REFUSE`. */
            reason?: string | null;
            valueSource?: components["schemas"]["ValueSource"] | null;
            /** @description Selection of fields. */
            when: components["schemas"]["RuleCondition"];
        };
        /**
         * @description Action of a rule for the fields that it matches.
         * @enum {string}
         */
        RuleAction: "ACCEPT" | "PREFILL" | "REFUSE";
        /** @description Selection of fields: those that every list contains. An empty list matches all. */
        RuleCondition: {
            /**
             * @description Built-in types by name.
             * @default []
             */
            dataTypes?: string[];
            /**
             * @description Pattern of the field's name, in which `*` matches any text; case does not matter.
             * @default null
             */
            namePattern?: string | null;
            /**
             * @description Organisations. A rule that accepts or pre-fills matches requests of which the requester and
             *     *every* recipient are listed; a rule that refuses, requests of which any is.
             * @default []
             */
            partners?: components["schemas"]["OrganisationId"][];
            /**
             * @description Semantics as requested.
             * @default []
             */
            semantics?: string[];
            /**
             * @description Units as requested.
             * @default []
             */
            units?: string[];
        };
        /** @description A decision of standing rules, with its undoing if there was one. */
        RuleDecision: {
            /** @description `ACCEPT` or `REFUSE`. */
            action: string;
            /**
             * Format: int32
             * @description Number of the consent that the decision made.
             */
            consentVersion: number;
            decidedAt: components["schemas"]["DateTime"];
            field: components["schemas"]["FieldKey"];
            /** @description Number of the decision, as text. */
            id: string;
            /** @description The rules, in the versions that decided. */
            rules: components["schemas"]["DocumentVersion"][];
            undoneAt?: components["schemas"]["DateTime"] | null;
            /** @description The person who undid it; none while it is in force. */
            undoneBy?: string | null;
        };
        /** @description A field that a rule means. */
        RuleMatch: {
            key: components["schemas"]["FieldKey"];
            /** @description `PENDING`, `MAPPED` or `REFUSED`: only undecided fields would be decided. */
            mappingState: components["schemas"]["MappingState"];
            /** @description Decision that the rule offers. */
            offer: components["schemas"]["RuleOfferView"];
            /** @description Undecided, and no engineer has left it open: the rule would decide now. */
            wouldDecide: boolean;
        };
        /** @description Decision about a field that standing rules offer. */
        RuleOfferView: components["schemas"]["Statement"] & {
            action: components["schemas"]["RuleAction"];
            /** @description Coarsening of values. */
            disclosure: components["schemas"]["DisclosurePolicy"];
            mapping?: components["schemas"]["Mapping"] | null;
            /** @description Reason that the partner would read. */
            reason?: string | null;
            /** @description Rules, the one that gives reason and source first. */
            rules: components["schemas"]["RuleReference"][];
            valueSource?: components["schemas"]["ValueSource"] | null;
        };
        /** @description Matches of a draft of a rule. */
        RulePreview: {
            /** @description All fields it means. */
            count: number;
            /** @description At most 500 of them, those it would decide first. */
            items: components["schemas"]["RuleMatch"][];
            /** @description Number of these that it would decide now. */
            wouldDecideCount: number;
        };
        /** @description A version of a rule, with its name. */
        RuleReference: components["schemas"]["DocumentVersion"] & {
            name: string;
        };
        /**
         * @description `value * factor / divisor + offset`. Integers stay integers (of 64 bits) where factor, divisor
         *     and offset are and the division comes out even.
         */
        Scale: {
            /** @description Divisor of the product; not zero. */
            divisor?: components["schemas"]["Number"];
            /** @description Factor of the value. */
            factor?: components["schemas"]["Number"];
            /** @description Summand added at the end. */
            offset?: components["schemas"]["Number"];
        };
        /**
         * @description A JavaScript function `(value, ctx) => ...`, run in a worker process.
         *
         *     `ctx.state` is kept between calls (at most 4 KiB as JSON) and survives restarts; variables
         *     outside the function do not. `ctx.inputs.<name>` has `value`, `status` and `sourceTimestamp`,
         *     `ctx.status` and `ctx.sourceTimestamp` are those of `value`. 64-bit integers are BigInt.
         *     `undefined` yields nothing, `null` no value.
         */
        Script: {
            /** @description The source text. */
            source: string;
        };
        /** @description Worker process of scripts, running or refused. */
        ScriptWorkerStatus: {
            /** @description Name and version of the engine. */
            engine?: string | null;
            /** @description Reason for which it does not run; a sentence for people. */
            fault?: string | null;
            /** @description Number among the workers of one purpose. */
            number: number;
            purpose: components["schemas"]["WorkerPurpose"];
            walls?: components["schemas"]["WorkerWalls"] | null;
        };
        /** @description A server that was looked through. */
        SearchedSource: {
            /**
             * @description False while the list is being made, or where the server has more than is listed: ask again,
             *     or search by hand.
             */
            isComplete: boolean;
            listedAt?: components["schemas"]["DateTime"] | null;
            /** @description Reason why they could not be listed. */
            problem?: string | null;
            sourceId: components["schemas"]["SourceId"];
            /** @description Number of its variables. */
            variables: number;
        };
        /** @description Password that a change of the second factor takes. */
        SecondFactorBegin: {
            /** Format: password */
            password: string;
        };
        /** @description A code from the authenticator app. */
        SecondFactorCode: {
            code: string;
        };
        /**
         * @description Proof that a person gives beside the password.
         * @enum {string}
         */
        SecondFactorKind: "CODE" | "PASSKEY";
        /** @description Second factors that a person has. */
        SecondFactorNeeded: {
            /** @description Kinds that are on; a recovery code is good in place of each. */
            kinds: components["schemas"]["SecondFactorKind"][];
            /**
             * @description Options of `navigator.credentials.get` for the person's passkeys: `PublicKeyCredentialRequestOptionsJSON`
             *     of WebAuthn Level 3. Their challenge is good once, for two minutes.
             */
            passkeyOptions?: Record<string, never> | null;
        };
        /** @description New secret for an authenticator app, shown this once. */
        SecondFactorOffer: {
            /** @description SVG image of a QR code with the URI. */
            qrCode: string;
            /** @description The secret in base 32, to type. */
            secret: string;
            /** @description URI `otpauth://...` of the secret, for the app. */
            uri: string;
        };
        /** @description Password and code with which a second factor is removed. */
        SecondFactorRemoval: {
            /** @description A code from the app, or a recovery code. */
            code: string;
            /** Format: password */
            password: string;
        };
        /** @description State of a user's second factor. */
        SecondFactorState: {
            /** @description True if codes of an authenticator app are on. Passkeys are listed by themselves. */
            isOn: boolean;
            /** @description Recovery codes that are left, for codes of an app and passkeys alike. */
            recoveryCodesLeft: number;
        };
        /** @description Choice among a server's endpoints. */
        SecurityChoice: {
            /** @enum {string} */
            choice: "strongest";
        } | {
            /** @enum {string} */
            choice: "none";
        } | {
            /** @enum {string} */
            choice: "exactly";
            /** @description Signed only, or encrypted too. */
            mode: components["schemas"]["MessageSecurity"];
            policy: components["schemas"]["SecurityPolicy"];
        };
        /**
         * @description Security policies (OPC 10000-7) that are not deprecated.
         * @enum {string}
         */
        SecurityPolicy: "None" | "Aes128Sha256RsaOaep" | "Basic256Sha256" | "Aes256Sha256RsaPss";
        /** @description Picks an element of an array or a field of a structure. */
        Select: {
            /** @description Field names and 0-based indexes, as `Axes[2].Position` or `[0]`. */
            path: string;
        };
        /** @description Meaning of a field: one of the names, or an IRI. */
        Semantic: ("PRODUCED_QUANTITY" | "GOOD_QUANTITY" | "SCRAP_QUANTITY" | "PERCENT_COMPLETE" | "OPERATION_STATE" | "ACTUAL_START" | "ACTUAL_END" | "EXPECTED_END") | string;
        /** @description DataSetMessages with the NetworkMessage that contained them. */
        SentView: components["schemas"]["SequenceRange"] & {
            messageId?: components["schemas"]["MessageId"] | null;
        };
        /** @description Sequence numbers of one writer and epoch. */
        SequenceRange: {
            /** Format: int32 */
            dataSetWriterId: number;
            /** Format: int32 */
            epoch: number;
            /** Format: int32 */
            firstSequence: number;
            /** Format: int32 */
            lastSequence: number;
        };
        /** @description A range of consecutive sequence numbers. */
        Sequences: {
            /** Format: int32 */
            firstSequence: number;
            /** Format: int32 */
            lastSequence: number;
        };
        /** @description The members of a series. */
        Series: {
            /**
             * @description Or patterns of numbers, as `1..12` or `1,3,7..9`: the first mapping gets the first number of
             *     each, and so on; a pattern of one number, or another text, is the same for all.
             */
            patterns?: {
                [key: string]: string;
            };
            /** @description The values of the parameters, one set per mapping. */
            sets?: {
                [key: string]: string;
            }[];
        };
        /** @description Finding about a server that does not keep it from being used. */
        ServerFinding: {
            /** @enum {string} */
            code: "hostNameUnknown";
            host: string;
            usedUrl: string;
        } | {
            /** @enum {string} */
            code: "hostNameDiffers";
            host: string;
            usedUrl: string;
        } | {
            /** @enum {string} */
            code: "nothingEncrypted";
            offered: string[];
        } | {
            /** @enum {string} */
            code: "certificateExpired";
            fingerprint: string;
            validTo: components["schemas"]["DateTime"];
        } | {
            /** @enum {string} */
            code: "certificateNotYetValid";
            fingerprint: string;
            validFrom: components["schemas"]["DateTime"];
        } | {
            /** @enum {string} */
            code: "certificateOfOtherHost";
            fingerprint: string;
            host: string;
            hostNames: string[];
        } | {
            applicationUri: string;
            /** @enum {string} */
            code: "certificateOfOtherApplication";
            fingerprint: string;
        } | {
            /** @enum {string} */
            code: "keyTooShort";
            fingerprint: string;
            keyBits: number;
        } | {
            /** @enum {string} */
            code: "signedWithSha1";
            fingerprint: string;
        } | {
            /** Format: int64 */
            aheadMs: number;
            /** @enum {string} */
            code: "clockDiffers";
        };
        /** @description A server's limits (OPC 10000-5 §6.3.2, §6.3.11); `None` where it declares none. */
        ServerLimits: {
            /** Format: int32 */
            browseContinuationPointsMax?: number | null;
            /** Format: int32 */
            itemsPerCallMax?: number | null;
            /** Format: int32 */
            itemsPerSubscriptionMax?: number | null;
            /** Format: int32 */
            nodesPerBrowseMax?: number | null;
            /** Format: int32 */
            nodesPerReadMax?: number | null;
            /** Format: int32 */
            nodesPerWriteMax?: number | null;
            /** Format: int32 */
            pathsPerTranslateMax?: number | null;
            /** Format: int32 */
            subscriptionsPerSessionMax?: number | null;
        };
        /** @description Answer of a server that was asked what it offers. Nothing of it is kept. */
        ServerOffer: {
            /** @description Certificates of these endpoints, each once. */
            certificates: components["schemas"]["OfferedCertificate"][];
            /** @description Endpoints of the server, the strongest that can be used first. */
            endpoints: components["schemas"]["EndpointOffer"][];
            /** @description Findings that a person should know before relying on the server. */
            findings: components["schemas"]["ServerFinding"][];
        };
        /** @description Product behind a server, as it says (OPC 10000-5 §12.4, BuildInfo); empty where it says nothing. */
        ServerProduct: {
            manufacturerName: string;
            productName: string;
            productUri: string;
            softwareVersion: string;
        };
        /** @description Profile of a family of servers. */
        ServerProfile: {
            advised: components["schemas"]["AdvisedIntervals"];
            /** @description Behaviour that is normal for the family. */
            expected: components["schemas"]["ProfileNote"][];
            /** @description Name of the family for programs, as `s7-1500`. */
            family: string;
            figures: components["schemas"]["ProfileFigure"][];
            /** @description Name of the family for people. */
            name: string;
            /** @description Texts of which one occurs in what a server says of itself. */
            recognisedBy: string[];
            /** @description Steps that are taken at the machine. */
            settings: components["schemas"]["ProfileNote"][];
        };
        /** @description Session of a person. */
        Session: {
            /** @description Value of the header `x-csrf-token` that changes need. */
            csrfToken: string;
            role: components["schemas"]["Role"];
            userName: string;
        };
        /**
         * @description Place of a session.
         * @enum {string}
         */
        SessionKind: "PAGE" | "OPC_UA";
        /** @description One setting as a person reads it. */
        Setting: {
            /** @description Default as TOML; none when the setting has no default. */
            default?: string | null;
            /** @description True for a configured value that is not shown. */
            isHidden: boolean;
            /** @description Path of the key, as `web.listen`. */
            key: string;
            /** @description Description for people. */
            meaning: string;
            /** @description Origin of the value: a line of the file or a variable of the environment. */
            origin?: string | null;
            /** @description The section it stands in; empty at the top. */
            section: string;
            /** @description Configured value as TOML; none when the default is used. Secrets are not shown. */
            value?: string | null;
        };
        /**
         * @description Severity of a diagnostic.
         * @enum {string}
         */
        Severity: "hint" | "warning" | "error";
        /** @description A shadow mapping beside the published one. */
        ShadowView: {
            /** @description Name of the person who started it. */
            author: string;
            /** @description Differences to the published mapping; none if there is none. */
            changes: components["schemas"]["MappingChange"][];
            /** @description The shadow mapping. */
            mapping: components["schemas"]["Mapping"];
            published?: components["schemas"]["MappingStatus"] | null;
            startedAt: components["schemas"]["DateTime"];
            status?: components["schemas"]["MappingStatus"] | null;
        };
        /**
         * @description Value in the form that pages show. It is made of one that a gate released:
         *
         *     ```
         *     fn show(released: &disclosure::Released) -> factory_connector::api::ShownValue {
         *         released.into()
         *     }
         *     ```
         *
         *     Any other one takes the proof that it is shown to an operator or engineer:
         *
         *     ```compile_fail,E0277
         *     fn show(value: &asi_model::DataValue) -> factory_connector::api::ShownValue {
         *         value.into()
         *     }
         *     ```
         *
         *     ```compile_fail,E0277
         *     use factory_connector::api::{ShownValue, Viewer};
         *     fn show(value: &asi_model::DataValue, user: &Viewer) -> ShownValue {
         *         ShownValue::before_gate(value, user.into())
         *     }
         *     ```
         *
         *     ```
         *     use factory_connector::api::{Engineer, ShownValue};
         *     fn show(value: &asi_model::DataValue, user: &Engineer) -> ShownValue {
         *         ShownValue::before_gate(value, user.into())
         *     }
         *     ```
         *
         *     Nor is it put together or changed elsewhere:
         *
         *     ```compile_fail,E0616
         *     fn change(shown: &mut factory_connector::api::ShownValue) {
         *         shown.value = 17.into();
         *     }
         *     ```
         */
        ShownValue: {
            sourceTimestamp?: components["schemas"]["DateTime"] | null;
            /** @description The status, by its name where it has one. */
            status: string;
            /** @description The value as plain JSON; 64-bit integers as text; null where there is none. */
            value: components["schemas"]["PlainValue"];
        };
        /** @description User name, password and second factor. */
        SignIn: {
            /** @description A code from the authenticator app or a recovery code, for people with a second factor. */
            code?: string | null;
            /** @description Assertion of a passkey in place of a code: `AuthenticationResponseJSON` of WebAuthn Level 3. */
            passkey?: Record<string, never> | null;
            /** Format: password */
            password: string;
            userName: string;
        };
        /** @description A certificate that the connector shows machines. */
        SourceClientCertificate: components["schemas"]["OwnCertificate"] & {
            /** @description The certificate as PEM, to be handed to the servers' administrators. DER is what it contains in base64. */
            content: string;
        };
        /** @description Certificate that the connector shows machines, and the next one. */
        SourceClientCertificates: {
            /** @description Used for each new session. */
            current: components["schemas"]["SourceClientCertificate"];
            next?: components["schemas"]["SourceClientCertificate"] | null;
        };
        /**
         * @description One OPC UA server to read from. The password is accepted but never serialised; who persists a
         *     source stores [`Password::expose`] apart.
         */
        SourceConfig: {
            /** @description The server's address, `opc.tcp://host:port/path`. */
            endpointUrl: string;
            /** @description Sign-in of the client on the server. */
            identity?: components["schemas"]["Identity"];
            /** @description Name for people. */
            name?: string;
            /**
             * Format: int32
             * @description Publishing interval of the subscriptions, in milliseconds (1 to 60 000).
             */
            publishingIntervalMs?: number;
            /**
             * Format: int32
             * @description Sampling interval of the variables, in milliseconds (0 to 86 400 000; 0: on every change). Absent: the publishing
             *     interval. A mapping may ask for another one.
             */
            samplingIntervalMs?: number | null;
            /** @description Choice among the server's endpoints. */
            security?: components["schemas"]["SecurityChoice"];
            /**
             * @description Sends a user's password over an unprotected connection, too, where everybody on the network can read
             *     it. For servers that offer nothing else.
             */
            sendsPasswordUnprotected?: boolean;
            /**
             * Format: int32
             * @description Milliseconds without any sign of life after which a connection is given up (500 to 600
             *     000).
             */
            silenceMsMax?: number;
            /** @description The source's name, unique in a connector. */
            sourceId: components["schemas"]["SourceId"];
        };
        /** @description Answer of a server, or the problem that it could not be asked. */
        SourceDiscovery: {
            offer?: components["schemas"]["ServerOffer"] | null;
            problem?: components["schemas"]["SourceProblem"] | null;
        };
        /** @description The name of a source: `[A-Za-z0-9_-]{1,64}`. */
        SourceId: string;
        /** @description Problem of a source, with its remedy. */
        SourceProblem: {
            kind: components["schemas"]["SourceProblemKind"];
            message: string;
            /** @description Action that resolves the problem, and the person who takes it. */
            remedy: string;
        };
        /**
         * @description Kinds of problems with a source.
         * @enum {string}
         */
        SourceProblemKind: "unreachable" | "hostNameUnknown" | "nothingListens" | "endpointsHidden" | "noSuitableEndpoint" | "securityOutdated" | "serverCertificateUntrusted" | "serverCertificateInvalid" | "serverKeyTooShort" | "clientCertificateRejected" | "clientCertificateOutOfTime" | "credentialsRejected" | "serverFull" | "connectionLost" | "stalled" | "refused" | "configuration";
        /**
         * @description Progress of a session towards live values.
         * @enum {string}
         */
        SourceState: "connecting" | "subscribing" | "connected" | "waiting";
        /** @description Status of a source, with the evidence. */
        SourceStatus: {
            /**
             * Format: int64
             * @description Changes received since the connector started.
             */
            changes: number;
            /**
             * Format: int64
             * @description Milliseconds by which the server's clock is ahead of the connector's, measured when the
             *     session was established.
             */
            clockAheadMs?: number | null;
            /** @description Inputs of which single changes may not arrive, each with the reason; the first 1000. */
            coarse: components["schemas"]["CoarseInput"][];
            endpoint?: components["schemas"]["ChosenEndpoint"] | null;
            /** @description Family of the server, where it is one that is known. */
            family?: string | null;
            /**
             * @description Number of inputs with a known browse path. They are found again when the server changes its
             *     node ids.
             */
            findable: number;
            granted?: components["schemas"]["GrantedIntervals"] | null;
            /** @description Number of inputs that are monitored on it. */
            inputs: number;
            lastChangeAt?: components["schemas"]["DateTime"] | null;
            lastSignOfLifeAt?: components["schemas"]["DateTime"] | null;
            limits?: components["schemas"]["ServerLimits"] | null;
            /** @description Number of inputs that the server monitors and has sent a first value for. */
            live: number;
            /** @description The inputs that are not live, each with the reason; the first 1000. */
            notLive: components["schemas"]["InputProblem"][];
            problem?: components["schemas"]["SourceProblem"] | null;
            product?: components["schemas"]["ServerProduct"] | null;
            /**
             * Format: int64
             * @description Sessions established since the connector started.
             */
            sessions: number;
            since: components["schemas"]["DateTime"];
            sourceId: components["schemas"]["SourceId"];
            state: components["schemas"]["SourceState"];
        };
        /** @description Findings of a test, or the problem that kept it from a session. */
        SourceTest: {
            problem?: components["schemas"]["SourceProblem"] | null;
            server?: components["schemas"]["TestedServer"] | null;
        };
        /** @description Fields that are disclosed from the values of a source. */
        SourceUse: {
            /** @description Number of the fields. */
            fieldCount: number;
            /** @description The first of them, in the order of their keys. */
            fields: components["schemas"]["FieldKey"][];
        };
        /** @description A source with its configuration and status. */
        SourceView: components["schemas"]["SourceConfig"] & components["schemas"]["SourceStatus"];
        /** @description A state as a JSON value. */
        StateValue: boolean | number | string;
        /** @description A precision as published to the partner. */
        Statement: {
            /** @description The English sentence that the partner gets. */
            statement: string;
            /** @description The same as codes with parameters. */
            statementParts: components["schemas"]["StatementPart"][];
        };
        /**
         * @description Part of a policy as published to the partner: a code with parameters, for texts in another
         *     language.
         */
        StatementPart: {
            /** @enum {string} */
            code: "UNCHANGED";
        } | {
            /** @enum {string} */
            code: "AGGREGATED";
            function: components["schemas"]["AggregateFunction"];
            /**
             * Format: int64
             * @description The window's length in milliseconds.
             */
            windowMs: number;
        } | {
            /** @enum {string} */
            code: "ROUNDED";
            step: components["schemas"]["RoundingStep"];
            /** @description The field's unit. */
            unit?: string | null;
        } | {
            /** @description The bounds, ascending. */
            bounds: number[];
            /** @enum {string} */
            code: "BANDED";
            /** @description The field's unit. */
            unit?: string | null;
        } | {
            /** @enum {string} */
            code: "DIGITS";
            /** Format: int32 */
            digits: number;
        } | {
            /** @enum {string} */
            code: "INTERVAL";
            /**
             * Format: int64
             * @description The interval in milliseconds.
             */
            periodMs: number;
        } | {
            /** @enum {string} */
            code: "RATE";
            /**
             * Format: int64
             * @description The period in milliseconds.
             */
            periodMs: number;
            /** Format: int32 */
            values: number;
        } | {
            /** @enum {string} */
            code: "TIME_STEP";
            /**
             * Format: int64
             * @description The step in milliseconds.
             */
            periodMs: number;
        } | {
            /** @enum {string} */
            code: "DELAYED";
            /**
             * Format: int64
             * @description The delay in milliseconds.
             */
            periodMs: number;
        } | {
            /** @enum {string} */
            code: "HOURS";
            hours: components["schemas"]["WorkingHours"];
        } | {
            /** @enum {string} */
            code: "WITHHELD";
        } | {
            /** @enum {string} */
            code: "STATUS_CODES";
            resolution: components["schemas"]["StatusCodes"];
        };
        /** @description Status of the connector, with evidence. */
        Status: {
            factoryId: string;
            /** @description True where the key that seals passwords lies beside the store, so that a copy of the folder has both. */
            isSealingKeyBesideStore: boolean;
            /** @description Lease to speak for the factory. */
            lease: components["schemas"]["LeaseStatus"];
            /**
             * @description Conflicts with the platform as the witness of the ledger. While there is one, values wait in
             *     the spool.
             */
            ledgerConflicts: components["schemas"]["LedgerConflictStatus"][];
            link?: components["schemas"]["LinkStatus"] | null;
            /** @description Clock of the connector; pages compute ages from it. */
            now: components["schemas"]["DateTime"];
            /** @description Ways to other machines without TLS that the configuration allows. */
            plaintextWays: components["schemas"]["PlaintextWay"][];
            /** @description Worker processes of scripts, with the walls around each. */
            scriptWorkers: components["schemas"]["ScriptWorkerStatus"][];
            /** @description Status of each local server. */
            sources: components["schemas"]["SourceStatus"][];
            /** @description Rows that wait to be sent, or for a receipt. */
            spool: components["schemas"]["Backlog"];
            startedAt: components["schemas"]["DateTime"];
            /** @description OPC UA server. */
            twin: components["schemas"]["TwinStatus"];
            version: string;
        };
        /**
         * Format: int32
         * @description An OPC UA status code: severity in the two highest bits, sub code below, flag bits at the end.
         */
        StatusCode: number;
        /**
         * @description Resolution of the disclosed status codes, from the finest to the coarsest.
         * @enum {string}
         */
        StatusCodes: "FULL" | "COMMON" | "SEVERITY";
        /**
         * @description One function of a chain. In JSON an object with `function` and the parameters.
         *
         *     A function gets the value the one before it yielded, and may keep it to itself: then the
         *     chain ends there until the next value.
         */
        Step: (components["schemas"]["Select"] & {
            /** @enum {string} */
            function: "select";
        }) | (components["schemas"]["Constant"] & {
            /** @enum {string} */
            function: "constant";
        }) | (components["schemas"]["Convert"] & {
            /** @enum {string} */
            function: "convert";
        }) | (components["schemas"]["Scale"] & {
            /** @enum {string} */
            function: "scale";
        }) | (components["schemas"]["UnitConversion"] & {
            /** @enum {string} */
            function: "unitConversion";
        }) | (components["schemas"]["Increment"] & {
            /** @enum {string} */
            function: "increment";
        }) | (components["schemas"]["Counter"] & {
            /** @enum {string} */
            function: "counter";
        }) | (components["schemas"]["Edge"] & {
            /** @enum {string} */
            function: "edge";
        }) | (components["schemas"]["Threshold"] & {
            /** @enum {string} */
            function: "threshold";
        }) | (components["schemas"]["Debounce"] & {
            /** @enum {string} */
            function: "debounce";
        }) | (components["schemas"]["Deadband"] & {
            /** @enum {string} */
            function: "deadband";
        }) | (components["schemas"]["Rate"] & {
            /** @enum {string} */
            function: "rate";
        }) | (components["schemas"]["Window"] & {
            /** @enum {string} */
            function: "window";
        }) | (components["schemas"]["Lookup"] & {
            /** @enum {string} */
            function: "lookup";
        }) | (components["schemas"]["Enumeration"] & {
            /** @enum {string} */
            function: "enumeration";
        }) | (components["schemas"]["Bit"] & {
            /** @enum {string} */
            function: "bit";
        }) | (components["schemas"]["BitTexts"] & {
            /** @enum {string} */
            function: "bitTexts";
        }) | (components["schemas"]["Format"] & {
            /** @enum {string} */
            function: "format";
        }) | (components["schemas"]["Parse"] & {
            /** @enum {string} */
            function: "parse";
        }) | (components["schemas"]["Expression"] & {
            /** @enum {string} */
            function: "expression";
        }) | (components["schemas"]["Merge"] & {
            /** @enum {string} */
            function: "merge";
        }) | (components["schemas"]["Script"] & {
            /** @enum {string} */
            function: "script";
        });
        /** @description Result of one function. */
        StepView: {
            /** @description Name of the function. */
            function: string;
            kind?: components["schemas"]["FaultKind"] | null;
            /** @description Text of its fault; none if it succeeded. */
            message?: string | null;
            value?: components["schemas"]["ShownValue"] | null;
        };
        /** @description A cap with its new version, and the fields that it held back. */
        StoredCap: components["schemas"]["DocumentVersion"] & {
            /** @description Fields whose consents ended so that all caps hold. */
            heldBack: components["schemas"]["FieldKey"][];
        };
        /** @description A comment as it was made. */
        StoredComment: {
            authorId: string;
            /** @description The request it is about; none for the whole network. */
            dynamicDataRequestId?: string | null;
            /** @description The field it is about; none for the whole request. */
            fieldName?: string | null;
            /**
             * Format: int64
             * @description Number of the comment at this connector, counting up in the order of arrival.
             */
            id: number;
            /** @description True if it was made at this factory. */
            isOwn: boolean;
            text: string;
            writtenAt: components["schemas"]["DateTime"];
        };
        /** @description A decision about the past: who decided what, when and why. */
        StoredPastDecision: {
            decidedAt: components["schemas"]["DateTime"];
            decidedBy: string;
            /** @description Number of the decision, as text. */
            id: string;
            /** @description True where reports of the past are shown to it. */
            isReleased: boolean;
            reason?: string | null;
            /** @description The recipient that was added. */
            recipientId: components["schemas"]["OrganisationId"];
            /**
             * Format: int64
             * @description Number of reports that are shown.
             */
            reportCount: number;
            request: components["schemas"]["RequestKey"];
            /** @description Root over their values, hexadecimal, as the ledger commits to them; none where none is shown. */
            root?: string | null;
        };
        /** @description A receipt with its signature, and the arrivals since of reports that were on their way. */
        StoredRevocation: components["schemas"]["RevocationReceipt"] & {
            /**
             * Format: int32
             * @description Reports that were on their way when the consent ended, of which the platform has said since
             *     that it holds them.
             */
            arrivedSince: number;
            /**
             * Format: int32
             * @description Reports of which it is still not known whether they arrived.
             */
            open: number;
            /** @description The key it is verified with, hexadecimal. */
            publicKey: string;
            /** @description The Ed25519 signature over that text, hexadecimal. */
            signature: string;
            /** @description The exact text that was signed. */
            signedText: string;
        };
        /** @description A variable that might be meant. */
        SuggestedVariable: components["schemas"]["Suggestion"] & {
            /** @description Description by the server. */
            description?: string | null;
            /** @description Mapping to decide with. */
            mapping: components["schemas"]["MappingDraft"];
            /** @description Its unit, as people see it. */
            unit?: string | null;
            value?: components["schemas"]["ShownValue"] | null;
            valueType?: components["schemas"]["TypeName"] | null;
        };
        /** @description A variable that might be meant. */
        Suggestion: {
            /** @description Node id with its namespace's URI. */
            nodeId: components["schemas"]["NodeId"];
            /** @description Names down to the variable, joined by `/`. */
            place: string;
            /** @description Evidence, the weightiest first. */
            reasons: components["schemas"]["Reason"][];
            /**
             * Format: int32
             * @description 20 to 100.
             */
            score: number;
            /** @description Source of the variable. */
            sourceId: components["schemas"]["SourceId"];
            /** @description The functions it would need. */
            steps: components["schemas"]["Step"][];
        };
        /** @description Variables that might be meant, best first, and where they were looked for. */
        Suggestions: {
            /** @description The variables; none is used before a person decides. */
            items: components["schemas"]["SuggestedVariable"][];
            /** @description The servers that were looked through. */
            sources: components["schemas"]["SearchedSource"][];
        };
        /** @description A mapping with the health that it is listed under. */
        SurveyedMapping: {
            /** @description Health from which its rank follows. */
            health: components["schemas"]["MappingHealth"];
            /** @description Counters, inputs and last candidate. */
            status: components["schemas"]["MappingStatus"];
        };
        /**
         * @description The JSON of a mapping with placeholders: any object, since a placeholder may stand in the place
         *     of a number or of a truth value.
         */
        TemplateContent: {
            [key: string]: unknown;
        };
        /** @description Draft of a template of a field's mapping. */
        TemplateDraft: {
            /** @description Name for people. */
            name?: string | null;
            /** @description Parameters and the texts that they replace in this mapping, as `machine` for `Press1`. */
            parameters: {
                [key: string]: string;
            };
            /** @description Its id: letters, digits, `_` and `-`. */
            templateId: string;
        };
        /** @description Placeholder in the documents of a template. */
        TemplateParameter: {
            /** @description Value where none is given. */
            default?: string | null;
            /** @description Meaning, for people. */
            description?: string | null;
            /** @description Its name within `${...}`. */
            name: string;
        };
        /** @description A stored template. */
        TemplateView: components["schemas"]["MappingTemplate"] & {
            /** @description Name of the person who changed it last. */
            author: string;
            changedAt: components["schemas"]["DateTime"];
        };
        /** @description Findings of a session that was opened as a source would, and closed again. */
        TestedServer: {
            /**
             * Format: int64
             * @description Milliseconds by which the server's clock is ahead of the connector's.
             */
            clockAheadMs?: number | null;
            endpoint: components["schemas"]["ChosenEndpoint"];
            /** @description Family of the server, where it is one that is known. */
            family?: string | null;
            /** @description Findings that a person should know before relying on the server. */
            findings: components["schemas"]["ServerFinding"][];
            /** @description The server's limits as it declares them. */
            limits: components["schemas"]["ServerLimits"];
            product: components["schemas"]["ServerProduct"];
            /**
             * Format: int64
             * @description Publishing interval that the server grants where that of the source is requested, in milliseconds; absent where it
             *     refuses a subscription.
             */
            publishingIntervalMs?: number | null;
        };
        /** @description Comparison of a number with a limit, with hysteresis. */
        Threshold: {
            above?: components["schemas"]["Literal"] | null;
            below?: components["schemas"]["Literal"] | null;
            /** @description At or above this it is above. */
            limit: components["schemas"]["Number"];
            release?: components["schemas"]["Number"] | null;
        };
        /** @description A partner's tool that asks for data and receives reports. */
        ToolId: string;
        /** @description Result of a dry run. */
        Trace: {
            /** @description All diagnostics of the mapping; with an error there are no runs. */
            diagnostics: components["schemas"]["MappingDiagnostic"][];
            /** @description One run per sample, and per timer that ran out in between. */
            runs: components["schemas"]["TraceRun"][];
        };
        /** @description One run of the chain. */
        TraceRun: {
            /** @description Time of the run by the local clock. */
            at: components["schemas"]["DateTime"];
            candidate?: components["schemas"]["TracedValue"] | null;
            fault?: components["schemas"]["TracedFault"] | null;
            /** @description The input that changed; absent where time passed. */
            input?: string | null;
            /** @description Results of the functions, as far as the chain got. */
            steps: components["schemas"]["TraceStep"][];
            value?: components["schemas"]["TracedValue"] | null;
        };
        /** @description Result of one function on one value. */
        TraceStep: {
            fault?: components["schemas"]["TracedFault"] | null;
            /** @description Name of the function, as in JSON. */
            function: string;
            /** @description Index of the function. */
            step: number;
            value?: components["schemas"]["TracedValue"] | null;
        };
        /** @description Fault of a function. */
        TracedFault: {
            /**
             * Format: int32
             * @description The column in the script, from 1.
             */
            column?: number | null;
            /** @description Kind, for programs. */
            kind: components["schemas"]["FaultKind"];
            /**
             * Format: int32
             * @description The line in the script, from 1.
             */
            line?: number | null;
            /** @description Sentence that names the fault. */
            message: string;
        };
        /**
         * @description A value for people: 64-bit integers as text, arrays cut after 256 elements, structures as
         *     objects.
         */
        TracedValue: {
            serverTimestamp?: components["schemas"]["DateTime"] | null;
            sourceTimestamp?: components["schemas"]["DateTime"] | null;
            /**
             * Format: int32
             * @description The status code.
             */
            status: number;
            /** @description The status' name, where it is a well-known one. */
            statusName?: string | null;
            type?: components["schemas"]["TypeName"] | null;
            /** @description Value as plain JSON. */
            value: components["schemas"]["PlainValue"];
        };
        /** @description Approval of a server's certificate. */
        TrustBody: {
            /** @description True: connections to the server are allowed. */
            isTrusted: boolean;
        };
        /** @description A file for the trust list. */
        TrustFileBody: {
            /** @description Its content: PEM, or DER in base64. One certificate or list. */
            content: string;
            kind: components["schemas"]["TrustFileKind"];
        };
        /**
         * @description Kind of a file for the trust list.
         * @enum {string}
         */
        TrustFileKind: "CERTIFICATE" | "ISSUER" | "REVOCATION_LIST";
        /**
         * @description Trust in a server's certificate.
         * @enum {string}
         */
        TrustState: "trusted" | "rejected";
        /** @description OPC UA server of the connector. */
        TwinStatus: {
            /** @description Address for clients; none while it does not listen. */
            endpointUrl?: string | null;
        };
        /**
         * @description An OPC UA built-in type by its name.
         * @enum {string}
         */
        TypeName: "Boolean" | "SByte" | "Byte" | "Int16" | "UInt16" | "Int32" | "UInt32" | "Int64" | "UInt64" | "Float" | "Double" | "String" | "DateTime" | "Guid" | "ByteString" | "XmlElement" | "NodeId" | "ExpandedNodeId" | "StatusCode" | "QualifiedName" | "LocalizedText" | "ExtensionObject" | "DataValue" | "Variant" | "DiagnosticInfo";
        /** @description Conversion of one unit of measurement to another of the same kind, by UNECE codes. */
        UnitConversion: {
            /** @description The unit that comes in; the first input's unit where absent. */
            from?: string | null;
            /** @description The unit that goes out; the target's unit where absent. */
            to?: string | null;
        };
        /** @description A unit as the server gives it. */
        UnitName: {
            /** @description The UNECE code behind it (`C16`), where the unit is one of them. */
            code?: string | null;
            /** @description Symbol for people: `mm/s`. */
            displayName: string;
        };
        /**
         * @description The period of an update frequency.
         * @enum {string}
         */
        UpdateFrequencyUnit: "SECOND" | "MINUTE" | "HOUR" | "DAY" | "WEEK";
        /** @description Role and password of a user. */
        UserBody: {
            /**
             * Format: password
             * @description At least ten characters; needed for a new person, unchanged without it.
             */
            password?: string | null;
            role: components["schemas"]["Role"];
        };
        /** @description A person who may sign in. */
        UserView: {
            role: components["schemas"]["Role"];
            userName: string;
        };
        /**
         * @description Source of a mapped field's values.
         * @enum {string}
         */
        ValueSource: "MAPPING" | "MANUAL" | "EXTERNAL";
        /** @description A variable of a local OPC UA server. */
        VariableKey: {
            /** @description The variable, with its namespace's URI. */
            nodeId: components["schemas"]["NodeId"];
            /** @description The local server. */
            sourceId: components["schemas"]["SourceId"];
        };
        /** @description Information about a variable, in all fields that rest on it. */
        VariableLeak: {
            /**
             * Format: double
             * @description Most bits per hour in these fields; none when one of them has no limit.
             */
            bitsPerHourMax?: number | null;
            /**
             * @description The fields that rest on it: with it as an input of their mapping, or withheld by the state of
             *     such a field.
             */
            fields: components["schemas"]["FieldKey"][];
            /**
             * Format: double
             * @description Most values per hour in these fields; none when one of them has no limit.
             */
            valuesPerHourMax?: number | null;
            variable: components["schemas"]["VariableKey"];
        };
        /** @description Variables to read. */
        VariablesBody: {
            /** @description Node ids of the variables, at most 100. */
            nodes: components["schemas"]["NodeId"][];
        };
        /** @description Result of a verification. */
        Verification: {
            /**
             * Format: int64
             * @description Number of verified checkpoints.
             */
            checkpoints: number;
            /**
             * Format: int64
             * @description Number of verified entries.
             */
            entries: number;
            /**
             * Format: int64
             * @description Number of entries that retention has removed, by the signed anchors.
             */
            entriesPruned: number;
            /**
             * Format: int64
             * @description Number of all faults.
             */
            faultCount: number;
            /** @description The first hundred faults. */
            faultList: components["schemas"]["LedgerFault"][];
            /**
             * @description The public key of all signatures, hexadecimal; to be compared with a copy outside of the
             *     connector.
             */
            publicKey?: string | null;
            /**
             * Format: int64
             * @description Number of verified receipts of ended consents.
             */
            revocations: number;
            /**
             * Format: int64
             * @description Number of entries that were compared with the values that they commit to.
             */
            valuesCompared: number;
            /**
             * Format: int64
             * @description Number of entries whose values retention has emptied.
             */
            valuesEmptied: number;
        };
        /** @description The outcome of a verification. */
        VerificationView: components["schemas"]["Verification"] & {
            /** @description Number of chains. */
            chains: number;
            /** @description The first thing that is wrong, in words. */
            fault?: string | null;
            /** @description True where nothing is wrong. */
            valid: boolean;
        };
        /** @description A published mapping. */
        VersionView: {
            /** @description Name of the person who published it. */
            author?: string | null;
            /** @description Differences to the version before; none for the oldest. */
            changes: components["schemas"]["MappingChange"][];
            /** @description True for the mapping that is published now. */
            isCurrent: boolean;
            mapping: components["schemas"]["Mapping"];
            /** @description Origin, if not the editor. */
            note?: string | null;
            publishedAt: components["schemas"]["DateTime"];
            /**
             * Format: int32
             * @description Number, from 1.
             */
            version: number;
        };
        /** @description A document with its version, author and time. */
        Versioned_Alliance: components["schemas"]["DocumentVersion"] & {
            /** @description True when its members are no longer assumed to tell each other. */
            isRetired?: boolean;
            /** @description The organisations, 2 to 100. */
            memberList: components["schemas"]["OrganisationId"][];
            /** @description Name for people, 1 to 120 characters. */
            name: string;
        } & {
            changedAt: components["schemas"]["DateTime"];
            /** @description User of the last change. */
            changedBy: string;
        };
        /** @description A document with its version, author and time. */
        Versioned_Cap: components["schemas"]["DocumentVersion"] & {
            /**
             * Format: double
             * @description Most bits per hour, 0 to 1e15. With 0 nothing is disclosed.
             */
            bitsPerHourMax: number;
            /** @description True when it no longer limits anything. */
            isRetired?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
            subject: components["schemas"]["CapSubject"];
            variable?: components["schemas"]["VariableKey"] | null;
        } & {
            changedAt: components["schemas"]["DateTime"];
            /** @description User of the last change. */
            changedBy: string;
        };
        /** @description A document with its version, author and time. */
        Versioned_NamedPolicy: components["schemas"]["DocumentVersion"] & {
            disclosure: components["schemas"]["DisclosurePolicy"];
            /** @description True when it is no longer offered or applied. */
            isRetired?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
        } & {
            changedAt: components["schemas"]["DateTime"];
            /** @description User of the last change. */
            changedBy: string;
        };
        /** @description A document with its version, author and time. */
        Versioned_Rule: components["schemas"]["DocumentVersion"] & {
            action: components["schemas"]["RuleAction"];
            disclosure?: components["schemas"]["DisclosurePolicy"] | null;
            /** @description True when it is applied to new requests. */
            isEnabled?: boolean;
            /** @description Name for people, 1 to 120 characters. */
            name: string;
            policyId?: components["schemas"]["DocumentId"] | null;
            /** @description Reason for the partner, with `REFUSE`. */
            reason?: string | null;
            valueSource?: components["schemas"]["ValueSource"] | null;
            /** @description Selection of fields. */
            when: components["schemas"]["RuleCondition"];
        } & {
            changedAt: components["schemas"]["DateTime"];
            /** @description User of the last change. */
            changedBy: string;
        };
        /**
         * @description A day of the week.
         * @enum {string}
         */
        Weekday: "MONDAY" | "TUESDAY" | "WEDNESDAY" | "THURSDAY" | "FRIDAY" | "SATURDAY" | "SUNDAY";
        /**
         * @description An aggregate over the last values (`samples`) or the last span of time (`durationMs`); exactly
         *     one of the two. Over time it also changes when values leave the window. At most 4096 values are
         *     kept; beyond, the oldest leave early.
         */
        Window: {
            /** @description Function over the values in the window. */
            aggregate: components["schemas"]["Aggregate"];
            /**
             * Format: int64
             * @description Span back from the newest value, in milliseconds.
             */
            durationMs?: number | null;
            /**
             * Format: int32
             * @description Number of values.
             */
            samples?: number | null;
        };
        /** @description An aggregate over windows. */
        WindowAggregate: {
            function: components["schemas"]["AggregateFunction"];
            /**
             * Format: int64
             * @description Length of a window in milliseconds.
             */
            windowMs: number;
        };
        /**
         * @description Condition that withholds a field: while a value is in one of these states, no value of the field
         *     is released, and candidates of that time never are.
         */
        WithholdCondition: {
            field?: components["schemas"]["FieldName"] | null;
            /** @description The states: texts, numbers or truth values. */
            states: components["schemas"]["StateValue"][];
        };
        /** @description A checkpoint with the signature of the platform. */
        WitnessedView: {
            /** @description The checkpoint, a C2SP signed note. */
            checkpoint: string;
            cosignedAt: components["schemas"]["DateTime"];
            /**
             * Format: int64
             * @description Number of leaves that the platform holds; 0 where it has lost them.
             */
            size: number;
            /** @description The platform's key as a witness: name, id and key. */
            witnessKey: string;
        };
        /**
         * @description Scripts that a worker runs.
         * @enum {string}
         */
        WorkerPurpose: "mappings" | "dryRuns";
        /** @description Walls around a worker process. */
        WorkerWalls: {
            /** @description True where memory, files and processes are bounded. */
            hasLimits: boolean;
            /** @description True where it runs as another user than the connector. */
            hasOwnUser: boolean;
            /** @description True where the kernel filters its system calls. */
            isFiltered: boolean;
            /** @description Rules of Landlock that deny files, network and other processes. */
            landlock: components["schemas"]["LandlockState"];
            /**
             * Format: int32
             * @description User that it runs as.
             */
            userId: number;
        };
        /**
         * @description Hours in which values may be released. Of changes outside of them, the newest is released when
         *     they begin.
         */
        WorkingHours: {
            days: components["schemas"]["Weekday"][];
            /** @description The first minute, `HH:MM`. */
            from: components["schemas"]["ClockTime"];
            /** @description The first minute after them, `HH:MM`; later than `from`. */
            until: components["schemas"]["ClockTime"];
            /**
             * Format: int32
             * @description Offset of the plant's clock from UTC, in minutes; positive to the east.
             */
            utcOffsetMinutes?: number;
        };
    };
    responses: {
        /** @description The request cannot be understood. */
        BadRequest: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description The call does not fit the present state. */
        Conflict: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description The role does not allow it, or the CSRF token is wrong. */
        Forbidden: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description The resource does not exist. */
        NotFound: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description A part that is needed is not there at the moment. */
        ServiceUnavailable: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description Too many requests, downloads or live streams at once. */
        TooManyRequests: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description No user is signed in. */
        Unauthorized: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
        /** @description Understood, but wrong in its meaning; each fault with its JSON pointer. */
        UnprocessableEntity: {
            headers: {
                [name: string]: unknown;
            };
            content: {
                "application/problem+json": components["schemas"]["Problem"];
            };
        };
    };
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type $defs = Record<string, never>;
export interface operations {
    listAlliances: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Versioned_Alliance"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putAlliance: {
        parameters: {
            query?: never;
            header?: {
                "If-Match"?: string | null;
            };
            path: {
                allianceId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Alliance"];
            };
        };
        responses: {
            /** @description One version of a policy or rule. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DocumentVersion"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listAllianceVersions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                allianceId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Versioned_Alliance"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showApplicationCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description The certificate that the OPC UA server shows its clients. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ApplicationCertificateView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    installApplicationCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["IssuedCertificateBody"];
            };
        };
        responses: {
            /** @description The certificate that the OPC UA server shows its clients. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ApplicationCertificateView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    requestApplicationCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CertificateRequestBody"];
            };
        };
        responses: {
            /** @description A request to be given to an authority. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["CertificateRequestView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listCaps: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_CapView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putCap: {
        parameters: {
            query?: never;
            header?: {
                "If-Match"?: string | null;
            };
            path: {
                capId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Cap"];
            };
        };
        responses: {
            /** @description A cap with its new version, and the fields that it held back. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StoredCap"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    previewCap: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                capId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Cap"];
            };
        };
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_FieldToHoldBack"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listCapVersions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                capId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Versioned_Cap"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listClientAuthorities: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_ClientAuthorityView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    removeClientAuthority: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                thumbprint: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listClientCertificates: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_ClientCertificateView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addClientCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["TrustFileBody"];
            };
        };
        responses: {
            /** @description Added */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    trustClientCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                thumbprint: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ClientTrustBody"];
            };
        };
        responses: {
            /** @description A certificate that the OPC UA server has seen or was given. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ClientCertificateView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listClientRevocationLists: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_ClientRevocationListView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    removeClientRevocationList: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                revocationListId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showConfiguration: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Setting"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listDeadLetters: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before. */
                cursor?: string;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_DeadLetter"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    streamEvents: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Live event: `event` is its name, `data` says what changed. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/event-stream": components["schemas"]["LiveEvent"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showField: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A requested field with its decision and value. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FieldView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showConsentOffer: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Disclosure that the consent for a field begins with. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ConsentOffer"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    decideField: {
        parameters: {
            query?: never;
            header?: {
                "If-Match"?: string | null;
            };
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DecisionBody"];
            };
        };
        responses: {
            /** @description A requested field with its decision and value. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FieldView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showMappingStatus: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Status of a mapping, for its page. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MappingStatus"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    restartMapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Status of a mapping, for its page. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MappingStatus"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    previewDecision: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Draft"];
            };
        };
        responses: {
            /** @description Side by side: machine, mapping, what is disclosed, and the message. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Preview"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showShadowMapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A shadow mapping beside the published one. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ShadowView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    startShadowMapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["MappingDraft"];
            };
        };
        responses: {
            /** @description A shadow mapping beside the published one. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ShadowView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    endShadowMapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Ended */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    publishShadowMapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A requested field with its decision and value. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FieldView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listSuggestions: {
        parameters: {
            query?: {
                /** @description At most so many, up to 100; 10 without it. */
                limit?: number;
            };
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Variables that might be meant, best first, and where they were looked for. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Suggestions"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    makeMappingTemplate: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["TemplateDraft"];
            };
        };
        responses: {
            /** @description A mapping with gaps. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MappingTemplate"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    dryRunMapping: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DryRunBody"];
            };
        };
        responses: {
            /** @description Result of a dry run. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DryRun"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    enterValue: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["EnteredValue"];
            };
        };
        responses: {
            /** @description Outcome of an entered value. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Entered"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    compareMappingVersions: {
        parameters: {
            query: {
                /** @description The earlier version. */
                from: number;
                /** @description The later version; the present mapping without it. */
                to?: number;
            };
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Difference between two versions. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Difference"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listMappingVersions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_VersionView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    rollMappingBack: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
                fieldName: components["schemas"]["FieldName"];
                version: number;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A requested field with its decision and value. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FieldView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listInbox: {
        parameters: {
            query?: {
                /**
                 * @description `nextCursor` of the page before. Requests behind its last one follow, also if others came or
                 *     went meanwhile.
                 */
                cursor?: string;
                /** @description Requests per page, at most 200. */
                limit?: number;
                /** @description Requests with a field in this state: `PENDING`, `MAPPED` or `REFUSED`. */
                state?: components["schemas"]["MappingState"];
                /** @description Requests of this requester. */
                partner?: string;
                /** @description Requests of this network. */
                operationNetworkId?: string;
                /** @description Requests in whose ids, names, purpose, fields or partners all these words occur. */
                search?: string;
                /** @description Requests that have been open for longer than the time after which the inbox reminds. */
                isOverdue?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of the inbox, and totals. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["InboxPage"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listLeakBudgets: {
        parameters: {
            query?: {
                /** @description One organisation only. */
                partner?: string;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_PartnerLeaks"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listAllianceBudgets: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_AllianceLeaks"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    summariseLeakBudgets: {
        parameters: {
            query?: {
                /** @description One organisation only. */
                partner?: string;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_PartnerSummary"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listLedgerEntries: {
        parameters: {
            query?: {
                /** @description Entries of this recipient's chain. */
                recipient?: components["schemas"]["OrganisationId"];
                /** @description Entries recorded at this time or later. */
                from?: components["schemas"]["DateTime"];
                /** @description Entries recorded before this time. */
                until?: components["schemas"]["DateTime"];
                /**
                 * @description Entries of this kind: `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED`, `PURGED` or
                 *     `REVOKED`.
                 */
                kind?: "CONSENT" | "QUEUED" | "SENT" | "RECEIPTED" | "COALESCED" | "EXPIRED" | "PURGED" | "REVOKED" | "RETENTION" | "PAST_RELEASED";
                /**
                 * @description Entries about this network: decisions about its fields, reports that carried them, and the
                 *     delivery of those.
                 */
                operationNetworkId?: components["schemas"]["OperationNetworkId"];
                /** @description Restriction to entries about this operation. */
                operationId?: components["schemas"]["OperationId"];
                /** @description Restriction to entries about this request. */
                dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"];
                /** @description Restriction to entries about this field. */
                fieldName?: components["schemas"]["FieldName"];
                /** @description `nextCursor` of the page before. */
                after?: string;
                /** @description Entries on the page, 1 to 500; 100 without it. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Entries of one chain, newest first. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["LedgerView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listCheckpoints: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before. */
                cursor?: string;
                /** @description Checkpoints per page, at most 200; 20 without it. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_CheckpointView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    exportLedger: {
        parameters: {
            query: {
                /** @description Entries of this recipient's chain. */
                recipient?: components["schemas"]["OrganisationId"];
                /** @description Entries recorded at this time or later. */
                from?: components["schemas"]["DateTime"];
                /** @description Entries recorded before this time. */
                until?: components["schemas"]["DateTime"];
                /**
                 * @description Entries of this kind: `CONSENT`, `QUEUED`, `SENT`, `RECEIPTED`, `COALESCED`, `EXPIRED`, `PURGED` or
                 *     `REVOKED`.
                 */
                kind?: "CONSENT" | "QUEUED" | "SENT" | "RECEIPTED" | "COALESCED" | "EXPIRED" | "PURGED" | "REVOKED" | "RETENTION" | "PAST_RELEASED";
                /**
                 * @description Entries about this network: decisions about its fields, reports that carried them, and the
                 *     delivery of those.
                 */
                operationNetworkId?: components["schemas"]["OperationNetworkId"];
                /** @description Restriction to entries about this operation. */
                operationId?: components["schemas"]["OperationId"];
                /** @description Restriction to entries about this request. */
                dynamicDataRequestId?: components["schemas"]["DynamicDataRequestId"];
                /** @description Restriction to entries about this field. */
                fieldName?: components["schemas"]["FieldName"];
                /** @description `jsonl`, `csv` or `html`. */
                format: "jsonl" | "csv" | "html";
                /** @description Language of a page to print: `en` or `de`. */
                language?: "en" | "de";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description OK */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/csv": string;
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    searchLedgerFields: {
        parameters: {
            query?: {
                /** @description Fields in whose ids all these words occur. */
                search?: string;
                /** @description Most fields, at most 200; 20 without it. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_LedgerField"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listLedgerLogs: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_LogView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    beginLedgerLog: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                recipientId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewLogBody"];
            };
        };
        responses: {
            /** @description Log of a chain, which others check with one checkpoint that they kept. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["LogView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    verifyLedger: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description The outcome of a verification. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["VerificationView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listMappingTemplates: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_TemplateView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putMappingTemplate: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                templateId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["MappingTemplate"];
            };
        };
        responses: {
            /** @description A mapping with gaps. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MappingTemplate"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    removeMappingTemplate: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                templateId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    fillMappingTemplate: {
        parameters: {
            query?: {
                /** @description True to change nothing and return the outcome that there would be. */
                dryRun?: boolean;
            };
            header?: never;
            path: {
                templateId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Series"];
            };
        };
        responses: {
            /** @description Outcome of an import, or of its dry run. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ImportOutcome"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    exportMappings: {
        parameters: {
            query?: {
                /** @description `file` (the default) or `csv`. */
                form?: "file" | "csv";
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Mappings and templates as one JSON document. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MappingFile"];
                    "text/csv": string;
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    importMappings: {
        parameters: {
            query?: {
                /** @description True to change nothing and return the outcome that there would be. */
                dryRun?: boolean;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["MappingFile"];
                "text/csv": string;
            };
        };
        responses: {
            /** @description Outcome of an import, or of its dry run. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["ImportOutcome"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    surveyMappings: {
        parameters: {
            query?: {
                /** @description Mappings in this condition only. */
                health?: components["schemas"]["MappingHealth"];
                /** @description Up to 500; 50 without it, none with 0. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Health of the published mappings, without shadow mappings. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["MappingSurvey"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listOperationNetworks: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_NetworkSummary"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showOperationNetwork: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A network with its requests. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["NetworkView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listComments: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_StoredComment"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addComment: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewComment"];
            };
        };
        responses: {
            /** @description Stored and queued */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showRevisionDifference: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Difference between the revision in force and the one before. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RevisionDifference"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listOperatorEntries: {
        parameters: {
            query: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_OperatorEntry"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    deliverOperatorEntries: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["EntryDelivery"];
            };
        };
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_EntryResult"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listOperatorOperations: {
        parameters: {
            query?: {
                /** @description Begin of the day; that of the present day in UTC without it. */
                from?: components["schemas"]["DateTime"];
                /** @description End of the day; 24 hours after its begin without it. */
                until?: components["schemas"]["DateTime"];
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_OperatorOperation"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listPastDecisions: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before. */
                cursor?: number;
                /** @description Decisions per page, at most 50. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_StoredPastDecision"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    decidePast: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PastDecisionBody"];
            };
        };
        responses: {
            /** @description A decision about the past that was stored. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DecidedPast"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listPastOffers: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_PastOfferView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listPolicies: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_PolicyView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putPolicy: {
        parameters: {
            query?: never;
            header?: {
                "If-Match"?: string | null;
            };
            path: {
                policyId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NamedPolicy"];
            };
        };
        responses: {
            /** @description One version of a policy or rule. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DocumentVersion"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    previewPolicy: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                policyId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NamedPolicy"];
            };
        };
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_PolicyUse"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listPolicyVersions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                policyId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Versioned_NamedPolicy"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listRecipients: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_RecipientView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putRecipientPolicy: {
        parameters: {
            query?: never;
            header?: {
                "If-Match"?: string | null;
            };
            path: {
                recipient: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RecipientBody"];
            };
        };
        responses: {
            /** @description Version of a recipient's policy. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RecipientVersion"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showRequest: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                operationNetworkId: components["schemas"]["OperationNetworkId"];
                operationId: components["schemas"]["OperationId"];
                dynamicDataRequestId: components["schemas"]["DynamicDataRequestId"];
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A request of a partner. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RequestView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listRevocations: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before. */
                cursor?: string;
                /** @description Receipts per page, at most 50. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_StoredRevocation"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    revokeConsents: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["RevocationBody"];
            };
        };
        responses: {
            /** @description A receipt with its signature, and the arrivals since of reports that were on their way. */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StoredRevocation"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showRevocation: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                revocationId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A receipt with its signature, and the arrivals since of reports that were on their way. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["StoredRevocation"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    printRevocation: {
        parameters: {
            query?: {
                /** @description `en` or `de`. */
                language?: "en" | "de";
            };
            header?: never;
            path: {
                revocationId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description OK */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "text/html": string;
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listRuleDecisions: {
        parameters: {
            query?: {
                /** @description `nextCursor` of the page before. */
                cursor?: string;
                /** @description Decisions per page, at most 100. */
                limit?: number;
            };
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_RuleDecision"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    undoRuleDecision: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                id: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Undone */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listRules: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Versioned_Rule"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    applyRules: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Result of applying the rules. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Applied"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    previewRule: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Rule"];
            };
        };
        responses: {
            /** @description Matches of a draft of a rule. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RulePreview"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putRule: {
        parameters: {
            query?: never;
            header?: {
                "If-Match"?: string | null;
            };
            path: {
                ruleId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Rule"];
            };
        };
        responses: {
            /** @description One version of a policy or rule. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["DocumentVersion"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listRuleVersions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                ruleId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_Versioned_Rule"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listServerProfiles: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_ServerProfile"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showSession: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Session of a person. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    signIn: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SignIn"];
            };
        };
        responses: {
            /** @description Session of a person. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    signOut: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Signed out */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listPasskeys: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Passkeys of a person, the oldest first. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PasskeyList"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addPasskey: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewPasskey"];
            };
        };
        responses: {
            /**
             * @description Codes that sign in once each when app or passkey is lost; shown this once. None where the person has
             *     codes of before, which stay good.
             */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RecoveryCodes"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    beginPasskey: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PasskeyBegin"];
            };
        };
        responses: {
            /** @description Options with which a browser makes a passkey. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PasskeyOffer"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    removePasskey: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                passkeyId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PasskeyRemoval"];
            };
        };
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    changePassword: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PasswordChange"];
            };
        };
        responses: {
            /** @description Changed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description State of a user's second factor. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SecondFactorState"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    confirmSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SecondFactorCode"];
            };
        };
        responses: {
            /**
             * @description Codes that sign in once each when app or passkey is lost; shown this once. None where the person has
             *     codes of before, which stay good.
             */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["RecoveryCodes"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    beginSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SecondFactorBegin"];
            };
        };
        responses: {
            /** @description New secret for an authenticator app, shown this once. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SecondFactorOffer"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    removeSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SecondFactorRemoval"];
            };
        };
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            /** @description Too many attempts were made. */
            429: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/problem+json": components["schemas"]["Problem"];
                };
            };
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listSessions: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_PersonSession"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    endSession: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                sessionId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Ended */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listSourceCertificates: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_PeerCertificate"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    trustSourceCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                thumbprint: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["TrustBody"];
            };
        };
        responses: {
            /** @description Certificate that a server has presented. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["PeerCertificate"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showSourceClientCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Certificate that the connector shows machines, and the next one. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceClientCertificates"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    prepareSourceClientCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Certificate that the connector shows machines, and the next one. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceClientCertificates"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    discardSourceClientCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Certificate that the connector shows machines, and the next one. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceClientCertificates"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    useSourceClientCertificate: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Certificate that the connector shows machines, and the next one. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceClientCertificates"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    discoverSource: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DiscoveryBody"];
            };
        };
        responses: {
            /** @description Answer of a server, or the problem that it could not be asked. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceDiscovery"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    testSource: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SourceConfig"];
            };
        };
        responses: {
            /** @description Findings of a test, or the problem that kept it from a session. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceTest"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listSources: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_SourceView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    addSource: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SourceConfig"];
            };
        };
        responses: {
            /**
             * @description One OPC UA server to read from. The password is accepted but never serialised; who persists a
             *     source stores [`Password::expose`] apart.
             */
            201: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceConfig"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    changeSource: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                sourceId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SourceConfig"];
            };
        };
        responses: {
            /**
             * @description One OPC UA server to read from. The password is accepted but never serialised; who persists a
             *     source stores [`Password::expose`] apart.
             */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceConfig"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    removeSource: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                sourceId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    browseSource: {
        parameters: {
            query?: {
                /** @description Node whose children are listed; the Objects folder without it. */
                parent?: components["schemas"]["NodeId"];
                /** @description `nextCursor` of the page before. */
                cursor?: string;
                /** @description Children per page, 500 without it, at most 1000. */
                limit?: number;
            };
            header?: never;
            path: {
                sourceId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_BrowsedNode"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    searchSource: {
        parameters: {
            query: {
                /**
                 * @description Words that all occur in the variable's path, in any order, without regard to case. Or a node id, as other clients
                 *     show it: `ns=3;s=Speed` or `nsu=<URI>;s=Speed`.
                 */
                text: string;
                /** @description At most so many, up to 200; 50 without it. */
                limit?: number;
            };
            header?: never;
            path: {
                sourceId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Variables that were found. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["FoundVariables"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showSourceUse: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                sourceId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Fields that are disclosed from the values of a source. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["SourceUse"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    readSourceValues: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                sourceId: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["VariablesBody"];
            };
        };
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_ShownValue"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showSpool: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /**
             * @description Numbers of rows and bytes in a spool, for the link's state and metrics. Parked rows are not
             *     counted.
             */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Backlog"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    showStatus: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Status of the connector, with evidence. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Status"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listUsers: {
        parameters: {
            query?: never;
            header?: never;
            path?: never;
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_UserView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    putUser: {
        parameters: {
            query?: never;
            header?: {
                "If-None-Match"?: string | null;
            };
            path: {
                userName: string;
            };
            cookie?: never;
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["UserBody"];
            };
        };
        responses: {
            /** @description A person who may sign in. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["UserView"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    removeUser: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                userName: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    resetSecondFactor: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                userName: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Removed */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    listUserSessions: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                userName: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description A page of a list. */
            200: {
                headers: {
                    [name: string]: unknown;
                };
                content: {
                    "application/json": components["schemas"]["Page_PersonSession"];
                };
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
    endUserSession: {
        parameters: {
            query?: never;
            header?: never;
            path: {
                userName: string;
                sessionId: string;
            };
            cookie?: never;
        };
        requestBody?: never;
        responses: {
            /** @description Ended */
            204: {
                headers: {
                    [name: string]: unknown;
                };
                content?: never;
            };
            400: components["responses"]["BadRequest"];
            401: components["responses"]["Unauthorized"];
            403: components["responses"]["Forbidden"];
            404: components["responses"]["NotFound"];
            409: components["responses"]["Conflict"];
            422: components["responses"]["UnprocessableEntity"];
            429: components["responses"]["TooManyRequests"];
            503: components["responses"]["ServiceUnavailable"];
        };
    };
}

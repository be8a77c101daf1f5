/* A machine on open62541 with the limits of a small controller: a counter, a temperature, a text and 24 more variables.
 *
 * Options: --port N, --address A, --before N (namespaces that come first), --renumber N (node ids shifted by it),
 * --small MS (it publishes no faster). Values are looked at every 250 ms, the queue of an item holds the newest one, 10
 * operations fit into a request, 20 items into a subscription (which it does not say), 2 subscriptions into a session and 3
 * sessions into the server.
 *
 * Prints "ready" when clients may come. Each line on standard input is a JSON object of new values: {"counter": 7};
 * {"counting": true} counts up every 100 ms; {"starting": true} refuses to read anything, as while a program is loaded.
 * Each value of the counter that goes out in a message is printed: "kept 7".
 * Ends with its standard input. */
#include <open62541/server.h>
#include <open62541/server_config_default.h>

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define NAMESPACE "urn:verbund:test:open62541"
#define MORE_VARIABLES 24
#define NUMBERS (5 + MORE_VARIABLES)
#define SAMPLING_MS 250
#define QUEUE 1
#define OPERATIONS 10
#define ITEMS 20
#define SUBSCRIPTIONS 2
#define SESSIONS 3

static UA_UInt16 namespaceIndex;
static unsigned renumber;
static UA_Int32 counter;
static UA_Boolean counting;
static UA_Boolean starting;

/* Every message that leaves the server, and each request to read, passes here: the linker puts these in the place of the
 * originals. */
UA_StatusCode __real_sendResponse(UA_Server *server, void *channel, UA_UInt32 requestId, void *response,
                                  const UA_DataType *type);
UA_StatusCode __wrap_sendResponse(UA_Server *server, void *channel, UA_UInt32 requestId, void *response,
                                  const UA_DataType *type);
UA_StatusCode
__wrap_sendResponse(UA_Server *server, void *channel, UA_UInt32 requestId, void *response, const UA_DataType *type) {
    if(type == &UA_TYPES[UA_TYPES_PUBLISHRESPONSE]) {
        const UA_NotificationMessage *message = &((UA_PublishResponse*)response)->notificationMessage;
        for(size_t i = 0; i < message->notificationDataSize; i++) {
            const UA_ExtensionObject *notification = &message->notificationData[i];
            if(notification->content.decoded.type != &UA_TYPES[UA_TYPES_DATACHANGENOTIFICATION])
                continue;
            const UA_DataChangeNotification *changes = notification->content.decoded.data;
            for(size_t j = 0; j < changes->monitoredItemsSize; j++) {
                const UA_Variant *value = &changes->monitoredItems[j].value.value;
                if(UA_Variant_hasScalarType(value, &UA_TYPES[UA_TYPES_INT32]))
                    printf("kept %d\n", *(UA_Int32*)value->data);
            }
        }
        fflush(stdout);
    }
    return __real_sendResponse(server, channel, requestId, response, type);
}

UA_Boolean __real_Service_Read(UA_Server *server, void *session, const UA_ReadRequest *request, UA_ReadResponse *response);
UA_Boolean __wrap_Service_Read(UA_Server *server, void *session, const UA_ReadRequest *request, UA_ReadResponse *response);
UA_Boolean
__wrap_Service_Read(UA_Server *server, void *session, const UA_ReadRequest *request, UA_ReadResponse *response) {
    if(!starting)
        return __real_Service_Read(server, session, request, response);
    response->responseHeader.serviceResult = UA_STATUSCODE_BADOUTOFSERVICE;
    return true;
}

static void
must(UA_StatusCode status, const char *what) {
    if(status != UA_STATUSCODE_GOOD) {
        fprintf(stderr, "%s: %s\n", what, UA_StatusCode_name(status));
        exit(1);
    }
}

/* All numbers stay in use: an old one names another variable after renumbering. */
static UA_NodeId
nodeId(unsigned number) {
    return UA_NODEID_NUMERIC(namespaceIndex, 2000 + (number + renumber) % NUMBERS);
}

static void
add(UA_Server *server, unsigned number, char *name, void *value, size_t type) {
    UA_VariableAttributes attributes = UA_VariableAttributes_default;
    attributes.displayName = UA_LOCALIZEDTEXT("", name);
    attributes.dataType = UA_TYPES[type].typeId;
    UA_Variant_setScalar(&attributes.value, value, &UA_TYPES[type]);
    must(UA_Server_addVariableNode(server, nodeId(number), nodeId(0), UA_NS0ID(HASCOMPONENT),
                                   UA_QUALIFIEDNAME(namespaceIndex, name), UA_NS0ID(BASEDATAVARIABLETYPE), attributes,
                                   NULL, NULL), name);
}

/* A limit that open62541 has, and does not say by itself. */
static void
declare(UA_Server *server, UA_NodeId id, char *name, UA_UInt32 limit) {
    UA_VariableAttributes attributes = UA_VariableAttributes_default;
    attributes.displayName = UA_LOCALIZEDTEXT("", name);
    attributes.dataType = UA_TYPES[UA_TYPES_UINT32].typeId;
    UA_Variant_setScalar(&attributes.value, &limit, &UA_TYPES[UA_TYPES_UINT32]);
    UA_Server_deleteNode(server, id, true);
    must(UA_Server_addVariableNode(server, id, UA_NS0ID(SERVER_SERVERCAPABILITIES), UA_NS0ID(HASPROPERTY),
                                   UA_QUALIFIEDNAME(0, name), UA_NS0ID(PROPERTYTYPE), attributes, NULL, NULL), name);
}

static void
set(UA_Server *server, unsigned number, void *value, size_t type) {
    UA_DataValue data;
    UA_DataValue_init(&data);
    UA_Variant_setScalar(&data.value, value, &UA_TYPES[type]);
    data.hasValue = data.hasSourceTimestamp = true;
    data.sourceTimestamp = UA_DateTime_now();
    must(UA_Server_writeDataValue(server, nodeId(number), data), "set");
}

static void
count(UA_Server *server, void *unused) {
    (void)unused;
    if(counting) {
        counter++;
        set(server, 1, &counter, UA_TYPES_INT32);
    }
}

/* Finds what stands behind a key in one line of JSON as the tests write it. */
static const char *
valueOf(const char *line, const char *key) {
    const char *found = strstr(line, key);
    if(!found)
        return NULL;
    found = strchr(found, ':') + 1;
    return found + strspn(found, " ");
}

static void
obey(UA_Server *server, const char *line) {
    const char *value;
    if((value = valueOf(line, "\"counter\""))) {
        counter = atoi(value);
        set(server, 1, &counter, UA_TYPES_INT32);
    }
    if((value = valueOf(line, "\"temperature\""))) {
        UA_Double temperature = atof(value);
        set(server, 2, &temperature, UA_TYPES_DOUBLE);
    }
    if((value = valueOf(line, "\"text\""))) {
        UA_String text = {strcspn(value + 1, "\""), (UA_Byte*)(uintptr_t)(value + 1)};
        set(server, 3, &text, UA_TYPES_STRING);
    }
    if((value = valueOf(line, "\"counting\"")))
        counting = strncmp(value, "true", 4) == 0;
    if((value = valueOf(line, "\"starting\"")))
        starting = strncmp(value, "true", 4) == 0;
}

static void
limit(UA_ServerConfig *config, double publishingMs) {
    config->publishingIntervalLimits.min = publishingMs;
    config->samplingIntervalLimits.min = SAMPLING_MS;
    config->queueSizeLimits.min = config->queueSizeLimits.max = QUEUE;
    config->maxMonitoredItemsPerCall = config->maxNodesPerRead = config->maxNodesPerWrite = OPERATIONS;
    config->maxNodesPerBrowse = config->maxNodesPerTranslateBrowsePathsToNodeIds = OPERATIONS;
    config->maxMonitoredItemsPerSubscription = ITEMS;
    config->maxSubscriptionsPerSession = SUBSCRIPTIONS;
    config->maxSessions = SESSIONS;
}

static const char *
option(int count, char **options, const char *name, const char *standard) {
    for(int i = 1; i + 1 < count; i++) {
        if(strcmp(options[i], name) == 0)
            return options[i + 1];
    }
    return standard;
}

/* Reads what waits on standard input, at most one chunk. Returns false at its end. */
static bool
hear(UA_Server *server) {
    static char lines[4096];
    static size_t length;
    struct pollfd input = {STDIN_FILENO, POLLIN, 0};
    if(poll(&input, 1, 0) <= 0)
        return true;
    ssize_t more = read(STDIN_FILENO, lines + length, sizeof(lines) - 1 - length);
    if(more <= 0)
        return false;
    length += (size_t)more;
    lines[length] = 0;
    char *end;
    while((end = strchr(lines, '\n'))) {
        *end = 0;
        obey(server, lines);
        length -= (size_t)(end + 1 - lines);
        memmove(lines, end + 1, length + 1);
    }
    return true;
}

/* Wakes the loop, so that standard input is looked at. */
static void
wake(UA_Server *server, void *unused) {
    (void)server;
    (void)unused;
}

int
main(int argc, char **argv) {
    const char *address = option(argc, argv, "--address", "127.0.0.1");
    int port = atoi(option(argc, argv, "--port", "0"));
    UA_ServerConfig config;
    memset(&config, 0, sizeof(config));
    static UA_Logger quiet;
    config.logging = &quiet;
    must(UA_ServerConfig_setMinimal(&config, (UA_UInt16)port, NULL), "configuration");
    char url[128];
    snprintf(url, sizeof(url), "opc.tcp://%s:%d/machine", address, port);
    UA_Array_delete(config.serverUrls, config.serverUrlsSize, &UA_TYPES[UA_TYPES_STRING]);
    config.serverUrls = UA_Array_new(1, &UA_TYPES[UA_TYPES_STRING]);
    config.serverUrls[0] = UA_STRING_ALLOC(url);
    config.serverUrlsSize = 1;
    config.tcpReuseAddr = true;
    limit(&config, atof(option(argc, argv, "--small", "500")));
    UA_Server *server = UA_Server_newWithConfig(&config);

    int before = atoi(option(argc, argv, "--before", "0"));
    for(int i = 0; i < before; i++) {
        char other[64];
        snprintf(other, sizeof(other), "urn:verbund:test:other:%d", i);
        UA_Server_addNamespace(server, other);
    }
    namespaceIndex = UA_Server_addNamespace(server, NAMESPACE);
    renumber = (unsigned)atoi(option(argc, argv, "--renumber", "0"));
    UA_ObjectAttributes machine = UA_ObjectAttributes_default;
    machine.displayName = UA_LOCALIZEDTEXT("", "Machine");
    must(UA_Server_addObjectNode(server, nodeId(0), UA_NS0ID(OBJECTSFOLDER), UA_NS0ID(ORGANIZES),
                                 UA_QUALIFIEDNAME(namespaceIndex, "Machine"), UA_NS0ID(BASEOBJECTTYPE), machine, NULL,
                                 NULL), "machine");
    UA_Double temperature = 20.5;
    UA_String text = UA_STRING("idle");
    add(server, 1, "Counter", &counter, UA_TYPES_INT32);
    add(server, 2, "Temperature", &temperature, UA_TYPES_DOUBLE);
    add(server, 3, "Text", &text, UA_TYPES_STRING);
    for(unsigned number = 1; number <= MORE_VARIABLES; number++) {
        char name[16];
        snprintf(name, sizeof(name), "Value%u", number);
        UA_Double value = number;
        add(server, 4 + number, name, &value, UA_TYPES_DOUBLE);
    }
    declare(server, UA_NS0ID(SERVER_SERVERCAPABILITIES_MAXSUBSCRIPTIONSPERSESSION), "MaxSubscriptionsPerSession",
            SUBSCRIPTIONS);
    declare(server, UA_NS0ID(SERVER_SERVERCAPABILITIES_MAXSESSIONS), "MaxSessions", SESSIONS);

    must(UA_Server_run_startup(server), "start");
    must(UA_Server_addRepeatedCallback(server, count, NULL, 100, NULL), "count");
    must(UA_Server_addRepeatedCallback(server, wake, NULL, 20, NULL), "wake");
    puts("ready");
    fflush(stdout);
    while(hear(server))
        UA_Server_run_iterate(server, true);
    UA_Server_run_shutdown(server);
    UA_Server_delete(server);
    return 0;
}

/* Plays single OPC UA services with open62541: the commands and answers are those of asyncua_player.py in this folder, but that
 * a session has the authentication token that it got. */

#include <open62541/client.h>
#include <open62541/client_config_default.h>
#include <open62541/plugin/certificategroup_default.h>
#include <open62541/plugin/create_certificate.h>
#include <open62541/plugin/log.h>
#include <open62541/types.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TIMEOUT_MS 30000
#define WORDS_MAX 5

/* The library exports it for the functions that its headers define. */
void __UA_Client_Service(UA_Client *client, const void *request, const UA_DataType *request_type, void *response,
                         const UA_DataType *response_type);

static UA_Client *client = NULL;

/* The output is for answers. */
static void log_nothing(void *context, UA_LogLevel level, UA_LogCategory category, const char *text, va_list arguments) {
    (void)context, (void)level, (void)category, (void)text, (void)arguments;
}

static UA_Logger silence = {.log = log_nothing, .context = NULL, .clear = NULL};

static void answer(const char *kind, const char *text) {
    printf("{\"%s\":\"%s\"}\n", kind, text);
    fflush(stdout);
}

static void must(int is_true, const char *what) {
    if(!is_true) {
        fprintf(stderr, "%s: %s\n", what, strerror(errno));
        exit(2);
    }
}

static UA_ByteString read_file(const char *folder, const char *name) {
    char path[4096];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    UA_ByteString content = UA_BYTESTRING_NULL;
    FILE *file = fopen(path, "rb");
    if(!file)
        return content;
    must(fseek(file, 0, SEEK_END) == 0, path);
    long length = ftell(file);
    rewind(file);
    must(length >= 0 && UA_ByteString_allocBuffer(&content, (size_t)length) == UA_STATUSCODE_GOOD, path);
    must(fread(content.data, 1, content.length, file) == content.length, path);
    fclose(file);
    return content;
}

static void write_file(const char *folder, const char *name, UA_ByteString content) {
    char path[4096];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    must(file && fwrite(content.data, 1, content.length, file) == content.length && fclose(file) == 0, path);
}

/* Reads the client's certificate and key, and makes them at the first time. */
static void own_certificate(const char *folder, UA_ByteString *certificate, UA_ByteString *key) {
    *certificate = read_file(folder, "certificate.der");
    *key = read_file(folder, "key.der");
    if(certificate->length > 0 && key->length > 0)
        return;
    UA_String subject[2] = {UA_STRING_STATIC("O=Verbund"), UA_STRING_STATIC("CN=Verbund open62541 test client")};
    UA_String names[2] = {UA_STRING_STATIC("DNS:localhost"), UA_STRING_STATIC("URI:urn:verbund:test:open62541")};
    UA_UInt16 bits = 2048;
    UA_KeyValueMap *parameters = UA_KeyValueMap_new();
    UA_KeyValueMap_setScalar(parameters, UA_QUALIFIEDNAME(0, "key-size-bits"), &bits, &UA_TYPES[UA_TYPES_UINT16]);
    UA_StatusCode made = UA_CreateCertificate(&silence, subject, 2, names, 2, UA_CERTIFICATEFORMAT_DER, parameters, key,
                                              certificate);
    must(made == UA_STATUSCODE_GOOD, "certificate");
    UA_KeyValueMap_delete(parameters);
    write_file(folder, "certificate.der", *certificate);
    write_file(folder, "key.der", *key);
}

static void close_session(void) {
    if(!client)
        return;
    UA_Client_disconnect(client);
    UA_Client_delete(client);
    client = NULL;
}

static void connect_session(char **words, size_t count) {
    close_session();
    UA_ClientConfig config = {.logging = &silence};
    UA_StatusCode status;
    if(count > 3) {
        UA_ByteString certificate, key;
        own_certificate(words[2], &certificate, &key);
        status = UA_ClientConfig_setDefaultEncryption(&config, certificate, key, NULL, 0, NULL, 0);
        UA_ByteString_clear(&certificate);
        UA_ByteString_clear(&key);
        config.securityMode = UA_MESSAGESECURITYMODE_SIGNANDENCRYPT;
        config.securityPolicyUri = UA_STRING_ALLOC("http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256");
    } else {
        status = UA_ClientConfig_setDefault(&config);
    }
    must(status == UA_STATUSCODE_GOOD, "configuration");
    if(config.certificateVerification.clear)
        config.certificateVerification.clear(&config.certificateVerification);
    UA_CertificateGroup_AcceptAll(&config.certificateVerification);
    UA_String_clear(&config.clientDescription.applicationUri);
    config.clientDescription.applicationUri = UA_STRING_ALLOC("urn:verbund:test:open62541");
    config.timeout = TIMEOUT_MS;
    /* Requests of its own would stand between those of a case. */
    config.connectivityCheckInterval = 0;
    config.outStandingPublishRequests = 0;
    config.requestedSessionTimeout = 3600000;
    client = UA_Client_newWithConfig(&config);
    must(client != NULL, "client");
    status = count > 3 ? UA_Client_connectUsername(client, words[1], words[3], words[4]) : UA_Client_connect(client, words[1]);
    if(status == UA_STATUSCODE_GOOD)
        printf("{\"connected\":true}\n");
    else
        answer("ended", UA_StatusCode_name(status));
    fflush(stdout);
}

static const UA_DataType *type_named(const char *service, const char *suffix) {
    char name[128];
    snprintf(name, sizeof(name), "%s%s", service, suffix);
    for(size_t i = 0; i < UA_TYPES_COUNT; i++) {
        if(strcmp(UA_TYPES[i].typeName, name) == 0)
            return &UA_TYPES[i];
    }
    return NULL;
}

static void play(char **words) {
    const UA_DataType *request_type = type_named(words[1], "Request");
    const UA_DataType *response_type = type_named(words[1], "Response");
    if(!request_type || !response_type) {
        answer("unsendable", "the library does not know the service");
        return;
    }
    if(!client) {
        answer("ended", "there is no session");
        return;
    }
    void *request = UA_new(request_type);
    void *response = UA_new(response_type);
    must(request && response, "memory");
    UA_ByteString text = UA_BYTESTRING(words[2]);
    if(UA_decodeJson(&text, request, request_type, NULL) != UA_STATUSCODE_GOOD) {
        answer("unsendable", "the library does not decode the request");
    } else {
        __UA_Client_Service(client, request, request_type, response, response_type);
        UA_StatusCode result = ((UA_ResponseHeader *)response)->serviceResult;
        UA_SecureChannelState channel;
        UA_SessionState session;
        UA_StatusCode connection;
        UA_Client_getState(client, &channel, &session, &connection);
        UA_ByteString shown = UA_BYTESTRING_NULL;
        if(result != UA_STATUSCODE_GOOD && channel != UA_SECURECHANNELSTATE_OPEN)
            answer("ended", UA_StatusCode_name(result));
        else if(result != UA_STATUSCODE_GOOD)
            answer("fault", UA_StatusCode_name(result));
        else if(UA_encodeJson(response, response_type, &shown, NULL) == UA_STATUSCODE_GOOD)
            printf("{\"response\":%.*s}\n", (int)shown.length, (char *)shown.data);
        else
            answer("unreadable", "the library does not encode the response");
        fflush(stdout);
        UA_ByteString_clear(&shown);
    }
    UA_delete(request, request_type);
    UA_delete(response, response_type);
}

int main(void) {
    char *line = NULL;
    size_t capacity = 0;
    while(getline(&line, &capacity, stdin) > 0) {
        line[strcspn(line, "\n")] = 0;
        char *words[WORDS_MAX] = {0};
        size_t count = 0;
        for(char *rest = line; rest && count < WORDS_MAX; count++)
            words[count] = strsep(&rest, "\t");
        if(strcmp(words[0], "connect") == 0 && (count == 3 || count == 5)) {
            connect_session(words, count);
        } else if(strcmp(words[0], "play") == 0 && count >= 3) {
            if(count > 3)
                answer("unsendable", "the library sends no other token than the session's");
            else
                play(words);
        } else {
            close_session();
            printf("{\"closed\":true}\n");
            fflush(stdout);
        }
    }
    close_session();
    free(line);
    return 0;
}

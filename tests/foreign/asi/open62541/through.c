/* Writes again with open62541 what it has read. Each line of the input is a letter for the type, a space and a value in
 * the JSON encoding; each line of the output an equals sign and the value, or an exclamation mark and what went wrong.
 * Arguments: the namespaces from index 1 on. */
#include <open62541/types.h>
#include <open62541/types_generated.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct UA_Server;

/* The codec alone is linked: a clock and a server are none of its own. */
UA_DateTime UA_DateTime_now(void) { return 0; }
UA_StatusCode UA_Server_browseRecursive(struct UA_Server *server, const void *description, size_t *size, void **results) {
    (void)server, (void)description, (void)size, (void)results;
    return UA_STATUSCODE_BADNOTSUPPORTED;
}
UA_StatusCode UA_Server_readBrowseName(struct UA_Server *server, const UA_NodeId node, UA_QualifiedName *name) {
    (void)server, (void)node, (void)name;
    return UA_STATUSCODE_BADNOTSUPPORTED;
}

static const UA_DataType *type_of(char letter) {
    switch(letter) {
    case 'V': return &UA_TYPES[UA_TYPES_VARIANT];
    case 'D': return &UA_TYPES[UA_TYPES_DATAVALUE];
    case 'R': return &UA_TYPES[UA_TYPES_RANGE];
    case 'E': return &UA_TYPES[UA_TYPES_EUINFORMATION];
    default: return NULL;
    }
}

static void through(const UA_DataType *type, char *text, size_t length, UA_NamespaceMapping *mapping) {
    UA_DecodeJsonOptions decode;
    memset(&decode, 0, sizeof decode);
    decode.namespaceMapping = mapping;
    UA_EncodeJsonOptions encode;
    memset(&encode, 0, sizeof encode);
    encode.namespaceMapping = mapping;
    encode.useReversible = true;
    UA_ByteString source = {length, (UA_Byte *)text};
    UA_ByteString written = UA_BYTESTRING_NULL;
    void *value = UA_new(type);
    UA_StatusCode status = UA_decodeJson(&source, value, type, &decode);
    if(status != UA_STATUSCODE_GOOD) {
        printf("!not decoded: 0x%08X\n", status);
    } else if((status = UA_encodeJson(value, type, &written, &encode)) != UA_STATUSCODE_GOOD) {
        printf("!decoded, but not encoded: 0x%08X\n", status);
    } else {
        putchar('=');
        fwrite(written.data, 1, written.length, stdout);
        putchar('\n');
    }
    UA_ByteString_clear(&written);
    UA_delete(value, type);
}

int main(int count, char **arguments) {
    UA_String *uris = (UA_String *)calloc((size_t)count, sizeof(UA_String));
    if(uris == NULL) return 1;
    uris[0] = UA_STRING("http://opcfoundation.org/UA/");
    for(int index = 1; index < count; index++) uris[index] = UA_STRING(arguments[index]);
    UA_NamespaceMapping mapping;
    memset(&mapping, 0, sizeof mapping);
    mapping.namespaceUris = uris;
    mapping.namespaceUrisSize = (size_t)count;

    char *line = NULL;
    size_t room = 0;
    ssize_t length;
    while((length = getline(&line, &room, stdin)) > 0) {
        if(line[length - 1] == '\n') length--;
        const UA_DataType *type = type_of(line[0]);
        if(length < 2 || type == NULL) return 2;
        through(type, line + 2, (size_t)length - 2, &mapping);
    }
    free(line);
    free(uris);
    return 0;
}

/* Reads where a SPIR-V module puts the members of a struct, to hold it against offsetof in C. */
#ifndef HEWN_TESTS_SPIRV_LAYOUT_H
#define HEWN_TESTS_SPIRV_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { SPIRV_OP_NAME = 5, SPIRV_OP_MEMBER_NAME = 6, SPIRV_OP_MEMBER_DECORATE = 72, SPIRV_OFFSET = 35 };

/* Calls for each instruction with a given opcode. */
typedef bool (*spirv_visit)(const uint32_t *words, size_t count, void *user);

static inline void spirv_each(const uint32_t *module, size_t bytes, uint32_t opcode, spirv_visit visit, void *user)
{
    const size_t count = bytes / 4;
    for (size_t i = 5; i < count;) {
        const size_t length = module[i] >> 16;
        if (length == 0 || i + length > count)
            return;
        if ((module[i] & 0xffff) == opcode && !visit(module + i, length, user))
            return;
        i += length;
    }
}

typedef struct spirv_query {
    const uint32_t *module;
    size_t bytes;
    const char *type, *member;
    uint32_t id, index; /* the struct and the member under way */
    int64_t offset;     /* -1: not found */
} spirv_query;

static inline bool spirv_on_offset(const uint32_t *words, size_t count, void *user)
{
    spirv_query *query = user;
    if (count >= 5 && words[1] == query->id && words[2] == query->index && words[3] == SPIRV_OFFSET)
        query->offset = words[4];
    return query->offset < 0;
}

static inline bool spirv_on_member(const uint32_t *words, size_t count, void *user)
{
    spirv_query *query = user;
    if (count >= 4 && words[1] == query->id && strcmp((const char *)(words + 3), query->member) == 0) {
        query->index = words[2];
        spirv_each(query->module, query->bytes, SPIRV_OP_MEMBER_DECORATE, spirv_on_offset, query);
    }
    return query->offset < 0;
}

static inline bool spirv_on_name(const uint32_t *words, size_t count, void *user)
{
    spirv_query *query = user;
    if (count >= 3 && strcmp((const char *)(words + 2), query->type) == 0) {
        query->id = words[1];
        spirv_each(query->module, query->bytes, SPIRV_OP_MEMBER_NAME, spirv_on_member, query);
    }
    return query->offset < 0;
}

/* The byte offset of `type`.`member`, or -1 where no struct of that name is laid out with such a member. A struct may
 * stand in a module several times; the one that is laid out counts. */
static inline int64_t spirv_offset(const void *module, size_t bytes, const char *type, const char *member)
{
    spirv_query query = {.module = module, .bytes = bytes, .type = type, .member = member, .offset = -1};
    spirv_each(module, bytes, SPIRV_OP_NAME, spirv_on_name, &query);
    return query.offset;
}

#endif

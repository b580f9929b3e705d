#include "field/internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/hash.h"
#include "field/sampling.h"

static hewn_node add_variables(hewn_field *field)
{
    hewn_node last = HEWN_NODE_NONE;
    for (int i = 0; i < 3; i++)
        last = hewn_field_add_node(field, &(hewn_node_data){.op = HEWN_OP_X + i});
    return last;
}

hewn_result hewn_field_create(hewn_field **out, hewn_error *error)
{
    if (!out)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "hewn_field_create: no place for the field");
    *out = NULL;
    hewn_field *field = hewn_alloc_zero(1, sizeof *field);
    if (!field)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory creating a field");
    field->root = HEWN_NO_ID;
    if (hewn_node_is_none(add_variables(field))) {
        hewn_result result = hewn_field_status(field, error);
        hewn_field_destroy(&field);
        return result;
    }
    *out = field;
    return HEWN_OK;
}

void hewn_field_destroy(hewn_field **field)
{
    if (!field || !*field)
        return;
    for (size_t i = 0; i < (*field)->sampling_count; i++)
        hewn_sampling_destroy(&(*field)->samplings[i]);
    hewn_free((*field)->samplings);
    hewn_free((*field)->nodes);
    hewn_free((*field)->table);
    hewn_free(*field);
    *field = NULL;
}

hewn_result hewn_field_status(const hewn_field *field, hewn_error *error)
{
    if (!field)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no field");
    if (field->failure.code != HEWN_OK && error)
        *error = field->failure;
    return field->failure.code;
}

hewn_node hewn_field_refuse(hewn_field *field, hewn_result code, const char *format, ...)
{
    if (!field || field->failure.code != HEWN_OK)
        return HEWN_NODE_NONE;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(field->failure.message, sizeof field->failure.message, format, arguments);
    va_end(arguments);
    field->failure.code = code;
    return HEWN_NODE_NONE;
}

hewn_result hewn_field_set_root(hewn_field *field, hewn_node root, hewn_error *error)
{
    if (!field)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "there is no field");
    HEWN_TRY(hewn_field_status(field, error));
    if (root.id >= field->count)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "the root is no node of this field");
    field->root = root.id;
    return HEWN_OK;
}

hewn_node hewn_field_root(const hewn_field *field)
{
    return field ? (hewn_node){field->root} : HEWN_NODE_NONE;
}

uint32_t hewn_field_node_count(const hewn_field *field)
{
    return (uint32_t)field->count;
}

const hewn_node_data *hewn_field_node(const hewn_field *field, uint32_t id)
{
    return &field->nodes[id];
}

/* --- hash-consing --------------------------------------------------------------------------------------------------
 */

/* Nodes compare by their bytes: no padding, and what an operation does not use is set to one value. */
_Static_assert(sizeof(hewn_node_data) == sizeof(hewn_op) + HEWN_MAX_OPERANDS * sizeof(uint32_t) +
                                             HEWN_MAX_PARAMETERS * sizeof(double) + sizeof(void *),
               "a node has no padding");

static size_t home_slot(const hewn_field *field, const hewn_node_data *data)
{
    return (size_t)hewn_hash_bytes(hewn_hash_begin(), data, sizeof *data).a & (field->table_size - 1);
}

/* The slot that holds an equal node, or the free slot where it would go. */
static uint32_t *find_slot(const hewn_field *field, const hewn_node_data *data)
{
    size_t slot = home_slot(field, data);
    while (field->table[slot] != HEWN_NO_ID && memcmp(&field->nodes[field->table[slot]], data, sizeof *data) != 0)
        slot = (slot + 1) & (field->table_size - 1);
    return &field->table[slot];
}

static hewn_result grow_table(hewn_field *field, hewn_error *error)
{
    if (field->table_size > 2 * field->count)
        return HEWN_OK;
    size_t old_size = field->table_size;
    size_t size = old_size ? 2 * old_size : 64;
    uint32_t *table = hewn_alloc(size, sizeof *table);
    if (!table)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory growing a field beyond %zu nodes", field->count);
    memset(table, 0xFF, size * sizeof *table);
    hewn_free(field->table);
    field->table = table;
    field->table_size = size;
    for (size_t i = 0; i < field->count; i++)
        *find_slot(field, &field->nodes[i]) = (uint32_t)i;
    return HEWN_OK;
}

static hewn_node intern(hewn_field *field, const hewn_node_data *data)
{
    hewn_error error;
    hewn_result result = grow_table(field, &error);
    if (result != HEWN_OK)
        return hewn_field_refuse(field, result, "%s", error.message);
    uint32_t *slot = find_slot(field, data);
    if (*slot != HEWN_NO_ID)
        return (hewn_node){*slot};
    if (field->count >= HEWN_NO_ID)
        return hewn_field_refuse(field, HEWN_LIMIT, "a field holds at most %u nodes", HEWN_NO_ID);
    void *items = field->nodes;
    result = hewn_reserve(&items, &field->capacity, field->count + 1, sizeof *field->nodes, &error);
    if (result != HEWN_OK)
        return hewn_field_refuse(field, result, "%s", error.message);
    field->nodes = items;
    field->nodes[field->count] = *data;
    *slot = (uint32_t)field->count;
    return (hewn_node){(uint32_t)field->count++};
}

/* Nodes compare by where their samples are, so those must not go before the field does. */
static hewn_result hold(hewn_field *field, const hewn_sampling *sampling, hewn_error *error)
{
    for (size_t i = 0; i < field->sampling_count; i++)
        if (field->samplings[i] == sampling)
            return HEWN_OK;
    void *items = field->samplings;
    HEWN_TRY(
        hewn_reserve(&items, &field->sampling_capacity, field->sampling_count + 1, sizeof *field->samplings, error));
    field->samplings = items;
    field->samplings[field->sampling_count++] = hewn_sampling_share(sampling);
    return HEWN_OK;
}

hewn_node hewn_field_add_node(hewn_field *field, const hewn_node_data *given)
{
    if (!field)
        return HEWN_NODE_NONE;
    if (!given || (unsigned)given->op >= HEWN_OP_COUNT)
        return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "there is no such operation");
    const hewn_op_info *info = &hewn_op_infos[given->op];
    hewn_node_data data = {.op = given->op, .operand = {HEWN_NO_ID, HEWN_NO_ID, HEWN_NO_ID}};
    for (int i = 0; i < info->operands; i++) {
        if (given->operand[i] >= field->count)
            return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "operand %d of %s is no node of this field", i + 1,
                                     info->name);
        data.operand[i] = given->operand[i];
    }
    for (int i = 0; i < info->parameters; i++)
        data.parameter[i] = given->parameter[i];
    const char *complaint = hewn_op_complaint(data.op, data.parameter);
    if (complaint)
        return hewn_field_refuse(field, HEWN_INVALID_ARGUMENT, "%s: %s", info->name, complaint);
    if (data.op == HEWN_OP_SAMPLED) {
        hewn_error error;
        hewn_result result = given->samples ? hold(field, given->samples, &error)
                                            : hewn_fail(&error, HEWN_INVALID_ARGUMENT, "sampled: it has no samples");
        if (result != HEWN_OK)
            return hewn_field_refuse(field, result, "%s", error.message);
        data.samples = given->samples;
    }
    uint32_t existing;
    if (field->count > HEWN_ID_Z && hewn_node_fold(field, &data, &existing))
        return (hewn_node){existing};
    return intern(field, &data);
}

/* --- what a node depends on ----------------------------------------------------------------------------------------
 */

/* A bit for each id up to the root's. Operands have smaller ids than their users, so one walk downwards meets every
 * user before its operands, however deep the graph. */
static uint64_t *mark_live(const hewn_field *field, uint32_t root, size_t *count)
{
    uint64_t *marks = hewn_alloc_zero((size_t)root / 64 + 1, sizeof *marks);
    if (!marks)
        return NULL;
    marks[root / 64] |= (uint64_t)1 << root % 64;
    *count = 0;
    for (size_t word = (size_t)root / 64 + 1; word-- > 0;) {
        uint64_t done = 0;
        while (marks[word] & ~done) {
            int bit = 63 - __builtin_clzll(marks[word] & ~done);
            done |= (uint64_t)1 << bit;
            ++*count;
            const hewn_node_data *node = &field->nodes[word * 64 + (size_t)bit];
            for (int i = 0; i < hewn_op_infos[node->op].operands; i++)
                marks[node->operand[i] / 64] |= (uint64_t)1 << node->operand[i] % 64;
        }
    }
    return marks;
}

hewn_result hewn_field_live_nodes(const hewn_field *field, hewn_node root, uint32_t **ids, size_t *count,
                                  hewn_error *error)
{
    *ids = NULL;
    *count = 0;
    if (!field || root.id >= field->count)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "this is no node of the field");
    size_t live = 0;
    uint64_t *marks = mark_live(field, root.id, &live);
    uint32_t *list = marks ? hewn_alloc(live, sizeof *list) : NULL;
    if (!list) {
        hewn_free(marks);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory listing the nodes of a field");
    }
    size_t at = 0;
    for (size_t word = 0; word <= root.id / 64; word++)
        for (uint64_t rest = marks[word]; rest; rest &= rest - 1)
            list[at++] = (uint32_t)(word * 64) + (uint32_t)__builtin_ctzll(rest);
    hewn_free(marks);
    *ids = list;
    *count = live;
    return HEWN_OK;
}

size_t hewn_field_size(const hewn_field *field, hewn_node node)
{
    if (!field || node.id >= field->count)
        return 0;
    size_t live = 0;
    hewn_free(mark_live(field, node.id, &live));
    return live;
}

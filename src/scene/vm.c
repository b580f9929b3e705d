/* The `.vm` text of fidget and libfive: one instruction a line, `name op operands...`; the last one is the result. */
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"
#include "scene/scene.h"

typedef struct word {
    const char *bytes;
    size_t length;
} word;

typedef struct name_entry {
    const char *bytes; /* in the file's text; NULL marks a free slot */
    size_t length;
    hewn_node node;
    uint32_t line;
} name_entry;

typedef struct vm_reader {
    hewn_field *field;
    const char *path;
    uint32_t line;
    locale_t locale;   /* "C", so that a point is a point whatever the program has set */
    name_entry *names; /* open addressing, capacity a power of two, at most half full */
    size_t capacity, count;
    hewn_node last;
    hewn_error *error;
} vm_reader;

enum { MAX_WORDS = 4, SHOWN = 40, MAX_INSTRUCTIONS = 1 << 21 };

typedef hewn_node (*unary_builder)(hewn_field *, hewn_node);
typedef hewn_node (*binary_builder)(hewn_field *, hewn_node, hewn_node);

static hewn_node build_recip(hewn_field *field, hewn_node a)
{
    return hewn_div(field, hewn_constant(field, 1.0), a);
}

static const struct {
    const char *name;
    unary_builder build;
} unary_ops[] = {
    {"neg", hewn_neg},       {"abs", hewn_abs},   {"sqrt", hewn_sqrt},   {"square", hewn_square},
    {"sin", hewn_sin},       {"cos", hewn_cos},   {"tan", hewn_tan},     {"asin", hewn_asin},
    {"acos", hewn_acos},     {"atan", hewn_atan}, {"exp", hewn_exp},     {"ln", hewn_ln},
    {"floor", hewn_floor},   {"ceil", hewn_ceil}, {"round", hewn_round}, {"recip", build_recip},
    {"not", hewn_logic_not},
};

static const struct {
    const char *name;
    binary_builder build;
} binary_ops[] = {
    {"add", hewn_add},         {"sub", hewn_sub},       {"mul", hewn_mul},     {"div", hewn_div},
    {"min", hewn_min},         {"max", hewn_max},       {"mod", hewn_mod},     {"atan2", hewn_atan2},
    {"compare", hewn_compare}, {"and", hewn_logic_and}, {"or", hewn_logic_or},
};

static bool is_word(word w, const char *name)
{
    return strlen(name) == w.length && memcmp(name, w.bytes, w.length) == 0;
}

/* A word for a message. */
static const char *show(word w, char out[SHOWN])
{
    hewn_text_clean(out, SHOWN, w.bytes, w.length);
    return out;
}

/* --- names ------------------------------------------------------------------------------------------------------- */

static name_entry *find_slot(const vm_reader *reader, word w)
{
    uint64_t hash = 14695981039346656037u; /* FNV-1a, then mixed: its low bits alone are weak */
    for (size_t i = 0; i < w.length; i++)
        hash = (hash ^ (unsigned char)w.bytes[i]) * 1099511628211u;
    hash = (hash ^ (hash >> 32)) * 0x9E3779B97F4A7C15u;
    size_t mask = reader->capacity - 1;
    for (size_t slot = (hash >> 20) & mask;; slot = (slot + 1) & mask) {
        name_entry *entry = &reader->names[slot];
        if (!entry->bytes || (entry->length == w.length && memcmp(entry->bytes, w.bytes, w.length) == 0))
            return entry;
    }
}

static hewn_result grow_names(vm_reader *reader)
{
    name_entry *old = reader->names;
    size_t old_capacity = reader->capacity, capacity = old_capacity ? old_capacity * 2 : 256;
    name_entry *names = hewn_alloc_zero(capacity, sizeof *names);
    if (!names)
        return hewn_fail(reader->error, HEWN_OUT_OF_MEMORY, "out of memory reading %s", reader->path);
    reader->names = names;
    reader->capacity = capacity;
    for (size_t i = 0; i < old_capacity; i++)
        if (old[i].bytes)
            *find_slot(reader, (word){old[i].bytes, old[i].length}) = old[i];
    hewn_free(old);
    return HEWN_OK;
}

static hewn_result define(vm_reader *reader, word name, hewn_node node)
{
    if (reader->count >= MAX_INSTRUCTIONS)
        return hewn_fail_at(reader->error, HEWN_BAD_INPUT, reader->path, reader->line, "more than %d instructions",
                            MAX_INSTRUCTIONS);
    if (reader->count * 2 >= reader->capacity)
        HEWN_TRY(grow_names(reader));
    name_entry *entry = find_slot(reader, name);
    *entry = (name_entry){name.bytes, name.length, node, reader->line};
    reader->count++;
    reader->last = node;
    return HEWN_OK;
}

/* --- one line ---------------------------------------------------------------------------------------------------- */

static hewn_result find_operand(const vm_reader *reader, word w, hewn_node *out)
{
    const name_entry *entry = find_slot(reader, w);
    char shown[SHOWN];
    if (!entry->bytes)
        return hewn_fail_at(reader->error, HEWN_BAD_INPUT, reader->path, reader->line,
                            "no line above this one is called '%s'", show(w, shown));
    *out = entry->node;
    return HEWN_OK;
}

static hewn_result read_number(const vm_reader *reader, word w, double *out)
{
    char shown[SHOWN], *end = NULL;
    bool plain = w.length > 0;
    for (size_t i = 0; i < w.length; i++) /* decimal only: no hexadecimal, no "nan", no "infinity" */
        plain = plain && memchr("0123456789+-.eE", w.bytes[i], 15);
    /* What follows the word is a blank, a line's end or the NUL after the text, so the conversion stops there. */
    *out = plain ? strtod_l(w.bytes, &end, reader->locale) : 0;
    if (end != w.bytes + w.length)
        return hewn_fail_at(reader->error, HEWN_BAD_INPUT, reader->path, reader->line, "'%s' is not a number",
                            show(w, shown));
    if (!isfinite(*out))
        return hewn_fail_at(reader->error, HEWN_BAD_INPUT, reader->path, reader->line, "the number '%s' is too large",
                            show(w, shown));
    return HEWN_OK;
}

static hewn_result check_count(const vm_reader *reader, word op, size_t words, size_t operands)
{
    char shown[SHOWN];
    if (words == operands + 2)
        return HEWN_OK;
    return hewn_fail_at(reader->error, HEWN_BAD_INPUT, reader->path, reader->line, "%s takes %zu operand%s, not %s%zu",
                        show(op, shown), operands, operands == 1 ? "" : "s", words > MAX_WORDS ? "more than " : "",
                        words > MAX_WORDS ? (size_t)MAX_WORDS - 2 : words - 2);
}

static hewn_result build(vm_reader *reader, const word *words, size_t count, hewn_node *out)
{
    word op = words[1];
    hewn_node a = HEWN_NODE_NONE, b = HEWN_NODE_NONE;
    if (is_word(op, "const")) {
        double value = 0;
        HEWN_TRY(check_count(reader, op, count, 1));
        HEWN_TRY(read_number(reader, words[2], &value));
        *out = hewn_constant(reader->field, value);
        return HEWN_OK;
    }
    if (is_word(op, "var-x") || is_word(op, "var-y") || is_word(op, "var-z")) {
        HEWN_TRY(check_count(reader, op, count, 0));
        char axis = op.bytes[4];
        *out = axis == 'x' ? hewn_x(reader->field) : axis == 'y' ? hewn_y(reader->field) : hewn_z(reader->field);
        return HEWN_OK;
    }
    for (size_t i = 0; i < sizeof unary_ops / sizeof unary_ops[0]; i++)
        if (is_word(op, unary_ops[i].name)) {
            HEWN_TRY(check_count(reader, op, count, 1));
            HEWN_TRY(find_operand(reader, words[2], &a));
            *out = unary_ops[i].build(reader->field, a);
            return HEWN_OK;
        }
    for (size_t i = 0; i < sizeof binary_ops / sizeof binary_ops[0]; i++)
        if (is_word(op, binary_ops[i].name)) {
            HEWN_TRY(check_count(reader, op, count, 2));
            HEWN_TRY(find_operand(reader, words[2], &a));
            HEWN_TRY(find_operand(reader, words[3], &b));
            *out = binary_ops[i].build(reader->field, a, b);
            return HEWN_OK;
        }
    char shown[SHOWN];
    return hewn_fail_at(reader->error, HEWN_BAD_INPUT, reader->path, reader->line, "unknown operation '%s'",
                        show(op, shown));
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Splits a line; returns how many words it has, MAX_WORDS + 1 for more than fit. */
static size_t split(const char *at, const char *end, word words[MAX_WORDS])
{
    size_t count = 0;
    for (;;) {
        while (at < end && is_blank(*at))
            at++;
        if (at == end)
            return count;
        if (count == MAX_WORDS)
            return MAX_WORDS + 1;
        const char *begin = at;
        while (at < end && !is_blank(*at))
            at++;
        words[count++] = (word){begin, (size_t)(at - begin)};
    }
}

static hewn_result read_line(vm_reader *reader, const char *begin, const char *end)
{
    word words[MAX_WORDS];
    size_t count = split(begin, end, words);
    char shown[SHOWN];
    if (count == 0 || words[0].bytes[0] == '#')
        return HEWN_OK;
    if (count == 1)
        return hewn_fail_at(reader->error, HEWN_BAD_INPUT, reader->path, reader->line, "'%s' has no operation",
                            show(words[0], shown));
    const name_entry *entry = find_slot(reader, words[0]);
    if (entry->bytes)
        return hewn_fail_at(reader->error, HEWN_BAD_INPUT, reader->path, reader->line,
                            "'%s' is already defined on line %u", show(words[0], shown), entry->line);
    hewn_node node = HEWN_NODE_NONE;
    HEWN_TRY(build(reader, words, count, &node));
    if (hewn_node_is_none(node)) {
        hewn_error reason = {0};
        hewn_result result = hewn_field_status(reader->field, &reason);
        return hewn_fail_at(reader->error, result == HEWN_OK ? HEWN_INTERNAL : result, reader->path, reader->line, "%s",
                            reason.message);
    }
    return define(reader, words[0], node);
}

hewn_result hewn_vm_parse(hewn_field *field, const char *path, const char *text, size_t length, hewn_node *out,
                          hewn_error *error)
{
    vm_reader reader = {.field = field, .path = path, .last = HEWN_NODE_NONE, .error = error};
    *out = HEWN_NODE_NONE;
    reader.locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!reader.locale)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory reading %s", path);
    const char *at = text, *end = text + length;
    if (length >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
        at += 3; /* the mark that some editors put before UTF-8 */
    hewn_result result = grow_names(&reader);
    while (at < end && result == HEWN_OK) {
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        const char *stop = newline ? newline : end;
        reader.line++;
        result = read_line(&reader, at, stop);
        at = newline ? newline + 1 : end;
    }
    if (result == HEWN_OK && reader.count == 0)
        result = hewn_fail_at(error, HEWN_BAD_INPUT, path, 0, "the file has no instruction");
    if (result == HEWN_OK)
        *out = reader.last;
    hewn_free(reader.names);
    freelocale(reader.locale);
    return result;
}

#include "app/options.h"

#include <assert.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* --- likeness ---------------------------------------------------------------------------------------------------- */

enum { LONGEST_NAME = 31 };

/* Edits (insert, drop, replace, swap two neighbours) that lead from a to b; more than anything useful for long words.
 * The restricted Damerau-Levenshtein distance. */
static size_t distance(const char *a, const char *b)
{
    size_t m = strlen(a), n = strlen(b);
    if (m > LONGEST_NAME || n > LONGEST_NAME)
        return SIZE_MAX;
    size_t cost[LONGEST_NAME + 1][LONGEST_NAME + 1];
    for (size_t i = 0; i <= m; ++i) {
        for (size_t j = 0; j <= n; ++j) {
            if (i == 0 || j == 0) {
                cost[i][j] = i + j;
                continue;
            }
            size_t best = cost[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
            size_t dropped = cost[i - 1][j] + 1, inserted = cost[i][j - 1] + 1;
            best = dropped < best ? dropped : best;
            best = inserted < best ? inserted : best;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && cost[i - 2][j - 2] + 1 < best)
                best = cost[i - 2][j - 2] + 1;
            cost[i][j] = best;
        }
    }
    return cost[m][n];
}

const char *hewn_nearest_name(const char *word, const char *const *names, size_t count)
{
    const char *nearest = NULL;
    size_t least = SIZE_MAX, length = strlen(word);
    for (size_t i = 0; i < count; ++i) {
        if (!names[i])
            continue;
        /* What is written out in part is meant, however much of it is missing. */
        size_t edits = length >= 2 && strncmp(names[i], word, length) == 0 ? 1 : distance(word, names[i]);
        size_t longest = length > strlen(names[i]) ? length : strlen(names[i]);
        if (edits < least && 3 * edits <= longest + 1) {
            least = edits;
            nearest = names[i];
        }
    }
    return nearest;
}

/* --- parsing ----------------------------------------------------------------------------------------------------- */

static const hewn_option *find_name(const hewn_arguments *arguments, const char *name, size_t length)
{
    for (size_t i = 0; i < arguments->option_count; ++i) {
        const char *known = arguments->options[i].name;
        if (known && strlen(known) == length && memcmp(known, name, length) == 0)
            return &arguments->options[i];
    }
    return NULL;
}

static const hewn_option *find_letter(const hewn_arguments *arguments, char letter)
{
    for (size_t i = 0; i < arguments->option_count; ++i)
        if (letter && arguments->options[i].letter == letter)
            return &arguments->options[i];
    return NULL;
}

static void give(hewn_arguments *arguments, const hewn_option *option, const char *value)
{
    arguments->given[arguments->given_count++] = (hewn_given){option, value};
}

static hewn_result fail_unknown(const hewn_arguments *arguments, const char *name, hewn_error *error)
{
    const char *names[64];
    size_t count = 0;
    for (size_t i = 0; i < arguments->option_count && count < 64; ++i)
        if (arguments->options[i].name)
            names[count++] = arguments->options[i].name;
    const char *nearest = hewn_nearest_name(name, names, count);
    if (nearest)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "unknown option '--%s'; did you mean '--%s'?", name, nearest);
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "unknown option '--%s'", name);
}

/* Takes argv[*at], which starts with two dashes, and its value. */
static hewn_result parse_long(hewn_arguments *arguments, int argc, char **argv, int *at, hewn_error *error)
{
    const char *name = argv[*at] + 2;
    size_t length = strcspn(name, "=");
    const hewn_option *option = find_name(arguments, name, length);
    if (!option) {
        char word[64];
        snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word - 1), name);
        return fail_unknown(arguments, word, error);
    }
    bool attached = name[length] == '=';
    if (!option->value && attached)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "option '--%s' takes no value", option->name);
    if (!option->value)
        give(arguments, option, NULL);
    else if (attached)
        give(arguments, option, name + length + 1);
    else if (*at + 1 < argc)
        give(arguments, option, argv[++*at]);
    else
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "option '--%s' needs a value: --%s %s", option->name,
                         option->name, option->value);
    return HEWN_OK;
}

/* Takes argv[*at], which starts with one dash and goes on, and its value. */
static hewn_result parse_short(hewn_arguments *arguments, int argc, char **argv, int *at, hewn_error *error)
{
    size_t length = strcspn(argv[*at] + 1, "=");
    if (length > 1 && find_name(arguments, argv[*at] + 1, length)) /* -output would be -o with the value "utput" */
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "unknown option '%s'; did you mean '-%s'?", argv[*at],
                         argv[*at]);
    for (const char *letter = argv[*at] + 1; *letter; ++letter) {
        const hewn_option *option = find_letter(arguments, *letter);
        if (!option)
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "unknown option '-%c'", *letter);
        if (!option->value) {
            give(arguments, option, NULL);
            continue;
        }
        if (letter[1])
            give(arguments, option, letter + 1);
        else if (*at + 1 < argc)
            give(arguments, option, argv[++*at]);
        else
            return hewn_fail(error, HEWN_INVALID_ARGUMENT, "option '-%c' needs a value: -%c %s", *letter, *letter,
                             option->value);
        break;
    }
    return HEWN_OK;
}

static hewn_result parse(hewn_arguments *arguments, int argc, char **argv, hewn_error *error)
{
    size_t room = 1; /* an argument of several letters gives as many options */
    for (int i = 0; i < argc; ++i)
        room += strlen(argv[i]) + 1;
    arguments->given = hewn_alloc_zero(room, sizeof *arguments->given);
    arguments->operands = hewn_alloc_zero((size_t)argc + 1, sizeof *arguments->operands);
    if (!arguments->given || !arguments->operands)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the arguments");
    bool options_ended = false;
    for (int at = 0; at < argc; ++at) {
        const char *argument = argv[at];
        if (options_ended || argument[0] != '-' || argument[1] == '\0')
            arguments->operands[arguments->operand_count++] = argument;
        else if (strcmp(argument, "--") == 0)
            options_ended = true;
        else if (argument[1] == '-')
            HEWN_TRY(parse_long(arguments, argc, argv, &at, error));
        else
            HEWN_TRY(parse_short(arguments, argc, argv, &at, error));
    }
    return HEWN_OK;
}

hewn_result hewn_arguments_parse(const hewn_option *options, size_t option_count, int argc, char **argv,
                                 hewn_arguments *out, hewn_error *error)
{
    *out = (hewn_arguments){.options = options, .option_count = option_count};
    hewn_result result = parse(out, argc, argv, error);
    if (result != HEWN_OK)
        hewn_arguments_destroy(out);
    return result;
}

void hewn_arguments_destroy(hewn_arguments *arguments)
{
    hewn_free(arguments->given);
    hewn_free(arguments->operands);
    *arguments = (hewn_arguments){0};
}

static const hewn_given *find_given(const hewn_arguments *arguments, const char *name)
{
    const hewn_option *option = find_name(arguments, name, strlen(name));
    if (!option && !name[1])
        option = find_letter(arguments, name[0]);
    assert(option && "the command asks for an option that its table lacks");
    for (size_t i = arguments->given_count; i-- > 0;)
        if (arguments->given[i].option == option)
            return &arguments->given[i];
    return NULL;
}

bool hewn_arguments_has(const hewn_arguments *arguments, const char *name)
{
    return find_given(arguments, name) != NULL;
}

const char *hewn_arguments_value(const hewn_arguments *arguments, const char *name)
{
    const hewn_given *given = find_given(arguments, name);
    return given ? given->value : NULL;
}

/* --- help -------------------------------------------------------------------------------------------------------- */

enum { HELP_COLUMN = 26, HELP_WIDTH = 80 };

/* Prints words from column HELP_COLUMN on, breaking lines between them; `column` is where the cursor stands. */
static void print_wrapped(const char *text, int column, FILE *file)
{
    if (column > HELP_COLUMN - 2) {
        fputc('\n', file);
        column = 0;
    }
    fprintf(file, "%*s", HELP_COLUMN - column, "");
    column = HELP_COLUMN;
    for (const char *word = text; *word;) {
        int length = (int)strcspn(word, " ");
        if (column > HELP_COLUMN && column + 1 + length > HELP_WIDTH) {
            fprintf(file, "\n%*s", HELP_COLUMN, "");
            column = HELP_COLUMN;
        } else if (column > HELP_COLUMN) {
            fputc(' ', file);
            ++column;
        }
        fprintf(file, "%.*s", length, word);
        column += length;
        word += length;
        word += strspn(word, " ");
    }
    fputc('\n', file);
}

void hewn_options_print(const hewn_option *options, size_t option_count, FILE *file)
{
    for (size_t i = 0; i < option_count; ++i) {
        const hewn_option *option = &options[i];
        if (!option->letter && !option->name) {
            fprintf(file, "\n%s:\n", option->help);
            continue;
        }
        int column = fprintf(file, "  ");
        if (option->letter && option->name)
            column += fprintf(file, "-%c, --%s", option->letter, option->name);
        else if (option->letter)
            column += fprintf(file, "-%c", option->letter);
        else
            column += fprintf(file, "    --%s", option->name);
        if (option->value)
            column += fprintf(file, " %s", option->value);
        print_wrapped(option->help, column, file);
    }
}

#include "app/simplify_arguments.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "app/number.h"
#include "base/error.h"

/* --- targets ------------------------------------------------------------------------------------------------------ */

static hewn_result read_faces(const char *text, const char *option, hewn_simplify_desc *out, hewn_error *error)
{
    uint32_t faces;
    HEWN_TRY(hewn_count_parse(text, option, 1, &faces, error));
    out->faces = faces;
    return HEWN_OK;
}

static hewn_result read_ratio(const char *text, const char *option, hewn_simplify_desc *out, hewn_error *error)
{
    HEWN_TRY(hewn_number_parse(text, option, &out->ratio, error));
    if (out->ratio > 0 && out->ratio <= 1)
        return HEWN_OK;
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s is above 0 and at most 1, not %s", option, text);
}

static hewn_result read_length(const char *text, const char *option, double *out, hewn_error *error)
{
    HEWN_TRY(hewn_number_parse(text, option, out, error));
    return *out > 0 ? HEWN_OK
                    : hewn_fail(error, HEWN_INVALID_ARGUMENT, "%s must be greater than 0, not %s", option, text);
}

static hewn_result read_targets(const hewn_arguments *arguments, hewn_simplify_desc *out, hewn_error *error)
{
    const char *faces = hewn_arguments_value(arguments, "faces"), *ratio = hewn_arguments_value(arguments, "ratio");
    const char *length = hewn_arguments_value(arguments, "error"),
               *relative = hewn_arguments_value(arguments, "error-rel");
    if (!faces && !ratio && !length && !relative)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "simplify how far? Give --faces, --ratio, --error or --error-rel");
    if (faces && ratio)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--faces and --ratio exclude each other");
    if (length && relative)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--error and --error-rel exclude each other");
    if (faces)
        HEWN_TRY(read_faces(faces, "--faces", out, error));
    if (ratio)
        HEWN_TRY(read_ratio(ratio, "--ratio", out, error));
    if (length)
        HEWN_TRY(read_length(length, "--error", &out->error, error));
    return relative ? read_length(relative, "--error-rel", &out->relative_error, error) : HEWN_OK;
}

hewn_result hewn_simplify_target_read(const hewn_arguments *arguments, hewn_simplify_desc *out, bool *given,
                                      hewn_error *error)
{
    const char *text = hewn_arguments_value(arguments, "simplify");
    *given = text != NULL;
    if (!text)
        return HEWN_OK;
    if (strncmp(text, "faces:", 6) == 0)
        return read_faces(text + 6, "--simplify faces:", out, error);
    if (strncmp(text, "ratio:", 6) == 0)
        return read_ratio(text + 6, "--simplify ratio:", out, error);
    if (strncmp(text, "error:", 6) == 0)
        return read_length(text + 6, "--simplify error:", &out->error, error);
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--simplify takes faces:N, ratio:R or error:LENGTH, not '%s'", text);
}

/* --- lists -------------------------------------------------------------------------------------------------------- */

static hewn_result read_lock(const char *word, size_t length, hewn_simplify_desc *out, hewn_error *error)
{
    static const char features[] = "features:";
    const size_t prefix = sizeof features - 1;
    char angle[32];
    if (length == 8 && memcmp(word, "boundary", 8) == 0) {
        out->lock_boundary = true;
        return HEWN_OK;
    }
    if (length == 6 && memcmp(word, "labels", 6) == 0) {
        out->lock_labels = true;
        return HEWN_OK;
    }
    if (length > prefix && memcmp(word, features, prefix) == 0 && length - prefix < sizeof angle) {
        memcpy(angle, word + prefix, length - prefix);
        angle[length - prefix] = '\0';
        HEWN_TRY(hewn_number_parse(angle, "--lock features:", &out->lock_angle, error));
        if (out->lock_angle > 0 && out->lock_angle < 180)
            return HEWN_OK;
    }
    return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                     "--lock takes boundary, labels and features:ANGLE (0 to 180 degrees), not '%.*s'", (int)length,
                     word);
}

static hewn_result read_preserve(const char *word, size_t length, hewn_simplify_desc *out, hewn_error *error)
{
    static const struct {
        const char *word;
        uint32_t bit;
    } all[] = {{"uv", HEWN_PRESERVE_UV},
               {"normal", HEWN_PRESERVE_NORMAL},
               {"color", HEWN_PRESERVE_COLOR},
               {"label", HEWN_PRESERVE_LABEL},
               {"none", HEWN_PRESERVE_NONE}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (strlen(all[i].word) == length && memcmp(word, all[i].word, length) == 0) {
            out->preserve |= all[i].bit;
            return HEWN_OK;
        }
    return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--preserve takes uv, normal, color and label, or none, not '%.*s'",
                     (int)length, word);
}

typedef hewn_result read_word(const char *word, size_t length, hewn_simplify_desc *out, hewn_error *error);

static hewn_result read_list(const char *at, read_word *read, hewn_simplify_desc *out, hewn_error *error)
{
    while (at) {
        size_t length = strcspn(at, ",");
        HEWN_TRY(read(at, length, out, error));
        at = at[length] ? at + length + 1 : NULL;
    }
    return HEWN_OK;
}

hewn_result hewn_simplify_manner_read(const hewn_arguments *arguments, hewn_simplify_desc *out, hewn_error *error)
{
    HEWN_TRY(read_list(hewn_arguments_value(arguments, "lock"), read_lock, out, error));
    HEWN_TRY(read_list(hewn_arguments_value(arguments, "preserve"), read_preserve, out, error));
    if ((out->preserve & HEWN_PRESERVE_NONE) && out->preserve != HEWN_PRESERVE_NONE)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "--preserve none excludes all others");
    out->no_self_intersections = hewn_arguments_has(arguments, "no-self-intersections");
    return HEWN_OK;
}

hewn_result hewn_simplify_arguments_read(const hewn_arguments *arguments, hewn_simplify_desc *out, hewn_error *error)
{
    *out = (hewn_simplify_desc){0};
    HEWN_TRY(read_targets(arguments, out, error));
    HEWN_TRY(hewn_simplify_manner_read(arguments, out, error));
    out->measure = hewn_arguments_has(arguments, "report");
    return HEWN_OK;
}

/* --- what people see ---------------------------------------------------------------------------------------------- */

void hewn_simplify_print(const hewn_simplify_report *done)
{
    fprintf(stderr, "  %" PRIu64 " of %" PRIu64 " triangles left (%.3g %%)", done->triangles, done->triangles_before,
            done->triangles_before > 0 ? 100 * (double)done->triangles / (double)done->triangles_before : 0);
    if (done->measured)
        fprintf(stderr, "; nowhere more than %.4g away", done->distance);
    if (done->locked_vertices > 0)
        fprintf(stderr, "; %" PRIu64 " vertices locked", done->locked_vertices);
    fputc('\n', stderr);
    if (!done->reached)
        fprintf(stderr,
                "hewn: note: fewer than %" PRIu64 " triangles are not possible here; %" PRIu64 " were asked for\n",
                done->triangles, done->target);
    if (done->unwalked_vertices > 0)
        fprintf(stderr,
                "hewn: note: %" PRIu64 " vertices where the mesh is not manifold stayed as they were; `hewn repair` "
                "first frees them\n",
                done->unwalked_vertices);
}

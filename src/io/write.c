#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "base/clones.h"
#include "base/error.h"
#include "base/progress.h"
#include "io/formats.h"
#include "mesh/cut.h"

static const hewn_format_writer *writer_of(hewn_mesh_format format)
{
    switch (format) {
    case HEWN_MESH_GLB: return &hewn_glb_writer;
    case HEWN_MESH_OBJ: return &hewn_obj_writer;
    case HEWN_MESH_PLY: return &hewn_ply_writer;
    case HEWN_MESH_STL: return &hewn_stl_writer;
    case HEWN_MESH_OFF: return &hewn_off_writer;
    case HEWN_MESH_3MF: return &hewn_3mf_writer;
    case HEWN_MESH_GLTF:
    case HEWN_MESH_HPM:
    case HEWN_MESH_UNKNOWN: break;
    }
    return NULL;
}

bool hewn_mesh_format_has_polygons(hewn_mesh_format format)
{
    const hewn_format_writer *writer = writer_of(format);
    return writer && !writer->triangles;
}

const hewn_channel *hewn_writing_channel(const hewn_writing *job, hewn_domain domain, const char *name)
{
    for (uint32_t i = 0; i < job->channel_count; i++)
        if (job->channels[i].info.domain == domain && strcmp(job->channels[i].info.name, name) == 0)
            return &job->channels[i];
    return NULL;
}

double hewn_channel_number(const hewn_channel *channel, uint64_t index, uint32_t component)
{
    size_t at = (size_t)index * channel->info.components + component;
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT: return (double)((const float *)channel->values)[at];
    case HEWN_SCALAR_DOUBLE: return ((const double *)channel->values)[at];
    case HEWN_SCALAR_UINT8: return ((const uint8_t *)channel->values)[at];
    case HEWN_SCALAR_INT32: return ((const int32_t *)channel->values)[at];
    }
    return 0;
}

char *hewn_object_name(const char *given, const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *from = given && *given ? given : strcmp(path, "-") == 0 ? "mesh" : slash ? slash + 1 : path;
    char *name = hewn_strdup(from);
    if (!name)
        return NULL;
    char *dot = strrchr(name, '.');
    if (!(given && *given) && dot && dot != name)
        *dot = '\0';
    for (char *at = name; *at; at++)
        if ((unsigned char)*at < 0x20 || *at == 0x7f)
            *at = ' ';
    return name;
}

/* --- checks ------------------------------------------------------------------------------------------------------- */

static hewn_result check_size(const hewn_writing *job, const hewn_format_writer *writer, hewn_error *error)
{
    if (job->vertex_count > (uint64_t)UINT32_MAX + 1 || job->face_count > UINT64_MAX / 64)
        return hewn_fail(error, HEWN_LIMIT, "%llu vertices and %llu faces are more than indices can name",
                         (unsigned long long)job->vertex_count, (unsigned long long)job->face_count);
    return writer->fits ? writer->fits(job, error) : HEWN_OK;
}

/* A look at the progress callback now and then. */
static hewn_result look_up(const hewn_progress *progress, uint64_t done, hewn_error *error)
{
    return done % (16 * HEWN_WRITE_BLOCK) == 0 ? hewn_progress_report(progress, "write", 0, error) : HEWN_OK;
}

/* The largest of some indices. */
HEWN_CLONES static uint32_t find_largest(const uint32_t *indices, uint64_t count)
{
    uint32_t largest = 0;
    for (uint64_t i = 0; i < count; i++)
        largest = indices[i] > largest ? indices[i] : largest;
    return largest;
}

/* Whether none of some numbers is infinite or NaN, whose exponents have all bits set. */
HEWN_CLONES static bool all_finite(const float *numbers, uint64_t count)
{
    uint32_t most = 0;
    for (uint64_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, numbers + i, sizeof bits);
        bits &= 0x7FFFFFFFu;
        most = bits > most ? bits : most;
    }
    return most < 0x7F800000u;
}

/* Numbers are looked at in runs, some of them at once, and one by one only where one of them is wrong. */
enum { CHECK_RUN = 1 << 16, RUNS_AT_ONCE = 16 };

static hewn_result blame_number(const hewn_triangles *mesh, uint64_t begin, uint64_t end, bool index, hewn_error *error)
{
    for (uint64_t i = begin; i < end; i++) {
        if (index && mesh->indices[i] >= mesh->vertex_count)
            return hewn_fail(error, HEWN_BAD_INPUT, "triangle %llu names vertex %u, but there are %llu vertices",
                             (unsigned long long)(i / 3), mesh->indices[i], (unsigned long long)mesh->vertex_count);
        if (!index && !isfinite(mesh->positions[i]))
            return hewn_fail(error, HEWN_BAD_INPUT, "the position of vertex %llu is not finite",
                             (unsigned long long)(i / 3));
    }
    return HEWN_OK;
}

static bool all_good(const hewn_triangles *mesh, bool index, uint64_t begin, uint64_t end)
{
    bool good = true;
#pragma omp parallel for schedule(static) reduction(&& : good) if (end - begin > 4 * (uint64_t)CHECK_RUN)
    for (uint64_t at = begin; at < end; at += CHECK_RUN) {
        const uint64_t length = end - at < CHECK_RUN ? end - at : CHECK_RUN;
        good = good && (index ? find_largest(mesh->indices + at, length) < mesh->vertex_count
                              : all_finite(mesh->positions + at, length));
    }
    return good;
}

static hewn_result check_numbers(const hewn_triangles *mesh, bool index, const hewn_progress *progress,
                                 hewn_error *error)
{
    const uint64_t count = 3 * (index ? mesh->triangle_count : mesh->vertex_count);
    for (uint64_t begin = 0, end; begin < count; begin = end) {
        end = count - begin < RUNS_AT_ONCE * CHECK_RUN ? count : begin + RUNS_AT_ONCE * CHECK_RUN;
        if (!all_good(mesh, index, begin, end))
            return blame_number(mesh, begin, end, index, error);
        for (uint64_t at = begin + CHECK_RUN; at <= end; at += CHECK_RUN) /* who maps the numbers lets pages go here */
            HEWN_TRY(hewn_progress_report(progress, "write", 0, error));
    }
    return HEWN_OK;
}

static hewn_result check_triangles(const hewn_triangles *mesh, const hewn_progress *progress, hewn_error *error)
{
    if ((mesh->vertex_count > 0 && !mesh->positions) || (mesh->triangle_count > 0 && !mesh->indices))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "triangles without positions or indices");
    HEWN_TRY(check_numbers(mesh, true, progress, error));
    return check_numbers(mesh, false, progress, error);
}

/* Numbers in files are finite: readers elsewhere take anything else ill. */
static hewn_result check_channel(const hewn_channel *channel, uint64_t count, const hewn_progress *progress,
                                 hewn_error *error)
{
    bool real = channel->info.scalar == HEWN_SCALAR_FLOAT || channel->info.scalar == HEWN_SCALAR_DOUBLE;
    uint32_t components = channel->info.components;
    for (uint64_t i = 0; real && i < count; i++) {
        for (uint32_t k = 0; k < components; k++)
            if (!isfinite(hewn_channel_number(channel, i, k)))
                return hewn_fail(error, HEWN_BAD_INPUT, "\"%s\" of %s %llu is not finite", channel->info.name,
                                 channel->info.domain == HEWN_DOMAIN_VERT     ? "vertex"
                                 : channel->info.domain == HEWN_DOMAIN_CORNER ? "corner"
                                                                              : "face",
                                 (unsigned long long)i);
        HEWN_TRY(look_up(progress, i + 1, error));
    }
    return HEWN_OK;
}

hewn_result hewn_writing_check(const hewn_writing *job, hewn_error *error)
{
    const uint64_t counts[] = {[HEWN_DOMAIN_VERT] = job->vertex_count,
                               [HEWN_DOMAIN_CORNER] = job->corner_count,
                               [HEWN_DOMAIN_FACE] = job->face_count};
    for (uint32_t i = 0; i < job->channel_count; i++)
        HEWN_TRY(check_channel(&job->channels[i], counts[job->channels[i].info.domain], job->progress, error));
    return HEWN_OK;
}

/* --- writing ------------------------------------------------------------------------------------------------------ */

static hewn_result write_file(const hewn_format_writer *writer, const hewn_writing *job, const char *path,
                              hewn_error *error)
{
    hewn_output *output;
    HEWN_TRY(hewn_progress_report(job->progress, "write", 0, error));
    HEWN_TRY(hewn_output_create(path, &output, error));
    hewn_result result = writer->write(job, output, error);
    if (result == HEWN_OK)
        return hewn_output_finish(&output, error);
    hewn_output_destroy(&output);
    return result;
}

static hewn_result find_writer(const char *path, hewn_mesh_format format, const hewn_format_writer **out,
                               hewn_error *error)
{
    *out = writer_of(format != HEWN_MESH_UNKNOWN ? format : hewn_mesh_format_of(path));
    if (!*out)
        return hewn_fail_at(
            error, HEWN_INVALID_ARGUMENT, path, 0,
            "no format that can be written; known extensions are .glb, .obj, .ply, .stl, .off and .3mf");
    if (!(*out)->to_stdout && strcmp(path, "-") == 0)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "this format cannot be written to standard output");
    return HEWN_OK;
}

static hewn_result prepare_and_write(hewn_writing *job, const hewn_format_writer *writer, const char *path,
                                     const hewn_write_desc *desc, hewn_error *error)
{
    char *name = hewn_object_name(desc->name, path);
    job->name = name;
    hewn_result result =
        name ? hewn_writing_check(job, error) : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    if (result == HEWN_OK && writer->prepare)
        result = writer->prepare(job, error);
    if (result == HEWN_OK)
        result = write_file(writer, job, path, error);
    if (writer->release)
        writer->release(job);
    hewn_free(job->head);
    hewn_free(name);
    return result;
}

/* Pairs of triangles as faces of four corners, which are the caller's. */
static hewn_result take_quads(const hewn_triangles *triangles, uint32_t **out, hewn_writing *job, hewn_error *error)
{
    uint64_t count = triangles->triangle_count / 2;
    uint32_t *quads = hewn_alloc(count, 4 * sizeof *quads);
    if (!quads)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for writing");
    for (uint64_t i = 0; i < count; i++) {
        memcpy(quads + 4 * i, triangles->indices + 6 * i, 3 * sizeof *quads);
        quads[4 * i + 3] = triangles->indices[6 * i + 5];
    }
    job->face_count = count;
    job->corner_count = 4 * count;
    job->each = 4;
    job->corners = quads;
    *out = quads;
    return HEWN_OK;
}

hewn_result hewn_triangles_write(const hewn_triangles *triangles, const char *path, const hewn_write_desc *desc,
                                 hewn_error *error)
{
    static const hewn_write_desc defaults;
    const hewn_write_desc *wanted = desc ? desc : &defaults;
    const hewn_format_writer *writer;
    HEWN_TRY(find_writer(path, wanted->format, &writer, error));
    enum { MORE = 4 };
    hewn_channel channels[MORE + 1] = {
        {.info = {"normal", HEWN_DOMAIN_VERT, HEWN_SCALAR_FLOAT, 3}, .values = triangles->normals}};
    uint32_t count = triangles->normals ? 1 : 0;
    if (wanted->channel_count > MORE)
        return hewn_fail(error, HEWN_INVALID_ARGUMENT, "at most %d channels besides, not %u", MORE,
                         wanted->channel_count);
    for (uint32_t i = 0; i < wanted->channel_count; i++)
        channels[count++] = wanted->channels[i];
    hewn_writing job = {.vertex_count = triangles->vertex_count,
                        .face_count = triangles->triangle_count,
                        .corner_count = 3 * triangles->triangle_count,
                        .floats = triangles->positions,
                        .all_float = true,
                        .each = 3,
                        .corners = triangles->indices,
                        .triangle_count = triangles->triangle_count,
                        .channels = channels,
                        .channel_count = count,
                        .unit = wanted->unit || wanted->unsure ? wanted->unit : hewn_unit_at(0),
                        .up = wanted->up,
                        .up_known = !wanted->unsure,
                        .space = wanted->space,
                        .progress = wanted->progress};
    uint32_t *quads = NULL;
    HEWN_TRY(check_size(&job, writer, error));
    HEWN_TRY(check_triangles(triangles, wanted->progress, error));
    if (wanted->quads && triangles->paired && !writer->triangles)
        HEWN_TRY(take_quads(triangles, &quads, &job, error));
    hewn_result result = prepare_and_write(&job, writer, path, wanted, error);
    hewn_free(quads);
    return result;
}

static bool is_all_float(const hewn_model *model)
{
    for (uint64_t i = 0; i < 3 * model->vertex_count; i++)
        if ((double)(float)model->positions[i] != model->positions[i])
            return false;
    return true;
}

hewn_writing hewn_writing_of(const hewn_model *model, const hewn_write_desc *wanted)
{
    return (hewn_writing){.vertex_count = model->vertex_count,
                          .face_count = model->face_count,
                          .corner_count = hewn_model_corner_count(model),
                          .doubles = model->positions,
                          .all_float = is_all_float(model),
                          .first = model->first,
                          .each = 3,
                          .corners = model->corners,
                          .triangle_count = model->face_count,
                          .channels = model->channels,
                          .channel_count = model->channel_count,
                          .unit = model->unit ? model->unit : wanted->unit,
                          .up = model->up_known ? model->up : wanted->up,
                          .up_known = model->up_known || wanted->unit,
                          .space = wanted->space,
                          .progress = wanted->progress};
}

hewn_result hewn_model_write(const hewn_model *model, const char *path, const hewn_write_desc *desc, hewn_error *error)
{
    static const hewn_write_desc defaults;
    const hewn_write_desc *wanted = desc ? desc : &defaults;
    const hewn_format_writer *writer;
    HEWN_TRY(find_writer(path, wanted->format, &writer, error));
    HEWN_TRY(hewn_model_check(model, error));
    hewn_writing job = hewn_writing_of(model, wanted);
    uint32_t *cut = NULL;
    if (writer->triangles && model->first) {
        hewn_polygons polygons = hewn_model_polygons(model);
        HEWN_TRY(hewn_cut_polygons(&polygons, &cut, &job.triangle_count, wanted->progress, error));
        job.cut = cut;
    }
    hewn_result result = check_size(&job, writer, error);
    if (result == HEWN_OK)
        result = prepare_and_write(&job, writer, path, wanted, error);
    hewn_free(cut);
    return result;
}

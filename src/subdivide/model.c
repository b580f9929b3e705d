/* Subdividing a model: polygons first, then each channel in its own way. */
#include <math.h>
#include <string.h>

#include "base/alloc.h"
#include "mesh/renew_normals.h"
#include "subdivide/pick.h"
#include "subdivide/seams.h"

typedef struct model_job {
    const hewn_model *from;
    const hewn_subdivide_desc *desc;
    hewn_subdivision *sub;
    sub_picks picks;
    bool picked;      /* else the whole last level is the result */
    uint32_t *number; /* of each vertex in the result, HEWN_NONE for those left out; NULL: all stay */
    hewn_model to;
} model_job;

/* --- faces -------------------------------------------------------------------------------------------------------- */

typedef struct corner_sink {
    uint32_t *corners;
    uint64_t count;
} corner_sink;

static void count_corner(void *user, uint32_t vert, uint32_t corner)
{
    corner_sink *sink = user;
    (void)corner;
    if (sink->corners)
        sink->corners[sink->count] = vert;
    sink->count++;
}

/* Faces that were picked, and only the vertices that they name. */
static hewn_result write_picked(model_job *job, hewn_error *error)
{
    hewn_model *to = &job->to;
    uint32_t verts = hewn_subdivision_vert_count(job->sub), kept = 0;
    corner_sink sink = {0};
    to->face_count = job->picks.count;
    to->first = hewn_alloc(job->picks.count + 1, sizeof *to->first);
    job->number = hewn_alloc(verts, sizeof *job->number);
    if (!to->first || !job->number)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %zu faces", job->picks.count);
    for (size_t f = 0; f < job->picks.count; f++) {
        to->first[f] = sink.count;
        hewn_sub_walk(job->sub, job->sub, &job->picks, &job->picks.faces[f], count_corner, &sink);
    }
    to->first[job->picks.count] = sink.count;
    to->corners = sink.corners = hewn_alloc(sink.count, sizeof *to->corners);
    if (!to->corners)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %zu faces", job->picks.count);
    sink.count = 0;
    for (size_t f = 0; f < job->picks.count; f++)
        hewn_sub_walk(job->sub, job->sub, &job->picks, &job->picks.faces[f], count_corner, &sink);
    memset(job->number, 0xFF, verts * sizeof *job->number);
    for (uint64_t c = 0; c < sink.count; c++)
        job->number[to->corners[c]] = 0;
    for (uint32_t v = 0; v < verts; v++)
        job->number[v] = job->number[v] == HEWN_NONE ? HEWN_NONE : kept++;
    for (uint64_t c = 0; c < sink.count; c++)
        to->corners[c] = job->number[to->corners[c]];
    for (uint32_t v = 0; v < verts; v++)
        if (job->number[v] != HEWN_NONE)
            memmove(to->positions + 3 * (size_t)job->number[v], to->positions + 3 * (size_t)v, 3 * sizeof(double));
    to->vertex_count = kept;
    return HEWN_OK;
}

/* The last level's own arrays are taken over. */
static void take_whole(model_job *job)
{
    sub_level *last = &job->sub->levels[job->sub->count];
    job->to.vertex_count = last->verts;
    job->to.face_count = last->faces;
    if (last->sides != 3) {
        job->to.first = job->sub->first;
        job->sub->first = NULL;
    }
    job->to.corners = last->corner_verts;
    last->corner_verts = NULL;
}

static hewn_result make_faces(model_job *job, double adaptive, hewn_subdivide_report *report, hewn_error *error)
{
    hewn_subdivision *sub = job->sub;
    bool inner = job->desc->boundary == HEWN_BOUNDARY_NONE && job->desc->scheme != HEWN_SCHEME_BILINEAR;
    job->to.positions = hewn_alloc(hewn_subdivision_vert_count(sub), 3 * sizeof *job->to.positions);
    if (!job->to.positions)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u vertices", hewn_subdivision_vert_count(sub));
    HEWN_TRY(hewn_subdivision_evaluate(sub, job->from->positions, 3, job->to.positions, error));
    job->picked = inner || adaptive > 0;
    if (!job->picked)
        return HEWN_OK;
    HEWN_TRY(hewn_sub_pick(sub, job->to.positions, adaptive, inner, &job->picks, &report->dropped_faces, error));
    report->adaptive_faces = job->picks.coarse;
    return write_picked(job, error);
}

/* --- numbers of a channel as doubles ------------------------------------------------------------------------------ */

static double read_number(const hewn_channel *channel, size_t index)
{
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT: return (double)((const float *)channel->values)[index];
    case HEWN_SCALAR_DOUBLE: return ((const double *)channel->values)[index];
    case HEWN_SCALAR_UINT8: return ((const uint8_t *)channel->values)[index];
    default: return 0;
    }
}

static void write_number(hewn_channel *channel, size_t index, double value)
{
    switch (channel->info.scalar) {
    case HEWN_SCALAR_FLOAT: ((float *)channel->values)[index] = (float)value; break;
    case HEWN_SCALAR_DOUBLE: ((double *)channel->values)[index] = value; break;
    case HEWN_SCALAR_UINT8: ((uint8_t *)channel->values)[index] = (uint8_t)(fmin(fmax(value, 0), 255) + 0.5); break;
    default: break;
    }
}

/* Values of `count` control elements (element i: sources[i], or i) through a subdivision; to be freed. */
static hewn_result refine_values(const hewn_subdivision *sub, const hewn_channel *channel, const uint32_t *sources,
                                 double **out, hewn_error *error)
{
    uint32_t width = channel->info.components, count = sub->levels[0].verts;
    double *control = hewn_alloc(count, width * sizeof *control);
    *out = hewn_alloc(hewn_subdivision_vert_count(sub), width * sizeof **out);
    hewn_result result = HEWN_OK;
    if (!control || !*out)
        result = hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the attribute \"%s\"", channel->info.name);
    for (uint32_t i = 0; result == HEWN_OK && i < count; i++)
        for (uint32_t k = 0; k < width; k++)
            control[(size_t)i * width + k] = read_number(channel, (size_t)(sources ? sources[i] : i) * width + k);
    if (result == HEWN_OK)
        result = hewn_subdivision_evaluate(sub, control, width, *out, error);
    hewn_free(control);
    return result;
}

/* --- channels ----------------------------------------------------------------------------------------------------- */

/* The control vertex that a vertex of the last level is nearest to: of an edge its first end, of a face its first
 * corner. */
static uint32_t vert_origin(const hewn_subdivision *sub, uint32_t v)
{
    for (uint32_t at = sub->count; at > 0; at--) {
        const sub_level *level = &sub->levels[at - 1];
        if (v >= level->verts + level->edges)
            v = level->corner_verts[sub_face_begin(level, v - level->verts - level->edges)];
        else if (v >= level->verts)
            v = level->edge_verts[2 * (size_t)(v - level->verts)];
    }
    return v;
}

static hewn_result fill_verts(model_job *job, const hewn_channel *from, hewn_channel *to, hewn_error *error)
{
    uint32_t width = from->info.components, verts = hewn_subdivision_vert_count(job->sub);
    size_t stride = width * hewn_scalar_size(from->info.scalar);
    double *values = NULL;
    bool whole = from->info.scalar == HEWN_SCALAR_INT32;
    if (!whole) {
        hewn_result result = refine_values(job->sub, from, NULL, &values, error);
        if (result != HEWN_OK) {
            hewn_free(values);
            return result;
        }
    }
    for (uint32_t v = 0; v < verts; v++) {
        size_t at = job->number ? job->number[v] : v;
        if (at == HEWN_NONE)
            continue;
        if (whole)
            memcpy((char *)to->values + at * stride, (char *)from->values + vert_origin(job->sub, v) * stride, stride);
        for (uint32_t k = 0; !whole && k < width; k++)
            write_number(to, at * width + k, values[(size_t)v * width + k]);
    }
    hewn_free(values);
    return HEWN_OK;
}

/* Corners of a channel, in the order of the result. */
typedef struct value_sink {
    const model_job *job;
    const hewn_channel *from;
    hewn_channel *to;
    const double *values; /* NULL: those of the control corner */
    uint64_t count;
    uint32_t level;
} value_sink;

static void write_corner(void *user, uint32_t vert, uint32_t corner)
{
    value_sink *sink = user;
    uint32_t width = sink->from->info.components;
    size_t stride = width * hewn_scalar_size(sink->from->info.scalar);
    for (uint32_t k = 0; sink->values && k < width; k++)
        write_number(sink->to, sink->count * width + k, sink->values[(size_t)vert * width + k]);
    if (!sink->values) {
        size_t origin = hewn_sub_corner_origin(sink->job->sub, sink->level, corner);
        memcpy((char *)sink->to->values + sink->count * stride, (char *)sink->from->values + origin * stride, stride);
    }
    sink->count++;
}

static void write_corners(value_sink *sink, const hewn_subdivision *seams)
{
    const model_job *job = sink->job;
    const sub_level *last = &seams->levels[seams->count];
    for (size_t f = 0; job->picked && f < job->picks.count; f++) {
        sink->level = job->picks.faces[f].level;
        hewn_sub_walk(job->sub, seams, &job->picks, &job->picks.faces[f], write_corner, sink);
    }
    sink->level = seams->count;
    for (uint32_t c = 0; !job->picked && c < last->corners; c++)
        write_corner(sink, last->corner_verts[c], c);
}

static hewn_result fill_corners(model_job *job, const hewn_channel *from, hewn_channel *to, hewn_error *error)
{
    hewn_subdivision *seams = NULL;
    uint32_t *sources = NULL;
    double *values = NULL;
    size_t stride = from->info.components * hewn_scalar_size(from->info.scalar);
    hewn_result result = hewn_sub_seams(job->sub, from->values, stride, job->desc->uv, &seams, &sources, error);
    if (result == HEWN_OK && from->info.scalar != HEWN_SCALAR_INT32)
        result = refine_values(seams, from, sources, &values, error);
    value_sink sink = {job, from, to, values, 0, 0};
    if (result == HEWN_OK)
        write_corners(&sink, seams);
    hewn_free(values);
    hewn_free(sources);
    hewn_subdivision_destroy(&seams);
    return result;
}

static void fill_faces(model_job *job, const hewn_channel *from, hewn_channel *to)
{
    size_t stride = from->info.components * hewn_scalar_size(from->info.scalar);
    for (size_t f = 0; f < job->to.face_count; f++) {
        sub_picked face = job->picked ? job->picks.faces[f] : (sub_picked){job->sub->count, (uint32_t)f};
        size_t origin = hewn_sub_face_origin(job->sub, face.level, face.face);
        memcpy((char *)to->values + f * stride, (char *)from->values + origin * stride, stride);
    }
}

static hewn_result copy_names(const hewn_channel *from, hewn_channel *to, hewn_error *error)
{
    int32_t value;
    for (uint32_t i = 0; i < from->name_count; i++)
        HEWN_TRY(hewn_channel_value(to, from->names[i], &value, error));
    return HEWN_OK;
}

static hewn_result make_channels(model_job *job, hewn_error *error)
{
    for (uint32_t i = 0; i < job->from->channel_count; i++) {
        const hewn_channel *from = &job->from->channels[i];
        hewn_channel *to;
        HEWN_TRY(hewn_model_add_channel(&job->to, &from->info, &to, error));
        HEWN_TRY(copy_names(from, to, error));
        if (from->info.domain == HEWN_DOMAIN_VERT)
            HEWN_TRY(fill_verts(job, from, to, error));
        else if (from->info.domain == HEWN_DOMAIN_CORNER)
            HEWN_TRY(fill_corners(job, from, to, error));
        else
            fill_faces(job, from, to);
    }
    return HEWN_OK;
}

/* Whether there is one normal at a vertex: no corner, and no crease but a boundary. */
static bool has_normal(const sub_level *level, uint32_t v)
{
    if (!level->edge_sharp)
        return true;
    for (uint32_t i = level->vert_first[v]; i < level->vert_first[v + 1]; i++)
        if (level->edge_sharp[level->vert_edges[i]] > 0 && !sub_is_boundary(level, level->vert_edges[i]))
            return false;
    return level->vert_sharp[v] <= 0;
}

/* Exact normals where vertices are on the limit surface; those of creases, which have none, keep the faces' mean. */
static hewn_result limit_normals(model_job *job, hewn_error *error)
{
    hewn_channel *channel = hewn_model_find_channel(&job->to, HEWN_DOMAIN_VERT, "normal");
    uint32_t verts = hewn_subdivision_vert_count(job->sub);
    if (!channel || !job->desc->limit || job->sub->masks.linear || channel->info.components != 3)
        return HEWN_OK;
    double *normals = hewn_alloc(verts, 3 * sizeof *normals);
    if (!normals)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %u normals", verts);
    hewn_result result = hewn_subdivision_limit(job->sub, job->from->positions, NULL, NULL, NULL, normals, error);
    const sub_level *last = &job->sub->levels[job->sub->count];
    for (uint32_t v = 0; result == HEWN_OK && v < verts; v++) {
        size_t at = job->number ? job->number[v] : v;
        const double *n = normals + 3 * (size_t)v;
        if (at == HEWN_NONE || !has_normal(last, v) || n[0] * n[0] + n[1] * n[1] + n[2] * n[2] < 0.5)
            continue;
        for (size_t axis = 0; axis < 3; axis++)
            write_number(channel, 3 * at + axis, n[axis]);
    }
    hewn_free(normals);
    return result;
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(model_job *job, double adaptive, hewn_subdivide_report *report, hewn_error *error)
{
    HEWN_TRY(hewn_model_check(job->from, error));
    hewn_polygons polygons = hewn_model_polygons(job->from);
    HEWN_TRY(hewn_subdivision_create(&polygons, job->desc, &job->sub, error));
    report->levels = job->sub->count;
    report->creases = job->sub->tags.creases;
    report->corners = job->sub->tags.corners;
    HEWN_TRY(make_faces(job, adaptive, report, error));
    if (!job->picked) { /* channels need the counts, and the level its corners until they are done */
        job->to.vertex_count = hewn_subdivision_vert_count(job->sub);
        job->to.face_count = hewn_subdivision_face_count(job->sub);
        job->to.first = job->sub->levels[job->sub->count].sides == 3 ? NULL : job->sub->first;
    }
    hewn_result result = make_channels(job, error);
    if (!job->picked) {
        job->to.first = NULL;
        take_whole(job);
    }
    HEWN_TRY(result);
    HEWN_TRY(hewn_model_renew_normals(&job->to, error));
    return limit_normals(job, error);
}

hewn_result hewn_model_subdivide(hewn_model *model, const hewn_subdivide_desc *desc, double adaptive,
                                 hewn_subdivide_report *report, hewn_error *error)
{
    const hewn_subdivide_desc standard = {0};
    hewn_subdivide_report done = {0};
    model_job job = {.from = model, .desc = desc ? desc : &standard};
    if (report)
        *report = done;
    if (!(adaptive >= 0 && adaptive < INFINITY))
        return hewn_fail(error, HEWN_INVALID_ARGUMENT,
                         "the error of adaptive levels must be a number from 0 on, not %g", adaptive);
    hewn_result result = run(&job, adaptive, &done, error);
    hewn_subdivision_destroy(&job.sub);
    hewn_sub_picks_free(&job.picks);
    hewn_free(job.number);
    if (result != HEWN_OK) {
        hewn_model_destroy(&job.to);
        return result;
    }
    job.to.unit = model->unit;
    job.to.up = model->up;
    job.to.up_known = model->up_known;
    hewn_model_destroy(model);
    *model = job.to;
    if (report)
        *report = done;
    return HEWN_OK;
}

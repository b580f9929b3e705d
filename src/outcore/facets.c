#include "outcore/facets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/error.h"

/* Bytes of memory for a corner while its region is welded, with what sorting takes; triangles of a part; and
 * bytes of values that a face may have. */
enum { CORNER_MEMORY = 80, PART = 1 << 14, MOST_VALUES = 64 };

typedef struct facet_corner {
    double at[3];
    uint32_t corner;
} facet_corner;

typedef struct weld_work {
    hewn_facets *facets;
    hewn_store *store;
    hewn_regions regions;
    hewn_chain *lists;     /* one a region */
    hewn_pages *names;     /* the vertex of each corner */
    facet_corner *corners; /* of a region */
    size_t count;
    hewn_model part; /* faces on their way to the store */
    uint64_t taken;
} weld_work;

static hewn_result out_of_memory(hewn_error *error)
{
    return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory welding vertices");
}

void hewn_facets_begin(const char *output, hewn_facets *out)
{
    *out = (hewn_facets){.output = output};
}

void hewn_facets_free(hewn_facets *facets)
{
    hewn_model_destroy(&facets->schema);
    hewn_chain_free(&facets->corner_list);
    hewn_chain_free(&facets->value_list);
    hewn_chains_close(&facets->corners);
    hewn_chains_close(&facets->values);
    hewn_sample_free(&facets->sample);
    *facets = (hewn_facets){0};
}

/* --- coming in ---------------------------------------------------------------------------------------------------- */

static hewn_result learn(hewn_facets *facets, const hewn_model *part, hewn_error *error)
{
    facets->known = true;
    for (uint32_t i = 0; i < part->channel_count; i++) {
        hewn_channel *mine;
        const hewn_attribute_info *info = &part->channels[i].info;
        HEWN_TRY(hewn_model_add_channel(&facets->schema, info, &mine, error));
        facets->value_bytes += info->components * hewn_scalar_size(info->scalar);
    }
    if (facets->value_bytes > MOST_VALUES)
        return hewn_fail(error, HEWN_LIMIT, "facets have more values than %d bytes hold", MOST_VALUES);
    HEWN_TRY(hewn_chains_open(facets->output, sizeof(facet_corner), &facets->corners, error));
    return facets->value_bytes > 0 ? hewn_chains_open(facets->output, facets->value_bytes, &facets->values, error)
                                   : HEWN_OK;
}

static hewn_result add_corner(hewn_facets *facets, const double at[3], hewn_error *error)
{
    facet_corner corner = {.corner = (uint32_t)facets->corner_count};
    if (!(isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2])))
        return hewn_fail(error, HEWN_BAD_INPUT, "facet %llu has a position that is not finite",
                         (unsigned long long)(facets->corner_count / 3));
    if (facets->corner_count >= HEWN_NONE)
        return hewn_fail(error, HEWN_LIMIT, "more corners than indices can name");
    for (int axis = 0; axis < 3; axis++)
        corner.at[axis] = at[axis] + 0.0; /* -0 becomes 0 */
    if (hewn_sample_takes(&facets->sample, facets->corner_count))
        HEWN_TRY(hewn_sample_add(&facets->sample, facets->corner_count, corner.at, error));
    facets->corner_count++;
    return hewn_chain_add(&facets->corners, &facets->corner_list, &corner, error);
}

hewn_result hewn_facets_add(hewn_facets *facets, const hewn_model *part, hewn_error *error)
{
    char values[MOST_VALUES];
    if (!facets->known)
        HEWN_TRY(learn(facets, part, error));
    for (uint64_t f = 0; f < part->face_count; f++) {
        char *at = values;
        for (uint64_t k = 0; k < 3; k++)
            HEWN_TRY(add_corner(facets, part->positions + 3 * (size_t)part->corners[3 * f + k], error));
        for (uint32_t i = 0; i < part->channel_count; i++) {
            const hewn_channel *channel = &part->channels[i];
            const size_t size = channel->info.components * hewn_scalar_size(channel->info.scalar);
            memcpy(at, (const char *)channel->values + f * size, size);
            at += size;
        }
        if (facets->value_bytes > 0)
            HEWN_TRY(hewn_chain_add(&facets->values, &facets->value_list, values, error));
    }
    return HEWN_OK;
}

/* --- welding ------------------------------------------------------------------------------------------------------ */

static hewn_result take_apart(void *user, const void *record, hewn_error *error)
{
    weld_work *work = user;
    facet_corner corner;
    memcpy(&corner, record, sizeof corner);
    return hewn_chain_add(&work->facets->corners, &work->lists[hewn_region_of(&work->regions, corner.at)], record,
                          error);
}

static hewn_result make_regions(weld_work *work, uint64_t memory, hewn_error *error)
{
    hewn_facets *facets = work->facets;
    const double needed = 2 * (double)CORNER_MEMORY * (double)facets->corner_count;
    const double count = ceil(needed / (0.5 * (double)memory)) + 1;
    if (count * (double)hewn_chains_block_bytes(&facets->corners) > 0.5 * (double)memory)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                         "%llu corners would have to be welded in %.0f parts, which do not fit in the memory allowed "
                         "themselves",
                         (unsigned long long)facets->corner_count, count);
    HEWN_TRY(hewn_regions_make(&facets->sample, (uint32_t)count, 0, &work->regions, error));
    work->lists = hewn_alloc_zero(work->regions.count, sizeof *work->lists);
    if (!work->lists)
        return out_of_memory(error);
    HEWN_TRY(hewn_chain_settle(&facets->corners, &facets->corner_list, error));
    HEWN_TRY(hewn_chain_read(&facets->corners, &facets->corner_list, true, take_apart, work, error));
    for (uint32_t r = 0; r < work->regions.count; r++)
        HEWN_TRY(hewn_chain_settle(&facets->corners, &work->lists[r], error));
    return HEWN_OK;
}

static int compare_corners(const void *a, const void *b)
{
    const facet_corner *one = a, *two = b;
    for (int axis = 0; axis < 3; axis++)
        if (one->at[axis] != two->at[axis])
            return one->at[axis] < two->at[axis] ? -1 : 1;
    return one->corner < two->corner ? -1 : one->corner > two->corner;
}

static hewn_result take_corner(void *user, const void *record, hewn_error *error)
{
    weld_work *work = user;
    (void)error;
    memcpy(&work->corners[work->count++], record, sizeof *work->corners);
    return HEWN_OK;
}

/* Equal positions are in the same region, and follow each other when they are sorted. */
static hewn_result weld(weld_work *work, hewn_chain *list, uint64_t memory, hewn_error *error)
{
    if (list->count > memory / CORNER_MEMORY)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY,
                         "%llu corners lie in one place, too many to weld in the memory allowed",
                         (unsigned long long)list->count);
    hewn_model part = {.positions = hewn_alloc(list->count, 3 * sizeof *part.positions)};
    work->corners = hewn_alloc(list->count, sizeof *work->corners);
    work->count = 0;
    hewn_result result = part.positions && work->corners
                             ? hewn_chain_read(&work->facets->corners, list, true, take_corner, work, error)
                             : out_of_memory(error);
    if (result == HEWN_OK)
        qsort(work->corners, work->count, sizeof *work->corners, compare_corners);
    for (size_t i = 0; result == HEWN_OK && i < work->count; i++) {
        const facet_corner *corner = &work->corners[i];
        if (i == 0 || memcmp(corner->at, corner[-1].at, sizeof corner->at) != 0)
            memcpy(part.positions + 3 * part.vertex_count++, corner->at, sizeof corner->at);
        const uint32_t name = (uint32_t)(work->store->vertex_count + part.vertex_count - 1);
        result = hewn_pages_put(work->names, corner->corner, &name, error);
    }
    if (result == HEWN_OK)
        result = hewn_store_add(work->store, &part, error);
    hewn_free(work->corners);
    work->corners = NULL;
    hewn_model_destroy(&part);
    return result;
}

/* --- faces -------------------------------------------------------------------------------------------------------- */

static hewn_result send(weld_work *work, hewn_error *error)
{
    const hewn_result result = work->part.face_count > 0 ? hewn_store_add(work->store, &work->part, error) : HEWN_OK;
    hewn_model_destroy(&work->part);
    return result;
}

static hewn_result begin_part(weld_work *work, hewn_error *error)
{
    const uint64_t left = work->facets->corner_count / 3 - work->taken;
    work->part.face_count = left < PART ? left : PART;
    work->part.corners = hewn_alloc(work->part.face_count, 3 * sizeof *work->part.corners);
    if (!work->part.corners)
        return out_of_memory(error);
    for (uint32_t i = 0; i < work->facets->schema.channel_count; i++) {
        hewn_channel *made;
        HEWN_TRY(hewn_model_add_channel(&work->part, &work->facets->schema.channels[i].info, &made, error));
    }
    return HEWN_OK;
}

/* The next face; `values` are those of its channels, one after the other. */
static hewn_result take_face(void *user, const void *values, hewn_error *error)
{
    weld_work *work = user;
    const uint64_t f = work->taken % PART;
    const char *at = values;
    if (f == 0) {
        HEWN_TRY(send(work, error));
        HEWN_TRY(begin_part(work, error));
    }
    for (uint64_t k = 0; k < 3; k++)
        HEWN_TRY(hewn_pages_get(work->names, 3 * work->taken + k, &work->part.corners[3 * f + k], error));
    for (uint32_t i = 0; at && i < work->part.channel_count; i++) {
        hewn_channel *channel = &work->part.channels[i];
        const size_t size = channel->info.components * hewn_scalar_size(channel->info.scalar);
        memcpy((char *)channel->values + f * size, at, size);
        at += size;
    }
    work->taken++;
    return HEWN_OK;
}

static hewn_result make_faces(weld_work *work, hewn_error *error)
{
    hewn_facets *facets = work->facets;
    if (facets->value_bytes > 0) {
        HEWN_TRY(hewn_chain_settle(&facets->values, &facets->value_list, error));
        HEWN_TRY(hewn_chain_read(&facets->values, &facets->value_list, true, take_face, work, error));
    } else {
        for (uint64_t f = 0; f < facets->corner_count / 3; f++)
            HEWN_TRY(take_face(work, NULL, error));
    }
    return send(work, error);
}

/* --- the whole ---------------------------------------------------------------------------------------------------- */

static hewn_result run(weld_work *work, uint64_t memory, hewn_error *error)
{
    if (work->facets->corner_count == 0)
        return HEWN_OK;
    HEWN_TRY(hewn_pages_create(work->facets->output, sizeof(uint32_t), (size_t)(memory / 4), &work->names, error));
    HEWN_TRY(make_regions(work, memory, error));
    for (uint32_t r = 0; r < work->regions.count; r++)
        if (work->lists[r].count > 0)
            HEWN_TRY(weld(work, &work->lists[r], memory, error));
    return make_faces(work, error);
}

hewn_result hewn_facets_weld(hewn_facets *facets, uint64_t memory, hewn_store *store, hewn_error *error)
{
    weld_work work = {.facets = facets, .store = store};
    const hewn_result result = run(&work, memory, error);
    for (uint32_t r = 0; work.lists && r < work.regions.count; r++)
        hewn_chain_free(&work.lists[r]);
    hewn_free(work.lists);
    hewn_regions_free(&work.regions);
    hewn_pages_destroy(&work.names);
    hewn_model_destroy(&work.part);
    return result;
}

#include "simplify/least.h"

#include "base/alloc.h"
#include "base/error.h"

enum { OF_COMPONENT = 4, OF_HANDLE = 12, OF_LOOP = 5 };

static uint32_t root_of(uint32_t *into, uint32_t v)
{
    while (into[v] != v)
        v = into[v] = into[into[v]];
    return v;
}

/* Components: of all edges, or of boundary edges only. */
static uint32_t count_joined(const simplify_work *work, bool boundary, uint32_t *into)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < work->vertex_count; v++) {
        into[v] = v;
        count += work->half[v] != SIMPLIFY_GONE && (!boundary || work->twin[work->half[v]] == HEWN_NONE);
    }
    for (uint32_t h = 0; h < 3 * work->face_count; h++) {
        if (work->tail[h - h % 3] == HEWN_NONE || (boundary && work->twin[h] != HEWN_NONE))
            continue;
        const uint32_t a = root_of(into, work->tail[h]), b = root_of(into, simplify_head(work, h));
        count -= a != b;
        into[a > b ? a : b] = a > b ? b : a;
    }
    return count;
}

static bool is_manifold(const simplify_work *work)
{
    for (uint32_t v = 0; v < work->vertex_count; v++)
        if (work->half[v] != SIMPLIFY_GONE && work->rank[v] == SIMPLIFY_APART)
            return false;
    return true;
}

hewn_result hewn_simplify_least(const simplify_work *work, uint32_t *least, hewn_error *error)
{
    *least = 0;
    if (!is_manifold(work))
        return HEWN_OK;
    uint32_t *into = hewn_alloc(work->vertex_count, sizeof *into);
    if (!into)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory simplifying");
    const int64_t components = count_joined(work, false, into), loops = count_joined(work, true, into);
    int64_t edges = 0;
    for (uint32_t h = 0; h < 3 * work->face_count; h++)
        edges += work->tail[h - h % 3] != HEWN_NONE && simplify_name(work, h) == h;
    hewn_free(into);
    const int64_t euler = (int64_t)work->live_vertices - edges + (int64_t)work->live_faces;
    const int64_t handles = (2 * components - loops - euler) / 2;
    const int64_t all = OF_COMPONENT * components + OF_LOOP * loops + OF_HANDLE * (handles > 0 ? handles : 0);
    *least = (uint32_t)(all < (int64_t)work->live_faces ? all : work->live_faces);
    return HEWN_OK;
}

#include "pipeline/spool.h"

#include <sys/mman.h>

#include "base/alloc.h"
#include "base/error.h"
#include "base/scratch.h"

enum { POSITIONS, NORMALS, INDICES, FILES, ITEM = 12 };

struct hewn_spool {
    hewn_scratch *files[FILES];
    void *views[FILES];
    size_t lengths[FILES];
    bool normals; /* parts have them */
};

hewn_result hewn_spool_create(const char *output, hewn_spool **out, hewn_error *error)
{
    hewn_spool *spool = hewn_alloc_zero(1, sizeof *spool);
    *out = NULL;
    hewn_result result = spool ? HEWN_OK : hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for temporary files");
    for (int i = 0; result == HEWN_OK && i < FILES; i++)
        result = hewn_scratch_create(output, &spool->files[i], error);
    if (result != HEWN_OK)
        hewn_spool_destroy(&spool);
    *out = spool;
    return result;
}

void hewn_spool_destroy(hewn_spool **spool_place)
{
    hewn_spool *spool = *spool_place;
    if (!spool)
        return;
    for (int i = 0; i < FILES; i++) {
        if (spool->views[i])
            munmap(spool->views[i], spool->lengths[i]);
        hewn_scratch_destroy(&spool->files[i]);
    }
    hewn_free(spool);
    *spool_place = NULL;
}

static hewn_result put(const hewn_spool *spool, int which, const void *items, uint64_t first, uint64_t count,
                       hewn_error *error)
{
    return hewn_scratch_write(spool->files[which], items, (size_t)(ITEM * count), ITEM * first, error);
}

hewn_result hewn_spool_take(hewn_spool *spool, const hewn_mesh_part *part, hewn_error *error)
{
    for (int i = 0; i < 2; i++) {
        const hewn_vertex_run *vertices = &part->vertices[i];
        const hewn_triangle_run *triangles = &part->triangles[i];
        HEWN_TRY(put(spool, POSITIONS, vertices->positions, vertices->first, vertices->count, error));
        if (vertices->normals)
            HEWN_TRY(put(spool, NORMALS, vertices->normals, vertices->first, vertices->count, error));
        spool->normals = spool->normals || vertices->normals;
        HEWN_TRY(put(spool, INDICES, triangles->indices, triangles->first, triangles->count, error));
    }
    return HEWN_OK;
}

static hewn_result map(hewn_spool *spool, int which, uint64_t count, hewn_error *error)
{
    spool->lengths[which] = (size_t)(ITEM * count);
    return hewn_scratch_map(spool->files[which], spool->lengths[which], &spool->views[which], error);
}

hewn_result hewn_spool_view(hewn_spool *spool, uint64_t vertices, uint64_t triangles, hewn_triangles *out,
                            hewn_error *error)
{
    *out = (hewn_triangles){0};
    HEWN_TRY(map(spool, POSITIONS, vertices, error));
    HEWN_TRY(map(spool, NORMALS, spool->normals ? vertices : 0, error));
    HEWN_TRY(map(spool, INDICES, triangles, error));
    *out = (hewn_triangles){.vertex_count = vertices,
                            .triangle_count = triangles,
                            .positions = spool->views[POSITIONS],
                            .normals = spool->views[NORMALS],
                            .indices = spool->views[INDICES]};
    return HEWN_OK;
}

void hewn_spool_relax(hewn_spool *spool)
{
    for (int i = 0; i < FILES; i++)
        if (spool->views[i])
            madvise(spool->views[i], spool->lengths[i], MADV_DONTNEED);
}

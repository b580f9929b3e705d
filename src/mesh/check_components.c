#include "mesh/check_components.h"

#include <stdlib.h>

#include "base/alloc.h"
#include "base/error.h"

/* --- trees -------------------------------------------------------------------------------------------------------- */

/* The root of a vertex's tree. Roots have the least number of their tree, so trees only ever shrink toward it and
 * threads may shorten paths under each other's feet (Anderson and Woll 1991). */
uint32_t hewn_trees_root(_Atomic uint32_t *parent, uint32_t v)
{
    for (;;) {
        uint32_t up = atomic_load_explicit(&parent[v], memory_order_relaxed);
        if (up == v)
            return v;
        uint32_t above = atomic_load_explicit(&parent[up], memory_order_relaxed);
        if (above == up)
            return up;
        atomic_compare_exchange_weak_explicit(&parent[v], &up, above, memory_order_relaxed, memory_order_relaxed);
        v = above;
    }
}

void hewn_trees_join(_Atomic uint32_t *parent, uint32_t a, uint32_t b)
{
    for (;;) {
        a = hewn_trees_root(parent, a);
        b = hewn_trees_root(parent, b);
        if (a == b)
            return;
        uint32_t low = a < b ? a : b, high = a < b ? b : a, expected = high;
        if (atomic_compare_exchange_strong_explicit(&parent[high], &expected, low, memory_order_relaxed,
                                                    memory_order_relaxed))
            return;
    }
}

static hewn_result grow(const hewn_face_view *view, _Atomic uint32_t **out, hewn_error *error)
{
    uint64_t vertices = view->vertex_count;
    _Atomic uint32_t *parent = hewn_alloc(vertices, sizeof *parent);
    *out = parent;
    if (!parent)
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for the components of %llu vertices",
                         (unsigned long long)vertices);
#pragma omp parallel if (view->face_count >= HEWN_CHECK_ALONE)
    {
#pragma omp for schedule(static)
        for (uint64_t v = 0; v < vertices; v++)
            atomic_init(&parent[v], (uint32_t)v);
#pragma omp for schedule(static)
        for (uint64_t f = 0; f < view->face_count; f++) {
            if (hewn_face_collapsed(view, f))
                continue;
            uint64_t begin = hewn_face_begin(view, f), end = hewn_face_begin(view, f + 1);
            for (uint64_t c = begin + 1; c < end; c++)
                hewn_trees_join(parent, view->corners[begin], view->corners[c]);
        }
    }
    return HEWN_OK;
}

/* Trees of vertices joined by faces; a used vertex that is its own parent stands for one component. */
hewn_result hewn_trees_grow(const hewn_face_view *view, const hewn_stars *stars, _Atomic uint32_t **out,
                            uint64_t *count, hewn_error *error)
{
    uint64_t roots = 0;
    HEWN_TRY(grow(view, out, error));
    _Atomic uint32_t *parent = *out;
#pragma omp parallel for schedule(static) reduction(+ : roots) if (view->face_count >= HEWN_CHECK_ALONE)
    for (uint64_t v = 0; v < view->vertex_count; v++)
        roots +=
            hewn_star_length(stars, (uint32_t)v) > 0 && atomic_load_explicit(&parent[v], memory_order_relaxed) == v;
    *count = roots;
    return HEWN_OK;
}

hewn_result hewn_trees_count(const hewn_face_view *view, uint64_t *count, hewn_error *error)
{
    _Atomic uint32_t *parent;
    uint64_t roots = 0;
    HEWN_TRY(grow(view, &parent, error));
#pragma omp parallel for schedule(static) reduction(+ : roots) if (view->face_count >= HEWN_CHECK_ALONE)
    for (uint64_t v = 0; v < view->vertex_count; v++)
        roots += atomic_load_explicit(&parent[v], memory_order_relaxed) == v;
    *count = roots;
    hewn_free((void *)parent);
    return HEWN_OK;
}

/* --- slots -------------------------------------------------------------------------------------------------------- */

typedef struct ranked_root {
    uint32_t faces, root;
} ranked_root;

static int compare_roots(const void *a, const void *b)
{
    const ranked_root *first = a, *second = b;
    if (first->faces != second->faces)
        return first->faces > second->faces ? -1 : 1;
    return first->root < second->root ? -1 : first->root > second->root;
}

/* `slots` of the roots become their numbers in `roots`; `roots` gets the faces of each. */
static void count_faces(const hewn_face_view *view, const hewn_stars *stars, _Atomic uint32_t *parent, uint32_t *slots,
                        ranked_root *roots)
{
    uint32_t count = 0;
    for (uint64_t v = 0; v < view->vertex_count; v++)
        if (hewn_star_length(stars, (uint32_t)v) > 0 && hewn_trees_root(parent, (uint32_t)v) == v) {
            slots[v] = count;
            roots[count++] = (ranked_root){0, (uint32_t)v};
        }
    for (uint64_t f = 0; f < view->face_count; f++)
        if (!hewn_face_collapsed(view, f))
            roots[slots[hewn_trees_root(parent, view->corners[hewn_face_begin(view, f)])]].faces++;
}

static hewn_result deal_slots(const hewn_face_view *view, const hewn_stars *stars, _Atomic uint32_t *parent,
                              hewn_components *out, hewn_error *error)
{
    ranked_root *roots = hewn_alloc(out->count, sizeof *roots);
    out->slots = hewn_alloc(view->vertex_count, sizeof *out->slots);
    if (!roots || !out->slots) {
        hewn_free(roots);
        return hewn_fail(error, HEWN_OUT_OF_MEMORY, "out of memory for %llu components",
                         (unsigned long long)out->count);
    }
    count_faces(view, stars, parent, out->slots, roots);
    qsort(roots, out->count, sizeof *roots, compare_roots);
    for (uint64_t i = 0; i < out->count; i++)
        out->slots[roots[i].root] = i < out->listed ? (uint32_t)i : out->listed;
    for (uint64_t v = 0; v < view->vertex_count; v++) /* roots come before the others of their trees */
        out->slots[v] =
            hewn_star_length(stars, (uint32_t)v) > 0 ? out->slots[hewn_trees_root(parent, (uint32_t)v)] : out->listed;
    hewn_free(roots);
    return HEWN_OK;
}

hewn_result hewn_components_find(const hewn_face_view *view, const hewn_stars *stars, uint32_t most_listed,
                                 hewn_components *out, hewn_error *error)
{
    _Atomic uint32_t *parent;
    *out = (hewn_components){0};
    hewn_result result = hewn_trees_grow(view, stars, &parent, &out->count, error);
    out->listed = out->count < most_listed ? (uint32_t)out->count : most_listed;
    if (result == HEWN_OK)
        result = deal_slots(view, stars, parent, out, error);
    hewn_free((void *)parent);
    return result;
}

void hewn_components_free(hewn_components *components)
{
    hewn_free(components->slots);
    *components = (hewn_components){0};
}
